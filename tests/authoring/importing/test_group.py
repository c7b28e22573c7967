"""Robots that are drawn or filled in: headings, formations, laps, lanes and sizes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim.authoring.importing import Options, import_world
from tests.authoring.importing.plans import (
    HALL,
    LOOP,
    METRES,
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
    (one,) = made.world.robots
    assert one.path.offset == pytest.approx(offset)


def test_a_path_begins_straight_behind_the_robots_that_wait_for_it(tmp_path: Path) -> None:
    """Before it a formation cannot measure how far apart they are."""
    robots = [("robot", shapely.box(x, 6.5, x + 1.6, 7.5)) for x in (5, 1)]
    way = ("path", shapely.LineString([(12, 7), (40, 7)]))
    place = ("boundary", shapely.box(0, 0, 50, 14))
    made = import_world(geojson(tmp_path, [place, *robots, way]))
    assert np.asarray(made.world.reference_path)[0] == pytest.approx((1.8, 7.0))
    check_says(only(made, "earlier"), "10.20 m … (1.80, 7.00)")
    free_area(made, tmp_path)
    wall = ("obstacle", shapely.box(9, 6, 10, 8))
    blocked = import_world(geojson(tmp_path, [place, wall, *robots, way]))
    check_says(only(blocked, "before the path"), "WARNING … 10.20 m … (12.00, 7.00)")


CART = ("robot cart", shapely.box(4, 14, 5.8, 15))
OWN = shapely.LineString([(5, 14.5), (40, 14.5)])
A = ("robot a", box(4, 5))


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ([A, CART, ("path cart", shapely.LineString([(5, 14.5), (20, 25), (22, 14)]))],
         "path of cart leaves the area at (12.86, 20.00)"),
        ([A, CART, ("path cart", OWN), ("obstacle", shapely.box(20, 14.8, 21, 16))],
         "path of cart passes 0.3 m from a wall at … 14.50) … 1 m wide … smaller robot"),
        ([A, ("robot b", box(9, 19.7))], "path of b, +14.7 m beside … passes 0.3 m from a wall"),
        ([A, ("robot a", box(9, 9))], "robots[1].name … robots[0]"),
        ([A, ("robot b", box(4.2, 5))], "robots[1].pose … overlaps"),
    ],
    ids=["outside", "narrow", "lane", "one name", "one place"],
)  # fmt: skip
def test_robots_that_have_no_room_are_refused(tmp_path: Path, parts: Any, says: str) -> None:
    check_says(refusal(geojson(tmp_path, [HALL, WAY, *parts])), says)


def test_robots_without_a_path_are_asked_about(tmp_path: Path) -> None:
    said = refusal(geojson(tmp_path, [HALL, A, CART, ("path cart", OWN)]))
    check_says(said, 'robot "a" has no path')


@pytest.mark.parametrize("way", ["open", "own", "closed", "asked"])
def test_all_robots_on_open_paths_are_a_formation(tmp_path: Path, way: str) -> None:
    """On a closed path, or if it is said, there is none."""
    line = shapely.LineString([(x + 8, y + 3) for x, y in LOOP] if way == "closed" else WAY[1])
    parts = [HALL, ("path", line), ("robot", box(12, 3 if way == "closed" else 5)), CART]
    parts += [("path cart", OWN)] if way != "open" else []
    made = import_world(geojson(tmp_path, parts), Options(scale=1.0, no_formation=way == "asked"))
    assert (made.world.formation is not None) == (way in ("open", "own"))
    assert any("no formation" in one for one in made.facts) == (way in ("closed", "asked"))


@pytest.mark.parametrize("start", [0, 1, 2])
def test_a_lap_begins_at_its_robot(tmp_path: Path, start: int) -> None:
    """Wherever it was drawn from: each robot drives the whole of it."""
    corners = [(4, 4), (26, 4), (26, 12), (4, 12)]
    lap = [*corners[start:], *corners[:start], corners[start]]
    boxes = [shapely.box(25.5, y, 26.5, y + 1.8) for y in (8.5, 5.5)]
    parts = [("boundary", shapely.box(0, 0, 30, 16)), ("path", shapely.LineString(lap))]
    made = import_world(geojson(tmp_path, [*parts, *(("robot", one) for one in boxes)]))
    for path, y in zip(paths_of(made), (9.4, 6.4), strict=True):
        assert path[0] == pytest.approx((26.0, y - 0.18), abs=0.01)
        assert shapely.LineString(path).length == pytest.approx(60.0)
    free_area(made, tmp_path)


@pytest.mark.parametrize("side", [0.0, 1.2, -1.2])
def test_robots_all_round_a_lap_drive_one_each(tmp_path: Path, side: float) -> None:
    lap = shapely.LineString(LOOP)
    parts = [("boundary", shapely.box(-8, -8, 32, 22)), ("path", lap)]
    for k in range(4):
        x, y = lap.interpolate((4.0 + k / 4 * lap.length) % lap.length).coords[0]
        tip = lap.interpolate((4.1 + k / 4 * lap.length) % lap.length).coords[0]
        one = shapely.affinity.rotate(
            box(0, side, 1.4, 0.8), np.arctan2(tip[1] - y, tip[0] - x), (0, 0), use_radians=True
        )
        parts.append((f"robot v{k}", shapely.affinity.translate(one, x, y)))
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert min(ways_of(made)) > lap.length - 8.0 * abs(side) - 0.5


@pytest.mark.parametrize("angle", [0.0, 30.0])
def test_a_robot_heads_along_its_path_and_is_as_large_as_drawn(
    tmp_path: Path, angle: float
) -> None:
    drawn = shapely.Polygon([(0.9, 0), (0.6, 0.5), (-0.9, 0.5), (-0.9, -0.5), (0.6, -0.5)])
    turned = shapely.affinity.rotate(drawn, angle, origin=(0, 0))
    robot = ("robot a", shapely.affinity.translate(turned, 6, 5))
    (one,) = import_world(geojson(tmp_path, [HALL, WAY, robot])).world.robots
    assert one.pose[2] == 0.0
    at = shapely.affinity.translate(shapely.Polygon(one.outline), *one.pose[:2])
    assert at.symmetric_difference(robot[1]).area < 0.01


CROSSED = [(0, 0), (40, 0), (40, 3), (0, 3), (0, 30), (20, 30)]


@pytest.mark.parametrize(
    ("way", "given", "says"),
    [
        (
            [(5, 5), (45, 5)],
            {"lanes": 9, "robot": (1.8, 1.0)},
            "lane -6 m beside the path leaves the area … --lanes 8",
        ),
        ([(5, 5), (45, 5)], {"robots": 30}, "30 robots of 1.8 x 1 m … fewer --robots"),
        ([(5, 5), (25, 5), (25, 5.5), (5, 5.5)], {"lanes": 3}, "bends too tightly for a lane"),
        ([(5, 5), (45, 5)], {"robot": (20.0, 12.0)}, "passes 5 m … 12 m wide … --robot fit"),
        ([(5, 1.2), (45, 1.2)], {}, "1.2 m to a wall … need 1.8 m; … --robot fit makes them 1.2,"),
        ([(0.3, 5), (40, 5)], {}, "0.3 m to a wall at (0.30, 5.00) … --robot fit"),
        ([(9, 5), (49.8, 5)], {"robot": (1.8, 1.0)}, "0.2 m from a wall at (49.80"),
        ([(9, 5), (55, 5)], {"robot": "fit"}, "leaves the area at (50.00, 5.00) … 1); move it"),
    ],
)
def test_a_group_that_does_not_fit_is_refused_with_room_and_place(
    tmp_path: Path, way: Any, given: Any, says: str
) -> None:
    path = geojson(tmp_path, [HALL, ("path", shapely.LineString(way))])
    check_says(refusal(path, METRES.changed(**given)), says)


def test_a_group_is_as_large_as_fits_with_its_lanes(tmp_path: Path) -> None:
    """One factor on robots, speeds and lengths of the control."""
    path = geojson(tmp_path, [HALL, ("path", shapely.LineString([(5, 1.4), (45, 1.4)]))])
    one = import_world(path, METRES.changed(robot="fit")).world
    two = import_world(path, METRES.changed(robot="fit", robots=4, lanes=2)).world
    lengths = [world.robots[0].footprint.length for world in (one, two)]
    assert lengths == pytest.approx([1.8 * 1.4 / 1.8, 1.8 * 1.4 / 2.8], abs=0.05)
    assert {robot.path.offset for robot in two.robots} == {0.5, -0.5}
    assert two.formation is not None
    assert two.formation.speed == pytest.approx(0.5)
    assert two.controller.settings["look_ahead"] == pytest.approx(1.0)


def test_boxes_that_fit_shrink_until_all_have_room(tmp_path: Path) -> None:
    """Along the path too, not beside it alone."""
    path = geojson(tmp_path, [("boundary", shapely.box(0, 0, 12, 3.6))])
    three, six = (import_world(path, METRES.changed(robot="fit", robots=n)) for n in (3, 6))
    lengths = [made.world.robots[0].footprint.length for made in (three, six)]
    assert len(six.world.robots) == 6
    assert lengths[0] > lengths[1] > 0.5
    assert "6 robots in formation (--no-formation: each by itself)" in six.facts
    assert any("speeds of the control are the usual ones times" in one for one in six.facts)


def test_robots_that_go_opposite_ways_are_no_formation(tmp_path: Path) -> None:
    back = ("path cart", shapely.LineString([(40, 14.5), (5, 14.5)]))
    cart = ("robot cart", box(38, 14.5))
    path = geojson(tmp_path, [HALL, WAY, A, cart, back])
    check_says(refusal(path), "cart goes against the direction … --no-formation")
    assert import_world(path, METRES.changed(no_formation=True)).world.formation is None


def test_robots_are_counted_from_the_front(tmp_path: Path) -> None:
    path = tmp_path / "p.wkt"
    path.write_text("POLYGON ((0 0, 80 0, 80 9, 0 9, 0 0))\nLINESTRING (4 4.5, 76 4.5)")
    world = import_world(path, Options(robots=5, lanes=2)).world
    along = [robot.pose[0] for robot in world.robots]
    assert [robot.name for robot in world.robots] == ["r1", "r2", "r3", "r4", "r5"]
    assert np.diff(along).max() <= -1.5  # none stops abreast of another
    assert {robot.pose[1] for robot in world.robots} == {3.5, 5.5}
    assert {robot.pose[2] for robot in world.robots} == {0.0}
