"""Robots that touch nothing move as commanded, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers import inside
from tests.simulation.engine.hosts import host

arcs, chord_velocities = inside("physim.geometry", "arcs", "chord_velocities")


@pytest.mark.parametrize("dt", [0.01, 0.05, 0.1])
def test_equal_to_the_plain_update_and_to_the_arc(dt):
    rng = np.random.default_rng(7)
    start = np.column_stack((np.arange(6) * 500.0, rng.uniform(-9, 9, 6), rng.uniform(-3, 3, 6)))
    physics = host(start, dt=dt)
    plain, exact, velocity = start.copy(), start.copy(), np.zeros((6, 3))
    steps = round(100 / dt)
    for k in range(steps):
        if k % 10 == 0:
            command = rng.uniform(-1, 1, (6, 3))
        chord_velocities(plain, command, 6, dt, velocity)
        plain += velocity * dt
        physics.step(command)
        exact = arcs(exact, command, dt)
        assert np.array_equal(physics.pose, plain)
    assert np.abs(physics.pose - exact).max() < 1e-11  # places of 2500 m: an ulp is 5e-13 m
    assert len(physics.contacts) == 0
    assert not physics.touching.any()


@pytest.mark.parametrize("dt", [0.01, 0.05])
def test_within_1e_12_m_of_the_exact_arcs_after_100_s(dt):
    # Commands held for 0.5 s; each hold is one exact arc of the oracle, many steps of the engine.
    rng = np.random.default_rng(11)
    exact = np.array([[0.3, -0.2, 0.4], [4.0, 0.0, 2.0], [-4.0, 0.0, -1.0]])
    physics = host(exact, dt=dt)
    bearing = np.array([1.0, -1.0, 1.0])
    for _ in range(200):
        bearing = -bearing
        command = np.column_stack((rng.uniform(-0.3, 0.3, 3), bearing * rng.uniform(0.4, 0.6, 3)))
        exact = arcs(exact, command, 0.5)
        for _ in range(round(0.5 / dt)):
            physics.step(command)
    assert np.abs(physics.pose - exact).max() < 1e-12


def test_neighbours_in_contact_do_not_disturb_a_free_robot():
    start = [[0.0, 0.0, 0.0], [1.0, 0.0, np.pi], [0.0, 5.0, 0.3]]
    command = np.array([[1.0, 0.0], [1.0, 0.0], [1.0, 0.2]])
    crowded, alone = host(start), host([start[2]])
    for _ in range(100):
        crowded.step(command)
        alone.step(command[2:])
        assert crowded.touching.tolist() == [True, True, False]
        assert np.array_equal(crowded.pose[2], alone.pose[0])
