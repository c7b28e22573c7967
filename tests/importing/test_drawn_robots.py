"""Robots that are drawn, and the paths they go: queues, laps, lanes, ways of their own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim import simulate
from physim.authoring.importing import Imported, import_world
from physim.geometry.corridor import offset_polyline
from physim.world.checks import check_world
from physim.world.file import parse_world
from tests.importing.plans import check_says, only, svg_path
from tests.importing.test_joining import geojson
from tests.importing.test_places import LINE, METRES, drawing, free_area, refusal


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
    "other", [[(45, 9), (5, 9)], [(25, 11), (25, 1)]], ids=["against", "across"]
)
def test_robots_that_go_another_way_are_no_formation(
    tmp_path: Path, other: list[tuple[float, float]]
) -> None:
    """It would have those behind stop as far before their ends, after a step."""
    x, y = other[0]
    parts = [
        ("boundary", shapely.box(0, -4, 50, 16)), ("path", shapely.LineString([(3, 4), (47, 4)])),
        ("path east", shapely.LineString(other)),
        *(("robot", shapely.box(a, 3.5, a + 1.6, 4.5)) for a in (8, 4)),
        ("robot east", shapely.box(x - 0.8, y - 0.5, x + 0.8, y + 0.5)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    front, rear, east = _paths(made)
    assert rear[-1, 0] == pytest.approx(front[-1, 0] - 4.0, abs=0.01)
    assert [tuple(point) for point in east] == other
    assert [one for one in made.facts if "no formation" in one]
    along = import_world(geojson(tmp_path, [*parts[:2], *parts[3:5]]))
    assert along.world.formation is not None


def _paths(made: Imported) -> list[Any]:
    """Points of each robot's path, of the reference path where it is that."""
    return [
        np.asarray(
            made.world.reference_path if not isinstance(one.path, tuple | list) else one.path
        )
        for one in made.world.robots
    ]


@pytest.mark.parametrize(("x", "told"), [(31, ""), (24, ", behind a wall")])
def test_a_robot_far_from_its_path_is_told(tmp_path: Path, x: float, told: str) -> None:
    """In another room, whose walls leave its path no room beside the reference path."""
    parts = [
        ("boundary", shapely.box(0, 0, 40, 20)),
        *(("wall", shapely.LineString([(20, a), (20, b)])) for a, b in ((0, 9), (11, 20))),
        *((f"robot {n}", shapely.box(a - 0.9, 3, a + 0.9, 4)) for n, a in (("a", 4), ("b", x))),
    ]
    said = only(import_world(geojson(tmp_path, parts)), " m from its path")
    check_says(said, f"b at ({x:.2f}, 3.50) … path of its own")
    way = ("path b", shapely.LineString([(4, 16), (18, 16)]))
    changes = import_world(geojson(tmp_path, [*parts, way])).changes
    named = next(one for one in changes if "path with its name" in one)
    check_says(named, f"b at ({x:.2f}, 3.50)")
    assert ("behind a wall" in said) == bool(told)


def test_a_path_drawn_from_its_end_is_told(tmp_path: Path) -> None:
    """The robots have arrived, or nearly, where they are."""
    robots = [("robot", shapely.box(x - 0.9, 4.5, x + 0.9, 5.5)) for x in (6, 3)]
    for way in ([(47, 5), (2, 5)], [(2, 5), (47, 5)]):
        parts = [
            ("boundary", shapely.box(0, 0, 50, 10)),
            *robots,
            ("path", shapely.LineString(way)),
        ]
        told = [one for one in import_world(geojson(tmp_path, parts)).changes if "WARNING" in one]
        if way[0][0] == 2:
            assert not told
        else:
            check_says(told[0], "of a path of 44.73 m … (2.27, 5.00) … the other way round")


