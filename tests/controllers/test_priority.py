"""Who has to consider whom."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tests.helpers import examples, inside
from tests.oracles import priority as oracle

considered, has_priority = inside("physim.controllers", "considered", "has_priority")

station = st.floats(-10.0, 10.0)


@examples(25, deep=100)
@given(station, station)
def test_of_two_robots_exactly_one_has_priority(s_i: float, s_j: float) -> None:
    assert has_priority(s_i, 0, s_j, 1) != has_priority(s_j, 1, s_i, 0)


def test_the_one_ahead_has_priority_and_of_equals_the_lower_index() -> None:
    assert has_priority(1.0, 0, 2.0, 5)
    assert not has_priority(2.0, 5, 1.0, 0)
    assert has_priority(1.0, 5, 1.0, 0)
    assert not has_priority(1.0, 0, 1.0, 5)


def test_considered_are_those_ahead_within_range() -> None:
    pose = np.array([[0.0, 0, 0], [3.0, 0, 0], [-3.0, 0, 0], [0.0, 2, 0], [11.0, 0, 0]])
    along = np.array([0.0, 3.0, -3.0, 0.0, 11.0])
    index = np.arange(5)
    assert list(considered(0, index, pose, along, 10.0)) == [1]
    assert list(considered(3, index, pose, along, 10.0)) == [0, 1]
    assert list(considered(2, index, pose, along, 10.0)) == [0, 1, 3]


def test_considered_agree_with_the_oracle() -> None:
    """Rows in any order, equal stations, some ahead out of range along s* or straight."""
    ties = along_only = straight_only = 0
    for k in range(600):
        rng = np.random.default_rng([40, k])
        n = int(rng.integers(1, 8))
        index = np.sort(rng.permutation(20)[:n])
        pose = rng.uniform(-8.0, 8.0, (n, 3))
        along = np.round(rng.uniform(0.0, 20.0, n) / 2.0) * 2.0
        me = int(rng.integers(n))
        others = [(int(index[j]), pose[j], along[j]) for j in range(n) if j != me]
        expected = oracle.considered(int(index[me]), pose[me], along[me], others, 9.0)
        found = considered(me, index, pose, along, 9.0)
        assert index[found].tolist() == expected
        gap = np.hypot(*(pose - pose[me])[:, :2].T)
        lead = along - along[me]
        ties += ((lead == 0.0) & (gap <= 9.0)).sum() - 1
        along_only += ((lead > 0.0) & (lead <= 9.0) & (gap > 9.0)).sum()
        straight_only += ((lead > 9.0) & (gap <= 9.0)).sum()
    assert min(ties, along_only, straight_only) >= 50
