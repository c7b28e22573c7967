"""Speeds of points of moving robots, against small moves along the exact arc."""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers import inside

point_speed = inside("physim.analysis.crashtest", "point_speed")
arc = inside("physim.geometry", "arc")

STEP = 1e-5
"""[s] Central differences over it are good to 1e-9 m/s here: omega^3 times the arm times STEP^2."""


@pytest.mark.parametrize("case", range(50))
def test_the_speed_of_a_point_is_that_of_its_arc(case: int) -> None:
    rng = np.random.default_rng([90, case])
    pose = np.array([*rng.uniform(-5.0, 5.0, 2), rng.uniform(-3.0, 3.0)])
    command = np.array([rng.uniform(-2.0, 2.0), rng.uniform(-1.5, 1.5)])
    arm = rng.uniform(-1.0, 1.0, 2)
    angle = rng.uniform(-3.0, 3.0)
    normal = np.array([np.cos(angle), np.sin(angle)])

    def place(t: float) -> np.ndarray:
        x, y, heading = arc(tuple(pose), command[0], command[1], t)
        c, s = np.cos(heading), np.sin(heading)
        return np.array([x + c * arm[0] - s * arm[1], y + s * arm[0] + c * arm[1]])

    velocity = (place(STEP) - place(-STEP)) / (2.0 * STEP)
    found = point_speed(pose, command, *place(0.0), *normal)
    assert found == pytest.approx(float(velocity @ normal), abs=1e-8)
