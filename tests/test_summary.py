"""Summary, its JSON and table, and the expectations of a world."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
import yaml

from physim import Mode
from physim.analysis.summary import summarise, table, table_rows
from physim.contacts import Kind
from physim.errors import RecordError, decimal_text
from physim.record import Record
from tests.helpers import facts, inside
from tests.helpers.records import make_record
from tests.metrics.histories import history

Held, expectations = inside("physim.analysis", "Held", "expectations")
SHOWN_CONTACTS = inside("physim.analysis.summary", "SHOWN_CONTACTS")
Declared = inside("physim.parts", "Declared")
setup_of = inside("physim.record", "setup_of")


def test_figures_and_names() -> None:
    with make_record() as record:
        s = summarise(record)
    assert (s.name, s.seed, s.robots, s.ended) == ("made up", 3, 3, "duration")
    assert s.value("simulated_time") == 10.0
    assert (s.contacts.count, s.contacts.between_robots, s.contacts.with_boundaries) == (2, 1, 1)
    assert s.contacts.first_s == pytest.approx(3.0)
    assert s.contacts.max_depth_m == pytest.approx(0.02)
    assert sum(episode.impulse for episode in s.contacts.episodes) == pytest.approx(5.0 * 30)
    shortest = s.metrics["shortest_distance"]
    assert shortest.value == pytest.approx(-0.02)
    assert s.names_of(*shortest.bodies) == ("r1", "r2")
    assert s.names_of(*s.metrics["shortest_boundary_distance"].bodies) == ("r2", "left")
    assert s.real_time_factor == 100.0
    assert s.value("finished") is False
    told = json.loads(s.to_json())
    assert (told["format"], told["version"]) == ("physim-summary", 1)
    assert told["shortest_distance_m"]["value"] == shortest.value
    assert [
        (one["bodies"], one["impact_newton_seconds"], one["impulse_newton_seconds"])
        for one in told["contacts"]["episodes"]
    ] == [(list(s.names_of(e.a, e.b)), e.impact, e.impulse) for e in s.contacts.episodes]


def test_json_is_valid_and_the_same_but_for_the_wall_clock(tmp_path: Path) -> None:
    one = summarise(make_record(seconds=2.0, wall_clock={"seconds": 1.0}))
    make_record(tmp_path / "r.h5", seconds=2.0, wall_clock={"seconds": 2.0}).close()
    with Record.load(tmp_path / "r.h5") as record:
        other = summarise(record)
    first, second = json.loads(one.to_json()), json.loads(other.to_json())
    assert (first.pop("wall_clock"), second.pop("wall_clock")) == (
        {"seconds": 1.0},
        {"seconds": 2.0},
    )
    assert first == second
    assert first["shortest_distance_m"]["bodies"] == ["r1", "r2"]
    assert '_ns"' not in one.to_json()  # which reads as nanoseconds
    assert first["expectations"][0] == {"key": "contacts", "wanted": 2, "got": 2, "held": True}


def test_what_has_no_meaning_is_null() -> None:
    text = summarise(
        make_record(robots=1, seconds=1.0, wall_clock={"factor": float("inf")})
    ).to_json()
    found = json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    for key in ("shortest_distance_m", "farthest_pair_m", "formation_error_peak_m"):
        assert found[key] is None
    assert found["wall_clock"] == {"factor": None}
    assert found["contacts"]["first_s"] is None


WORLD = """\
controller: {type: path_following, look_ahead: 3.5}
sensing: {range: 5.0, stages: [{type: delay, seconds: 0.2}]}
filters: [{type: half_gap}, {type: slow, share: 0.5}]
"""


def test_it_names_what_the_run_was_made_with() -> None:
    setup = setup_of(yaml.safe_load(WORLD), (("observer", "mine:Watch"),), {"physim": "1.2"})
    assert setup.lines() == [
        ("controller", "path_following (look_ahead 3.5)"),
        ("sensing", "delay (seconds 0.2)"),
        ("filters", "half_gap, slow (share 0.5)"),
        ("from Python", "observer mine:Watch"),
    ]
    assert setup.controller.to_dict() == {"type": "path_following", "settings": {"look_ahead": 3.5}}
    given = setup_of(yaml.safe_load(WORLD), (("controller", "mine:Own"),), {})
    assert given.lines()[0] == ("controller", "mine:Own")
    assert setup_of({}, (), {}).lines() == [("controller", "mode_switching")]
    with make_record() as record:
        told, rows = json.loads(summarise(record).to_json()), dict(table_rows(summarise(record)))
        assert told["versions"] == record.versions
    assert rows["controller"] == told["controller"]["type"]
    assert "physim" in rows["made with"]


@pytest.mark.parametrize("world", [{"controller": "x", "filters": 3}, {"filters": ["x", None]}])
def test_a_world_that_is_none_has_a_setup_all_the_same(world: dict[str, object]) -> None:
    assert dict(setup_of(world, (), {}).lines())["controller"]


def test_table() -> None:
    lines = table(summarise(make_record())).splitlines()
    found = dict(line.split("  ", 1) for line in lines)
    texts = {label: text.strip() for label, text in found.items()}
    assert re.search(facts("made up", "seed 3", "3 robots", "10.00 s"), texts["run"])
    counted = facts("2 (", "1 between robots", "1 with boundaries", "3.00 s")
    assert re.search(counted, texts["contacts"])
    assert texts["shortest distance"] == "-0.0200 m (r1 and r2 at 3.19 s)"
    assert texts["expected contacts"] == "held: 2 <= 2"
    assert texts["expected finished"] == "held: false = false"
    assert texts["real-time factor"] == "100.0"
    assert all(len(line) <= 120 for line in lines)


def test_table_of_one_robot_without_wall_clock() -> None:
    text = table(summarise(make_record(robots=1, seconds=1.0, wall_clock={})))
    assert "shortest distance           n/a" in text
    assert "real-time factor            n/a" in text


def fared(expect: str) -> dict[str, Held]:
    with make_record(seconds=10.0, world_text=f"name: x\nexpect: {expect}\n") as record:
        return {one.key: one for one in expectations(record)}


@pytest.mark.parametrize(
    ("key", "held", "broken"),
    [
        ("contacts", 2, 1),
        ("min_distance", -0.021, -0.019),
        ("min_boundary_distance", -0.011, -0.009),
        ("max_distance", 4.8, 4.7),
        ("finished", "false", "true"),
    ],
)
def test_expectation_held_and_broken(key: str, held: object, broken: object) -> None:
    assert fared(f"{{{key}: {held}}}")[key].held
    one = fared(f"{{{key}: {broken}}}")[key]
    assert not one.held
    text = table(summarise(make_record(world_text=f"expect: {{{key}: {broken}}}")))
    assert f"expected {key}" in text
    assert "NOT HELD" in text


@pytest.mark.parametrize(
    ("key", "wanted", "got", "text"),
    [
        ("min_distance", 1, 0.99999996, "NOT HELD: 0.99999996 m >= 1 m"),
        ("max_distance", 4.8, 5.25, "NOT HELD: 5.25 m <= 4.8 m"),
        ("contacts", 1, 2, "NOT HELD: 2 <= 1"),
        ("finished", True, False, "NOT HELD: false = true"),
    ],
)
def test_a_bound_that_is_missed_differs_from_the_figure(
    key: str, wanted: float, got: float, text: str
) -> None:
    assert str(Held(key, wanted, got, False)) == text
    assert str(Held("min_distance", 1, 1.2, True)) == "held: 1.2 m >= 1 m"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.234, "1.23"), (0.05, "0.050"), (-0.0123, "-0.012"), (0.001234, "0.0012"),
        (1e-9, "0.0000"), (0.0, "0.00"), (-1e-9, "0.0000"), (-0.0, "0.00"),
    ],
)  # fmt: skip
def test_small_figures_keep_two_digits(value: float, text: str) -> None:
    assert decimal_text(value, 2, 4) == text


@pytest.mark.parametrize(
    ("expect", "said"),
    [("{contacts: 2}", "contacts: 2, as expected>"), ("{contacts: 1}", ", not as expected>"),
     ("null", "contacts: 2>")],
)  # fmt: skip
def test_a_summary_says_whether_that_was_expected_where_something_was(
    expect: str, said: str
) -> None:
    with make_record(seconds=10.0, world_text=f"name: x\nexpect: {expect}\n") as record:
        assert repr(summarise(record)).endswith(said)


def test_exactly_on_the_bound_holds() -> None:
    with make_record() as record:
        bound = float(record.extremes["clearance"].min())
    assert fared(f"{{min_distance: {bound!r}}}")["min_distance"].held


def test_bounds_on_what_a_run_does_not_have_hold() -> None:
    world = "expect: {min_distance: 0.05, max_distance: 1.0, contacts: null}"
    with make_record(robots=1, seconds=1.0, world_text=world) as record:
        assert [tuple(one) for one in expectations(record)] == [
            ("min_distance", 0.05, None, True),
            ("max_distance", 1.0, None, True),
        ]
        assert summarise(record).held


@pytest.mark.parametrize("world", ["", "name: x\n", "expect:\n", "- 1\n", "expect: 5\n"])
def test_world_without_expectations(world: str) -> None:
    with make_record(seconds=0.2, world_text=world) as record:
        assert expectations(record) == []


def test_world_text_that_is_not_yaml() -> None:
    with make_record(seconds=0.2, world_text="a: [") as record:
        with pytest.raises(RecordError, match="cannot be read") as caught:
            expectations(record)
        assert "\n" not in str(caught.value)


def test_expectation_that_is_no_number() -> None:
    wanted = facts("expect.contacts", "'few'", "number")
    record = make_record(seconds=0.2, world_text="expect: {contacts: few}")
    with record, pytest.raises(RecordError, match=wanted):
        expectations(record)


def test_a_contact_between_samples_counts_as_one() -> None:
    """For expectations; in the summary it stands apart."""
    contacts = [(40, 0, 1, 0, 0.01), (41, 0, 1, 2, -0.1), (60, 0, 1, 0, 1e-4)]
    record = history(contacts=contacts, world="expect: {contacts: 1}")
    rows = record.contacts.copy()
    rows["kind"][2] = Kind.SWEPT
    record.__dict__["contacts"] = rows
    (one,) = expectations(record)
    assert (one.got, one.held) == (2, False)
    summary = summarise(record)
    assert (summary.contacts.count, len(summary.grazes)) == (1, 1)
    assert not summary.held


@pytest.mark.parametrize(
    ("expect", "held"),
    [
        ("{contacts: 2, finished: false}", True),
        ("{contacts: 1, finished: false}", False),
        ("{contacts: 2, finished: true}", False),
    ],
)
def test_a_run_holds_when_every_expectation_does(expect: str, held: bool) -> None:
    with make_record(world_text=f"expect: {expect}") as record:
        assert summarise(record).held is held


def test_contacts_one_by_one() -> None:
    """How long, how deep, how hard at first and in all; and how many more there are."""
    contacts = []
    for k in range(SHOWN_CONTACTS + 3):
        step, body = 5 * k, 1 + k % 2
        contacts += [
            (step, 0, body, 0, 0.002, 30.0), (step + 1, 0, body, 1, 0.0134, 4.0),
            (step + 2, 0, body, 2, -0.1, 1.0),
        ]  # fmt: skip
    summary = summarise(history(contacts=contacts))
    first = summary.contacts.episodes[0]
    assert (first.depth, first.impact, first.impulse) == pytest.approx((0.0134, 30.0, 35.0))
    told = json.loads(summary.to_json())["contacts"]["episodes"][0]
    assert told.pop("bodies") == ["r1", "r2"]
    assert told == pytest.approx(
        {"begin_s": 0.0, "duration_s": 0.02, "max_depth_m": 0.0134,
         "impact_newton_seconds": 30.0, "impulse_newton_seconds": 35.0}
    )  # fmt: skip
    assert (summary.contacts.between_robots, summary.contacts.with_boundaries) == (6, 5)
    text = table(summary)
    first_line = facts("r1 and r2", "0.02 s", "13.4 mm deep", "30.0 N s")
    more = facts("3 more", "physim summary --json")
    assert any(re.search(first_line, line) for line in text.splitlines())
    assert any(re.search(more, line) for line in text.splitlines())
    assert text.count(" mm deep") == SHOWN_CONTACTS


def rows_of(record: Record) -> list[tuple[str, str]]:
    with record:
        return table_rows(summarise(record))


def test_who_did_not_arrive_is_told_with_the_reason_in_table_and_json() -> None:
    """A claim of the controller counts for nothing: the robots stand where they were put."""
    pose = np.zeros((101, 2, 3))
    claims = [{"step": 0, "robot": i, "mode": 3, "station": 0.0} for i in (0, 1)]
    record = history(claims, pose=pose, arrived=[-1, 60], steps_run=100)
    found = summarise(record)
    short = float(record.stop_station[0])
    assert found.value("finished") is False
    assert found.value("time_to_finish") is None
    (one,) = found.not_arrived
    assert (one.robot, one.stands, one.tolerance) == (0, True, 0.1)
    text = one.sentence("r1")
    told = json.loads(found.to_json())["not_arrived"]
    assert told == [
        {"robot": "r1", "short_m": one.short, "tolerance_m": 0.1, "stands": True, "text": text},
    ]
    assert one.short == pytest.approx(short, abs=3.0)  # its path begins near the origin
    rows = dict(table_rows(found))
    assert rows["all robots arrived"] == "no, 1 of 2"
    assert rows["  not arrived"] == text
    assert "stands" in text
    assert "0.10 m" in text


def test_of_many_that_did_not_arrive_the_first_are_told() -> None:
    rows = rows_of(make_record(robots=20, seconds=1.0))
    assert sum(label == "  not arrived" for label, _ in rows) == 12
    (more,) = [text for label, text in rows if label == "  ..."]
    assert re.search(facts("8 more", "physim summary --json"), more)


def test_commands_that_a_stage_changed_are_counted() -> None:
    same, slow = (1.0, 0.0), (0.5, 0.0)
    commands = [(step, 0, *same, *slow, *slow) for step in range(10)]
    commands += [(20, 1, *same, *same, *slow)]
    rows = dict(rows_of(history(commands=commands, steps_run=100)))
    filtered, applied = rows["commands"].split(", ")
    assert (filtered.split()[0], applied.split()[0]) == ("filtered", "applied")
    assert "in 10 robot-steps (5.0%)" in filtered
    assert "in 1 robot-steps (0.5%)" in applied
    assert "commands" not in dict(rows_of(make_record(seconds=0.5)))


def test_a_controller_that_declares_nothing_is_told_so() -> None:
    rows = dict(rows_of(history([{"step": 0, "robot": 0}], declared=Declared())))
    assert re.search(facts("n/a", "declares no modes,"), rows["danger mode, share of time"])
    assert rows["shortest collision time"].startswith("n/a (the controller")
    assert "collision times" not in rows["decisions"]
    calm = Declared((Mode("go", "#000000"),))
    rows = dict(rows_of(history([{"step": 0, "robot": 0}], declared=calm)))
    assert re.search(
        facts("n/a", "declares no modes of danger"), rows["danger mode, share of time"]
    )


def test_what_was_not_recorded_is_not_told_as_none() -> None:
    rows = dict(rows_of(history(tables=())))
    assert rows["contacts"] == rows["decisions"] == "n/a (not recorded)"
