"""Where a robot stood: long enough, before it arrived, to the sample."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from tests.helpers import inside

LEAST, stands = inside("physim.drawing.page", "LEAST", "stands")

STILL = 0.02
"""[m/s] at which robots of a metre stand: 1 cm in half a second"""


def record(
    speeds: list[tuple[float, float]], arrived: int = -1, every: int = 1, radius: float = 1.0
) -> SimpleNamespace:
    """One robot on a line: (seconds, speed [m/s]) one behind the other, in samples of 0.1 s."""
    moved = np.concatenate([np.full(round(10 * s), 0.1 * v) for s, v in speeds])
    x = np.concatenate(([0.0], np.cumsum(moved)))
    pose = np.zeros((len(x), 1, 3))
    pose[:, 0, 0] = x
    return SimpleNamespace(
        steps=np.arange(len(x)) * every, dt=0.1 / every, pose=pose, robots=1,
        arrived=np.array([arrived]), shapes=SimpleNamespace(radius=np.array([radius])),
    )  # fmt: skip


@pytest.mark.parametrize("every", [1, 3])
@pytest.mark.parametrize(
    ("speeds", "arrived", "count"),
    [
        ([(1.0, 1.0), (LEAST - 0.1, 0.0), (1.0, 1.0)], -1, 0),
        ([(1.0, 1.0), (LEAST, 0.5 * STILL), (1.0, 1.0)], -1, 1),
        ([(1.0, 1.0), (LEAST, 2.0 * STILL), (1.0, 1.0)], -1, 0),
        ([(1.0, 1.0), (5.0, 0.0)], 10, 0),
        ([(1.0, 1.0), (5.0, 0.0)], 15, 0),
        ([(1.0, 1.0), (5.0, 0.0)], 30, 1),
        ([(2.0, 0.0), (1.0, 1.0), (2.0, 0.0)], -1, 2),
        ([], -1, 0),
    ],
)
def test_what_counts_as_standing(
    speeds: list[tuple[float, float]], arrived: int, count: int, every: int
) -> None:
    """``arrived`` counts samples; a record counts steps."""
    made = record(speeds or [(0.1, 1.0)], max(-1, arrived * every), every)
    assert len(stands(made)) == count


def test_a_stop_is_told_to_the_sample_and_by_the_size_of_the_robot() -> None:
    for every in (1, 5):
        found = stands(record([(2.0, 1.0), (1.5, 0.0), (1.0, 0.5)], every=every))
        assert found.tolist() == [[0, 20 * every, 35 * every]]
    for radius, spans in ((0.0165, 0), (1.0, 1)):  # a Kilobot at its full speed, and a car
        assert len(stands(record([(5.0, 0.01)], radius=radius))) == spans
