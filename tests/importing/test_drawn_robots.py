"""Robots that are drawn, and their paths: where these begin and end, and who goes on which."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim.authoring.importing import Options, import_world
from tests.helpers import inside
from tests.importing.drawn import HALL, LOOP, WAY, box, paths_of
from tests.importing.plans import check_says, only, svg
from tests.importing.test_joining import geojson
from tests.importing.test_places import free_area, refusal

offset_polyline = inside("physim.geometry", "offset_polyline")


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


def test_a_path_begins_at_a_robot_beside_a_wall(tmp_path: Path) -> None:
    """It is not cut off there to have the room that it has farther on."""
    wall = ("obstacle", shapely.box(2, 6.1, 9, 7))
    parts = [HALL, wall, ("robot a", box(4, 5)), ("path", shapely.LineString([(4, 5), (45, 5)]))]
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert np.asarray(made.world.reference_path)[0] == pytest.approx((4.0, 5.0))
    assert not [one for one in made.changes if "at its start" in one or "earlier" in one]


def test_robots_of_one_lane_have_one_path(tmp_path: Path) -> None:
    """Which is made once, and as finely as a lane of its own."""
    robots = [(f"robot r{k}", box(4 + 3 * k, 7)) for k in range(7)]
    parts = [HALL, ("path", shapely.LineString([(2, 5), (47, 5)])), *robots,
             ("obstacle", shapely.box(42, 9, 43, 10))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    paths = {np.asarray(path).tobytes() for path in paths_of(made)}
    assert len(paths) == 1


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


def test_robots_without_a_path_follow_the_nearest_of_those_of_others(tmp_path: Path) -> None:
    """Each group on a path of its own, one behind the other to their stops."""
    parts = [HALL, *((f"robot {name}", box(x, y)) for name, x, y in (
                 ("a", 6, 4), ("a2", 3, 4), ("b", 36, 16), ("b2", 32, 16))),
             ("path a", shapely.LineString([(2, 4), (46, 4)])),
             ("path b", shapely.LineString([(46, 16), (4, 16)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert made.world.formation is None
    paths = dict(zip(["a", "a2", "b", "b2"], paths_of(made), strict=True))
    assert [paths[name][0][1] for name in paths] == [4.0, 4.0, 16.0, 16.0]
    assert paths["a"][-1][0] - paths["a2"][-1][0] == pytest.approx(3.0)
    assert paths["b"][-1][0] - paths["b2"][-1][0] == pytest.approx(4.0)
    plain = ("path", shapely.LineString([(2, 4), (46, 4)]))
    told = only(import_world(geojson(tmp_path, [*parts[:-2], plain, parts[-1]])), "stands on the")
    check_says(told, "WARNING: b2 … path of b … 12.00 m beside … named b2")


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
    by_name = dict(zip([one.name for one in made.world.robots], paths_of(made), strict=True))
    assert (by_name["c"][:, 1] == 15.0).all()
    assert made.world.robots[2].path.offset == pytest.approx(1.2)
    walled = [*parts, ("wall", shapely.LineString([(0, 14.2), (47, 14.2)]))]
    made = import_world(geojson(tmp_path, walled))
    assert paths_of(made)[1][:, 1].max() < 14.2


def test_a_path_whose_robot_is_not_there_is_told_with_the_nearest(tmp_path: Path) -> None:
    parts = [
        HALL,
        WAY,
        ("robot fork", box(4, 5)),
        ("path Fork", shapely.LineString([(4, 9), (40, 9)])),
    ]
    told = only(import_world(geojson(tmp_path, parts)), "there is no robot")
    check_says(told, '"Fork" … "fork" … left out')


@pytest.mark.parametrize("radius", [0.037, 0.1, 0.5])
@pytest.mark.parametrize("drawn", [
    '<circle id="robot a" cx="3" cy="4.1" r="{r}"/>',
    '<path id="robot a" d="M {left},4.1 a {r},{r} 0 0 1 {d},0 a {r},{r} 0 0 1 -{d},0 z"/>',
    '<ellipse id="robot a" cx="1" cy="4.1" rx="{r}" ry="{r}" transform="translate(2 0)"/>',
])  # fmt: skip
def test_small_round_robots_are_as_large_as_drawn(
    tmp_path: Path, radius: float, drawn: str
) -> None:
    """Chords within 1 cm of a circle of 3.7 cm made a square of it, and it headed anywhere."""
    robot = drawn.format(r=radius, d=2.0 * radius, left=3.0 - radius)
    file = tmp_path / "plan.svg"
    file.write_text(
        svg(
            '<rect id="boundary" width="20" height="8"/>'
            f'<path id="path" fill="none" d="M2,4 L17,5"/>{robot}',
            'viewBox="0 0 20 8"',
        )
    )
    (one,) = import_world(file, Options(scale=1.0)).world.robots
    outline = shapely.Polygon(one.outline)
    assert outline.area == pytest.approx(np.pi * radius**2, rel=0.06)
    assert outline.hausdorff_distance(shapely.Point(0, 0).buffer(radius)) < 0.025 * radius + 0.001
    assert one.pose is not None
    assert one.pose[2] == pytest.approx(-np.arctan2(1, 15), abs=6e-4)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_drawn_names_are_given_first(tmp_path: Path, order: tuple[int, int]) -> None:
    """A robot without a name, taken first, had the name of another, and so its path."""
    robots = [("robot r1", box(5, 4, 1.2, 0.7)), ("robot", box(5, 10, 1.2, 0.7))]
    parts = [("boundary", shapely.box(0, 0, 26, 14)), *(robots[k] for k in order)]
    parts += [("path", shapely.LineString([(3, 10), (23, 10)]))]
    parts += [("path r1", shapely.LineString([(3, 4), (20, 4)]))]
    made = import_world(geojson(tmp_path, parts))
    (drawn,) = (one for one in made.world.robots if one.name == "r1")
    assert drawn.pose is not None
    assert drawn.pose[1] == 4.0
    assert not [one for one in made.changes if "called" in one]


def test_an_id_names_a_robot_where_a_path_is_named_after_it(tmp_path: Path) -> None:
    """Others, such as rect12, are programs' own; a path of "tug" was for nobody, in one line."""
    file = tmp_path / "plan.svg"
    file.write_text(
        svg(
            '<rect id="boundary" width="40" height="20"/>'
            '<g id="path" fill="none"><path id="path_fork" d="M3,5 H37"/>'
            '<path id="path_tug" d="M37,15 H3"/></g>'
            '<g id="robot"><rect id="fork" x="2" y="4.5" width="2" height="1"/>'
            '<rect id="tug" x="36" y="14.5" width="2" height="1"/>'
            '<rect id="rect12" x="6" y="4.5" width="2" height="1"/></g>',
            'viewBox="0 0 40 20"',
        )
    )
    made = import_world(file, Options(scale=1.0))
    assert [one.name for one in made.world.robots] == ["fork", "tug", "r3"]
    assert not [one for one in made.changes if "there is no robot" in one]


