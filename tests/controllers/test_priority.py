"""Who has to consider whom."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tests.helpers import inside
from tests.oracles import priority as oracle

is_neighbour, considered = inside("physim.controllers", "is_neighbour", "considered")
considered_by_rank = inside("physim.controllers", "considered_by_rank")
has_priority, rank, ranking_of = inside("physim.controllers", "has_priority", "rank", "ranking_of")
within_by_rank = inside("physim.controllers", "within_by_rank")

station = st.floats(-10.0, 10.0)


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
    for k in range(3000):
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
    assert min(ties, along_only, straight_only) >= 500


def test_a_ranking_finds_what_a_look_at_all_rows_finds() -> None:
    """Over several moments of one cluster, in which robots overtake one another."""
    ties = overtaken = 0
    for k in range(150):
        rng = np.random.default_rng([41, k])
        n = int(rng.choice([1, 5, 70, 200]))
        index = np.sort(rng.permutation(3 * n)[:n])
        pose = rng.uniform(-12.0, 12.0, (n, 3))
        along = np.round(rng.uniform(0.0, 30.0, n), int(rng.integers(0, 3)))
        if k % 2:  # numbers in the order of the places, or any
            along = np.sort(along)
        ranking = ranking_of(n)
        for _ in range(4):
            before = ranking.order.copy()
            rank(ranking, along, index)
            overtaken += not np.array_equal(before, ranking.order)
            ties += n - len(np.unique(along))
            for me in rng.integers(n, size=min(n, 6)):
                found = ranking.rows[: considered_by_rank(me, ranking, pose, 9.0)]
                assert np.array_equal(found, considered(me, index, pose, along, 9.0))
                near = ranking.rows[: within_by_rank(me, ranking, 7.0)]
                listed = np.zeros((0, 0), dtype=np.int64)
                mates = [
                    j for j in range(n) if is_neighbour(me, j, along[me], along[j], listed, 7.0)
                ]
                assert near.tolist() == mates
            along = along + np.round(rng.normal(0.0, 1.0, n), 1)
    assert ties >= 1000
    assert overtaken >= 100
