"""Breakdowns: when, for how long, of whom, and what a broken robot does."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.disturbances.steps import DT, applied


def counting(step: int) -> NDArray[np.float64]:
    return np.full((3, 2), step + 1.0)


@pytest.mark.parametrize(
    ("then", "held"),
    [("stands", [1, 2, 0, 0, 0, 6, 7, 8, 0, 0, 0, 12]),
     ("runs_on", [1, 2, 2, 2, 2, 6, 7, 8, 8, 8, 8, 12])],
)  # fmt: skip
def test_a_robot_stands_or_runs_on_for_a_while(then: str, held: list[int]) -> None:
    at = [2 * DT, 8 * DT]
    found = applied(
        "breakdown", 3, 12, commands=counting, at=at, lasts=3 * DT, then=then, robots=["r1"]
    )
    assert found[:, 1, 0].tolist() == held
    assert (found[:, [0, 2], 0] == np.arange(1, 13)[:, None]).all()


def test_without_an_end_it_is_for_ever() -> None:
    found = applied("breakdown", 3, 50, commands=counting, at=2 * DT)
    assert (found[2:] == 0.0).all()
    assert (found[:2] > 0.0).all()


def test_robots_break_down_at_their_rate_and_for_their_time() -> None:
    robots, steps, rate, lasts = 500, 2000, 0.1, 10
    broken = applied("breakdown", robots, steps, rate=rate, lasts=lasts * DT)[:, :, 0] == 0.0
    begun = np.diff(broken.astype(int), axis=0, prepend=0) == 1
    working = (~broken).sum() * DT
    count, expected = int(begun[1:].sum()), rate * working
    assert abs(count - expected) < 5.0 * expected**0.5
    for robot in range(20):
        edges = np.flatnonzero(np.diff(broken[:, robot].astype(int)))
        assert set(np.diff(edges)[::2].tolist()) == {lasts}
    assert np.corrcoef(broken[200, :-1], broken[200, 1:])[0, 1] < 5.0 * robots**-0.5


def test_a_probability_is_the_share_that_breaks_down() -> None:
    found = applied("breakdown", 4000, 5, at=DT, probability=0.3)
    share = float((found[4, :, 0] == 0.0).mean())
    assert abs(share - 0.3) < 5.0 * (0.3 * 0.7 / 4000) ** 0.5


def test_draws_are_of_one_robot_alone() -> None:
    few, many = (applied("breakdown", n, 400, rate=0.2, lasts=1.0) for n in (3, 9))
    assert (few == many[:, :3]).all()
    assert (few == 0.0).any(axis=0).all()
    named = applied("breakdown", 9, 400, rate=0.2, lasts=1.0, robots=["r2"])
    assert (named[:, 2] == many[:, 2]).all()
    assert (np.delete(named, 2, axis=1) == 1.0).all()
    assert (applied("breakdown", 9, 400, rate=0.2, lasts=1.0, stream=1) != many).any()
