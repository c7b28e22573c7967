"""Runs are judged rightly: contacts, who was responsible, when they were due; and what is said."""

from __future__ import annotations

import re

import pytest

import physim
from physim.analysis.validation import report, responsibility, validate
from physim.contacts import Phase
from physim.errors import RecordError
from tests.analysis.validation.runs import DRIVERS, LANE, lane, states
from tests.helpers import facts, inside

AGREES, sentences = inside("physim.analysis.validation", "AGREES", "sentences")


def test_contact_free(apart):
    found = validate(apart)
    assert (found.verdict, found.code) == ("contact-free", 0)
    assert found.comparison.disagreements == ()
    assert "DISAGREEMENTS: none" in report(found)
    nearest = found.near_misses.smallest_robots.value
    assert nearest == physim.summarise(apart).value("shortest_distance")


def test_the_robot_behind_is_responsible(rear_end, monkeypatch):
    monkeypatch.setattr(responsibility, "PRIORITY", DRIVERS)
    found = validate(rear_end)
    assert found.code == 1
    assert found.verdict == "contacts: 2 of 1 pair"
    assert found.comparison.unexplained == 0
    first = found.contacts[0]
    assert (first.a, first.b, first.responsible) == (0, 1, (1,))
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
    assert not re.search(r"Responsible:|priority|had to (consider|give way)", text)
    assert states(text, "fast moved", "reported no distance", within=200)


def test_a_wall_is_never_to_blame(into_wall):
    found = validate(into_wall)
    assert found.code == 1
    first = found.contacts[0]
    assert first.b >= into_wall.robots
    assert first.responsible == (0,)
    assert states(report(found), "keep clear", "boundary", within=60)


@pytest.mark.parametrize("wanted", [True, False])
def test_a_run_that_was_cut_short_does_not_show_whether_all_arrive(wanted):
    world = physim.parse_world(LANE, overrides=[f"expect={{finished: {str(wanted).lower()}}}"])
    found = validate(physim.simulate(world, stop=lambda: True))
    assert found.code == 1
    assert "finished" in found.verdict
    assert states(report(found), "NOT HELD", "cut short", within=60)


def test_contact_comes_when_it_was_predicted(rear_end):
    contacts = validate(rear_end).contacts
    first = contacts[0]
    assert first.warning == pytest.approx(first.prediction.touched)  # commands stay as they were
    compared = [one.prediction for one in contacts]
    compared = [one for one in compared if one.verdict == AGREES]
    assert compared
    for one in compared:
        assert abs(one.error) <= one.slack
        assert one.found - rear_end.dt <= one.touched <= one.found


def test_tables_count_every_pair_and_sample(rear_end):
    found = validate(rear_end)
    rows = rear_end.contacts
    touching = int((rows["phase"] != Phase.ENDED).sum())
    at = found.comparison.at_samples
    assert at["robots"].both + at["boundaries"].both == touching
    assert sum(at["robots"]) == rear_end.samples
    assert sum(at["boundaries"]) == rear_end.samples * 2 * (len(rear_end.bodies) - 2)


def test_a_coarse_record_is_refused():
    with (
        lane(((1.0, 0.0), (0.9, 0.05)), **{"time.record_every": 5}) as record,
        pytest.raises(RecordError, match=facts("every step", "all tables")),
    ):
        validate(record)


@pytest.mark.deep
def test_a_command_that_kept_clear_of_what_was_known_is_not_blamed():
    """Of crowded_start with seed 97: r1 decides in the same step as r3, which avoids it."""
    world = physim.load_world("crowded_start", overrides=["time.duration=15", "expect=null"])
    with physim.simulate(world, seed=97) as record:
        found = validate(record)
    (one,) = found.contacts
    avoiding, other = sorted(one.sides, key=lambda side: not side.responsible)
    assert (avoiding.responsible, other.responsible) == (True, False)
    assert avoiding.mode.danger
    assert avoiding.decided == other.decided
    said = " ".join(sentences(one, found.names))
    assert states(said, "has priority", "Responsible: r3", "r1", within=60)
    assert states(said, "r3 moved", "collision time none", within=250)
