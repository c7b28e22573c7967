"""Boxes that push each other straight on with whole faces go straight on, step after step.

Where edges lie on one line to 1e-16 m the engine takes them to overlap all along, or at a slant.
"""

from __future__ import annotations

import numpy as np
import pytest

from physim.simulation.engine import Physics
from tests.helpers import inside

pack_parts = inside("physim.geometry", "pack_parts")
meeting = inside("physim.simulation.engine", "meeting")

NO_WALLS = pack_parts([])


def box(length: float, width: float) -> list[list[tuple[float, float]]]:
    a, b = length / 2.0, width / 2.0
    return [[(-a, -b), (a, -b), (a, b), (-a, b)]]


CASES = {
    "long boxes": ((1.8, 1.0), [0.0, 2.1], [200.0, 50.0], 0.5, 0.02),
    "square boxes": ((1.0, 1.0), [0.0, 1.3], [200.0, 50.0], 1.0, 0.02),
    "broad boxes": ((0.5, 0.6), [0.0, 0.8], [100.0, 100.0], 1.0, 0.02),
    "slowly": ((1.8, 0.6), [0.0, 2.1], [200.0, 200.0], 0.1, 0.01),
}
"""Size [m], places [m], masses [kg], speed of the first one [m/s], step [s]"""


def pushed(case: str, steps: int) -> np.ndarray:
    """Poses (steps, N, 3): the first of the boxes is driven, the others are not."""
    size, places, mass, v, dt = CASES[case]
    shapes = pack_parts([box(*size)] * len(places))
    start = np.array([(x, 0.0, 0.0) for x in places])
    made = Physics(shapes, NO_WALLS, start, np.array(mass), dt)
    command = np.zeros((len(places), 2))
    command[0, 0] = v
    found = []
    for _ in range(steps):
        made.step(command)
        found.append(made.pose)
    return np.array(found)


@pytest.mark.parametrize("case", CASES)
def test_they_neither_turn_nor_leave_their_line(case: str) -> None:
    """19 mm and 3 degrees in one step of 10 ms, at 0.3 m/s."""
    pose = pushed(case, 1500)
    assert np.ptp(pose[:, -1, 0]) > 0.5  # the last one is pushed on
    assert np.abs(pose[:, :, 1]).max() < 1e-9
    assert np.abs(pose[:, :, 2]).max() < 1e-9


ROWS = {
    "four": ([1.11] * 3, 0.01),
    "four, far apart": ([1.2] * 3, 0.05),
    "six": ([1.11] * 5, 0.01),
    "six, far apart": ([1.2] * 5, 0.05),
    "unequal gaps": ([1.017, 1.141, 1.003, 1.22, 1.08], 0.01),
    "long steps": ([1.017, 1.141, 1.003, 1.22, 1.08], 0.05),
}
"""From each to the next [m], step [s]"""


@pytest.mark.parametrize("row", ROWS)
def test_a_row_that_is_pushed_stays_straight(row: str) -> None:
    """One of four turned by 12 mrad in a step of 10 ms, and by 74 in one of 50."""
    gaps, dt = ROWS[row]
    places = np.concatenate(([0.0], np.cumsum(gaps)))
    shapes = pack_parts([box(1.0, 0.6)] * len(places))
    start = np.stack((places, 0.0 * places, 0.0 * places), 1)
    made = Physics(shapes, NO_WALLS, start, np.full(len(places), 60.0), dt)
    command = np.zeros((len(places), 2))
    command[0, 0] = 1.0
    for _ in range(int(8.0 / dt)):
        made.step(command)
        assert np.abs(made.pose[:, 1:]).max() < 1e-6
    assert made.pose[-1, 0] > places[-1] + 0.1


@pytest.mark.parametrize("turn", [0.0, 0.7, -2.1])
@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_they_meet_in_the_middle_of_what_their_faces_have_in_common(turn, gap) -> None:
    shapes = pack_parts([box(1.0, 1.0), box(1.0, 0.5)])
    c, s = np.cos(turn), np.sin(turn)
    there = np.array(((1.0 + gap) * c - 0.6 * s, (1.0 + gap) * s + 0.6 * c, turn))
    nx, ny, *ends = meeting(shapes, 0, np.array((0.0, 0.0, turn)), 1, there)
    assert (nx, ny) == pytest.approx((-c, -s), abs=1e-12)
    faces = [(x * c - 0.425 * s, x * s + 0.425 * c) for x in (0.5, 0.5 + gap)]
    assert ends == pytest.approx([*faces[0], *faces[1]], abs=1e-12)