@pytest.mark.parametrize("order", [(9, 6, 3), (3, 6, 9), (6, 3, 9)])
def test_a_queue_of_robots_with_paths_of_their_own_drives_all_of_them(
    tmp_path: Path, order: tuple[int, ...]
) -> None:
    """They end as far apart again as they begin: it would be off, measured on one of them."""
    parts: list[tuple[str, Any]] = [("boundary", shapely.box(0, 0, 50, 10))]
    for x in order:
        parts += [(f"robot r{x}", shapely.box(x - 0.9, 4.5, x + 0.9, 5.5)),
                  (f"path r{x}", shapely.LineString([(x, 5), (x + 25, 5)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert made.world.formation is None
    assert [path[-1][0] - path[0][0] for path in _paths(made)] == pytest.approx([25.0] * 3)


def test_a_path_is_as_wide_as_those_on_it_need(tmp_path: Path) -> None:
    """Not as a cart needs that goes its own way."""
    parts = [
        ("boundary", shapely.box(0, 0, 50, 20)), ("path", shapely.LineString([(3, 5), (47, 5)])),
        ("robot a", shapely.box(4, 4.5, 5.8, 5.5)), ("obstacle", shapely.box(20, 5.55, 21, 6.5)),
        ("robot cart", shapely.box(4, 14, 5.8, 15.2)),
        ("path cart", shapely.LineString([(4, 14.6), (47, 14.6)])),
    ]  # fmt: skip
    assert len(import_world(geojson(tmp_path, parts)).world.robots) == 2
    said = refusal(geojson(tmp_path, parts[:-1]))
    check_says(said, "0.55 m … 1.2 m wide … draw narrower robots")


@pytest.mark.parametrize("kind", ["svg", "geojson"])
@pytest.mark.parametrize("start", [0, 1, 2])
def test_a_lap_begins_at_its_robot(tmp_path: Path, kind: str, start: int) -> None:
    """Wherever it was drawn from: each robot drives the whole of it."""
    corners = [(4, 4), (26, 4), (26, 12), (4, 12)]
    lap = [*corners[start:], *corners[:start], corners[start]]
    boxes = [shapely.box(25.5, y, 26.5, y + 1.8) for y in (8.5, 5.5)]
    if kind == "svg":
        robots = "".join(f'<path d="{svg_path(one.exterior.coords)} Z"/>' for one in boxes)
        body = f'<path id="boundary" {LINE} d="M 0,0 H 30 V 16 H 0 Z"/>'
        body += f'<path id="path" {LINE} d="{svg_path(lap[:-1])} Z"/><g id="robot">{robots}</g>'
        flip = 60.0
        path = drawing(tmp_path, body)
    else:
        flip = 0.0
        parts = [("boundary", shapely.box(0, 0, 30, 16)), ("path", shapely.LineString(lap))]
        path = geojson(tmp_path, [*parts, *(("robot", one) for one in boxes)])
    made = import_world(path, METRES)
    for path, y in zip(_paths(made), (9.4, 6.4), strict=True):
        assert path[0] == pytest.approx((26.0, abs(flip - y)), abs=0.101)
        assert shapely.LineString(path).length == pytest.approx(60.0)
    assert any("no formation: a path is closed" in fact for fact in made.facts)
    free_area(made, tmp_path)


def test_a_queue_round_a_corner_is_asked_for_its_path(tmp_path: Path) -> None:
    """The way straight back leads where nobody stands."""
    hall = shapely.Polygon([(0, 0), (30, 0), (30, 5), (5, 5), (5, 30), (0, 30)])
    robots = [("robot", shapely.box(2, y, 3, y + 1.8)) for y in (8, 13)]
    way = ("path", shapely.LineString([(7, 2.5), (27, 2.5)]))
    made = import_world(geojson(tmp_path, [("boundary", hall), *robots, way]))
    assert not [one for one in made.changes if "earlier" in one]
    assert [one for one in made.changes if "before the path begins" in one]


@pytest.mark.parametrize("first", [True, False])
def test_a_mark_on_a_robot_is_no_robot(tmp_path: Path, first: bool) -> None:
    body, mark = shapely.box(4, 6, 5.8, 7), shapely.Polygon([(5.3, 6.2), (5.8, 6.5), (5.3, 6.8)])
    parts = [
        ("boundary", shapely.box(0, 0, 24, 14)),
        ("path", shapely.LineString([(3, 6.5), (20, 6.5)])),
    ]
    drawn = [("robot", body), ("robot", mark)]
    made = import_world(geojson(tmp_path, [*parts, *(drawn if first else drawn[::-1])]))
    assert len(made.world.robots) == 1
    check_says(only(made, "a mark on it"), "(5.30, 6.20)")


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


@pytest.mark.parametrize("truck", [1.8, 6.0])
def test_speeds_are_those_of_the_smallest_robot(tmp_path: Path, truck: float) -> None:
    """Those of a truck would be too fast for the others, and its distances too long."""
    parts = [
        ("boundary", shapely.box(0, 0, 60, 12)), ("path", shapely.LineString([(3, 4), (57, 4)])),
        ("robot a", shapely.box(14, 3.5, 15.8, 4.5)), ("robot b", shapely.box(10, 3.5, 11.8, 4.5)),
        ("robot c", shapely.box(1.5, 3, 1.5 + truck, 5)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is not None
    assert made.world.formation.speed == 1.0
    assert any("1.80 to 6.00 m" in one for one in made.facts) == (truck == 6.0)


@pytest.mark.parametrize("angle", np.linspace(0.1, 4.0, 12))
@pytest.mark.parametrize("first", [9.0, 8.0])
def test_a_path_begins_behind_two_lanes_of_waiting_robots(
    tmp_path: Path, angle: float, first: float
) -> None:
    """Also where the foremost of them stand at its beginning, or it begins at the first of them."""
    lanes = (3.5, 6.5) if first == 9.0 else (5.0,)
    robots = [shapely.box(x - 0.8, y - 0.5, x + 0.8, y + 0.5)
              for x in (first, first - 4.0) for y in lanes]  # fmt: skip
    parts = [("boundary", shapely.box(0, 0, 40, 10)),
             ("path", shapely.LineString([(first, 5), (35, 5)])),
             *(("robot", one) for one in robots)]  # fmt: skip
    turned = [(role, shapely.affinity.rotate(one, angle, origin=(0, 0))) for role, one in parts]
    made = import_world(geojson(tmp_path, turned))
    free_area(made, tmp_path)
    assert only(made, "earlier")


def test_a_robot_with_narrow_parts_has_shorter_steps(tmp_path: Path) -> None:
    """As a forklift with its tines; in the usual ones it could pass through another."""
    fork = shapely.union_all([shapely.box(4, 4, 6, 5.2), shapely.box(6, 4.1, 7, 4.3),
                              shapely.box(6, 4.9, 7, 5.1)])  # fmt: skip
    parts = [("boundary", shapely.box(0, 0, 48, 12)),
             ("path", shapely.LineString([(3, 4.6), (45, 4.6)])), ("robot fork", fork)]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.time.step == 0.005
    assert any("0.005 s" in one for one in made.facts)


@pytest.mark.parametrize("who", ["a", "c"])
def test_each_path_drawn_from_its_end_is_told(tmp_path: Path, who: str) -> None:
    """Also where another robot goes far, another way."""
    ways = {"a": [(3, 3), (37, 3)], "c": [(37, 9), (3, 9)]}
    ways[who] = ways[who][::-1]
    parts = [("boundary", shapely.box(0, 0, 40, 12)), ("path", shapely.LineString(ways["a"])),
             ("path c", shapely.LineString(ways["c"])),
             ("robot a", shapely.box(4, 2.5, 5.8, 3.5)),
             ("robot c", shapely.box(34, 8.5, 35.8, 9.5))]  # fmt: skip
    told = [one for one in import_world(geojson(tmp_path, parts)).changes if "WARNING" in one]
    assert any(f"{who} goes" in one and "the other way round" in one for one in told)


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0, 4.4])
@pytest.mark.parametrize("row", [2, 1])
@pytest.mark.parametrize("own", ["", " a"])
def test_a_lap_of_a_turned_hall_is_driven(tmp_path: Path, angle: float, row: int, own: str) -> None:
    """Robots abreast, or one behind the other, at the place where it was begun."""
    corners = [(15, 4), (26, 4), (26, 12), (4, 12), (4, 4), (15, 4)]
    spots = [(15, 3.2), (15, 4.8)] if row == 2 else [(15, 4), (12, 4)]
    names = ("a", "b")[: 1 if own else 2]
    parts: list[tuple[str, Any]] = [
        ("boundary", shapely.box(0, 0, 30, 16)), (f"path{own}", shapely.LineString(corners)),
        *((f"robot {name}", shapely.box(x - 0.5, y - 0.3, x + 0.5, y + 0.3))
          for name, (x, y) in zip(names, spots, strict=False)),
    ]  # fmt: skip
    turned = [(role, shapely.affinity.rotate(one, angle, origin=(0, 0), use_radians=True))
              for role, one in parts]  # fmt: skip
    made = import_world(geojson(tmp_path, turned))
    free_area(made, tmp_path)
    assert not [one for one in made.changes if "WARNING" in one]
    assert min(_ways(made)) > 38.0 - 8.0 * 0.8 - 0.2


HALL = ("boundary", shapely.box(0, 0, 50, 20))
WAY = ("path", shapely.LineString([(3, 5), (47, 5)]))
CART = ("robot cart", shapely.box(4, 14, 5.8, 15))


def box(x: float, y: float, length: float = 1.8, width: float = 1.0) -> Any:
    return shapely.box(x - length / 2, y - width / 2, x + length / 2, y + width / 2)


def test_a_path_of_its_own_is_fitted_as_the_reference_path_is(tmp_path: Path) -> None:
    """It ends away from the wall, begins at its robot, and stays in the area."""
    parts = [HALL, WAY, ("robot a", box(4, 5)), CART]
    own = ("path cart", shapely.LineString([(8, 14.5), (49.5, 14.5)]))
    made = import_world(geojson(tmp_path, [*parts, own]))
    free_area(made, tmp_path)
    _, cart = _paths(made)
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


@pytest.mark.parametrize("start", [0, 1, 2, 3])
def test_a_lap_of_its_own_begins_at_its_robot(tmp_path: Path, start: int) -> None:
    corners = [(4, 11), (40, 11), (40, 17), (4, 17)]
    lap = [*corners[start:], *corners[:start], corners[start]]
    parts = [HALL, WAY, ("robot a", box(4, 5)), ("robot b", box(20, 11)),
             ("path b", shapely.LineString(lap))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    path = _paths(made)[1]
    assert path[0] == pytest.approx((20, 11), abs=0.2)
    assert shapely.LineString(path).length == pytest.approx(84.0, abs=0.01)


def test_a_world_lasts_as_long_as_the_longest_way(tmp_path: Path) -> None:
    legs = [(5, 14.5), *((x, y) for x in range(8, 44, 8) for y in (9, 17)), (46, 17)]
    parts = [HALL, WAY, ("robot a", box(4, 5)), CART, ("path cart", shapely.LineString(legs))]
    made = import_world(geojson(tmp_path, parts))
    assert made.world.time.duration > shapely.LineString(legs).length


@pytest.mark.parametrize("size", [1.0, 0.5])
def test_speeds_shrink_with_robots_that_are_no_formation(tmp_path: Path, size: float) -> None:
    parts = [("boundary", shapely.box(0, 0, 50 * size, 20 * size)),
             *((f"robot {name}", box(x * size, y * size, 1.8 * size, size))
               for name, x, y in (("a", 4, 5), ("b", 46, 15))),
             ("path a", shapely.LineString(np.array([(4, 5), (46, 5)]) * size)),
             ("path b", shapely.LineString(np.array([(46, 15), (4, 15)]) * size))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    assert made.world.controller.settings.get("speed", 1.0) == pytest.approx(size)


def test_those_on_a_path_with_a_name_stop_one_behind_the_other(tmp_path: Path) -> None:
    """Where another robot goes another way, and there is no formation."""
    parts = [HALL, ("robot a", box(9, 5)), ("path a", shapely.LineString([(9, 5), (47, 5)])),
             ("robot b", box(5, 5)), ("robot c", box(46, 15)),
             ("path c", shapely.LineString([(46, 15), (25, 15)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    ends = {one.name: path[-1] for one, path in zip(made.world.robots, _paths(made), strict=True)}
    assert ends["a"][0] - ends["b"][0] == pytest.approx(4.0, abs=0.01)


@pytest.mark.parametrize("offset", [0.8, 1.5, 2.0, 2.5, -2.0])
@pytest.mark.parametrize("past", [0.05, 0.6, 1.4])
@pytest.mark.parametrize("angle", [0.0, 1.3])
def test_a_lap_beside_the_path_is_driven(
    tmp_path: Path, offset: float, past: float, angle: float
) -> None:
    """Of a robot within, or without, the corner where the lap begins: its lane is a lap, too."""
    corners = [(0, 0), (22, 0), (22, 14), (0, 14), (0, 0)]
    parts = [("boundary", shapely.box(-5, -5, 27, 19)), ("path", shapely.LineString(corners)),
             ("robot b", box(max(offset, 0) + past, offset, 1.4, 0.8))]  # fmt: skip
    turned = [(role, shapely.affinity.rotate(one, angle, origin=(0, 0), use_radians=True))
              for role, one in parts]  # fmt: skip
    made = import_world(geojson(tmp_path, turned))
    free_area(made, tmp_path)
    (path,) = _paths(made)
    if isinstance(made.world.robots[0].path, tuple | list):
        assert shapely.LineString(path).length > 72.0 - 8.0 * max(offset, 0.0) - 0.5
    assert not [one for one in made.changes if "WARNING" in one]
    assert not check_world(tmp_path / "made.yaml").warnings


def test_a_path_begins_at_a_robot_beside_a_wall(tmp_path: Path) -> None:
    """It is not cut off there to have the room that it has farther on."""
    wall = ("obstacle", shapely.box(2, 6.1, 9, 7))
    parts = [HALL, wall, ("robot a", box(4, 5)), ("path", shapely.LineString([(4, 5), (45, 5)]))]
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert np.asarray(made.world.reference_path)[0] == pytest.approx((4.0, 5.0))
    assert not [one for one in made.changes if "at its start" in one or "earlier" in one]


def _ways(made: Imported) -> list[float]:
    """[m] from each robot to the end of its path, at which the first of them stops."""
    found = []
    for one, path in zip(made.world.robots, _paths(made), strict=True):
        if not isinstance(one.path, tuple | list) and one.path is not None:
            path = offset_polyline(path, np.full(len(path), one.path.offset))
        line = shapely.LineString(path)
        found.append(line.length - line.project(shapely.Point(one.pose[:2])))
    return found


RECTANGLE = [(0, 0), (30, 0), (30, 18), (0, 18)]
L_SHAPE = [(0, 0), (30, 0), (30, 10), (14, 10), (14, 22), (0, 22)]
TRIANGLE = [(0, 0), (34, 0), (12, 24)]


@pytest.mark.parametrize("corners", [RECTANGLE, L_SHAPE, TRIANGLE], ids=["box", "L", "triangle"])
@pytest.mark.parametrize("seed", range(12))
def test_all_of_a_queue_drive_a_lap(
    tmp_path: Path, corners: list[tuple[float, float]], seed: int
) -> None:
    """Wherever the lap was drawn from, whichever way round, wherever on it and beside it they are.

    By the lengths of their paths, not by those that the import reckons.
    """
    draw = np.random.default_rng(seed)
    begin, back = int(draw.integers(len(corners))), bool(draw.integers(2))
    way = (corners[begin:] + corners[:begin])[:: -1 if back else 1]
    lap = shapely.LineString([*way, way[0]])
    side, where = float(draw.choice([0.0, -1.2, 1.2])), float(draw.uniform(0.0, lap.length))
    robots = []
    for k in range(int(draw.integers(1, 4))):
        x, y = lap.interpolate((where + 3.0 * k) % lap.length).coords[0]
        tip = lap.interpolate((where + 3.0 * k + 0.01) % lap.length).coords[0]
        turn = np.arctan2(tip[1] - y, tip[0] - x)
        one = shapely.affinity.rotate(box(0, side, 1.4, 0.8), turn, (0, 0), use_radians=True)
        robots.append((f"robot r{k}", shapely.affinity.translate(one, x, y)))
    parts = [("boundary", shapely.box(-12, -12, 46, 36)), ("path", lap), *robots]
    angle = float(draw.choice([0.0, 0.7, 2.3]))
    turned = [(role, shapely.affinity.rotate(one, angle, origin=(0, 0), use_radians=True))
              for role, one in parts]  # fmt: skip
    made = import_world(geojson(tmp_path, turned))
    free_area(made, tmp_path)
    assert made.world.formation is None
    assert min(_ways(made)) > lap.length - 12.0 * abs(side) - 0.5
    assert not [one for one in made.changes if "WARNING" in one]


@pytest.mark.parametrize("front", [[(0, -1.5), (1, -1.5), (1, 1.5), (0, 1.5)], []])
def test_a_robot_heavy_in_front_drives_a_lap(
    tmp_path: Path, front: list[tuple[float, float]]
) -> None:
    """Its reference point, not its centre of area, is where the path begins."""
    shaft = shapely.box(-3.0, -0.2, 1.0, 0.2)
    outline = shapely.union_all([shaft, shapely.Polygon(front)])
    lap = shapely.LineString([(0, 0), (24, 0), (24, 14), (0, 14), (0, 0)])
    parts = [("boundary", shapely.box(-6, -6, 30, 20)), ("path", lap),
             ("robot a", shapely.affinity.translate(outline, 9, 0))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert min(_ways(made)) == pytest.approx(lap.length, abs=0.3)
    straight = [("boundary", shapely.box(-6, -6, 30, 20)), parts[2],
                ("path", shapely.LineString([(9, 0), (26, 0)]))]  # fmt: skip
    path = np.asarray(import_world(geojson(tmp_path, straight)).world.reference_path)
    assert path[0] == pytest.approx((8.0, 0.0))


LOOP = [(0, 0), (24, 0), (24, 14), (0, 14), (0, 0)]
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


def test_a_lap_drawn_a_grain_too_short_is_closed(tmp_path: Path) -> None:
    parts = [("boundary", shapely.box(-6, -6, 30, 20)), ("robot a", box(12, 0)),
             ("path", shapely.LineString([*LOOP[:-1], (0, 0.004)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    check_says(only(made, "it is closed"), "0.004 m")
    assert min(_ways(made)) == pytest.approx(76.0, abs=0.3)


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
    ends = [shapely.LineString(path).length for path in _paths(made)]
    assert is_one or ends == pytest.approx([50.0, 45.0 - (1.2 + 1.1 * 0.67)], abs=0.01)
    behind = [one for one in made.facts if "behind others" in one]
    assert len(behind) == (not is_one)


@pytest.mark.parametrize("farther", [0.5, 1.5, 3.0, 14.0])
def test_robots_that_come_to_one_end_stop_behind_one_another_and_nowhere_else(
    tmp_path: Path, farther: float
) -> None:
    """However much farther one has to go; of two that come at a time the order is not known."""
    hall = shapely.box(-30, -3, 30, 3).union(shapely.box(-3, 0, 3, 30))
    parts = [
        ("boundary", hall), ("path z", shapely.LineString([(20, 2), (-25, 2)])),
        ("path a", shapely.LineString([(-25, -1), (25, -1)])),
        ("path b", shapely.LineString([(0, 20), (0, -1), (25, -1)])),
        ("robot a", box(-21, -1, 1.2, 0.7)), ("robot b", box(0, 20 - farther, 0.7, 1.2)),
        ("robot z", box(16, 2, 1.2, 0.7)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    ends = [shapely.LineString(path).length for path in _paths(made)]
    gap = 1.2 + 1.1 * 0.67
    assert ends == pytest.approx([50.0 - gap, 46.0, 45.0], abs=0.01)
    (behind,) = (one for one in made.facts if "behind others" in one)
    check_says(behind, f"a {gap:.2f} m")
    told = [one for one in made.facts if "come in the other order" in one]
    assert len(told) == (farther < 1.5 * gap)
    if told:
        check_says(told[0], f"b and a have {46.0 - farther:.2f} and 46.00 m")
    else:
        assert simulate(made.world).ended == "finished"


@pytest.mark.parametrize(("beyond", "aside", "gap"), [
    (0.6, 0.0, 2.537), (1.15, 0.0, 3.087), (-0.6, 0.0, 1.337), (-1.9, 0.0, 0.037),
    (0.0, 1.2, 0.0), (0.0, 0.9, 1.707), (3.0, 0.0, 0.0), (-3.0, 0.0, 0.0),
])  # fmt: skip
def test_robots_stop_behind_those_in_their_way_wherever_their_paths_end(
    tmp_path: Path, beyond: float, aside: float, gap: float
) -> None:
    """Ends that are drawn by hand are not one point; places side by side are nobody's way."""
    hall = shapely.box(-30, -3, 32, 3).union(shapely.box(-3, 0, 3, 30))
    parts = [
        ("boundary", hall), ("path z", shapely.LineString([(20, 2.2), (-25, 2.2)])),
        ("path a", shapely.LineString([(-25, -1), (25, -1)])),
        ("path b", shapely.LineString([(0, 20), (0, aside - 1), (25 + beyond, aside - 1)])),
        ("robot a", box(-3, -1, 1.2, 0.7)), ("robot b", box(0, 12, 0.7, 1.2)),
        ("robot z", box(16, 2.2, 3.0, 0.7)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    ends = [shapely.LineString(path).length for path in _paths(made)]
    whole = 20.0 + 1.0 - aside + 25.0 + beyond
    assert ends[:2] == pytest.approx([50.0, whole - gap], abs=0.01)


@pytest.mark.parametrize(("count", "spread"), [(3, 0.6), (5, 1.0)])
def test_robots_that_come_to_one_end_from_all_sides_stop_apart(
    tmp_path: Path, count: int, spread: float
) -> None:
    """Whoever comes later stops beside nobody nearer than robots keep from one another."""
    parts: list[tuple[str, Any]] = [
        ("boundary", shapely.box(-40, -40, 20, 40)),
        ("path z", shapely.LineString([(10, 30), (-30, 30)])), ("robot z", box(8, 30, 1.2, 0.7)),
    ]  # fmt: skip
    for k, turn in enumerate(np.linspace(-0.5, 0.5, count) * spread):
        way = shapely.LineString([(-30 * np.cos(turn), -30 * np.sin(turn)), (0, 0)])
        x, y = (-(6 + 4 * k) * np.cos(turn), -(6 + 4 * k) * np.sin(turn))
        robot = shapely.affinity.rotate(box(x, y, 1.2, 0.7), turn, use_radians=True)
        parts += [(f"path q{k}", way), (f"robot q{k}", robot)]
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    ends = []
    for path in _paths(made)[1:]:
        (x0, y0), (x, y) = path[-2:]
        at = shapely.affinity.rotate(
            box(x, y, 1.2, 0.7), np.arctan2(y - y0, x - x0), use_radians=True
        )
        ends.append(at)
    gaps = [a.distance(b) for i, a in enumerate(ends) for b in ends[:i]]
    assert min(gaps) > 0.5 * 0.67 - 0.02
    assert simulate(made.world).ended == "finished"


def test_robots_that_would_stop_in_one_place_are_no_formation(tmp_path: Path) -> None:
    """Measured along the reference path, which theirs joins ahead of both, b and c are abreast."""
    hall = shapely.box(-5, 15, 25, 25).union(shapely.box(15, -5, 25, 65))
    way, side = [(-3, 20), (20, 20), (20, 60)], shapely.LineString([(20, 0), (20, 60)])
    parts = [
        ("boundary", hall), ("path", shapely.LineString(way)), ("path b", side), ("path c", side),
        ("robot a", box(0, 20, 1.2, 0.7)), ("robot b", box(20, 5, 0.7, 1.2)),
        ("robot c", box(20, 2, 0.7, 1.2)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    assert [one for one in made.facts if "b and c would stop in one place" in one]
    assert simulate(made.world).ended == "finished"


@pytest.mark.parametrize("size", [(1.2, 0.7), (1.8, 1.0)])
def test_robots_on_laps_go_on_in_bends_tighter_than_they_turn(
    tmp_path: Path, size: tuple[float, float]
) -> None:
    """Where they might reverse they would go to and fro there for ever."""
    lap = shapely.LineString([(0, 0), (12, 0)]).buffer(1.25, quad_segs=6).exterior
    parts = [("boundary", shapely.box(-14, -14, 26, 14)), ("path", lap),
             ("robot a", box(6, -0.25, *size))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    assert simulate(parse_world(made.text)).ended == "finished"
    reversing = made.text.replace("reverse_in_safe_mode: false", "reverse_in_safe_mode: true")
    assert simulate(parse_world(reversing)).ended == "duration"


@pytest.mark.parametrize("lap", [LOOP, [(0, 0), (24, 0), (18, 12), (0, 0)]])
@pytest.mark.parametrize("spot", [(-1.5, -1.5), (-2.1, -0.5), (1.5, 1.2), (0.0, -2.0)])
def test_a_lap_goes_round_its_joint_as_round_any_corner(
    tmp_path: Path, lap: list[Any], spot: tuple[float, float]
) -> None:
    """Wherever it was drawn from, a robot about that corner is on the same lap beside it."""
    ways = []
    for begin in range(len(lap) - 1):
        ring = [*lap[begin:-1], *lap[:begin], lap[begin]]
        parts = [("boundary", shapely.box(-9, -9, 33, 23)), ("path", shapely.LineString(ring)),
                 ("robot a", box(*spot, 1.0, 0.6))]  # fmt: skip
        made = import_world(geojson(tmp_path, parts))
        free_area(made, tmp_path)
        (path,) = _paths(made)
        ways.append(shapely.LineString(path))
        assert np.hypot(*(path[[0, -1]] - spot).T).max() < 1.5  # at the tip of a corner
    for way in ways[1:]:
        assert way.hausdorff_distance(ways[0]) < 0.3


def test_a_lap_with_a_narrow_joint_stays_whole(tmp_path: Path) -> None:
    """It begins elsewhere: no wall is ahead at its end."""
    parts = [("boundary", shapely.box(-6, -6, 30, 20)), ("path", shapely.LineString(LOOP)),
             ("obstacle", shapely.box(-2.2, -2.2, -1, -1)), ("robot a", box(12, 0))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert _ways(made) == pytest.approx([76.0], abs=0.3)


def test_robots_of_one_lane_have_one_path(tmp_path: Path) -> None:
    """Which is made once, and as finely as a lane of its own."""
    robots = [(f"robot r{k}", box(4 + 3 * k, 7)) for k in range(7)]
    parts = [HALL, ("path", shapely.LineString([(2, 5), (47, 5)])), *robots,
             ("obstacle", shapely.box(42, 9, 43, 10))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    paths = {np.asarray(path).tobytes() for path in _paths(made)}
    assert len(paths) == 1


@pytest.mark.parametrize("sides", [16, 24, 32])
@pytest.mark.parametrize("inside", [0.8, 1.5, -1.0])
@pytest.mark.parametrize("ahead", [False, True])
def test_a_lap_beside_a_bend_begins_behind_its_robot(
    tmp_path: Path, sides: int, inside: float, ahead: bool
) -> None:
    """Before and after every corner of a round path: it is no lap that ends where it stands."""
    turns = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    lap = shapely.LineString(8.0 * np.stack([np.cos(turns), np.sin(turns)], axis=1))
    for angle in (0.3, 0.35, 0.5, 1.0):
        robots = [(angle, 8.0 - inside), (angle + 0.5, 8.0)][: 2 if ahead else 1]
        parts: list[tuple[str, Any]] = [("boundary", shapely.box(-14, -14, 14, 14)), ("path", lap)]
        for k, (turn, radius) in enumerate(robots):
            one = shapely.affinity.translate(box(0, 0, 1.0, 0.6), radius, 0)
            one = shapely.affinity.rotate(one, 90, origin=(radius, 0))
            one = shapely.affinity.rotate(one, turn, origin=(0, 0), use_radians=True)
            parts.append((f"robot r{k}", one))
        made = import_world(geojson(tmp_path, parts))
        free_area(made, tmp_path)
        assert min(_ways(made)) > 2.0 * np.pi * (8.0 - max(inside, 0.0)) - 5.0


@pytest.mark.parametrize("turn", [0.0, 90.0])
def test_a_box_at_a_corner_heads_along_its_longer_side(tmp_path: Path, turn: float) -> None:
    one = shapely.affinity.rotate(box(24, 0, 1.8, 1.0), turn)
    parts = [("boundary", shapely.box(-6, -6, 30, 20)), ("path", shapely.LineString(LOOP)),
             ("robot a", one)]  # fmt: skip
    (robot,) = import_world(geojson(tmp_path, parts)).world.robots
    assert robot.pose[2] == pytest.approx(np.radians(turn), abs=1e-3)
    assert robot.footprint.length == pytest.approx(1.8)


@pytest.mark.parametrize("turn", [30, 90, 110])
@pytest.mark.parametrize("offset", [-2.5, 1.5])
def test_a_path_parallel_round_a_corner_goes_along(
    tmp_path: Path, turn: int, offset: float
) -> None:
    """Outside it the reference path gains nothing for a while, inside much at once."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    way = np.array([(0.0, 0.0), (10.0, 0.0), (10.0 + 10.0 * c, 10.0 * s)])
    own = offset_polyline(way, np.full(3, offset))
    parts = [("boundary", shapely.box(-8, -8, 28, 22)), ("path", shapely.LineString(way)),
             ("robot a", box(0.6, 0, 1.0, 0.6)), ("path b", shapely.LineString(own)),
             ("robot b", box(0.6, offset, 1.0, 0.6))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is not None


@pytest.mark.parametrize("count", [2, 3, 4])
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
    assert min(_ways(made)[:count]) > lap.length - 8.0 * abs(side) - 0.5
    assert not [one for one in made.changes if "WARNING" in one]


def test_robots_without_a_path_follow_the_nearest_of_those_of_others(tmp_path: Path) -> None:
    """Each group on a path of its own, one behind the other to their stops."""
    parts = [HALL, *((f"robot {name}", box(x, y)) for name, x, y in (
                 ("a", 6, 4), ("a2", 3, 4), ("b", 36, 16), ("b2", 32, 16))),
             ("path a", shapely.LineString([(2, 4), (46, 4)])),
             ("path b", shapely.LineString([(46, 16), (4, 16)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert made.world.formation is None
    paths = dict(zip(["a", "a2", "b", "b2"], _paths(made), strict=True))
    assert [paths[name][0][1] for name in paths] == [4.0, 4.0, 16.0, 16.0]
    assert paths["a"][-1][0] - paths["a2"][-1][0] == pytest.approx(3.0)
    assert paths["b"][-1][0] - paths["b2"][-1][0] == pytest.approx(4.0)
    plain = ("path", shapely.LineString([(2, 4), (46, 4)]))
    told = only(import_world(geojson(tmp_path, [*parts[:-2], plain, parts[-1]])), "stands on the")
    check_says(told, "WARNING: b2 … path of b … 12.00 m beside … named b2")


def test_a_robot_that_stops_early_behind_another_is_told_so(tmp_path: Path) -> None:
    """Far behind it, at the beginning of its path; not that it is to be drawn the other way."""
    parts = [HALL, WAY, ("robot a", box(4, 5)), ("robot b", box(41, 5))]
    told = only(import_world(geojson(tmp_path, parts)), "WARNING")
    check_says(told, "a goes … behind b")
    assert "other way round" not in told


@pytest.mark.parametrize("visitor", [False, True])
def test_a_robot_far_behind_one_near_the_end_stays_behind_it(tmp_path: Path, visitor: bool) -> None:
    """However little way is left to it then; in a formation, too, which a queue is."""
    parts = [HALL, WAY, ("robot a", box(46.9, 5, 0.6, 0.4)), ("robot b", box(3.1, 5, 0.6, 0.4))]
    if visitor:
        parts += [("path x", shapely.LineString([(40, 15), (5, 15)])), ("robot x", box(40, 15))]
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert (made.world.formation is None) == visitor
    if visitor:
        assert _ways(made)[1] < 1.0
    check_says(only(made, "WARNING"), "b goes … behind a")


def test_a_formation_leaves_every_robot_most_of_its_way(tmp_path: Path) -> None:
    """One whose own path begins far ahead would hold back all others."""
    parts = [HALL, WAY, ("robot a", box(4, 5)), ("robot b", box(41, 8)),
             ("path b", shapely.LineString([(41, 8), (48, 8)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    check_says("; ".join(made.facts), "no formation … a would go … m of its way")
    assert _ways(made)[0] > 40.0


def test_a_path_in_another_room_is_told_so(tmp_path: Path) -> None:
    parts = [HALL, WAY, ("robot a", box(4, 5)), ("robot b", box(4, 15)),
             ("wall", shapely.LineString([(0, 10), (50, 10)])),
             ("path b", shapely.LineString([(4, 15), (40, 15)]))]  # fmt: skip
    said = refusal(geojson(tmp_path, parts))
    check_says(said, "all of the path of b lies outside the area of the reference path")


def test_a_path_of_no_robot_is_one_of_those_that_are_followed(tmp_path: Path) -> None:
    """The nearest is followed, not the first: and no wall may be before it."""
    parts = [HALL, ("path zz", shapely.LineString([(2, 4), (46, 4)])),
             ("path b", shapely.LineString([(2, 15), (46, 15)])), ("robot b", box(4, 15)),
             ("robot c", box(8, 13.4)), ("robot d", box(4, 5.2))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    by_name = dict(zip([one.name for one in made.world.robots], _paths(made), strict=True))
    assert (by_name["c"][:, 1] == 15.0).all()
    assert made.world.robots[2].path.offset == pytest.approx(1.2)
    walled = [*parts, ("wall", shapely.LineString([(0, 14.2), (47, 14.2)]))]
    made = import_world(geojson(tmp_path, walled))
    assert _paths(made)[1][:, 1].max() < 14.2


def test_robots_all_round_two_laps_drive_one_each(tmp_path: Path) -> None:
    laps = {"a": LOOP, "b": [(x + 34, y) for x, y in LOOP]}
    spots = (("a", 4, 0), ("a2", 20, 14), ("b", 54, 14), ("b2", 38, 0))
    parts = [
        ("boundary", shapely.box(-6, -6, 64, 20)),
        *((f"robot {name}", box(x, y)) for name, x, y in spots),
        *((f"path {name}", shapely.LineString(lap)) for name, lap in laps.items()),
    ]
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert min(_ways(made)) == pytest.approx(76.0, abs=0.3)
    assert not [one for one in made.changes if "WARNING" in one]


def test_a_path_whose_robot_is_not_there_is_told_with_the_nearest(tmp_path: Path) -> None:
    parts = [
        HALL,
        WAY,
        ("robot fork", box(4, 5)),
        ("path Fork", shapely.LineString([(4, 9), (40, 9)])),
    ]
    told = only(import_world(geojson(tmp_path, parts)), "there is no robot")
    check_says(told, '"Fork" … "fork" … left out')
