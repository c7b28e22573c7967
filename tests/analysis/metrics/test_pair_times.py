"""Collision times of all pairs under their present commands, against their closed form."""

from __future__ import annotations

import numpy as np
import pytest

from physim.record import Record
from tests.analysis.metrics.histories import history
from tests.helpers import inside

pair_collision_times = inside("physim.analysis.metrics", "pair_collision_times")
shortest_pair_collision_time = inside("physim.analysis.metrics", "shortest_pair_collision_time")

LENGTH = 1.8
"""[m] of a robot"""
AT = np.array([0.0, 6.0, 20.0])
"""[m] where the robots stand, one behind the other"""


def row(*commands: tuple[int, int, float]) -> Record:
    """Three robots in a row; ``commands`` are (step, robot, v)."""
    pose = np.zeros((101, 3, 3))
    pose[:, :, 0] = AT
    rows = [{"step": s, "robot": i, "nominal_v": v} for s, i, v in commands]
    return history(rows, robots=3, pose=pose)


def test_commands_are_those_given_at_that_step() -> None:
    """A robot that has decided nothing stands; a decision counts from its own step on."""
    record = row((0, 0, 1.0), (30, 1, 0.5), (60, 0, 2.0), (60, 1, -1.0))
    (time, least), who = pair_collision_times(record)
    assert time == pytest.approx([0.0, 0.3, 0.6])
    gap = 6.0 - LENGTH
    assert least == pytest.approx([gap / 1.0, gap / 0.5, gap / 3.0])
    assert who.tolist() == [[0, 1]] * 3


def test_least_over_all_pairs() -> None:
    """The third robot comes fast from far away; what parts never meets."""
    record = row((0, 0, 1.0), (0, 2, -8.0), (50, 0, -1.0), (50, 1, 0.0), (50, 2, 0.0))
    (_, least), who = pair_collision_times(record)
    gaps = 6.0 - LENGTH, 14.0 - LENGTH
    assert least[0] == pytest.approx(min(gaps[0] / 1.0, gaps[1] / 8.0))
    assert who[0].tolist() == [1, 2]
    assert least[1] == np.inf
    found = shortest_pair_collision_time(record)
    assert found is not None
    assert (found.value, found.step, found.a, found.b) == (least[0], 0, 1, 2)


def test_later_than_the_horizon_is_never() -> None:
    (_, least), _ = pair_collision_times(row((0, 0, 1.0)), horizon=4.0)
    assert least.tolist() == [np.inf]
    assert shortest_pair_collision_time(row((0, 0, 1.0)), horizon=4.0) is None
