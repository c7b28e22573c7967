"""Boxes that push each other straight on with whole faces go straight on, step after step.

Where edges lie on one line to 1e-16 m the engine takes them to overlap all along, or at a slant:
19 mm and 3 degrees in one step of 10 ms, at 0.3 m/s. Or it finds one end of the faces alone: one
of four turned by 12 mrad in a step of 10 ms, and by 74 in one of 50.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.simulation.engine.hosts import box, host

GAPS = [1.017, 1.141, 1.003, 1.22, 1.08]
CASES = [
    # size; from each to the next; masses; speed of the first [m/s]; step, whole time [s]; within
    ((1.8, 1.0), [2.1], [200.0, 50.0], 0.5, 0.02, 30.0, 1e-9),
    ((1.0, 1.0), [1.3], [200.0, 50.0], 1.0, 0.02, 30.0, 1e-9),
    ((0.5, 0.6), [0.8], [100.0, 100.0], 1.0, 0.02, 30.0, 1e-9),
    ((1.8, 0.6), [2.1], [200.0, 200.0], 0.1, 0.01, 15.0, 1e-9),
    ((1.0, 0.6), [1.11] * 3, 60.0, 1.0, 0.01, 8.0, 1e-6),
    ((1.0, 0.6), [1.2] * 3, 60.0, 1.0, 0.05, 8.0, 1e-6),
    ((1.0, 0.6), [1.11] * 5, 60.0, 1.0, 0.01, 8.0, 1e-6),
    ((1.0, 0.6), [1.2] * 5, 60.0, 1.0, 0.05, 8.0, 1e-6),
    ((1.0, 0.6), GAPS, 60.0, 1.0, 0.01, 8.0, 1e-6),
    ((1.0, 0.6), GAPS, 60.0, 1.0, 0.05, 8.0, 1e-6),
]


@pytest.mark.parametrize(("size", "gaps", "mass", "v", "dt", "time", "within"), CASES)
def test_a_row_that_is_pushed_stays_straight(size, gaps, mass, v, dt, time, within) -> None:
    start = [[x, 0.0, 0.0] for x in np.cumsum([0.0, *gaps])]
    physics = host(start, [[box(*size)]] * len(start), walls=[], dt=dt, mass=mass)
    command = np.zeros((len(start), 2))
    command[0, 0] = v
    for _ in range(round(time / dt)):
        physics.step(command)
        assert np.abs(physics.pose[:, 1:]).max() < within
    assert physics.pose[-1, 0] > start[-1][0] + 0.1  # the last one is pushed on
