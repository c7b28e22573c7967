"""Who has to consider whom."""

from __future__ import annotations

import dataclasses

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from physim import View
from tests.controllers.agreement import considered_by
from tests.controllers.scenes import scene_of, sensed_at, single_robot
from tests.helpers import examples, inside
from tests.oracles import priority as oracle

considered_by_rank = inside("physim.controllers", "considered_by_rank")
has_priority, rank = inside("physim.controllers", "has_priority", "rank")
ranking_of = inside("physim.controllers", "ranking_of")
ModeSwitching = inside("physim.controllers", "ModeSwitching")
ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")

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
        ranking = ranking_of(n)
        rank(ranking, along, index)
        found = ranking.rows[: considered_by_rank(me, ranking, pose, along, 9.0)]
        assert sorted(index[found].tolist()) == expected
        gap = np.hypot(*(pose - pose[me])[:, :2].T)
        lead = along - along[me]
        ties += ((lead == 0.0) & (gap <= 9.0)).sum() - 1
        along_only += ((lead > 0.0) & (lead <= 9.0) & (gap > 9.0)).sum()
        straight_only += ((lead > 9.0) & (gap <= 9.0)).sum()
    assert min(ties, along_only, straight_only) >= 50


def test_considered_in_a_large_cluster_agree_with_the_oracle() -> None:
    """As decisions tell them, over several moments in which robots overtake one another."""
    rng, n = np.random.default_rng(42), 150
    history = single_robot(np.array([[0.0, 0.0], [60.0, 0.0]]), 0.0)
    ((robot,),) = history.moments
    pose, station = rng.uniform(-12.0, 12.0, (n, 3)), rng.uniform(0.0, 60.0, n).round(1)
    cluster = dataclasses.replace(history.cluster, range=9.0)
    scene = scene_of(dataclasses.replace(history, cluster=cluster, moments=[[robot] * n]))
    controller = ModeSwitching(ModeSwitchingSettings())
    memory = controller.start(scene)
    for step in range(3):
        rows = [
            dataclasses.replace(robot, pose=at, reference_station=s)
            for at, s in zip(pose, station.tolist(), strict=True)
        ]
        view = View(scene, sensed_at(rows, step))
        made = controller.decide_all(view, np.arange(n), memory)
        seen = [(j, pose[j], station[j]) for j in range(n)]
        for i in range(n):
            others = seen[:i] + seen[i + 1 :]
            expected = oracle.considered(i, pose[i], station[i], others, 9.0)
            assert considered_by(made, i).tolist() == expected
        station = (station + rng.normal(0.0, 3.0, n)).round(1)
