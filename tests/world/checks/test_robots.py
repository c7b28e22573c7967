"""Robots at the start, their paths, speeds and scales, and the room that they have."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from tests.helpers import inside
from tests.world.worlds import (
    CORRIDOR,
    DRAWN,
    changed,
    check,
    check_finding,
    check_told,
    lines,
    with_facts,
)

ALIGNED, ANY, NOT = inside("physim.world.checks", "ALIGNED", "ANY", "NOT")

A = "    pose: [6.0, 1.0, 0.0]"
BOX = "    footprint: {length: 1.8, width: 1.0}\n" + A
SIZE = "{length: 1.8, width: 1.0}\n    pose: [6.0"
UPPER = "[[33, 4], [-3, 4], [-3, -4]]"
PATH = "path: {offset: 1.0}"
OWN = "[[0, 1], [30, 1]]"
REFERENCE = "[[0, 0], [30, 0]]"
FOOTPRINT, POSE, WIDTH = "6:16 robots[0].footprint", "7:11 robots[0].pose", "3:50 corridor.width"
WAY = "11:11 robots[0].path"


def one(old: str, new: str, world: str = CORRIDOR, more: str = "") -> str:
    return changed(world, (old, new)) + more


def outline(given: str) -> str:
    return one(BOX, f"    footprint: {given}\n{A}")


def pose(given: str) -> str:
    return one("[6.0, 1.0, 0.0]", given)


def first(given: str) -> str:
    """The first robot with one more key."""
    return changed(CORRIDOR, (PATH, f"{PATH}\n    {given}"), ("step: 0.01", "step: 0.002"))


def dented(depth: float, x: float = 15.0) -> str:
    """Boundaries, the upper one with a dent down to y = ``depth``."""
    return one(UPPER, f"[[33, 4], [{x + 2}, 4], [{x}, {depth}], [{x - 2}, 4], [-3, 4], [-3, -4]]",
               DRAWN)  # fmt: skip


def reference(given: str) -> str:
    return changed(DRAWN, (REFERENCE, given), ("{offset: -1.0}", "[[0, -1], [30, -1]]"))


NARROW = ('"a"', "15.00 m", "(15, 1)", "0.2 m", "boundaries[1]", "0.5 m")
TOLD = {
    "an outline that crosses itself": (outline("[[0, 0], [1, 1], [1, 0], [0, 1]]"),
        ("E", FOOTPRINT, "itself", "(0.5, 0.5)")),
    "an outline without an area": (outline("[[0, 0], [1, 0], [2, 0]]"),
        ("E", FOOTPRINT, "no area")),
    "an outline of two corners": (outline("[[0, 0], [1, 0]]"),
        ("E", FOOTPRINT, "at least 3", "2")),
    "a reference point outside":
        (changed(CORRIDOR, ("step: 0.01", "step: 0.005"), (BOX, "    footprint: "
                 "[[2, -0.5], [3, -0.5], [3, 0.5], [2, 0.5]]\n    pose: [6.0, 2.0, 0.0]")),
         ("W", FOOTPRINT, "2 m", "outside")),
    "at the wall": (pose("[6.0, 3.5, 0.0]"), ("E", POSE, '"a"', "touches", "corridor")),
    "over the wall": (pose("[6.0, 3.7, 0.0]"), ("E", POSE, '"a"', "0.2 m over", "corridor")),
    "outside": (pose("[6.0, 40.0, 0.0]"), ("E", POSE, '"a"', "outside", "35.5 m")),
    "at another": (pose("[3.0, 0.0, 0.0]"),
        ("E", "11:11 robots[1].pose", '"b"', "touches", '"a"')),
    "on another": (pose("[3.0, -0.3, 0.0]"),
        ("E", "11:11 robots[1].pose", '"b"', "overlaps", '"a"', "0.3 m")),
    "at an obstacle, through which the path leads":
        (CORRIDOR + "obstacles: [[[6.9, 0.9], [8, 0.9], [8, 1.1], [6.9, 1.1]]]\n", ...,
         ("E", POSE, '"a"', "touches", "obstacles[0]")),
    "a heading in degrees": (one("1.0, 0.0]\n    path: {offset: 1.0}",
                                 "1.0, 90]\n    path: {offset: 1.0}"),
        ("W", "7:22 robots[0].pose[2]", "90 rad", "1.5708")),
    "the back to the path": (pose("[6.0, 1.0, 3.14159]"),
        ("W", "7:22 robots[0].pose[2]", '"a"', "180 degrees", "path", "0 rad")),
    "along the path, most of a turn further": (pose("[6.0, 1.0, 6.2]"),),
    "before the reference path": (one("[3.0, -1.0", "[-1.1, -1.0"),
        ("W", "11:11 robots[1].pose", '"b"', "before", "reference path")),
    "a path through a wall": (dented(0.5),
        ("E", WAY, '"a"', "leaves", "14.71 m", "15.29 m")),
    "a path too near a wall": (dented(1.2), ("W", WAY, *NARROW, "lead the path further away")),
    "a reference path that turns back": (reference("[[0, 0], [20, 0], [10, 0.5], [30, 0]]"), ...,
        ("W", "6:17 reference_path", "turns back", "177 degrees", "(20, 0)", "1 more place")),
    "a reference path that crosses itself":
        (reference("[[0, 0], [20, 0], [20, 3], [15, 3], [15, -3], [25, -3], [30, 0]]"), ...,
         ("W", "6:17 reference_path", "crosses", "itself")),
    "a path that turns back": (one(OWN, "[[0, 1], [20, 1], [10, 1.2]]", DRAWN), ...,
        ("W", WAY, "turns back", '"a"', "179 degrees", "(20, 1)")),
    "a path against the reference path": (one(OWN, "[[30, 1], [0, 1]]", DRAWN), ...,
        ("W", WAY, "against", '"a"', "station 30.00 m", "to 0.00 m")),
    "a reference path too short":
        (changed(reference("[[6, 0], [6.9, 0]]"), ("formation: {spacing: [0.0, -3.0]}\n", "")),
         ("W", "6:17 reference_path", "0.9 m", "metres")),
    "a corridor too narrow at one point": (one("width: 8.0", "width: [8.0, 0.9]"), ...,
        ("E", "8:20 robots[0].path.offset", "leaves the accessible area", '"a"', "25.35 m")),
    "millimetres": (one(SIZE, SIZE.replace("1.8", "1800")),
        ("E", f"6:25 {FOOTPRINT[5:]}.length",
         "at most 1000 [m]", "given 1800")),
    "centimetres": (one(SIZE, "{length: 180, width: 100}\n    pose: [6.0"), ...,
        ("E", "2:14 time.step", '"a"'),
        ("W", FOOTPRINT, '"a"', "180 m", "write 1.8", "millimetres, 0.18")),
    "wider than the corridor": (one(SIZE, "{length: 1.8, width: 12.0}\n    pose: [6.0"), ...,
        ("E", POSE, '"a"', "3 m", "over the edge", "make it smaller"),
        ("E", POSE, '"a"', "1 m", "over the edge", "make it smaller")),
    "a width in centimetres": (one("width: 8.0", "width: 160"), ...,
        ("W", WIDTH, "160 m", "write 1.6")),
    "a very long road": (one("[30, 0]]", "[300000, 0]]"), ...,
        ("W", "3:24 corridor.centreline", "300000 m", "write 3000", "millimetres, 300")),
    "milliseconds": (one("duration: 60.0", "duration: 330000"), ...,
        ("W", "2:30 time.duration", "330000 s", "91.67 hours", "milliseconds", "write 330")),
    "a number with its unit": (one("width: 8.0", "width: 600 cm"),
        ("E", WIDTH, '"600 cm"', "bare number [m]")),
    "a minus of print": (one("{offset: -1.0}", "{offset: −1.5}"), ...,
        ("E", "12:20 robots[1].path.offset", "bare number [m]")),
    "an empty value that is needed": (one("width: 8.0", "width: "),
        ("E", "3:50 corridor.width", "empty value")),
    "an empty value that may be left out": (one("{spacing: [0.0, -3.0]}", ""),
        ("E", "13:11 formation", "empty value", "leave the key out")),
    "a step that would tunnel": (one("step: 0.01", "step: 0.1"),
        ("E", "2:14 time.step", '"a"', "1 more", "0.3147 m", "0.1 s", "at most 0.25 m",
         "at most 0.0794 s")),
    "very many steps": (one("step: 0.01, duration: 60.0", "step: 1.0e-6, duration: 40.0"), ...,
        ("W", "2:", "time.step", "40,000,000 steps")),
    "60 m/s": (first("limits: {v: 60.0}"),
        ("W", "9:17 robots[0].limits.v", "60 m/s", "metres per second", "0.06")),
    "90 rad/s": (first("limits: {omega: 90.0}"),
        ("W", "9:21 robots[0].limits.omega", "90 rad/s", "write 1.5708")),
    "an offset that folds in a bend":
        (changed(CORRIDOR, ("offset: 1.0", "offset: 2.5"),
                 (REFERENCE, "[[0, 0], [20, 0], [21, 0.5], [21.5, 1.5], [21.5, 20]]")), ...,
         ("W", "8:20 robots[0].path.offset", "backwards", "2.5 m", '"a"', "2.5)")),
    "a least distance to a wall": (CORRIDOR + "expect: {min_boundary_distance: 2.6}\n", ...,
        ("W", "14:33 expect.min_boundary_distance", '"a"', "2.5 m", "the edge of the corridor",
         "less than 2.6 m")),
    "a least distance": (CORRIDOR + "expect: {min_distance: 50}\n", ...,
        ("W", "14:24 expect.min_distance", '"a"', '"b"', "1.562 m", "less than 50 m")),
    "a greatest distance": (CORRIDOR + "expect: {max_distance: 1.5}\n", ...,
        ("W", "14:24 expect.max_distance", '"a"', '"b"', "1.562 m", "more than 1.5 m")),
    "a greatest distance that is kept": (CORRIDOR + "expect: {max_distance: 1.6}\n",),
    "a start region in degrees":
        (one(A, "    start: {region: [[2, -2], [9, -2], [9, 2], [2, 2]], heading: 90}"), ...,
         ("W", "7:66 robots[0].start.heading", "90 rad", "full turn", "1.5708")),
}  # fmt: skip


@pytest.mark.parametrize("name", TOLD)
def test_what_is_told_of_robots(tmp_path, name):
    text, *told = TOLD[name]
    check_told(check(tmp_path, text), *told)


def test_a_random_heading_needs_room_to_turn(tmp_path):
    assert lines(check(tmp_path, pose("[6.0, 1.0, random]"))) == ([], [])
    tight = changed(pose("[6.0, 3.1, random]"), ("name: co", "seed: 1\nname: co"))
    found = [lines(check(tmp_path, tight.replace("seed: 1", f"seed: {k}"))) for k in range(6)]
    assert {bool(errors) for errors, _ in found} == {True, False}
    for errors, warnings in found:
        if not errors:
            place = "8:22 robots[0].pose[2]"
            check_finding(warnings[0], place, "random", "seed", '"a"', "touch", "corridor")


@pytest.mark.parametrize(("slot", "is_way"), [(0.8, False), (1.2, True)])
def test_a_slot_narrower_than_the_robot_is_no_way(tmp_path, slot, is_way):
    low = slot - 4.0
    text = changed(
        CORRIDOR,
        ("formation: {spacing: [0.0, -3.0]}\n", ""),
        ("path: {offset: 1.0}", "path: [[0, 2], [30, 2]]"),
        ("path: {offset: -1.0}", "path: [[0, -1], [30, -1]]"),
    )
    text += "reference_path: [[0, 0], [13, -3.6], [18, -3.6], [30, 0]]\n"
    text += f"obstacles: [[[15, {low}], [16, {low}], [16, 3.9], [15, 3.9]]]\n"
    errors, warnings = lines(check(tmp_path, text))
    assert len(with_facts(warnings, "through obstacles[0]", "15.00 m", "16.00 m")) == 2
    keys = [] if is_way else ["robots[0].path", "robots[1].path"]
    assert [error.split(" ")[1] for error in errors] == keys
    if not is_way:
        check_finding(errors[0], "8:11 robots[0].path", "no route", '"a"', "narrower than 1 m")


def test_the_profile_has_the_clearance_of_every_station(tmp_path):
    found = check(tmp_path, dented(1.9))
    assert found.ok
    a, b = found.clearance
    assert a.inscribed == pytest.approx(0.5)
    assert a.circumscribed == pytest.approx(math.hypot(0.9, 0.5))
    assert a.narrowest == pytest.approx((15.0, 15.0, 1.0, 0.9))
    assert (a.station[0], a.station[-1]) == (0.0, 30.0)
    assert np.diff(a.station).max() <= 0.25 + 1e-9
    assert a.clearance.min() == pytest.approx(0.9)
    assert a.clearance[0] == pytest.approx(3.0)
    assert a.verdict == ALIGNED
    assert b.verdict == ANY
    json.dumps(found.as_json(), allow_nan=False)


@pytest.mark.parametrize(("at", "clearance"), [(2.0, 3.0), (15.0, 0.3)])
def test_room_is_judged_from_the_start_to_the_stop(tmp_path, at, clearance):
    """a starts at station 6 of 30."""
    a = check(tmp_path, dented(1.3, at)).clearance[0]
    assert a.as_json()["reached"] == {"from": 6.0, "to": 30.0}
    assert a.narrowest[3] == pytest.approx(clearance)
    assert a.verdict == (NOT if clearance < 0.5 else ANY)


def test_the_room_of_a_path_through_an_obstacle_is_its_depth(tmp_path):
    """The distance to the outline, at the deepest station; of two that overlap, of both together.

    An obstacle between two stations is touched.
    """
    whole, *halves = (
        f"[[{a}, 0], [{b}, 0], [{b}, 2], [{a}, 2]]" for a, b in ((14, 16), (14, 15), (15, 16))
    )
    for given in (whole, ", ".join((whole, *halves))):
        found = check(tmp_path, f"{DRAWN}obstacles: [{given}]\n").clearance[0]
        assert found.narrowest == pytest.approx((15.0, 15.0, 1.0, -1.0))
        within = (found.station > 14.0) & (found.station < 16.0)
        own = np.minimum(found.station - 14.0, 16.0 - found.station)
        assert found.clearance[within] == pytest.approx(-own[within])
        assert found.verdict == NOT
    thin = "[[14.05, 0], [14.15, 0], [14.15, 2], [14.05, 2]]"
    found = check(tmp_path, f"{DRAWN}obstacles: [{thin}]\n").clearance[0]
    assert found.narrowest == pytest.approx((14.05, 14.05, 1.0, 0.0))
    assert found.verdict == NOT


def lap(turn: str) -> str:
    """A corridor that comes back 5.2 m beside itself, beyond a wall; a robot beside the way out."""
    return (
        "name: hairpin\ntime: {step: 0.01, duration: 10}\ncorridor:\n"
        "  centreline: [[0, 0], [30, 0], [34, 0], [34, 5.2], [30, 5.2], [0, 5.2]]\n"
        "  width: [8, 8, 2, 2, 2, 2]\nrobots:\n"
        f"  - {{name: r1, footprint: {{length: 0.8, width: 0.4}}, pose: [8, {turn}, 0],\n"
        "     path: {offset: 0}}\n"
    )


def hall(pose: str) -> str:
    return (
        "name: far\ntime: {step: 0.02, duration: 90}\n"
        "boundaries: [[[0, 0], [40, 0], [40, 30], [0, 30], [0, 0]]]\n"
        "reference_path: [[2, 19], [36, 19]]\nrobots:\n"
        f"  - {{name: a, footprint: {{length: 1.2, width: 0.7}}, pose: {pose},\n"
        "     path: {offset: 0}}\n"
    )


@pytest.mark.parametrize(
    ("told", "untold", "parts"),
    [
        (
            lap("3.0"),
            lap("2.5"),
            ("robots[0].pose", "beyond a wall", "65.20 m of its path", "(8, 5.2)"),
        ),
        (hall("[19, 4, 0]"), hall("[4, 14, 0]"), ("robots[0].pose", "15 m away", "(19, 19)")),
    ],
)
def test_a_start_far_from_its_path_or_beyond_a_wall_is_a_warning(tmp_path, told, untold, parts):
    assert with_facts(lines(check(tmp_path, told))[1], *parts)
    assert not with_facts(lines(check(tmp_path, untold))[1], "robots[0].pose")
