"""Boundaries, obstacles, corridors and the area between them."""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers import inside
from tests.world.worlds import CORRIDOR, DRAWN, changed, check, check_told, lines, with_facts

wall_crossing = inside("physim.world.layout", "wall_crossing")

FIRST = "  - [[-3, -4], [33, -4], [33, 4]]\n"
SECOND = "  - [[33, 4], [-3, 4], [-3, -4]]\n"
LINE = "[[0, 0], [30, 0]]"
BEND = "[[0, 0], [20, 0], [21, 0.5], [21.5, 1.5], [21.5, 20]]"
AREA, CENTRELINE = "4:3 boundaries", "3:24 corridor.centreline"


def more(wall: str) -> str:
    """The drawn world with one more boundary."""
    return changed(DRAWN, (SECOND, f"{SECOND}  - {wall}\n"))


def bent(line: str, width: float = 8.0) -> str:
    """The corridor along another centreline."""
    return changed(CORRIDOR, (f"{LINE}, width: 8.0", f"{line}, width: {width}"))


def box(x0: float, y0: float, x1: float, y1: float) -> str:
    return f"[[{x0}, {y0}], [{x1}, {y0}], [{x1}, {y1}], [{x0}, {y1}]]"


def among(world: str, *boxes: str) -> str:
    return f"{world}obstacles: [{', '.join(boxes)}]\n"


