from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from physim.contacts import CONTACT_ROW, Kind, Phase
from tests.helpers import inside

Timeline, episodes = inside("physim.drawing", "Timeline", "episodes")


def test_the_nearest_sample_is_shown(made: Callable[..., Any], changed: Callable[..., Any]) -> None:
    record = made(1)
    timeline = Timeline(changed(record, time=np.array([0.0, 1.0, 3.0]), pose=record.pose[:3]))
    times = np.array([-1.0, 0.0, 0.5, 0.51, 1.9, 2.0, 2.1, 9.0])
    assert timeline.sample(times).tolist() == [0, 0, 0, 1, 1, 1, 2, 2]


def test_the_last_decision_at_or_before_holds(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    updates = made(3).updates[:4].copy()
    updates["robot"], updates["step"], updates["mode"] = [0, 1, 0, 1], [0, 5, 10, 10], [0, 1, 2, 3]
    timeline = Timeline(changed(made(3), updates=updates, dt=0.1))
    assert timeline.decisions(0.0).tolist() == [0, -1, -1]
    assert timeline.decisions(0.99).tolist() == [0, 1, -1]
    assert timeline.decisions(1.0).tolist() == [2, 3, -1]
    assert timeline.modes(timeline.decisions(1.0)).tolist() == [2, 3, -1]
    assert np.isnan(timeline.at(1.0).targets[2]).all()


def test_episodes_by_pair_and_time(made: Callable[..., Any], changed: Callable[..., Any]) -> None:
    began, stays, ended = Phase.BEGAN, Phase.STAYS, Phase.ENDED
    rows = [(10, 0, 1, began), (11, 0, 1, stays), (11, 1, 4, began), (12, 0, 1, ended)]
    rows += [(20, 0, 1, began), (30, 0, 2, began)]
    last = int(made(3).steps[-1])
    held = [(step, 1, 4, stays) for step in range(12, last + 1)]
    held += [(step, 0, 1, stays) for step in range(21, last + 1)]
    table = np.zeros(len(rows) + len(held), CONTACT_ROW)
    table["step"], table["a"], table["b"], table["phase"] = np.array(rows + held).T
    table["x"][: len(rows)], table["x"][len(rows) :] = np.arange(len(rows)), 9.0
    table["kind"][len(rows) - 1] = Kind.SWEPT
    record = changed(made(3), contacts=table, dt=0.1)
    found = episodes(record)
    assert found.began.tolist() == pytest.approx([1.0, 1.1, 2.0, 3.0])
    assert found.places[found.first, 0].tolist() == [0.0, 2.0, 4.0, 5.0]
    assert [found.count(t) for t in (0.9, 1.0, 1.1, 2.5, 3.0)] == [0, 1, 2, 3, 4]
    assert found.touching(1.15, 3).tolist() == [True, True, False]
    assert found.touching(1.2, 3).tolist() == [False, True, False], "0 and 1 parted at 1.2 s"
    assert found.touching(2.5, 3).tolist() == [True, True, False]
    assert found.touching(3.0, 3).tolist() == [True, True, True]
    assert found.touching(3.1, 3).tolist() == [True, True, False], "a swept contact is over at once"
    assert found.recent(2.0, 0.95).tolist() == [1, 2]
    assert [found.present(t).tolist() for t in (0.9, 1.0, 1.15, 1.2)] == [[], [0], [0, 1], [1]]
    places = [found.place_at(0, t)[0] for t in (0.5, 1.0, 1.09, 1.1, 9.0)]
    assert places == [0.0, 0.0, 0.0, 1.0, 1.0], "the last row before it ended"
    assert [found.place_at(2, t)[0] for t in (2.0, 2.5)] == [4.0, 9.0], "the next of that pair"
    assert found.apart.tolist() == pytest.approx([np.inf, np.inf, 0.8, np.inf])
    assert found.latest(np.arange(4)).tolist() == [1, 2, 3], "of 0 and 1 the second time alone"
    assert found.latest(np.arange(0)).tolist() == []


def test_who_has_arrived_is_told_by_the_motion(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    updates = made(3).updates.copy()
    updates["mode"] = 3
    timeline = Timeline(changed(made(3), updates=updates, arrived=np.array([50, -1, 100]), dt=0.02))
    assert [timeline.arrived(time) for time in (0.0, 0.99, 1.0, 2.0, 4.0)] == [0, 0, 1, 2, 2]