NAMED = {
    "one given twice does not take that of another": (
        '<path id="path_a" d="M2,4 H36"/><path id="path_a_2" d="M2,10 H36"/>',
        '<rect id="robot_a" x="4" y="3.5" width="1.8" height="1"/>'
        '<rect id="robot_a" x="7" y="3.5" width="1.8" height="1"/>'
        '<rect id="robot_a_2" x="4" y="9.5" width="1.8" height="1"/>',
        {"a": 4.0, "a_2": 10.0, "a_2_2": 4.0},
    ),
    "a mark that is drawn first has none": (
        '<path id="path_a" d="M2,4 H36"/><path id="path_b" d="M2,10 H36"/>',
        '<g id="robot_a"><path d="M5.2,4 4.6,4.3 4.6,3.7 Z"/>'
        '<rect x="4" y="3.5" width="1.8" height="1"/></g>'
        '<g id="robot_b"><path d="M5.2,10 4.6,10.3 4.6,9.7 Z"/>'
        '<rect x="4" y="9.5" width="1.8" height="1"/></g>',
        {"a": 4.0, "b": 10.0},
    ),
    "a copy has its own id": (
        '<path id="path_a" d="M2,4 H36"/><path id="path_b" d="M2,10 H36"/>',
        '<g id="robot"><rect id="a" x="4" y="3.5" width="1.8" height="1"/>'
        '<use href="#a" id="b" y="6"/></g>',
        {"a": 4.0, "b": 10.0},
    ),
    "a name goes before an id": (
        '<path id="path_a" d="M2,4 H36"/><path id="path" d="M2,10 H36"/>',
        '<g id="robot"><rect id="a" x="4" y="9.5" width="1.8" height="1"/>'
        '<rect inkscape:label="a" x="4" y="3.5" width="1.8" height="1"/></g>',
        {"r1": 10.0, "a": 4.0},
    ),
}


@pytest.mark.parametrize("case", NAMED)
def test_names(tmp_path: Path, case: str) -> None:
    paths, robots, expected = NAMED[case]
    file = tmp_path / "plan.svg"
    ground = f'<rect id="boundary" width="40" height="14"/><g fill="none">{paths}</g>{robots}'
    file.write_text(svg(ground, 'viewBox="0 0 40 14"'))
    made = import_world(file, Options(scale=1.0))
    drawn = {one.name: 14.0 - one.pose[1] for one in made.world.robots if one.pose}
    assert drawn == pytest.approx(expected)
