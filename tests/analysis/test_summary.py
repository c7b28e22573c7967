"""Summary, its JSON and table, and the expectations of a world."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from physim import Mode
from physim.analysis.metrics import measure
from physim.analysis.summary import SHOWN_CONTACTS, summarise, table, table_rows
from physim.contacts import Kind
from physim.errors import RecordError
from physim.record import Record
from tests.analysis.metrics.histories import history
from tests.helpers import facts, inside
from tests.helpers.records import make_record

Held, expectations = inside("physim.analysis", "Held", "expectations")
Declared = inside("physim.parts", "Declared")


def test_figures_and_names() -> None:
    with make_record() as record:
        s = summarise(record)
        assert s.metrics == measure(record)
    assert s.value("simulated_time") == 10.0
    assert [s.value(f"contacts{of}") for of in ("", "_between_robots", "_with_boundaries")] == [
        2, 1, 1,
    ]  # fmt: skip
    assert s.value("first_contact") == pytest.approx(3.0)
    assert s.value("deepest_contact") == pytest.approx(0.02)
    assert sum(episode.impulse for episode in s.contacts) == pytest.approx(5.0 * 30)
    shortest = s.metrics["shortest_distance"]
    assert shortest.value == pytest.approx(-0.02)
    assert s.names_of(*shortest.bodies) == ("r1", "r2")
    assert s.names_of(*s.metrics["shortest_boundary_distance"].bodies) == ("r2", "left")
    assert s.value("finished") is False
    told = json.loads(s.to_json())
    assert (told["format"], told["version"]) == ("physim-summary", 2)
    assert (told["name"], told["seed"], told["robots"], told["ended"]) == (
        "made up", 3, 3, "duration",
    )  # fmt: skip
    assert told["wall_clock"]["factor"] == 100.0
    assert told["metrics"]["shortest_distance"]["value"] == shortest.value
    assert told["metrics"]["width_min"]["station_m"] is not None
    assert [
        (one["bodies"], one["impact_newton_seconds"], one["impulse_newton_seconds"])
        for one in told["contacts"]
    ] == [(list(s.names_of(e.a, e.b)), e.impact, e.impulse) for e in s.contacts]


def test_json_is_the_same_but_for_the_wall_clock(tmp_path: Path) -> None:
    one = summarise(make_record(seconds=2.0, wall_clock={"seconds": 1.0}))
    make_record(tmp_path / "r.h5", seconds=2.0, wall_clock={"seconds": 2.0}).close()
    with Record.load(tmp_path / "r.h5") as record:
        other = summarise(record)
    first, second = json.loads(one.to_json()), json.loads(other.to_json())
    assert [x.pop("wall_clock")["seconds"] for x in (first, second)] == [1.0, 2.0]
    assert first == second
    assert first["expectations"][0] == {"key": "contacts", "wanted": 2, "got": 2, "held": True}


def test_what_has_no_meaning_is_left_out() -> None:
    text = summarise(
        make_record(robots=1, seconds=1.0, wall_clock={"factor": float("inf")})
    ).to_json()
    found = json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    for key in ("shortest_distance", "farthest_distance", "formation_error_peak", "first_contact"):
        assert key not in found["metrics"]
    assert found["wall_clock"] == {"factor": None}
    assert found["contacts"] == []


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
    for value, right in ((held, True), (broken, False)):
        with make_record(seconds=10.0, world_text=f"expect: {{{key}: {value}}}\n") as record:
            (one,) = (x for x in expectations(record) if x.key == key)
            summary = summarise(record)
        assert one.held == summary.held == right
        assert ("NOT HELD" in table(summary)) is not right
        assert repr(summary).endswith(", not as expected>") is not right


def test_exactly_on_the_bound_holds_and_what_is_missed_differs_from_it() -> None:
    with make_record() as record:
        bound = float(record.extremes["clearance"].min())
    with make_record(seconds=10.0, world_text=f"expect: {{min_distance: {bound!r}}}") as record:
        assert summarise(record).held
    assert str(Held("min_distance", 1, 0.99999996, False)) == "NOT HELD: 0.99999996 m >= 1 m"
    assert str(Held("max_distance", 4.8, 5.25, False)) == "NOT HELD: 5.25 m <= 4.8 m"


def test_bounds_on_what_a_run_does_not_have_hold() -> None:
    world = "expect: {min_distance: 0.05, max_distance: 1.0}"
    with make_record(robots=1, seconds=1.0, world_text=world) as record:
        assert [tuple(one) for one in expectations(record)] == [
            ("min_distance", 0.05, None, True),
            ("max_distance", 1.0, None, True),
        ]
        assert summarise(record).held


@pytest.mark.parametrize("world", ["name: none\n", "- 1\n"])
def test_world_without_expectations(world: str) -> None:
    with make_record(seconds=0.2, world_text=world) as record:
        assert expectations(record) == []


@pytest.mark.parametrize(
    ("world", "parts"),
    [
        ("a: [", ("cannot be read",)),
        ("expect: 5", ("expect", "mapping")),
        ("expect: {contacts: few}", ("expect.contacts", '"few"')),
    ],
)
def test_expectations_that_cannot_be_read(world: str, parts: tuple[str, ...]) -> None:
    with (
        make_record(seconds=0.2, world_text=world) as record,
        pytest.raises(RecordError, match=facts(*parts)) as caught,
    ):
        expectations(record)
    assert "\n" not in str(caught.value)


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
    assert (len(summary.contacts), len(summary.run.grazes)) == (1, 1)
    assert re.search(r"contacts</th>\s*<td[^>]*>1</td>", record._repr_html_())


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
    told = json.loads(summary.to_json())["contacts"][0]
    assert told.pop("bodies") == ["r1", "r2"]
    assert told == pytest.approx(
        {"time_s": 0.0, "duration_s": 0.02, "max_depth_m": 0.0134,
         "impact_newton_seconds": 30.0, "impulse_newton_seconds": 35.0}
    )  # fmt: skip
    text = table(summary)
    assert text.count(" mm deep") == SHOWN_CONTACTS
    assert re.search(facts("3 more", "physim summary --json"), text)


def test_who_did_not_arrive_is_told_with_the_reason() -> None:
    """A claim of the controller counts for nothing: the robots stand where they were put."""
    pose = np.zeros((101, 2, 3))
    claims = [{"step": 0, "robot": i, "mode": 3, "station": 0.0} for i in (0, 1)]
    found = summarise(history(claims, pose=pose, arrived=[-1, 60], steps_run=100))
    assert found.value("finished") is False
    assert found.value("time_to_finish") is None
    (one,) = found.run.absent
    assert (one.robot, one.stands, one.tolerance) == (0, True, 0.1)
    text = one.sentence("r1")
    told = json.loads(found.to_json())["not_arrived"]
    assert told == [
        {"robot": "r1", "short_m": one.short, "tolerance_m": 0.1, "stands": True, "text": text},
    ]
    rows = dict(table_rows(found))
    assert rows["all robots arrived"] == "no, 1 of 2"
    assert rows["  not arrived"] == text
    many = table_rows(summarise(make_record(robots=20, seconds=1.0)))
    assert sum(label == "  not arrived" for label, _ in many) == 12
    (more,) = [text for label, text in many if label == "  ..."]
    assert re.search(facts("8 more", "physim summary --json"), more)


def test_commands_that_a_stage_changed_are_counted() -> None:
    same, slow = (1.0, 0.0), (0.5, 0.0)
    commands = [(step, 0, *same, *slow, *slow) for step in range(10)]
    commands += [(20, 1, *same, *same, *slow)]
    rows = dict(table_rows(summarise(history(commands=commands, steps_run=100))))
    filtered, applied = rows["commands"].split(", ")
    assert "in 10 robot-steps (5.0 %)" in filtered
    assert "in 1 robot-steps (0.5 %)" in applied


def test_what_is_not_declared_or_not_recorded_is_not_told_as_none() -> None:
    label, decided = "danger mode, share of time", [{"step": 0, "robot": 0}]
    for declared, said in (
        (Declared(), "declares no modes,"),
        (Declared((Mode("go", "#000000"),)), "declares no danger mode"),
    ):
        rows = dict(table_rows(summarise(history(decided, declared=declared))))
        assert re.search(facts("n/a", said), rows[label])
        assert rows["shortest collision time"].startswith("n/a")
    rows = dict(table_rows(summarise(history(tables=()))))
    assert rows["contacts"] == rows["decisions"] == "n/a (not recorded)"
