"""Runs are judged rightly: contacts, who was responsible, and when they were due."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest

import physim
from physim.analysis.validation import report, responsibility, validate
from physim.contacts import Phase
from physim.errors import RecordError
from tests.helpers import facts, inside
from tests.validation.reports import states
from tests.validation.runs import DRIVERS, LANE, lane

GRAZE, AGREES = inside("physim.analysis.validation", "GRAZE", "AGREES")
json_of_validation = inside("physim.analysis.validation", "json_of_validation")
Part = inside("physim.record", "Part")


def test_contact_free(apart):
    found = validate(apart)
    assert (found.verdict, found.code) == ("contact-free", 0)
    assert found.comparison.disagreements == ()
    text = report(found)
    assert "VERDICT  contact-free" in text
    assert "DISAGREEMENTS: none" in text


def test_the_robot_behind_is_responsible(rear_end, monkeypatch):
    monkeypatch.setattr(responsibility, "PRIORITY", DRIVERS)
    found = validate(rear_end)
    assert found.code == 1
    assert found.verdict == "contacts: 2 of 1 pair"
    assert found.comparison.unexplained == 0
    first = found.contacts[0]
    assert (first.a, first.b) == (0, 1)
    assert first.responsible == (1,)
    slow, fast = first.sides
    assert fast.behind == -slow.behind > 1.0
    assert fast.part.startswith("front")
    assert slow.speed == pytest.approx(0.5, abs=1e-6)
    assert fast.speed == pytest.approx(1.4, abs=1e-4)
    assert 0.0 < first.severity.closing < 2.0
    assert len(first.severity.changes) == 2
    assert first.severity.energy > 0.0


def test_nobody_is_blamed_by_a_rule_that_the_controller_does_not_have(rear_end):
    found = validate(rear_end)
    text = report(found)
    assert found.contacts[0].responsible == ()
    assert all(one.behind is None for one in found.near_misses.times)
    assert not re.search(r"[Rr]esponsible is|priority|had to (consider|give way)", text)
    assert "fast reported no distance to slow" in " ".join(text.split())


@pytest.mark.parametrize("wanted", [True, False])
def test_a_run_that_was_cut_short_does_not_show_whether_all_arrive(wanted):
    world = physim.parse_world(LANE, overrides=[f"expect={{finished: {str(wanted).lower()}}}"])
    found = validate(physim.simulate(world, stop=lambda: True))
    assert found.code == 1
    assert "finished" in found.verdict
    assert states(report(found), "NOT HELD", "cut short", within=60)


def test_contact_comes_when_it_was_predicted(rear_end):
    for one in validate(rear_end).contacts:
        p = one.prediction
        if p.verdict != AGREES:
            continue
        assert abs(p.error) <= p.slack
        assert p.found - rear_end.dt <= p.touched <= p.found
        break
    else:
        pytest.fail("no contact could be compared")


def test_a_wall_is_never_to_blame(into_wall):
    found = validate(into_wall)
    assert found.code == 1
    first = found.contacts[0]
    assert first.b >= into_wall.robots
    assert first.responsible == (0,)
    text = " ".join(report(found).split())
    assert "against left wall" in text
    assert states(text, "keep clear", "boundaries", within=30)


def test_tables_count_every_pair_and_step(rear_end):
    found = validate(rear_end)
    rows = rear_end.contacts
    touching = int((rows["phase"] != Phase.ENDED).sum())
    at = found.comparison.at_samples["robots"]
    assert at.both + found.comparison.at_samples["boundaries"].both == touching
    assert sum(at) == rear_end.samples
    walls = found.comparison.at_samples["boundaries"]
    assert sum(walls) == rear_end.samples * 2 * (len(rear_end.bodies) - 2)
    assert sum(found.comparison.over_steps["robots"]) == rear_end.samples - 1


def test_smallest_approach_is_that_of_the_summary(apart):
    near = validate(apart).near_misses
    summary = physim.summarise(apart)
    assert near.smallest_robots.value == summary.value("shortest_distance")


def test_the_report_names_everything(rear_end):
    text = report(validate(rear_end))
    for word in ("slow", "fast", "responsible", "m along the reference path",
                 "closing at", "N s", "FIRST CONTACT", "NEAR MISSES"):  # fmt: skip
        assert word in text
    assert max(len(line) for line in text.splitlines()) <= 110


def graze(depth: float):
    """The fast one's rear corner passes ``depth`` [m] inside a corner of the standing one."""
    pose = f"[{4.822182541 + depth * 2**0.5!r}, -1.0, {np.pi / 4!r}]"
    return lane(((0.0, 0.0), (1.4, 0.0)), **{"robots.1.pose": pose})


def test_a_graze_between_samples_is_found_and_explained():
    found = {depth: validate(graze(depth)) for depth in (-1e-4, 2e-4, 4e-4, 8e-4)}
    assert all(one.comparison.unexplained == 0 for one in found.values())
    assert found.pop(-1e-4).comparison.disagreements == ()
    grazes = [(depth, d) for depth, one in found.items() for d in one.comparison.disagreements]
    assert grazes
    for depth, one in grazes:
        assert (one.cause, one.steps) == (GRAZE, 1)
        assert one.distance == pytest.approx(-depth, abs=0.3 * depth)


def test_a_coarse_record_is_refused():
    with (
        lane(((1.0, 0.0), (0.9, 0.05)), **{"time.record_every": 5}) as record,
        pytest.raises(RecordError, match=facts("every step", "all tables")),
    ):
        validate(record)


def test_a_contact_that_lay_not_ahead_is_told_in_words(rear_end):
    found = validate(rear_end)
    contacts = tuple(replace(one, warning=0.0) for one in found.contacts)
    text = " ".join(report(replace(found, contacts=contacts)).split())
    assert states(text, "not lie ahead", "last decision", within=30)
    assert "did not lay" not in text


def test_the_head_names_the_controller_and_what_of_it_is_not_known(rear_end):
    (line,) = [s for s in report(validate(rear_end)).splitlines() if s.startswith("  controller ")]
    assert states(line, "tests.validation.runs:Drivers", "commands not known", within=60)
    assert line.endswith("given from Python")


def test_the_head_names_settings_and_stages():
    chosen = ["controller.type=path_following", "controller.speed=0.75", "time.duration=0.2"]
    record = physim.simulate(physim.parse_world(LANE, overrides=chosen))
    found = validate(record)
    stages = {"sensing": (), "filters": (Part("slow", {"share": 0.5}),), "disturbances": ()}
    run = replace(found.run, setup=replace(found.run.setup, stages=stages))
    head = report(replace(found, run=run)).split("\n\n")[0]
    assert states(head, "controller", "path_following", "speed 0.75", within=60)
    assert states(head, "filter", "slow", "share 0.5", within=40)
    setup = json.loads(json_of_validation(replace(found, run=run)))["run"]["setup"]
    assert setup["controller"] == {"type": "path_following", "settings": {"speed": 0.75}}
    assert setup["filters"] == [{"type": "slow", "settings": {"share": 0.5}}]
