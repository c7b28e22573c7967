"""Figures on histories made by hand, with answers worked out by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from physim import Mode
from physim.analysis import metrics
from physim.analysis.metrics import Moment
from physim.analysis.summary import summarise, table_rows
from physim.errors import RecordError
from tests.analysis.metrics.histories import THERE, along_reference, history
from tests.helpers import inside
from tests.helpers.records import make_scene

FloatArray = inside("physim.geometry", "FloatArray")
Declared = inside("physim.parts", "Declared")

BEGAN, STAYS, ENDED = 0, 1, 2


def test_contact_episodes() -> None:
    """Rows of three pairs, interleaved; one pair touches twice; ended rows carry a gap."""
    record = history(contacts=[
        (5, 0, 1, BEGAN, 0.1, 2.0),
        (6, 0, 1, STAYS, 0.3, 5.0),
        (6, 1, 3, BEGAN, 0.5, 0.5),
        (7, 0, 1, ENDED, -0.2, 0.25),
        (7, 1, 3, ENDED, -0.2, 0.0),
        (8, 0, 1, BEGAN, 0.2, 4.0),
        (8, 0, 2, BEGAN, 0.0, 0.0),
    ])  # fmt: skip
    found = metrics.Figures(record).episodes
    assert [(e.a, e.b, e.step, e.samples) for e in found] == [
        (0, 1, 5, 2), (1, 3, 6, 1), (0, 1, 8, 1), (0, 2, 8, 1),
    ]  # fmt: skip
    assert [e.robots for e in found] == [True, False, True, False]
    assert [e.depth for e in found] == [0.3, 0.5, 0.2, 0.0]
    assert [e.impulse for e in found] == [7.25, 0.5, 4.0, 0.0]
    assert [e.impact for e in found] == [2.0, 0.5, 4.0, 0.0]
    assert found[0].time == pytest.approx(0.05)


@settings(max_examples=25)
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
    found = metrics.Figures(history(contacts=sorted(rows))).episodes
    for b, touching in ((1, first), (2, second)):
        edges = sum(t and not p for t, p in zip(touching, [False, *touching], strict=False))
        mine = [e for e in found if e.b == b]
        assert len(mine) == edges
        assert sum(e.impulse for e in mine) == sum(row[2] == b for row in rows)  # 1 N s each


def test_no_rows_at_all() -> None:
    run = metrics.Figures(history())
    assert run.episodes == ()
    assert (run.nearest, run.nearest_wall, run.farthest, run.collision_time) == (None,) * 4
    for name in (
        "formation_error_peak", "formation_error_final", "formation_error_rms",
        "formation_energy_peak", "danger_share", "mean_speed", "time_to_finish",
        "collision_time_evaluations",
    ):  # fmt: skip
        assert run.metric(name) is None, name
    assert [run.value(name) for name in ("finished", "decisions", "messages")] == [False, 0, 0]


def test_distances_come_from_the_extremes_over_all_steps() -> None:
    record = history(
        extremes=[(0.5, 7, 1, 0.3, 9, 3), (0.5, 7, 0, -0.1, 4, 2)], farthest=(8.0, 30, 0, 1)
    )
    run = metrics.Figures(record)
    assert (run.nearest, run.nearest_wall, run.farthest) == (
        Moment(0.5, 7, 0.07, 0, 1), Moment(-0.1, 4, 0.04, 1, 2), Moment(8.0, 30, 0.3, 0, 1),
    )  # fmt: skip


def test_shortest_collision_time_is_over_all_decisions() -> None:
    nan, inf = np.nan, np.inf
    times = [(0, 0, nan), (0, 1, inf), (10, 1, 0.7), (20, 0, 0.7), (30, 1, 2.0)]
    rows = [{"step": s, "robot": r, "collision_time": t} for s, r, t in times]
    assert metrics.Figures(history(rows)).collision_time == Moment(0.7, 10, 0.1, 1)
    assert metrics.Figures(history(rows[:2])).collision_time is None


def test_formation_errors() -> None:
    """Absolute values: the largest of all samples, and that of the last; whoever decided when."""
    stations = np.array([[9.0, 7.5, 3.0], [9.0, 5.0, 6.0], [9.0, 6.5, 4.5]])
    rows = [{"step": 1, "robot": 0, "formation_error": 50.0}]
    pose = along_reference(np.array([0, 1, 2]), stations)
    record = history(rows, robots=3, lead=np.array([0.0, -2.5, -5.0]), pose=pose, steps_run=2)
    errors = stations.mean(axis=1, keepdims=True) - stations - [-2.5, 0.0, 2.5]
    assert np.abs(errors).max(axis=1) == pytest.approx([1.0, 11 / 6, 1 / 3])
    for name, value, time in (("peak", 11 / 6, 0.01), ("final", 1 / 3, 0.02)):
        found = metrics.Figures(record).metric(f"formation_error_{name}")
        assert (found.value, found.time, found.bodies) == (pytest.approx(value), time, (2,))


def test_danger_share_by_decisions_and_by_time() -> None:
    """Robot 0: safe 10 steps, danger 5, there. Robot 1: safe 20, danger 80 of 400, cut off."""
    rows = [
        {"step": 0, "robot": 0, "mode": 0, "next_step": 10, "nominal_v": 1.0},
        {"step": 0, "robot": 1, "mode": 0, "next_step": 20, "nominal_v": 0.5},
        {"step": 10, "robot": 0, "mode": 1, "next_step": 15, "nominal_v": -1.0},
        {"step": 15, "robot": 0, "mode": 1, "next_step": 100, "station": THERE},
        {"step": 20, "robot": 1, "mode": 2, "next_step": 420, "nominal_v": 1.0},
    ]
    record = history(rows, arrived=[15, -1])
    share = metrics.Figures(record).metric("danger_share")
    assert share is not None
    assert share.robots == pytest.approx((5 / 15, 80 / 100))
    assert share.value == pytest.approx(85 / 115)
    assert metrics.Figures(record).value("mean_speed") == pytest.approx((10 - 5 + 10 + 80) / 115)


MOODS = (Mode("wait", "#000000"), Mode("go", "#111111"), Mode("fear", "#222222", danger=True))


def test_danger_is_what_the_controller_declares_as_such() -> None:
    rows = [{"step": 10 * k, "mode": k, "next_step": 10 * k + 10} for k in (0, 1, 2)]
    record = history(rows, robots=1, steps_run=30, declared=Declared(MOODS))
    share = metrics.Figures(record).metric("danger_share")
    assert share is not None
    assert share.value == pytest.approx(1 / 3)
    calm = history(rows[:2], robots=1, steps_run=30, declared=Declared(MOODS[:2]))
    assert metrics.Figures(calm).metric("danger_share") is None
    assert metrics.Figures(calm).metric("mode_switches") is None


def test_mean_speed_is_of_the_applied_commands_between_decisions_too() -> None:
    rows = [{"step": 0, "robot": 0, "nominal_v": 1.0, "next_step": 10}]
    slowed = [(step, 0, 1.0, 0.0, 1.0, 0.0, 0.25, 0.0) for step in (2, 3, 4, 5)]
    record = history(rows, robots=1, steps_run=10, commands=slowed)
    assert metrics.Figures(record).value("mean_speed") == pytest.approx((6 + 4 * 0.25) / 10)


def test_a_run_without_decisions_is_measured_by_its_motion_and_its_commands() -> None:
    told = [(step, 0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0) for step in range(6)]
    record = history(robots=1, steps_run=20, commands=told, arrived=[10])
    assert metrics.Figures(record).value("mean_speed") == pytest.approx(6 / 10)
    assert metrics.Figures(record).active_steps.tolist() == [10]
    assert metrics.Figures(record).metric("danger_share") is None


@pytest.mark.parametrize(
    ("arrived", "finish"), [([-1, -1], None), ([60, -1], None), ([60, 40], 0.6)]
)
def test_finished_means_that_all_have_arrived_by_their_motion(
    arrived: list[int], finish: float | None
) -> None:
    claims = [{"step": 0, "robot": i, "mode": 3} for i in (0, 1)]
    run = metrics.Figures(history(claims, arrived=arrived))
    assert run.value("finished") is (finish is not None)
    assert run.value("time_to_finish") == (None if finish is None else pytest.approx(finish))


def along(scene: Any, *stations: FloatArray) -> FloatArray:
    """Poses (K, N, 3) of robots on their paths, at stations (K,) short of their stop stations."""
    found = np.zeros((len(stations[0]), len(stations), 3))
    for i, short in enumerate(stations):
        a, b = scene.paths.start[i : i + 2]
        at, points = scene.paths.station[a:b], scene.paths.points[a:b]
        for k in (0, 1):
            found[:, i, k] = np.interp(scene.stop_station[i] - short, at, points[:, k])
    return found


def test_how_far_from_their_stops_robots_are_that_arrived() -> None:
    """Past it or beside it a robot has arrived, too: others may have pushed it there."""
    pose = along(make_scene(3), *np.zeros((3, 101)))
    pose[-1, 1, :2] += (0.3, -0.4)
    done = history([{"step": 0, "robot": 0}], robots=3, pose=pose, arrived=[50, 60, 70])
    found = metrics.Figures(done).metric("stop_distance")
    assert found is not None
    assert found.robots == pytest.approx((0.0, 0.5, 0.0), abs=1e-9)
    assert found.value == pytest.approx(0.5)
    assert "0.50 m" in dict(table_rows(summarise(done)))["all robots arrived"]
    short = history(robots=3, pose=pose, arrived=[50, -1, 70])
    assert metrics.Figures(short).metric("stop_distance") is None


def test_why_a_robot_has_not_arrived() -> None:
    """0 arrived, 1 stands 0.17 m short, 2 moves 12.3 m short, 3 moves at its stop, 4 just came."""
    time = 0.01 * np.arange(201)
    still, late = np.zeros(201), np.where(time < 1.8, 0.5 * (1.8 - time), 0.0)
    pose = along(
        make_scene(5), still, still + 0.17, 12.3 + 0.5 * (2.0 - time), 0.05 * (2.0 - time), late
    )
    rows = [{"step": 0, "robot": i, "station": s} for i, s in enumerate(made_stations(pose))]
    pose[-1, 3, :2] += square_to_the_end(3, 0.3)
    record = history(rows, robots=5, steps_run=200, pose=pose, arrived=[100, -1, -1, -1, -1])
    found = metrics.Figures(record).absent
    assert [one.robot for one in found] == [1, 2, 3, 4]
    assert [one.short for one in found] == pytest.approx([0.17, 12.3, 0.0, 0.0], abs=1e-9)
    assert [one.stands for one in found] == [True, False, False, False]
    assert [one.beside for one in found] == pytest.approx([0.0, 0.0, 0.3, 0.0], abs=1e-9)
    stands, far, moves, came = (one.sentence("r7") for one in found)
    assert has(stands, "r7", "stands", "0.17 m", "0.10 m")
    assert has(far, "r7", "moves", "12.3 m")
    assert has(moves, "r7", "moves")
    assert " m short" not in moves
    assert came == moves
    wide = history(rows, robots=5, steps_run=200, pose=pose, world="arrival: {tolerance: 0.1699}")
    waits, short = (one.sentence("r7") for one in metrics.Figures(wide).absent[:2])
    assert has(short, "r7", "stands", "0.1700 m", "0.1699 m")
    assert has(waits, "r7", "stop station", "0.5 s")


def has(sentence: str, *parts: str) -> bool:
    return all(part in sentence for part in parts)


def square_to_the_end(robot: int, by: float) -> FloatArray:
    """So far [m] to the left of the last leg of a path."""
    scene = make_scene(5)
    end = scene.paths.start[robot + 1]
    leg = np.diff(scene.paths.points[end - 2 : end], axis=0)[0]
    return by / np.hypot(*leg) * np.array([-leg[1], leg[0]])


def made_stations(pose: FloatArray) -> list[float]:
    """Stations at the start, of poses on the last leg of their paths."""
    scene = make_scene(pose.shape[1])
    ends = scene.paths.start[1:] - 1
    gap = np.hypot(*(scene.paths.points[ends] - pose[0, :, :2]).T)
    return [float(s) for s in scene.paths.station[ends] - gap]


def test_what_is_not_declared_or_not_recorded_has_no_figure() -> None:
    rows = [{"step": 0, "robot": 0, "next_step": 50, "nominal_v": 1.0}]
    found = metrics.measure(history(rows, declared=Declared()))
    missing = {"shortest_collision_time", "collision_time_evaluations", "danger_share"}
    assert not missing & set(found)
    assert found["mean_speed"].value == 1.0
    found = metrics.measure(history(tables=("considered",)))
    assert not {"contacts", "grazes", "decisions", "messages"} & set(found)


def test_messages_and_evaluations() -> None:
    rows = [{"step": s, "considered": s, "evaluations": 15 * s} for s in range(4)]
    run = metrics.Figures(history(rows, robots=4))
    names = ("decisions", "messages", "collision_time_evaluations")
    assert [run.value(name) for name in names] == [4, 6, 90]


@pytest.mark.parametrize(
    ("world", "said"),
    [
        ("formation: {neighbours: [[r1, nobody]]}", "neighbours"),
        ("formation: {range: far}", "range"),
    ],
)
def test_a_world_inside_that_no_run_has_is_told(world: str, said: str) -> None:
    """A record may come from a stranger: it was a traceback."""
    rows = [{"step": 0, "robot": i, "station": 1.0 + i} for i in range(2)]
    record = history(rows, world=world, pose=np.zeros((101, 2, 3)))
    with pytest.raises(RecordError, match=said):
        metrics.formation_energy(record)
