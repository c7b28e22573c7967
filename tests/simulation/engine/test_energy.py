"""Contacts take energy and add none, whatever the friction."""

from __future__ import annotations

import numpy as np
import pytest

from tests.simulation.engine.hosts import box, drive, host

U = [
    [(0.516, 0.452), (-0.387, 0.452), (-0.129, 0.258), (0.516, 0.258)],
    [(-0.129, 0.258), (-0.387, 0.452), (-0.387, -0.452), (-0.129, -0.258)],
    [(-0.129, -0.258), (-0.387, -0.452), (0.516, -0.452), (0.516, -0.258)],
]
FLOOR = [[(-6.0, -6.0), (6.0, -6.0)]]
BACKWARDS = [-1.8023765795840256, -5.509782593090083, 1.3173745607214675]
TWICE = [[(-2.816, -0.183), (-0.827, -0.396)], [(-0.827, -0.396), (-2.816, -0.183)]]
INTO = [-2.646, -1.484, 0.630157570029585]


def check_steps(physics, command, steps):
    """No step is longer than its command, but for what eases overlaps."""
    v, omega = command
    poses, rows = drive(physics, command, steps)
    assert any(len(r) for r in rows)
    moved = np.abs(np.diff(poses[:, 0], axis=0))
    depth = np.array([r["depth"].max(initial=0.0) for r in rows])[:-1]
    fastest = np.hypot(v, omega)
    assert (np.hypot(*moved[:, :2].T) <= fastest * physics.dt * 1.0001 + 2.0 * depth).all()
    assert (moved[:, 2] <= 4.0 * (fastest * physics.dt + 2.0 * depth) + 1e-9).all()
    given = 10.0 * fastest
    assert all((r["impulse"] <= 10.0 * given).all() for r in rows)


@pytest.mark.parametrize("friction", [0.0, 1.0, 100.0])
def test_a_corner_dragged_along_a_floor_is_not_spun(friction):
    """At 100 the robot turned by 49,200 rad in a step, and its record could not be read."""
    physics = host([BACKWARDS], [U], walls=[FLOOR], dt=0.02, friction=friction)
    check_steps(physics, [-2.0, 0.0], 60)


def test_a_wall_drawn_there_and_back_flings_nobody():
    """Its solver had given the robot 1e76 m/s, and then looked for it in endless cells."""
    physics = host([INTO], [[box(1.608, 0.804)]], walls=[TWICE], dt=0.01, friction=5.0)
    check_steps(physics, [2.0, 0.0], 500)