TOLD = {
    "a good corridor": (CORRIDOR,),
    "good boundaries": (DRAWN,),
    "one closed boundary":
        (changed(DRAWN, (FIRST + SECOND, f"  - {box(-3, -4, 33, 4)[:-1]}, [-3, -4]]\n")),),
    "a boundary closed onto its own middle":
        (changed(DRAWN, (FIRST + SECOND,
                         f"  - {box(-3, -4, 33, 4)[:-1]}, [-3, -3.9], [0, -4]]\n")),),
    "a boundary that touches another": (more("[[10, 4], [10, 3]]"),),
    "a wall drawn twice": (more("[[10, 4], [5, 4]]"),),
    "an end that lies on another boundary": (changed(DRAWN, ("[[33, 4], [", "[[33, 3.75], [")),),
    "nan": (changed(DRAWN, ("[-3, 4], [-3", "[.nan, 4], [-3")), ...,
            ("E", "5:16 boundaries[1][1][0]", "finite")),
    "a repeated point": (changed(DRAWN, ("[33, 4], [-3, 4]", "[33, 4], [33, 4], [-3, 4]")),
        ("E", "5:15 boundaries[1][1]", "repeats", "before")),
    "a boundary that crosses itself": (more("[[10, 2], [12, 3], [12, 2], [10, 3], [10, 2]]"),
        ("E", "6:5 boundaries[2]", "crosses itself", "(11, 2.5)")),
    "a boundary that turns back": (more("[[10, 2], [12, 2], [11, 2]]"),
        ("W", "6:5 boundaries[2]", "crosses itself", "(11.5, 2)")),
    "boundaries that cross": (more("[[10, 3], [12, 3], [12, 5], [10, 5], [10, 3]]"),
        ("E", "6:5 boundaries[2]", "crosses", "boundaries[1]", "(10, 4)")),
    "an end beyond a corner":
        (changed(DRAWN, ("[33, 4]]", "[33, 4.5]]"), ("[[33, 4], [-3", "[[33.5, 4], [-3")),
         ("W", "5:5 boundaries[1]", "crosses", "boundaries[0]", "(33, 4)", "beyond")),
    "a gap": (changed(DRAWN, ("[[33, 4], [-3, 4]", "[[32, 4], [-3, 4]")),
        ("E", AREA, "no area", "ends", "boundaries[0]", "(33, 4)", "1 m from boundaries[1]")),
    "walls that touch":
        (changed(DRAWN, ("[33, -4], [33, 4]]", "[15, 0], [33, -4], [33, 4]]"),
                 ("[[33, 4], [-3, 4]", "[[33, 4], [15, 0], [-3, 4]")), ...,
         ("E", "5:5 boundaries[1]", "crosses", "boundaries[0]", "(15, 0)"),
         ("E", "6:17 reference_path", "accessible area", "15.00 m", "30.00 m")),
    "a path through an inner wall": (more("[[15, -4], [15, 2]]"), ...,
        ("W", "12:11 robots[0].path", "boundaries[2]", "(15, 1)", "15.00 m", "way around")),
    "a gap beside an inner wall that is too small": (more("[[15, -4], [15, 3.9]]"), ...,
        ("E", "12:11 robots[0].path", "no route", "1 m")),
    "an obstacle that crosses itself":
        (among(DRAWN, "[[10, 3], [12, 3], [10, 3.5], [12, 3.5]]"),
         ("E", "17:13 obstacles[0]", "itself", "(11, 3.25)")),
    "an obstacle that fills the road": (among(DRAWN, box(-9, -9, 50, 9)), ...,
        ("E", AREA, "obstacles", "nothing", "reference path")),
    "a reference path through an obstacle": (among(CORRIDOR, box(15, -1, 16, 1.5)),
        ("E", CENTRELINE, "through obstacles[0]", "15.00 m", "16.00 m")),
    "obstacles that touch, with a way around":
        (among(DRAWN, box(10, 0.5, 10.5, 2), box(10.5, 0.5, 12.5, 2)), ...,
         ("W", "11:11 robots[0].path", "through obstacles[0]", "way around")),
    "an obstacle that cuts off the end of a path":
        (among(changed(DRAWN, (f"reference_path: {LINE}", "reference_path: [[0, 0], [20, 0]]")),
               box(24, -5, 25, 5)),
         ("E", "11:11 robots[0].path", '"a"', "24.00 m", "obstacles[0] cuts off")),
    "obstacles that cut the way together":
        (among(bent("[[0, 0], [15, -0.1], [15.5, 0.1], [30, 0]]"),
               box(15, -5, 15.5, 0), box(15, 0, 15.5, 5)),
         ("E", "14:13 obstacles[0]", "(15, -0.1)", "right across the way")),
    "a centreline that crosses itself":
        (bent("[[0, 0], [40, 0], [40, 30], [20, 30], [20, -30]]"), ...,
         ("E", CENTRELINE, "into itself")),
    "a bend tighter than the width": (bent(BEND), ...,
        ("W", "3:11 corridor", "walls cross", "tighter")),
    "a wall that folds over": (bent("[[0, 0], [30, 0], [30.5, 1], [20, 18]]"), ...,
        ("W", "3:11 corridor", "walls cross", "tighter")),
    "a centreline that turns back": (bent("[[0, 0], [30, 0], [2, 0.5]]"),
        ("E", CENTRELINE, "179 degrees", "[1] (30, 0)", "at most 149 degrees"),
        ("E", "8:20 robots[0].path.offset", "179 degrees", "[1] (30, 0)")),
    "legs that run into each other": (bent("[[0, 0], [20, 0], [20, 20], [0, 20], [0, 0]]"), ...,
        ("E", CENTRELINE, "into itself", "(-3, -3)", "[0] to [1]", "[3] to [4]")),
    "legs whose walls cross":
        (bent("[[0, 0], [60, 0], [60, 20], [30, 20], [30, 4], [44, 4]]", 6.0),
         ("E", CENTRELINE, "into itself", "[0]", "[4]")),
    "legs whose caps cross": (bent("[[0, 0], [40, 0], [40, 30], [-2, 30], [-2, 3]]", 6.0),
        ("E", CENTRELINE, "into itself", "[0]", "[3]")),
}  # fmt: skip


@pytest.mark.parametrize("name", TOLD)
def test_what_is_told_of_the_ground(tmp_path, name):
    text, *told = TOLD[name]
    check_told(check(tmp_path, text), *told)


