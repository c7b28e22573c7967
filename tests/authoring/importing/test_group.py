"""Robots that are drawn or filled in: their paths, formations, laps, lanes and stops."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim import check_world, simulate
from physim.authoring.importing import Options, import_world
from tests.authoring.importing.plans import (
    HALL,
    LOOP,
    WAY,
    box,
    check_says,
    free_area,
    geojson,
    only,
    paths_of,
    refusal,
    ways_of,
)


@pytest.mark.parametrize(("x", "y", "offset"), [(4, 7, 0.0), (4, 9, 2.0), (20.5, 6, -1.0)])
def test_a_robot_in_line_with_its_path_is_not_beside_it(
    tmp_path: Path, x: float, y: float, offset: float
) -> None:
    """Before its beginning or past its end: its distance to the path is along it."""
    robot = ("robot a", shapely.box(x - 0.5, y - 0.3, x + 0.5, y + 0.3))
    way = ("path", shapely.LineString([(6, 7), (20, 7)]))
    made = import_world(geojson(tmp_path, [("boundary", shapely.box(0, 0, 26, 14)), robot, way]))
    (line,) = (one.path for one in made.world.robots)
    assert (0.0 if line is None else line.offset) == pytest.approx(offset)


def test_a_path_begins_behind_the_robots_that_wait_for_it(tmp_path: Path) -> None:
    """Before it a formation cannot measure how far apart they are."""
    robots = [("robot", shapely.box(x, 6.5, x + 1.6, 7.5)) for x in (5, 1)]
    way = ("path", shapely.LineString([(12, 7), (40, 7)]))
    place = ("boundary", shapely.box(0, 0, 50, 14))
    made = import_world(geojson(tmp_path, [place, *robots, way]))
    assert np.asarray(made.world.reference_path)[0] == pytest.approx((1.8, 7.0))
    check_says(only(made, "earlier"), "10.20 m … (1.80, 7.00)")
    free_area(made, tmp_path)
    hook = ("path", shapely.LineString([(12, 7), (12.01, 7.02), (40, 7)]))
    drawn = import_world(geojson(tmp_path, [place, *robots, hook]))
    check_says(only(drawn, "earlier"), "10.20 m … (1.80, 7.00)")
    assert [one.pose[2] for one in drawn.world.robots] == pytest.approx([0.0, 0.0], abs=0.05)
    wall = ("obstacle", shapely.box(9, 6, 10, 8))
    blocked = import_world(geojson(tmp_path, [place, wall, *robots, way]))
    check_says(only(blocked, "before the path"), "WARNING … 10.20 m … (12.00, 7.00)")


@pytest.mark.parametrize(
    ("names", "count"),
    [(("", ""), 1), ((" a", " a"), 1), ((" a", " b"), 2), ((" r1", " r2"), 2), ((" a", " a_2"), 2)],
)
def test_a_robot_drawn_twice_is_one(tmp_path: Path, names: tuple[str, str], count: int) -> None:
    """As some programs write the filling and the line of a shape; not with names of their own."""
    parts = [HALL, WAY, *((f"robot{name}", box(5, 5)) for name in names), ("robot c", box(9, 5))]
    if count == 2:
        check_says(refusal(geojson(tmp_path, parts)), "overlaps")
        return
    made = import_world(geojson(tmp_path, parts))
    assert len(made.world.robots) == 2
    check_says(only(made, "drawn twice"), "robot at … left out")


CART = ("robot cart", shapely.box(4, 14, 5.8, 15))


def test_a_path_of_its_own_is_fitted_as_the_reference_path_is(tmp_path: Path) -> None:
    """It ends away from the wall, begins at its robot, and stays in the area."""
    parts = [HALL, WAY, ("robot a", box(4, 5)), CART]
    own = ("path cart", shapely.LineString([(8, 14.5), (49.5, 14.5)]))
    made = import_world(geojson(tmp_path, [*parts, own]))
    free_area(made, tmp_path)
    _, cart = paths_of(made)
    assert cart[0] == pytest.approx((4.9, 14.5))
    check_says(only(made, "path of cart begun"), "3.10 m earlier")
    assert 45.0 < cart[-1, 0] < 48.5
    assert only(made, "path of cart shortened")
    out = ("path cart", shapely.LineString([(5, 14.5), (20, 14.5), (20, 25), (22, 25), (22, 14)]))
    said = refusal(geojson(tmp_path, [*parts, out]))
    check_says(said, "the path of cart leaves the area … (20.00, 20.00)")
    narrow = ("obstacle", shapely.box(20, 15, 21, 16))
    said = refusal(geojson(tmp_path, [*parts, narrow, own]))
    check_says(said, "the path of cart passes 0.5 m from a boundary … 1 m wide")


def test_a_path_in_another_room_is_told_so(tmp_path: Path) -> None:
    parts = [HALL, WAY, ("robot a", box(4, 5)), ("robot b", box(4, 15)),
             ("wall", shapely.LineString([(0, 10), (50, 10)])),
             ("path b", shapely.LineString([(4, 15), (40, 15)]))]  # fmt: skip
    said = refusal(geojson(tmp_path, parts))
    check_says(said, "all of the path of b lies outside the area of the reference path")


def test_a_path_whose_robot_is_not_there_is_told_with_the_nearest(tmp_path: Path) -> None:
    parts = [
        HALL,
        WAY,
        ("robot fork", box(4, 5)),
        ("path Fork", shapely.LineString([(4, 9), (40, 9)])),
    ]
    told = only(import_world(geojson(tmp_path, parts)), "there is no robot")
    check_says(told, '"Fork" … "fork" … left out')


RING = [(12, 11), (20, 11), (20, 3), (4, 3), (4, 11), (12, 11)]

U = [(0, 0), (20, 0), (20, 14), (0, 14)]


@pytest.mark.parametrize(("reference", "own", "is_along"), [
    (LOOP, RING, False), (LOOP, RING[::-1], False), (U, [(12, 4), (12, 13)], False),
    (U, [(3, 2), (18, 2), (18, 12), (3, 12)], True), (U, [(3, -2), (22, -2), (22, 16)], False),
    (U, [(3, -2), (22, -2), (22, 16), (2, 16)], True),
    (U, [(2, -1), (10, -1), (10, 13), (2, 13)], False), (U, [(2, 2), (14, 7), (2, 12)], False),
    ([(0, 0), (24, 0)], [(1, 2), (18, 2), (18, 4), (12, 4), (12, 6), (23, 6)], False),
], ids=["against", "another lap", "across", "inside", "without an end", "outside", "short cut",
        "tip", "to and fro"])  # fmt: skip
def test_a_formation_goes_where_it_can_be_measured(
    tmp_path: Path, reference: list[Any], own: list[Any], is_along: bool
) -> None:
    """A robot's own path along the reference path has a like length on it, part by part."""
    ahead = np.array(own[1]) - own[0]
    turn = float(np.arctan2(ahead[1], ahead[0]))
    b = shapely.affinity.rotate(box(0, 0, 1.2, 0.6), turn, (0, 0), use_radians=True)
    parts = [("boundary", shapely.box(-6, -6, 30, 20)), ("path", shapely.LineString(reference)),
             ("robot a", box(0.9, 0, 1.2, 0.6)), ("path b", shapely.LineString(own)),
             ("robot b", shapely.affinity.translate(b, *own[0]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert (made.world.formation is not None) == is_along
    assert bool([one for one in made.facts if "no formation" in one]) != is_along


@pytest.mark.parametrize("start", [0, 1, 2])
def test_a_lap_begins_at_its_robot(tmp_path: Path, start: int) -> None:
    """Wherever it was drawn from: each robot drives the whole of it."""
    corners = [(4, 4), (26, 4), (26, 12), (4, 12)]
    lap = [*corners[start:], *corners[:start], corners[start]]
    boxes = [shapely.box(25.5, y, 26.5, y + 1.8) for y in (8.5, 5.5)]
    parts = [("boundary", shapely.box(0, 0, 30, 16)), ("path", shapely.LineString(lap))]
    made = import_world(geojson(tmp_path, [*parts, *(("robot", one) for one in boxes)]))
    for path, y in zip(paths_of(made), (9.4, 6.4), strict=True):
        assert path[0] == pytest.approx((26.0, y), abs=0.101)
        assert shapely.LineString(path).length == pytest.approx(60.0)
    assert any("no formation: a path is closed" in fact for fact in made.facts)
    free_area(made, tmp_path)


@pytest.mark.parametrize("count", [2, 4])
@pytest.mark.parametrize("side", [0.0, 1.2, -1.2])
@pytest.mark.parametrize("visitor", [False, True])
def test_robots_all_round_a_lap_drive_one_each(
    tmp_path: Path, count: int, side: float, visitor: bool
) -> None:
    """As vehicles do that serve a loop; with a robot that goes another way, too."""
    lap = shapely.LineString(LOOP)
    parts = [("boundary", shapely.box(-8, -8, 32, 22)), ("path", lap)]
    for k in range(count):
        x, y = lap.interpolate((4.0 + k / count * lap.length) % lap.length).coords[0]
        tip = lap.interpolate((4.1 + k / count * lap.length) % lap.length).coords[0]
        one = shapely.affinity.rotate(
            box(0, side, 1.4, 0.8), np.arctan2(tip[1] - y, tip[0] - x), (0, 0), use_radians=True
        )
        parts.append((f"robot v{k}", shapely.affinity.translate(one, x, y)))
    if visitor:
        parts += [("robot w", box(3, 7)), ("path w", shapely.LineString([(3, 7), (20, 7)]))]
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert made.world.formation is None
    assert min(ways_of(made)[:count]) > lap.length - 8.0 * abs(side) - 0.5
    assert not [one for one in made.changes if "WARNING" in one]


@pytest.mark.parametrize("way", [
    [(-80, 0), (40, 0), (40, 3.5), (-20, 3.5)],
    [(-80, 0), (26, 0), (26, 3), (-86, 3), (-86, -20), (80, -20)],
    [(-80, 0), (40, 0), (40, 1.5), (-20, 6)],
    [(-110, 0), (100, 0), (100, 10), (-20, 1.5), (-60, 1.5)],
], ids=["ends in it", "begins beside it", "opens", "widens to its tip"])  # fmt: skip
def test_lanes_stay_beside_their_leg_of_a_hairpin(tmp_path: Path, way: list[Any]) -> None:
    """Also where they do not cross at its open end: a run would take robots for elsewhere."""
    parts = [("boundary", shapely.box(-120, -60, 120, 60)), ("path", shapely.LineString(way))]
    made = import_world(geojson(tmp_path, parts), Options(robots=6, lanes=3))
    free_area(made, tmp_path)
    assert not check_world(tmp_path / "made.yaml").warnings
    reference = shapely.LineString(np.asarray(made.world.reference_path))
    starts = [reference.project(shapely.Point(one.pose[:2])) for one in made.world.robots]
    assert np.diff(starts) == pytest.approx([-3.2] * 5, abs=0.5)
    for path in paths_of(made):
        line = shapely.LineString(path)
        at = [reference.project(line.interpolate(x)) for x in np.arange(0.0, line.length, 1.0)]
        assert np.abs(np.diff(at)).max() < 8.0


CROSSED = [(0, 0), (40, 0), (40, 3), (0, 3), (0, 30), (20, 30), (20, -30), (60, -30)]


@pytest.mark.parametrize(("robots", "lanes"), [(6, 3), (4, 2)])
def test_a_group_that_would_lose_its_path_is_refused(
    tmp_path: Path, robots: int, lanes: int
) -> None:
    """Whose lanes leave out a hairpin that the path crosses later; in single file it goes."""
    parts = [("boundary", shapely.box(-20, -50, 80, 50)), ("path", shapely.LineString(CROSSED))]
    said = refusal(geojson(tmp_path, parts), Options(robots=robots, lanes=lanes))
    check_says(said, "would leave out a part … and the formation would be lost; fewer --lanes")
    made = import_world(geojson(tmp_path, parts), Options(robots=robots))
    free_area(made, tmp_path)
    assert min(ways_of(made)) > 200.0


@pytest.mark.parametrize(("ahead", "is_one"), [(2.5, False), (9.0, True)])
def test_robots_whose_paths_meet_stop_in_the_order_in_which_they_come(
    tmp_path: Path, ahead: float, is_one: bool
) -> None:
    """In a formation b, measured at the junction, would stop before a, which is there first."""
    hall = shapely.box(-30, -3, 30, 3).union(shapely.box(-3, 0, 3, 25))
    parts = [
        ("boundary", hall), ("path", shapely.LineString([(-25, 0), (25, 0)])),
        ("path b", shapely.LineString([(0, 20), (0, 0), (25, 0)])),
        ("robot a", box(-ahead, 0, 1.2, 0.7)), ("robot b", box(0, 6, 0.7, 1.2)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert (made.world.formation is not None) == is_one
    told = [one for one in made.facts if "a would stop in the way of b" in one]
    assert bool(told) != is_one
    behind = [one for one in made.facts if "start behind b" in one]
    assert len(behind) == is_one
    if is_one:
        check_says(behind[0], "a 9.00 m")
    assert simulate(made.world).ended == "finished"
    ends = [shapely.LineString(path).length for path in paths_of(made)]
    assert is_one or ends == pytest.approx([50.0, 45.0 - (1.2 + 1.1 * 0.67)], abs=0.01)
    behind = [one for one in made.facts if "behind others" in one]
    assert len(behind) == (not is_one)


CORNER = np.array([(0.0, 0.0), (30.0, 0.0), (30.0, 10.0)])


def track(folder: Path, points: np.ndarray, half: float) -> Path:
    path = folder / "t.csv"
    path.write_text("".join(f"{x},{y},{half},{half}\n" for x, y in points))
    return path


def test_a_path_that_ends_after_a_bend_is_shortened(tmp_path: Path) -> None:
    imported = import_world(track(tmp_path, CORNER, 3.0), Options(robots=4))
    told = [change for change in imported.changes if "more at its end" in change]
    assert len(told) == 1
    check_says(told[0], "1.20 m more … bend … 0.28 m … 1.20 m")


def test_lanes_are_drawn_in_where_the_corridor_is_narrow(tmp_path: Path) -> None:
    """Two lanes of boxes of 1 m through a door of 2.4 m: side by side before and after it."""
    plan = shapely.box(0, 0, 40, 8).difference(
        shapely.MultiPolygon([shapely.box(19, 0, 21, 2.8), shapely.box(19, 5.2, 21, 8)])
    )
    path = tmp_path / "p.wkt"
    path.write_text(f"{plan.wkt}\nLINESTRING (1 4, 39 4)\n")
    imported = import_world(path, Options(robots=4, lanes=2, robot=(1.0, 0.6)))
    assert sum("drawn in" in change for change in imported.changes) == 2
    lines = [np.array(robot.path) for robot in imported.world.robots[:2]]
    for line in lines:
        points = shapely.points(line)
        assert shapely.distance(plan.boundary, points).min() > 0.3
        assert 0.5 < np.abs(line[:, 1] - 4.0).max() < 1.2
        close = shapely.get_coordinates(shapely.segmentize(shapely.LineString(line), 0.1))
        inside = close[(close[:, 0] > 19) & (close[:, 0] < 21)]
        assert np.abs(inside[:, 1] - 4.0).max() < 0.7


def test_robots_are_counted_from_the_front_and_stop_apart(tmp_path: Path) -> None:
    path = tmp_path / "p.wkt"
    path.write_text("POLYGON ((0 0, 80 0, 80 9, 0 9, 0 0))\nLINESTRING (1 4.5, 79 4.5)")
    world = import_world(path, Options(robots=5, lanes=2)).world
    along = [robot.pose[0] for robot in world.robots]
    assert [robot.name for robot in world.robots] == ["r1", "r2", "r3", "r4", "r5"]
    assert along == sorted(along, reverse=True)
    assert np.diff(along).max() <= -1.5  # none stops abreast of another
    assert {robot.pose[1] for robot in world.robots} == {3.5, 5.5}
    assert {robot.pose[2] for robot in world.robots} == {0.0}


OUTLINES = {
    "box": [(0.9, 0.4), (-0.9, 0.4), (-0.9, -0.4), (0.9, -0.4)],
    "arrow": [(0.6, 0.0), (-0.4, 0.3), (-0.2, 0.0), (-0.4, -0.3)],
    "triangle": [(0.6, 0.0), (-0.4, 0.3), (-0.4, -0.3)],
    "arrow with a shaft": [(0.9, 0), (0.3, 0.5), (0.3, 0.2), (-0.9, 0.2), (-0.9, -0.2), (0.3, -0.2),
                           (0.3, -0.5)],
    "kite": [(0.9, 0), (0, 0.4), (-0.6, 0), (0, -0.4)],
    "house": [(0.9, 0), (0.6, 0.5), (-0.9, 0.5), (-0.9, -0.5), (0.6, -0.5)],
    "L": [(0.5, -0.3), (0.5, 0), (-0.2, 0), (-0.2, 0.4), (-0.5, 0.4), (-0.5, -0.3)],
    "oval": [(0.7 * cos(a), 0.5 * sin(a)) for a in np.arange(0.0, 2.0 * pi, pi / 20)],
}  # fmt: skip


@pytest.mark.parametrize("off", [-20.0, 3.0, 25.0])
@pytest.mark.parametrize("shape", OUTLINES)
def test_a_robot_heads_as_its_outline_points(tmp_path: Path, shape: str, off: float) -> None:
    """Not as its path leads; it is as large as it is drawn."""
    drawn = shapely.affinity.rotate(shapely.Polygon(OUTLINES[shape]), off, origin=(0, 0))
    robot = shapely.affinity.translate(drawn, 6, 5)
    (one,) = import_world(geojson(tmp_path, [HALL, WAY, ("robot a", robot)])).world.robots
    assert np.degrees(one.pose[2]) == pytest.approx(off, abs=0.4)
    assert shapely.Polygon(one.outline).area == pytest.approx(drawn.area, rel=0.02)


@pytest.mark.parametrize("corners", [15, 200])
def test_a_round_robot_heads_along_its_path(tmp_path: Path, corners: int) -> None:
    """The rectangles about a circle are as small in many directions; rounding chose one."""
    at = 0.1 + np.linspace(0.0, 2.0 * pi, corners, endpoint=False)
    robot = ("robot a", shapely.Polygon(0.3 * np.stack([np.cos(at), np.sin(at)], axis=1) + [6, 5]))
    (one,) = import_world(geojson(tmp_path, [HALL, WAY, robot])).world.robots
    assert one.pose == pytest.approx((6.0, 5.0, 0.0), abs=0.02)
