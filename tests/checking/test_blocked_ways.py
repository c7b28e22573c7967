"""Robots that stop in the way of others are told, and nobody else; runs are the judge."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from physim import simulate
from physim.world.file import parse_world
from tests.checking.worlds import check, check_finding, lines
from tests.helpers import inside

blocked_ways = inside("physim.world.checks", "blocked_ways")


def junction(first: float, extra: str = "") -> str:
    """Robot b comes out of a side arm onto the way of a, which stops 5 m after the junction."""
    hall = "[[-15, -3], [25, -3], [25, 3], [3, 3], [3, 20], [-3, 20], [-3, 3], [-15, 3], [-15, -3]]"
    return (
        "name: junction\ntime: {step: 0.02, duration: 60.0}\n"
        f"boundaries: [{hall}]\nreference_path: [[-12, 0], [22, 0]]\nrobots:\n"
        f"  - {{name: a, footprint: {{length: 1.2, width: 0.7}}, pose: [{-first}, 0, 0],\n"
        "     path: [[-12, 0], [5, 0]]}\n"
        "  - {name: b, footprint: {length: 1.2, width: 0.7}, pose: [0, 8, -1.5708],\n"
        "     path: [[0, 17], [0, 0], [20, 0]]}\n"
        f"controller: {{type: path_following, speed: 1.0}}\n{extra}"
    )


def told(folder: Path, text: str) -> list[str]:
    return [line for line in lines(check(folder, text))[1] if "in the way of" in line]


@pytest.mark.parametrize(("first", "is_blocked"), [(2.0, True), (11.9, False)])
def test_a_robot_that_stops_in_the_way_of_a_later_one_is_told(
    tmp_path: Path, first: float, is_blocked: bool
) -> None:
    """One that comes there before it drives on."""
    text = junction(first)
    found = told(tmp_path, text)
    assert len(found) == is_blocked
    if is_blocked:
        check_finding(found[0], "7:12 robots[0].path", '"a"', '"b"', "17.00 m", "(5, 0)")
    assert bool(simulate(parse_world(text)).contacts.size) == is_blocked


def test_who_goes_faster_is_there_first(tmp_path: Path) -> None:
    slow = junction(4.0).replace(
        "width: 0.7}, pose: [-4.0", "width: 0.7}, limits: {v: 0.4}, pose: [-4.0"
    )
    assert told(tmp_path, junction(4.0))
    assert told(tmp_path, slow) == []


def test_no_word_of_ways_in_a_formation_or_where_the_run_is_not_to_finish(tmp_path: Path) -> None:
    assert told(tmp_path, junction(2.0, "expect: {finished: false}\n")) == []
    assert told(tmp_path, junction(2.0, "formation: {}\n").replace(", speed: 1.0", "")) == []


def test_the_robots_that_would_wait_are_counted(tmp_path: Path) -> None:
    c = (
        "  - {name: c, footprint: {length: 1.2, width: 0.7}, pose: [0, 11, -1.5708],\n"
        "     path: [[0, 17], [0, 0], [18, 0]]}\ncontroller:"
    )
    (line,) = told(tmp_path, junction(2.0).replace("controller:", c))
    assert "as 1 more robot would" in line


@pytest.mark.parametrize("swapped", [False, True])
def test_who_stops_on_another_hides_nobody_in_its_way(tmp_path: Path, swapped: bool) -> None:
    """That of b and c is told as a shared stop, whichever of a and c is the first robot."""
    c = (
        "  - {name: c, footprint: {length: 1.2, width: 0.7}, pose: [19, 0, 0],\n"
        "     path: [[-12, 0], [19.5, 0]]}\n"
    )
    text = junction(2.0)
    place = "  - {name: a" if swapped else "controller:"
    found = told(tmp_path, text.replace(place, c + place))
    assert len(found) == 1
    assert '"a" stops' in found[0]


LANES = """\
name: lanes
time: {step: 0.02, duration: 60.0}
corridor: {centreline: [[0, 0], [40, 0]], width: 5.0}
robots:
  - {name: a, footprint: {length: 1.8, width: 1.0}, pose: [2, 0, 0], path: [[0, 0], [40, 0]]}
  - {name: b, footprint: {length: 1.8, width: 1.0}, pose: [6, Y, 0], path: [[0, Y], [20, Y]]}