@pytest.mark.parametrize(
    ("y", "is_told"), [(4.5, True), (4.0, False), (3.5, False), (0.0, False), (-9.0, True)]
)
@pytest.mark.parametrize("world", [CORRIDOR, DRAWN])
def test_an_obstacle_that_no_robot_can_meet_is_a_warning(tmp_path, world, y, is_told):
    """Beyond a wall at 4 m; one that lies on it or leads through it stands in the way."""
    _, warnings = lines(check(tmp_path, among(world, box(20.0, y, 21.0, y + 1.0))))
    assert len(with_facts(warnings, "outside the accessible area", f"(20, {y:g})")) == is_told


@pytest.mark.parametrize("world", [CORRIDOR, DRAWN])
@pytest.mark.parametrize(("x", "low", "high"), [(1, -5, 5), (15, -4, 4), (15, -4.5, 9)])
def test_an_obstacle_right_across_the_way_is_named_and_nothing_that_follows(
    tmp_path, world, x, low, high
):
    """Robots and paths beyond it stand right."""
    errors, _ = lines(check(tmp_path, among(world, box(x, low, x + 0.2, high))))
    assert len(errors) == 1
    assert with_facts(errors, "obstacles[0]", f"({x}, 0)", f"{x:.2f} m", "right across the way")


def test_only_those_that_cut_the_way_are_named(tmp_path):
    """Two that meet beside the path; it leads through a third, and in and out of a fourth."""
    boxes = [box(20, -1, 21, 1), box(12, -5, 13, 0.5), box(12, 0.4, 13, 5)]
    errors, _ = lines(check(tmp_path, among(CORRIDOR, *boxes)))
    assert [error.split("obstacles[")[1][0] for error in errors] == ["1"]
    arch = "[[8, -5], [8, 1], [14, 1], [14, -5], [13.5, -5], [13.5, 0.5], [8.5, 0.5], [8.5, -5]]"
    errors, _ = lines(check(tmp_path, among(CORRIDOR, arch)))
    assert errors
    assert "across the way" not in " ".join(errors)


@pytest.mark.parametrize(("times", "counted"), [(2, "1 more stretch"), (3, "2 more stretches")])
def test_stretches_are_counted(tmp_path, times, counted):
    out = [f"[{x}, 1], [{x}, 6], [{x + 2}, 6], [{x + 2}, 1]" for x in (10, 16, 22)[:times]]
    text = changed(DRAWN, ("[[0, 1], [30, 1]]", f"[[0, 1], {', '.join(out)}, [30, 1]]"))
    errors, _ = lines(check(tmp_path, text))
    assert with_facts(errors, "11:11 robots[0].path", "13.00 m", "19.00 m", counted)


@pytest.mark.parametrize(("across", "is_told"), [(3.0, True), (3.99, True), (4.0, False)])
def test_a_hairpin_is_clear_where_its_legs_are_a_width_apart(tmp_path, across, is_told):
    """Their inner walls are parallel, and their caps on one line: nothing crosses."""
    text = bent(f"[[0, 0], [20, 0], [20, {across}], [0, {across}]]", 4.0)
    errors, warnings = lines(check(tmp_path, text))
    assert bool(with_facts(errors, "into itself", "[0] to [1]", "[2] to [3]")) == is_told
    assert "folds" not in "".join(warnings)


@pytest.mark.parametrize("turn", range(30, 150, 30))
@pytest.mark.parametrize(("radius", "apart"), [(0.05, 1.0), (1.0, 0.1), (3.0, 100.0)])
def test_a_bend_is_no_leg_of_its_own_however_its_points_lie(turn, radius, apart):
    """What a single corner may do, a bend of many points may, on legs of many points too."""
    width, ahead = 4.0, np.radians(turn)
    bend = np.linspace(0.0, ahead, 12)
    legs = np.append(np.arange(0.0, 40.0, apart), 40.0)
    before = np.stack([legs, np.zeros_like(legs)], axis=1)
    corner = np.stack([40.0 + radius * np.sin(bend), radius * (1.0 - np.cos(bend))], axis=1)
    after = corner[-1] + legs[:, None] * [np.cos(ahead), np.sin(ahead)]
    line = np.vstack([before, corner[1:], after[1:]])
    found = wall_crossing(line, np.full(len(line), width), 3.0)
    assert found is None or found.severity == "warning"
