"""Records whose tables of contacts and decisions, or whose attributes, were changed afterwards."""

from __future__ import annotations

import numpy as np
import pytest

import physim
from physim.analysis.validation import report, validate
from physim.cli import main
from physim.contacts import Phase
from tests.helpers import inside
from tests.validation.reports import states
from tests.validation.runs import LANE, Drivers
from tests.validation.test_tampered import tampered

CONTROLLER, make_part = inside("physim.parts", "CONTROLLER", "make_part")


def column(path, name, change):
    def apply(file):
        rows = file[path][()]
        rows[name] = change(rows[name])
        file[path][...] = rows

    return apply


def without(phase):
    def apply(file):
        rows = file["/contacts"][()]
        kept = rows[rows["phase"] != phase]
        file["/contacts"].resize(len(kept), axis=0)
        file["/contacts"][...] = kept

    return apply


def turned(file):
    for name in ("nx", "ny"):
        column("/contacts", name, np.negative)(file)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (column("/contacts", "x", lambda c: c + 50.0), ("contact point",)),
        (turned, ("normal",)),
        (without(Phase.ENDED), ("contact", "end", "not in the record")),
        (without(Phase.BEGAN), ("begins", "goes on", "wrongly")),
        (column("/contacts", "phase", np.zeros_like), ("row", "begins", "contact")),
        (column("/updates", "station", lambda c: c + 1e-6), ("/updates, row 1", "fast", "station")),
        (
            column("/updates", "deviation", np.negative),
            ("/updates, row 1", "fast", "deviation", "1 in the record"),
        ),
        (
            column("/updates", "reference_station", lambda c: c[::-1]),
            ("/updates, row 0", "reference_station"),
        ),
    ],
)
def test_tables(parted, tmp_path, change, expected):
    assert validate(parted).code == 1
    with physim.Record.load(tampered(parted, tmp_path, change)) as record:
        found = validate(record)
    assert found.code == 3
    assert states(report(found), *expected)


@pytest.fixture(scope="module")
def parted():
    """The fast one hits the slow one in passing, and both go on."""
    world = physim.parse_world(LANE, overrides=["time.duration=6"])
    return physim.simulate(world, controller=Drivers((0.3, 0.0), (1.4, 0.0)))


def test_a_gap_after_a_contact(parted, tmp_path):
    def change(file):
        rows = file["/contacts"][()]
        rows["depth"][rows["phase"] == Phase.ENDED] -= 1e-6
        file["/contacts"][...] = rows

    assert (parted.contacts["phase"] == Phase.ENDED).any()
    with physim.Record.load(tampered(parted, tmp_path, change)) as record:
        found = validate(record)
    assert found.code == 3
    assert states(report(found), "gap after a contact")


def twice(path):
    def apply(file):
        rows = file[path][()]
        file[path].resize(2 * len(rows), axis=0)
        file[path][...] = np.repeat(rows, 2)

    return apply


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (twice("/contacts"), ("/contacts, row 1", "step")),
        (twice("/updates"), ("/updates, row 1", "step 0", "robot 0", "once")),
        (
            column("/contacts", "impulse", lambda c: c - 1e9),
            ("/contacts, row 0", "impulse", "negative"),
        ),
        (column("/contacts", "x", lambda c: c * np.nan), ("/contacts, row 0", "x", "nan")),
        (lambda f: f.attrs.modify("versions", "nonsense"), ("JSON object", "versions")),
        (lambda f: f.attrs.modify("units", "feet"), ("attribute units", "'feet'")),
        (lambda f: f.attrs.create("ended", b"finished"), ("S16", "ended", "fixed length")),
    ],
)
def test_what_no_run_writes_is_refused_in_one_line(rear_end, tmp_path, capsys, change, expected):
    path = tampered(rear_end, tmp_path, change)
    for command in ("summary", "validate"):
        assert main([command, str(path)]) == 2
        (line,) = [s for s in capsys.readouterr().err.splitlines() if not s.startswith("compiling")]
        assert line.startswith(f"{path}: ")
        assert states(line, *expected)


def cut(file):
    """As if the run had been longer."""
    file.attrs.modify("steps_planned", np.int64(900))


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda f: f.attrs.modify("name", "other"), ("name", "other in the record", "lane by")),
        (cut, ("steps_planned", "900 in the record", "300 by")),
        (lambda f: f.attrs.modify("safe_distance", 1.0), ("safe area", "another")),
        (
            lambda f: f["/areas/accessible/points"].__setitem__((0, 1), 7.0),
            ("accessible area", "another"),
        ),
    ],
)
def test_name_duration_and_areas(rear_end, tmp_path, change, expected):
    with physim.Record.load(tampered(rear_end, tmp_path, change)) as record:
        found = validate(record)
    assert found.code == 3
    assert states(found.verdict, *expected)


def test_a_run_that_is_said_to_have_lasted_its_whole_duration(apart, tmp_path):
    world = physim.parse_world(LANE)
    half = physim.simulate(
        world,
        controller=Drivers((1.0, 0.0), (0.9, 0.05)),
        stop=iter([False] * 99 + [True]).__next__,
    )
    assert half.ended == "interrupted"
    assert validate(half).code == 0

    def lasted(file):
        file.attrs["ended"] = np.array(b"duration", dtype="S16")

    with physim.Record.load(tampered(half, tmp_path, lasted)) as record:
        found = validate(record)
    assert found.code == 3
    assert states(found.verdict, "steps_run", "100 in the record", "300 by")


def test_what_decided_is_recorded(tmp_path):
    world = physim.parse_world(LANE)
    assert physim.simulate(world).controller == ""
    assert physim.simulate(world, controller=world.controller.type).controller == ""
    for gap, expected in ((0.5, ""), (0.7, "physim.controllers.mode_switching:ModeSwitching")):
        own = make_part(CONTROLLER, "mode_switching", {"safe_distance": gap})
        usual = physim.parse_world(LANE, overrides=["controller.safe_distance=0.5"])
        assert physim.simulate(usual, controller=own).controller == expected
    given = physim.simulate(world, controller=Drivers((1.0, 0.0), (0.9, 0.05)))
    assert given.controller == "tests.validation.runs:Drivers"
    path = tmp_path / "r.h5"
    given.save(path)
    with physim.Record.load(path) as copy:
        assert copy.controller == given.controller