controller: {type: mode_switching}
"""


@pytest.mark.parametrize(("beside", "is_blocked"), [
    (0.0, True), (-0.6, True), (0.9, True), (-1.2, True), (1.52, False),
])  # fmt: skip
def test_who_stands_beside_a_way_is_in_it_up_to_what_robots_keep(
    tmp_path: Path, beside: float, is_blocked: bool
) -> None:
    """1 m wide, from which `distance_low` is kept."""
    text = LANES.replace("Y", f"{beside:g}")
    assert bool(told(tmp_path, text)) == is_blocked
    assert (simulate(parse_world(text)).ended == "finished") != is_blocked
    blind = text.replace("mode_switching", "path_following")
    assert bool(told(tmp_path, blind)) == (abs(beside) < 1.0)
    assert bool(simulate(parse_world(blind)).contacts.size) == (abs(beside) < 1.0)


@pytest.mark.parametrize(("end", "is_blocked"), [(1.2, True), (2.6, False)])
def test_who_stops_across_a_way_is_in_it(tmp_path: Path, end: float, is_blocked: bool) -> None:
    """With a part of it that reaches farther than its width."""
    text = junction(2.0).replace("[0, 8, -1.5708]", f"[0, {end + 4}, -1.5708]")
    text = text.replace("[[0, 17], [0, 0], [20, 0]]", f"[[0, 17], [0, {end}]]")
    text = text.replace("pose: [-2.0, 0, 0]", "pose: [-11, 0, 0]").replace("[5, 0]]", "[20, 0]]")
    text = text.replace(
        "b, footprint: {length: 1.2, width: 0.7}", "b, footprint: {length: 3, width: 0.6}"
    )
    assert bool(told(tmp_path, text)) == is_blocked
    assert bool(simulate(parse_world(text)).contacts.size) == is_blocked


@pytest.mark.parametrize(("first", "second", "is_blocked"), [(30, 36, True), (38, 35, False)])
def test_nobody_overtakes_on_one_path(
    tmp_path: Path, first: float, second: float, is_blocked: bool
) -> None:
    """Who starts ahead is there first, however slow."""
    text = LANES.replace("60.0}", "150.0}").replace("pose: [6, Y, 0], path: [[0, Y], [20, Y]]",
        f"limits: {{v: 0.3}}, pose: [8, 0, 0], path: [[0, 0], [{first}, 0]]")  # fmt: skip
    text = text.replace("[[0, 0], [40, 0]]}", f"[[0, 0], [{second}, 0]]}}", 2)
    text = text.replace("centreline: [[0, 0], [36, 0]]", "centreline: [[0, 0], [40, 0]]")
    text = text.replace("centreline: [[0, 0], [35, 0]]", "centreline: [[0, 0], [40, 0]]")
    assert bool(told(tmp_path, text)) == is_blocked
    assert (simulate(parse_world(text)).ended == "finished") != is_blocked


def test_who_starts_on_a_way_and_leaves_it_is_no_leader(tmp_path: Path) -> None:
    """b starts on the way of a, goes round, and stops on it long after a has passed."""
    loop = "[[10, 0], [10, 8], [30, 8], [30, -8], [6, -8], [6, 0], [8, 0]]"
    text = (
        "name: round\ntime: {step: 0.02, duration: 120.0}\n"
        "boundaries: [[[-5, -12], [50, -12], [50, 12], [-5, 12], [-5, -12]]]\n"
        "reference_path: [[0, 0], [45, 0]]\nrobots:\n"
        "  - {name: a, footprint: {length: 1, width: 0.6}, pose: [2, 0, 0],\n"
        "     path: [[0, 0], [45, 0]]}\n"
        "  - {name: b, footprint: {length: 1, width: 0.6}, pose: [10, 0, 1.57],\n"
        f"     path: {loop}}}\n"
        "controller: {type: path_following}\n"
    )
    assert told(tmp_path, text) == []
    assert simulate(parse_world(text)).contacts.size == 0


@pytest.mark.parametrize(("beside", "low", "high", "is_blocked"), [
    (-1.3, -1.0, 1.0, True), (-1.3, -0.2, 1.2, False), (1.3, -0.2, 1.2, True),
    (1.3, -1.2, 0.2, False), (-1.3, -1.2, 0.2, True),
])  # fmt: skip
def test_a_robot_is_as_wide_as_across_its_heading(
    tmp_path: Path, beside: float, low: float, high: float, is_blocked: bool
) -> None:
    """To each side, however short it is."""
    outline = f"[[-0.3, {low}], [0.3, {low}], [0.3, {high}], [-0.3, {high}]]"
    text = LANES.replace("Y", f"{beside:g}").replace("mode_switching", "path_following")
    text = text.replace("{length: 1.8, width: 1.0}", outline, 1)
    assert bool(told(tmp_path, text)) == is_blocked
    assert bool(simulate(parse_world(text)).contacts.size) == is_blocked


@pytest.mark.parametrize(("slow", "is_blocked"), [("a", True), ("b", False)])
def test_two_ways_round_are_not_one(tmp_path: Path, slow: str, is_blocked: bool) -> None:
    """Of the same length, from where b starts on the way of a: who goes faster is there first."""
    robots = "".join(
        f"  - {{name: {name}, footprint: {{length: 1, width: 0.6}}, pose: [{x}, 0, 0],\n"
        f"     limits: {{v: {0.2 if name == slow else 1.0}}},\n"
        f"     path: [[{x}, 0], [13, 0], [15, {side}], [21, {side}], [24, 0], [{end}, 0]]}}\n"
        for name, x, side, end in (("a", 0, -4, 36), ("b", 12, 4, 30))
    )
    text = (
        "name: round\ntime: {step: 0.02, duration: 250.0}\n"
        "boundaries: [[[-9, -12], [50, -12], [50, 12], [-9, 12], [-9, -12]]]\n"
        f"reference_path: [[0, 0], [36, 0]]\nrobots:\n{robots}"
        "controller: {type: path_following}\n"
    )
    assert bool(told(tmp_path, text)) == is_blocked
    assert bool(simulate(parse_world(text)).contacts.size) == is_blocked


@pytest.mark.parametrize(("aside", "is_blocked"), [(1.2, False), (0.0, True)])
def test_a_short_way_round_on_a_long_road_is_another_way(aside: float, is_blocked: bool) -> None:
    """Of a straight path no corner says that the other leaves it."""
    paths = [
        np.array([[0.0, 0], [13, 0], [16, aside], [19, 0], [190, 0]]),
        np.array([[12.0, 0], [150, 0]]),
    ]
    length = float(np.hypot(*np.diff(paths[0], axis=0).T).sum())
    found = blocked_ways(
        paths, np.array([[0.0, 0], [12, 0]]), np.zeros(2), np.array([length, 138.0]),
        np.array([1.0, 0.2]), np.full((2, 2), 0.3), [shapely.box(189, -1, 190, 1),
        shapely.box(149.5, -0.3, 150.5, 0.3)],
    )  # fmt: skip
    assert found == ({0: [1]} if is_blocked else {})
