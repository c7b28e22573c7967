"""Robots that are drawn on closed paths: each drives a lap of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim import simulate
from physim.authoring.importing import import_world
from physim.world.checks import check_world
from physim.world.file import parse_world
from tests.importing.drawn import HALL, LOOP, WAY, box, paths_of, ways_of
from tests.importing.plans import check_says, only, svg_path
from tests.importing.test_joining import geojson
from tests.importing.test_places import LINE, METRES, drawing, free_area


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
    for path, y in zip(paths_of(made), (9.4, 6.4), strict=True):
        assert path[0] == pytest.approx((26.0, abs(flip - y)), abs=0.101)
        assert shapely.LineString(path).length == pytest.approx(60.0)
    assert any("no formation: a path is closed" in fact for fact in made.facts)
    free_area(made, tmp_path)


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
    assert min(ways_of(made)) > 38.0 - 8.0 * 0.8 - 0.2


@pytest.mark.parametrize("start", [0, 1, 2, 3])
def test_a_lap_of_its_own_begins_at_its_robot(tmp_path: Path, start: int) -> None:
    corners = [(4, 11), (40, 11), (40, 17), (4, 17)]
    lap = [*corners[start:], *corners[:start], corners[start]]
    parts = [HALL, WAY, ("robot a", box(4, 5)), ("robot b", box(20, 11)),
             ("path b", shapely.LineString(lap))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    path = paths_of(made)[1]
    assert path[0] == pytest.approx((20, 11), abs=0.2)
    assert shapely.LineString(path).length == pytest.approx(84.0, abs=0.01)


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
    (path,) = paths_of(made)
    if isinstance(made.world.robots[0].path, tuple | list):
        assert shapely.LineString(path).length > 72.0 - 8.0 * max(offset, 0.0) - 0.5
    assert not [one for one in made.changes if "WARNING" in one]
    assert not check_world(tmp_path / "made.yaml").warnings


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
    assert min(ways_of(made)) > lap.length - 12.0 * abs(side) - 0.5
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
    assert min(ways_of(made)) == pytest.approx(lap.length, abs=0.3)
    straight = [("boundary", shapely.box(-6, -6, 30, 20)), parts[2],
                ("path", shapely.LineString([(9, 0), (26, 0)]))]  # fmt: skip
    path = np.asarray(import_world(geojson(tmp_path, straight)).world.reference_path)
    assert path[0] == pytest.approx((8.0, 0.0))


def test_a_lap_drawn_a_grain_too_short_is_closed(tmp_path: Path) -> None:
    parts = [("boundary", shapely.box(-6, -6, 30, 20)), ("robot a", box(12, 0)),
             ("path", shapely.LineString([*LOOP[:-1], (0, 0.004)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    check_says(only(made, "it is closed"), "0.004 m")
    assert min(ways_of(made)) == pytest.approx(76.0, abs=0.3)


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
        (path,) = paths_of(made)
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
    assert ways_of(made) == pytest.approx([76.0], abs=0.3)


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
        assert min(ways_of(made)) > 2.0 * np.pi * (8.0 - max(inside, 0.0)) - 5.0


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
    assert min(ways_of(made)[:count]) > lap.length - 8.0 * abs(side) - 0.5
    assert not [one for one in made.changes if "WARNING" in one]


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
    assert min(ways_of(made)) == pytest.approx(76.0, abs=0.3)
    assert not [one for one in made.changes if "WARNING" in one]
