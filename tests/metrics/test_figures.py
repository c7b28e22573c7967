"""Figures on histories made by hand, with answers worked out by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim import metrics
from physim.metrics import DangerShare, Moment
from physim.record import Record
from tests.metrics.histories import history
from tests.records import make_record

BEGAN, STAYS, ENDED = 0, 1, 2


def test_contact_episodes() -> None:
    """Rows of three pairs, interleaved; one pair touches twice; ended rows carry a gap."""
    record = history(contacts=[
        (5, 0, 1, BEGAN, 0.1, 2.0),
        (6, 0, 1, STAYS, 0.3, 1.0),
        (6, 1, 3, BEGAN, 0.5, 0.5),
        (7, 0, 1, ENDED, -0.2, 0.0),
        (7, 1, 3, ENDED, -0.2, 0.0),
        (8, 0, 1, BEGAN, 0.2, 4.0),
        (8, 0, 2, BEGAN, 0.0, 0.0),
    ])  # fmt: skip
    found = metrics.contact_episodes(record)
    assert [(e.a, e.b, e.step, e.samples) for e in found] == [
        (0, 1, 5, 2), (1, 3, 6, 1), (0, 1, 8, 1), (0, 2, 8, 1),
    ]  # fmt: skip
    assert [e.robots for e in found] == [True, False, True, False]
    assert [e.depth for e in found] == [0.3, 0.5, 0.2, 0.0]
    assert [e.impulse for e in found] == [3.0, 0.5, 4.0, 0.0]
    assert found[0].time == pytest.approx(0.05)


@given(st.lists(st.booleans(), max_size=30), st.lists(st.booleans(), max_size=30))
def test_episodes_are_maximal_runs(first: list[bool], second: list[bool]) -> None:
    """Against counting rising edges of made-up touching histories of two pairs."""
    rows: list[tuple[Any, ...]] = []
    for b, history_of_pair in ((1, first), (2, second)):
        before = False
        for step, touches in enumerate(history_of_pair):
            phase = (STAYS if before else BEGAN) if touches else ENDED
            if touches or before:
                rows.append((step, 0, b, phase, 0.0, 1.0))
            before = touches
    found = metrics.contact_episodes(history(contacts=sorted(rows)))
    for b, touching in ((1, first), (2, second)):
        edges = sum(t and not p for t, p in zip(touching, [False, *touching], strict=False))
        mine = [e for e in found if e.b == b]
        assert len(mine) == edges
        assert sum(e.impulse for e in mine) == sum(touching)


def test_no_rows_at_all() -> None:
    record = history()
    assert metrics.contact_episodes(record) == ()
    assert metrics.shortest_distance(record) is None
    assert metrics.shortest_boundary_distance(record) is None
    assert metrics.farthest_pair(record) is None
    assert metrics.shortest_collision_time(record) is None
    assert metrics.formation_error_peak(record) is None
    assert metrics.formation_error_final(record) is None
    assert metrics.danger_shares(record) == (DangerShare(0, None, None), DangerShare(1, None, None))
    assert metrics.danger_time_share(record) is None
    assert metrics.mean_speed(record) is None
    assert not metrics.finished(record)
    assert metrics.time_to_finish(record) is None
    assert (metrics.decisions(record), metrics.messages(record), metrics.evaluations(record)) == (
        0, 0, 0,
    )  # fmt: skip


def test_distances_come_from_the_extremes_over_all_steps() -> None:
    record = history(
        extremes=[(0.5, 7, 1, 0.3, 9, 3), (0.5, 7, 0, -0.1, 4, 2)], farthest=(8.0, 30, 0, 1)
    )
    assert metrics.shortest_distance(record) == Moment(0.5, 7, 0.07, 0, 1)
    assert metrics.shortest_boundary_distance(record) == Moment(-0.1, 4, 0.04, 1, 2)
    assert metrics.farthest_pair(record) == Moment(8.0, 30, 0.3, 0, 1)


def test_one_robot_has_no_distance_and_no_formation_error() -> None:
    with make_record(robots=1, seconds=1.0) as record:
        assert metrics.shortest_distance(record) is None
        assert metrics.farthest_pair(record) is None
        assert metrics.formation_error_peak(record) is None
        assert metrics.formation_error_final(record) is None
        assert metrics.shortest_boundary_distance(record) is not None


def test_shortest_collision_time_is_over_all_decisions() -> None:
    nan, inf = np.nan, np.inf
    times = [(0, 0, nan), (0, 1, inf), (10, 1, 0.7), (20, 0, 0.7), (30, 1, 2.0)]
    rows = [{"step": s, "robot": r, "collision_time": t} for s, r, t in times]
    assert metrics.shortest_collision_time(history(rows)) == Moment(0.7, 10, 0.1, 1)
    assert metrics.shortest_collision_time(history(rows[:2])) is None


def test_formation_errors() -> None:
    """The peak is an absolute value; the final one is over each robot's own last decision."""
    errors = [(0, 0, 0.5), (0, 1, -4.0), (10, 0, 3.0), (20, 1, 0.25), (30, 1, -0.125)]
    rows = [{"step": s, "robot": r, "formation_error": e} for s, r, e in errors]
    record = history(rows)
    assert metrics.formation_error_peak(record) == Moment(4.0, 0, 0.0, 1)
    assert metrics.formation_error_final(record) == Moment(3.0, 10, 0.1, 0)
    late = history([*rows, {"step": 40, "robot": 0, "formation_error": np.nan}])
    assert metrics.formation_error_final(late) == Moment(0.125, 30, 0.3, 1)


