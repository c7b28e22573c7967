"""Errors of actuation: each is what its settings say, and off it is nothing."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.disturbances.steps import DT, applied

ROBOTS = 4000


def within(found: float, expected: float, deviation: float) -> None:
    """A figure is what it should be within five standard deviations of its own."""
    assert abs(found - expected) < 5.0 * deviation, (found, expected, deviation)


def test_gain_and_bias_have_their_mean_and_spread_from_robot_to_robot() -> None:
    v = {"gain": 0.9, "gain_spread": 0.1}
    omega = {"bias": 0.3, "bias_spread": 0.2}
    first, later = applied("actuation", ROBOTS, 2, v=v, omega=omega)
    assert (first == later).all()
    for k, mean, sd in ((0, 0.9, 0.1), (1, 1.3, 0.2)):
        within(first[:, k].mean(), mean, sd / ROBOTS**0.5)
        within(first[:, k].std(), sd, sd / (2 * ROBOTS) ** 0.5)
    within(np.corrcoef(first.T)[0, 1], 0.0, ROBOTS**-0.5)


@pytest.mark.parametrize("correlation", [0.0, 1.0])
def test_noise_has_its_deviation_at_every_step_and_is_forgotten_in_time(
    correlation: float,
) -> None:
    steps = round(1.0 / DT) + 1
    found = applied("actuation", ROBOTS, steps, v={"noise": 0.2}, correlation=correlation)
    assert (found[:, :, 1] == 1.0).all()
    noise = found[:, :, 0] - 1.0
    for step in range(steps):
        within(noise[step].mean(), 0.0, 0.2 / ROBOTS**0.5)
        within(noise[step].std(), 0.2, 0.2 / (2 * ROBOTS) ** 0.5)
    # half-way between two knots noise shares one half of the square of its deviation with each
    for apart, share in ((steps // 2, 2.0**-0.5 if correlation else 0.0), (steps - 1, 0.0)):
        within(np.corrcoef(noise[0], noise[apart])[0, 1], share, ROBOTS**-0.5)


def test_slip_loses_from_nothing_to_its_share() -> None:
    lost = 1.0 - applied("actuation", ROBOTS, 30, slip=0.4, correlation=1.0)
    assert 0.0 <= lost.min() < 0.01
    assert 0.39 < lost.max() <= 0.4
    within(lost[0, :, 0].mean(), 0.2, 0.4 / 12**0.5 / ROBOTS**0.5)
    within(np.corrcoef(lost[0].T)[0, 1], 0.0, ROBOTS**-0.5)


@pytest.mark.parametrize("delay", [1, 2, 7])
def test_a_delay_of_n_steps_is_n(delay: int) -> None:
    def commands(step: int) -> NDArray[np.float64]:
        return np.full((3, 2), step + 1.0)

    found = applied("actuation", 3, 20, delay=delay, commands=commands)
    wanted = [max(0, step + 1 - delay) for step in range(20)]
    assert found[:, 0, 0].tolist() == wanted


def test_a_robot_that_is_to_stand_stands() -> None:
    every = {"gain": 0.8, "bias": 0.5, "noise": 0.3}
    found = applied(
        "actuation", 3, 4, v=every, omega=every, slip=0.5, commands=lambda _: np.zeros((3, 2))
    )
    assert (found == 0.0).all()


def test_draws_are_of_one_robot_alone() -> None:
    every = {"gain_spread": 0.1, "bias_spread": 0.1, "noise": 0.1}
    settings = {"v": every, "omega": every, "slip": 0.2}
    few, many = (applied("actuation", n, 30, **settings) for n in (3, 5))
    assert (few == many[:, :3]).all()
    named = applied("actuation", 5, 30, robots=["r1", "r4"], **settings)
    assert (named[:, [1, 4]] == many[:, [1, 4]]).all()
    assert (named[:, [0, 2, 3]] == 1.0).all()
    wide = applied("actuation", 5, 30, parts=3, **settings)
    assert (wide[:, :, :2] == many).all()
    assert len(np.unique(wide[10, 0])) == 3
    other = applied("actuation", 5, 30, stream=1, **settings)
    assert not np.isclose(other, many).any()
    assert not np.isclose(applied("actuation", 5, 30, seed=8, **settings), many).any()
