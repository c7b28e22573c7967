"""A robot that is pushed, or run into where it stands, is not responsible."""

from __future__ import annotations

import json
from math import hypot

import pytest

import physim
from physim.analysis.validation import report, responsibility, validate
from tests.analysis.validation.runs import DRIVERS, LANE, Drivers, edited, states
from tests.helpers import inside

json_of_validation, sentences = inside(
    "physim.analysis.validation", "json_of_validation", "sentences"
)

BOX = "footprint: {length: 1.8, width: 1.0}"
STAND, DRIVE = (0.0, 0.0), (0.8, 0.0)


def driven(*robots: tuple[float, float, tuple[float, float]], obstacles: str = "[]"):
    """Robots on the middle of the lane: x [m], heading [rad], command; the record."""
    lines = [
        f"  - {{name: r{k}, {BOX}, pose: [{x}, 0.0, {heading}], path: {{offset: 0.0}}}}"
        for k, (x, heading, _) in enumerate(robots, 1)
    ]
    head = f"obstacles: {obstacles}\n{LANE[: LANE.index('  - {')]}"
    world = physim.parse_world(head + "\n".join(lines) + "\n")
    return physim.simulate(world, controller=Drivers(*(c for _, _, c in robots)))


def row(*robots: tuple[float, float, tuple[float, float]], obstacles: str = "[]"):
    """The same, as validated."""
    found = validate(driven(*robots, obstacles=obstacles))
    return found, " ".join(report(found, full=True).split())


def contact(found, a: int, b: int):
    return next(one for one in found.contacts if (one.a, one.b) == (a, b))


def test_a_standing_robot_that_is_pushed_into_another_is_not_responsible():
    found, text = row((8.0, 0.0, STAND), (5.9, 0.0, STAND), (3.5, 0.0, DRIVE))
    assert contact(found, 1, 2).responsible == (2,)
    pushed = contact(found, 0, 1)
    assert pushed.responsible == (2,)
    front, middle = pushed.sides
    assert (front.pushed_by, middle.pushed_by, middle.stands) == (None, 2, True)
    assert not front.responsible
    assert not middle.responsible
    assert "Responsible:" in text
    assert states(text, "Responsible: r3", "pushed r2 into r1", within=40)
    assert "r2 stood by command" in text
    written = json.loads(json_of_validation(found))["contacts"][pushed.number - 1]
    assert written["responsible"] == [2]
    assert written["sides"][1]["pushed_by"] == 2


ROUNDING = (0.0, -1e-15)
CREEP = (0.05, 0.0)
BEHIND = (8.0, 3.14159, DRIVE)
WALL = "[[[10, 0.2], [11, 0.2], [11, 2], [10, 2]]]"
CHAIN = [(8.0, 0.0, STAND), (5.9, 0.0, STAND), (3.9, 0.0, STAND), (1.8, 0.0, DRIVE)]


@pytest.mark.parametrize(
    ("robots", "between", "responsible", "words"),
    [
        (CHAIN, (0, 1), (3,), ("stood by command",)),
        ([(8.0, 0.0, STAND), (5.9, 0.0, CREEP), (3.5, 0.0, DRIVE)], (0, 1), (2,),
         ("r3 pushed r2", "into r1")),
        ([BEHIND, (4.5, 0.0, STAND)], (0, 1), (0,), ("ran into r2", "r1")),
        ([BEHIND, (4.5, 0.0, ROUNDING)], (0, 1), (0,), ("ran into r2", "r1")),
        ([BEHIND, (5.9, 0.0, STAND), (3.8, 0.0, STAND)], (1, 2), (0,),
         ("pushed r2 into r3", "r1")),
    ],
)  # fmt: skip
def test_who_is_responsible(robots, between, responsible, words):
    found, text = row(*robots)
    assert contact(found, *between).responsible == responsible
    assert states(text, *words, within=50)


def test_a_robot_that_is_pushed_against_a_wall_is_not_responsible():
    found, _ = row((8.7, 0.0, STAND), (6.3, 0.0, DRIVE), obstacles=WALL)
    assert [one.responsible for one in found.contacts if one.b >= 2] == [(1,)]


def test_a_robot_that_pushes_is_not_pushed_by_what_it_pushes():
    found, _ = row((8.0, 0.0, (0.1, 0.0)), (5.9, 0.0, (0.8, 0.0)))
    assert found.contacts
    assert all(0 not in one.responsible for one in found.contacts)


@pytest.mark.parametrize(("turn", "expected"), [(9e-4, True), (1.1e-3, False)])
def test_standing_is_a_matter_of_the_footprint_and_its_speed(turn, expected):
    found, _ = row((8.0, 3.14159, DRIVE), (4.5, 0.0, (0.0, turn / hypot(0.9, 0.5))))
    assert contact(found, 0, 1).sides[1].stands == expected


def test_side_by_side_the_lower_index_has_priority(monkeypatch):
    """Two that turn on the spot until their corners meet; neither is ahead of the other."""
    lines = [
        f"  - {{name: r{k}, {BOX}, pose: [8.0, {y}, 0.0], path: {{offset: 0.0}}}}"
        for k, y in enumerate((0.6, -0.6), 1)
    ]
    world = physim.parse_world(LANE[: LANE.index("  - {")] + "\n".join(lines) + "\n")
    monkeypatch.setattr(responsibility, "PRIORITY", DRIVERS)
    found = validate(physim.simulate(world, controller=Drivers((0.0, 0.8), (0.0, 0.8))))
    one = contact(found, 0, 1)
    assert [side.behind for side in one.sides] == [0.0, 0.0]
    assert one.responsible == (1,)


@pytest.fixture(scope="module")
def pushed_along():
    """A standing robot, driven against a wall by another."""
    lines = [
        f"  - {{name: {name}, {BOX}, pose: {pose}, path: {{offset: 0.0}}}}"
        for name, pose in (("stander", [8.0, 3.45, 0.0]), ("driver", [6.1, 3.3, 0.1]))
    ]
    world = physim.parse_world(LANE[: LANE.index("  - {")] + "\n".join(lines) + "\n")
    return physim.simulate(world, controller=Drivers(STAND, DRIVE))


def test_a_standing_robot_that_nobody_is_seen_to_push(tmp_path, pushed_along):
    found = validate(pushed_along)
    first = next(one for one in found.contacts if one.b >= 2)
    assert first.responsible == (1,)
    alone = edited(pushed_along, tmp_path / "r.h5", lambda rows: rows[rows["b"] >= 2])
    with alone:
        found = validate(alone)
    one = next(one for one in found.contacts if one.b >= 2)
    assert one.responsible == (0,)
    said = " ".join(sentences(one, found.names))
    assert states(said, "stander stood by command", "no robot", "pushed")
