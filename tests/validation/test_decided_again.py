"""Decisions made again by the world's own controller: a change is reported with row and column."""

from __future__ import annotations

import json

import pytest

import physim
from physim.analysis.validation import report, validate
from tests.forgeries.parts import Heard, Ramp, Slip
from tests.forgeries.runs import LANE
from tests.forgeries.tools import column, decided, dropped, together, world
from tests.helpers import inside
from tests.validation.reports import states
from tests.validation.runs import REAR_END, lane
from tests.validation.test_tampered import tampered

json_of_validation = inside("physim.analysis.validation", "json_of_validation")


@pytest.fixture(scope="module")
def free():
    return physim.simulate(physim.parse_world(LANE, overrides=["time.duration=8"]))


def judged(record, folder, change):
    with physim.Record.load(tampered(record, folder, change)) as forged:
        return validate(forged)


def test_as_it_is_everything_agrees(free):
    found = validate(free)
    assert found.recomputed.mismatches == found.recomputed.left_out == ()
    assert found.recomputed.replayed == found.recomputed.decisions == len(free.updates)
    assert states(report(found), f"{len(free.updates)} made again", "mode_switching", within=40)


@pytest.mark.parametrize(
    ("name", "value", "recorded", "exact"),
    [("mode", 2, "danger_time", "safe"), ("rule", 1, "plan", "path_following")],
)
def test_a_mode_and_a_rule(free, tmp_path, name, value, recorded, exact):
    found = judged(free, tmp_path, column("/updates", name, value, decided(0, 15)))
    (one,) = found.recomputed.mismatches
    assert (one.table, one.column, one.robot, one.step) == ("/updates", name, 0, 300)
    assert (one.recorded, one.exact, one.count) == (recorded, exact, 1)
    assert found.code == 3
    assert states(
        found.verdict, f"/updates, row {one.row}", "r1", name, f"{recorded} in the record"
    )
    (written,) = json.loads(json_of_validation(found))["recomputed"]["mismatches"]
    assert (written["told"], written["exact"], "recorded" in written) == (recorded, exact, False)


def test_a_decision_that_is_not_there(free, tmp_path):
    gone = together(dropped("/updates", decided(1, 20)), dropped("/considered", decided(1, 20)))
    found = judged(free, tmp_path, gone)
    (one,) = [one for one in found.recomputed.mismatches if one.column == "next_step"]
    assert (one.robot, one.step) == (1, free.updates["step"][free.updates["robot"] == 1][19])


def test_limits_lowered_in_the_world(free, tmp_path):
    found = judged(free, tmp_path, world("v: 1.5", "v: 0.9"))
    wrong = {(one.column, one.robot) for one in found.recomputed.mismatches if one.exact == 0.9}
    assert {("nominal_v", i) for i in range(3)} <= wrong


def test_limits_hold_for_a_controller_that_is_not_made_again(tmp_path):
    """The slow one goes 0.5 m/s, the fast one 1.4 where the world inside allows 0.9."""
    found = judged(lane(REAR_END), tmp_path, world("v: 1.5", "v: 0.9"))
    wrong = {(one.column, one.robot, one.exact) for one in found.recomputed.mismatches}
    assert wrong == {("nominal_v", 1, 0.9)}


def test_plans_of_several_speeds_are_remembered():
    text = LANE.replace("horizon: 4.0", "horizon: 4.0, dwell_times: [0.04, 0.06]")
    record = physim.simulate(physim.parse_world(text, overrides=["time.duration=5"]))
    assert len(set(record.updates["rule"].tolist())) > 1
    assert validate(record).recomputed.mismatches == ()


def test_behind_filters_and_disturbances_decisions_are_made_again(tmp_path):
    world = physim.parse_world(LANE, overrides=["time.duration=4"])
    record = physim.simulate(world, filters=[Ramp()], disturbances=[Slip()])
    found = validate(record)
    assert found.recomputed.mismatches == ()
    assert found.recomputed.replayed == len(record.updates)
    for word, said in zip(("filter", "disturbance"), found.recomputed.left_out, strict=True):
        assert word in said
        assert "--rerun" in said
        assert states(report(found), said, within=200)


def test_nobody_considers_itself_whatever_was_sensed(tmp_path):
    world = physim.parse_world(LANE, overrides=["time.duration=2"])
    record = physim.simulate(world, sensing=[Heard()])
    assert len(record.considered)
    own = column("/considered", "other", 1, lambda rows: rows["robot"] == 1)
    (one,) = judged(record, tmp_path, own).recomputed.mismatches
    assert (one.table, one.column, one.robot) == ("/considered", "other", 1)
    assert one.exact == "another robot"


def test_what_was_sensed_is_not_in_the_record():
    world = physim.parse_world(LANE, overrides=["time.duration=2"])
    found = validate(physim.simulate(world, sensing=[Heard()]))
    assert (found.recomputed.mismatches, found.recomputed.replayed) == ((), 0)
    assert states(report(found), "sensed", "not in the record", within=40)


def test_no_kernel_is_compiled_twice(free):
    decide_all = inside("physim.controllers", "decide_all")

    known = len(decide_all.whole.signatures)  # that of the run among them
    validate(free)
    assert len(decide_all.whole.signatures) == known