def test_danger_share_by_decisions_and_by_time() -> None:
    """Robot 0: safe 10 steps, danger 5, arrived. Robot 1: safe 20, danger 80 of 400, cut off."""
    rows = [
        {"step": 0, "robot": 0, "mode": 0, "next_step": 10, "given_v": 1.0},
        {"step": 0, "robot": 1, "mode": 0, "next_step": 20, "given_v": 0.5},
        {"step": 10, "robot": 0, "mode": 1, "next_step": 15, "given_v": -1.0},
        {"step": 15, "robot": 0, "mode": 3, "next_step": 100},
        {"step": 20, "robot": 1, "mode": 2, "next_step": 420, "given_v": 1.0},
    ]
    record = history(rows)
    assert metrics.danger_shares(record) == (
        DangerShare(0, 0.5, pytest.approx(5 / 15)),
        DangerShare(1, 0.5, pytest.approx(80 / 100)),
    )
    assert metrics.danger_time_share(record) == pytest.approx(85 / 115)
    assert metrics.mean_speed(record) == pytest.approx((10 - 5 + 10 + 80) / 115)


def modes(*rows: tuple[int, int, int]) -> Record:
    return history([{"step": s, "robot": r, "mode": m} for s, r, m in rows])


def test_finished_means_that_all_are_there_at_their_last_decision() -> None:
    done = modes((0, 0, 0), (0, 1, 0), (30, 0, 3), (40, 1, 3), (50, 0, 0), (60, 0, 3), (70, 1, 3))
    assert metrics.finished(done)
    assert metrics.time_to_finish(done) == pytest.approx(0.6)
    assert metrics.time_to_finish(modes((0, 0, 3), (0, 1, 3))) == 0.0
    for record in (
        modes((0, 0, 0), (0, 1, 0), (30, 0, 3), (40, 1, 3), (50, 0, 0)),
        modes((0, 0, 3)),
    ):
        assert not metrics.finished(record)
        assert metrics.time_to_finish(record) is None


def test_messages_and_evaluations() -> None:
    rows = [{"step": s, "considered": s, "evaluations": 15 * s} for s in range(4)]
    record = history(rows)
    assert metrics.decisions(record) == 4
    assert metrics.messages(record) == 6
    assert metrics.evaluations(record) == 90
