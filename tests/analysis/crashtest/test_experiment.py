"""The crash test agrees when all is well, and says so when anything is broken."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from physim import build_scene, simulate
from physim.analysis.crashtest import CrashReport, crash_test
from physim.simulation.engine import Physics
from physim.world.file import load_world
from tests.analysis.crashtest.sabotage import BROKEN, two_steps_late
from tests.helpers import inside

build_store = inside("physim.analysis.crashtest", "build_store")
KINDS, TIME_STEPS, text = inside("physim.analysis.crashtest", "KINDS", "TIME_STEPS", "text")
draw_case, place_of = inside("physim.analysis.crashtest", "draw_case", "place_of")
Verdict, case_world = inside("physim.analysis.crashtest", "Verdict", "case_world")

CASES = 50 * len(KINDS)
"""Ten of each kind at each time step."""


@pytest.fixture(scope="module")
def report() -> CrashReport:
    return crash_test(CASES, 5)


def test_engine_and_analysis_agree(report: CrashReport) -> None:
    assert report.cases == CASES
    assert report.unexplained == []
    assert report.count(Verdict.SAME_SAMPLE) > 200
    assert report.count(Verdict.NO_CONTACT) > 150
    assert report.count(Verdict.GRAZE) > 10
    figures = json.loads(report.to_json())
    assert set(figures["by_kind"]) == set(KINDS)
    assert all(
        sum(counts.values()) == CASES // len(KINDS) for counts in figures["by_kind"].values()
    )
    assert all(sum(counts.values()) == CASES // 5 for counts in figures["by_time_step"].values())
    lag = figures["contact_after_collision_time"]["quantiles"]
    assert lag["least"] > -1e-3
    assert lag["most"] < 1.0
    assert lag["median"] == pytest.approx(0.5, abs=0.1)
    verdict = text(report).splitlines()[-1]
    assert all(part in verdict for part in ("agree", f" 0 of {CASES} ", "seed 5", "unexplained"))


def test_swept_contacts_are_where_the_collision_time_says(report: CrashReport) -> None:
    figures = json.loads(report.to_json())
    swept = figures["swept_contact_against_collision_time"]
    assert swept["straight"]["quantiles"]["most"] <= 1e-6
    assert swept["beyond_chord_tolerance"] == 0
    grazes = figures["grazes_found_by_swept_check"]["straight"]
    assert grazes["found"] == grazes["of"]


def test_a_report_depends_on_its_seed_and_a_case_on_its_number_alone(report: CrashReport) -> None:
    fewer = [crash_test(110, seed) for seed in (5, 5, 6)]
    assert fewer[0].to_json() == fewer[1].to_json() != fewer[2].to_json()
    step = np.arange(CASES) // len(KINDS) % len(TIME_STEPS)  # cases are compared by time step
    of_all, of_few = (
        one.rows["verdict"][np.argsort(np.argsort(step[: one.cases], kind="stable"))]
        for one in (report, fewer[0])
    )
    assert np.array_equal(of_all[:110], of_few)


def test_a_stopped_test_reports_what_it_has() -> None:
    done: list[int] = []
    stopped = crash_test(CASES, 5, progress=done.append, stop=lambda: len(done) == 2)
    assert stopped.interrupted
    assert done == [CASES // 5, 2 * CASES // 5]
    assert stopped.cases == 2 * CASES // 5


# Broken on purpose


@pytest.mark.parametrize(("broken", "share"), BROKEN)
def test_a_broken_check_is_found_out(
    broken: Callable[..., object],
    share: float,
    report: CrashReport,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("physim.analysis.crashtest.experiment.predict", broken)
    found = crash_test(CASES, 5)
    assert len(found.unexplained) > share * report.count(Verdict.SAME_SAMPLE)
    assert all(one.reason for one in found.unexplained)
    verdict = text(found).splitlines()[-1]
    assert all(part in verdict for part in ("disagree", f" {len(found.unexplained)} of {CASES} "))


@pytest.mark.deep
def test_without_the_guard_the_engines_false_contacts_are_reported(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cases, seed = 600, 33
    guarded = crash_test(cases, seed)
    assert guarded.rejected > 0
    assert guarded.unexplained == []
    monkeypatch.setattr(
        "physim.analysis.crashtest.experiment.Physics", partial(Physics, _guarded=False)
    )
    found = crash_test(cases, seed)
    (near,) = found.unexplained  # between the skins of the engine's shapes
    assert (near.number, near.kind) == (512, "graze")
    assert near.collision_time == pytest.approx(3.602596)
    assert "1.55e-09 m" in near.reason


# Worlds of failing cases


def test_every_unexplained_case_becomes_a_world_that_replays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("physim.analysis.crashtest.experiment.predict", two_steps_late)
    found = crash_test(CASES, 5, folder=tmp_path / "worlds")
    assert len(list((tmp_path / "worlds").iterdir())) == len(found.unexplained) > 100
    seen = set()
    for one in found.unexplained:
        if one.kind in seen:
            continue
        seen.add(one.kind)
        assert one.world is not None
        world = load_world(one.world)
        assert one.reason in world.description
        with simulate(world) as record:
            assert record.dt == one.dt
            first = record.contacts["step"].min() if len(record.contacts) else None
            assert first == one.physical_sample
    assert seen == set(KINDS)


# Drawing


def test_cases_are_clear_at_the_start_and_keep_the_tunnelling_rule() -> None:
    store = build_store(9)
    for number in range(110):
        case = draw_case(9, number, place_of(number), store)
        scene = build_scene(case_world(case, 9, "drawn"))  # raises where a world is refused
        drawn = slice(1 if case.layout.second == "pushed" else None)  # its frame is another
        assert np.array_equal(scene.moving_start[drawn], case.layout.start[drawn])
        parts = np.concatenate([p for robot in case.layout.robots[drawn] for p in robot.parts])
        assert np.array_equal(scene.shapes.vertices[: len(parts)], parts)
