"""Which area of a drawing is the place of the robots, and where it is open or in doubt."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim.authoring.importing import Imported, ImportSourceError, Options, import_world
from physim.authoring.importing.roles import role_named
from physim.geometry.area import accessible_area
from physim.world.checks import check_world
from tests.importing.plans import check_says, only, svg, svg_path
from tests.importing.test_joining import geojson

METRES = Options(scale=1.0)
LINE = 'fill="none" stroke="black"'


def drawing(folder: Path, body: str, extent: float = 60.0) -> Path:
    path = folder / "plan.svg"
    path.write_text(svg(body, f'width="{extent:g}" height="{extent:g}"'))
    return path


def free_area(made: Imported, folder: Path) -> float:
    """[m²] that the robots of a world may use; its check must find no error."""
    world = folder / "made.yaml"
    world.write_text(made.text)
    assert not check_world(world).errors
    boundaries = [np.asarray(line) for line in made.world.boundaries or ()]
    obstacles = [np.asarray(getattr(one, "outline", one)) for one in made.world.obstacles or ()]
    path = np.asarray(made.world.reference_path)
    return float(accessible_area(boundaries, obstacles, path).polygon.area)


def refusal(path: Path, options: Options = METRES) -> str:
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def filled(shape: Any) -> str:
    """Path data of a shapely polygon with its holes, y turned down as on a page of 60."""
    rings = [shape.exterior, *shape.interiors]
    return " ".join(f"{svg_path([(x, 60 - y) for x, y in ring.coords])} Z" for ring in rings)


ROOM = "M 0,0 H 40 V 40 H 0 V 0.1"
"""An outer wall that stops 0.1 m short of its beginning, at (0, 60) to (0, 59.9)"""


@pytest.mark.parametrize(
    "thing",
    [
        '<rect x="20" y="0" width="2" height="2"/>',
        '<rect x="39" y="39" width="2" height="2"/>',
        '<rect x="20" y="36" width="8" height="4"/>',
    ],
    ids=["column at the wall", "column on the corner", "table at the wall"],
)
def test_ends_are_joined_whatever_touches_the_wall(tmp_path: Path, thing: str) -> None:
    path = drawing(tmp_path, f'<g id="boundary" {LINE}><path d="{ROOM}"/>{thing}</g>')
    made = import_world(path, METRES)
    assert only(made, "0.100 m apart at (0.00, 60.00) joined")
    assert 1560.0 < free_area(made, tmp_path) < 1600.5


CLOSET = '<path d="M 30,40 V 30"/><path d="M 30,30 H 40"/>'


def test_a_closet_in_an_open_room_is_not_taken_for_the_room(tmp_path: Path) -> None:
    """The ends of its walls are joined, as they are without it, or it is asked for."""
    body = f'<g id="boundary" {LINE}><path d="{ROOM}"/>{CLOSET}</g>'
    joined = import_world(drawing(tmp_path, body), METRES)
    assert only(joined, "0.100 m apart at (0.00, 60.00) joined")
    assert free_area(joined, tmp_path) == pytest.approx(1500.0)
    path = drawing(tmp_path, body.replace("V 0.1", "V 2"))
    said = refusal(path)
    check_says(said, ":2: … 100 m² … (0.00, 60.00) and (0.00, 58.00) … 2 m apart … --from")
    inside = Options(scale=1.0, origin=(35.0, 25.0))
    assert free_area(import_world(path, inside), tmp_path) == pytest.approx(100.0)


def test_a_closet_of_open_lines_leaves_a_passage_beside_it(tmp_path: Path) -> None:
    """Nothing is joined where the lines enclose a place: the gap may be a door."""
    passage = '<path d="M 0,20 H 9.9"/><path d="M 10.1,20 H 40"/>'
    room = '<path d="M 0,0 H 40 V 40"/><path d="M 40,40 H 0 V 0"/>'
    made = import_world(drawing(tmp_path, f'<g id="boundary" {LINE}>{room}{passage}</g>'), METRES)
    assert not [one for one in made.changes if "joined" in one]


def test_lines_beside_a_closed_room_make_no_room_of_their_own(tmp_path: Path) -> None:
    kerbs = '<path d="M 0,50 H 30"/><path d="M 0,58 H 30"/>'
    room = '<path d="M 0,0 H 40 V 40 H 0 Z"/>'
    body = f'<g id="boundary" {LINE}>{room}{kerbs}</g>'
    check_says(refusal(drawing(tmp_path, body)), "60 m of lines beyond it … leave them out")
    made = import_world(drawing(tmp_path, body), Options(scale=1.0, origin=(20.0, 40.0)))
    assert free_area(made, tmp_path) == pytest.approx(1600.0)
    assert not [one for one in made.changes if "cap" in one]
    assert sum("dropped" in one for one in made.changes) == 2


@pytest.mark.parametrize("tails", [0.0, 0.6])
def test_lines_that_go_a_little_too_far_are_no_doubt(tmp_path: Path, tails: float) -> None:
    a, b = 10.0 - tails, 50.0 + tails
    lines = f"M {a},10 H {b} M {a},50 H {b} M 10,{a} V {b} M 50,{a} V {b}"
    stub = f'<rect x="30" y="{10 - tails}" width="1" height="6" id="wall 2"/>'
    path = drawing(tmp_path, f'<path id="boundary" {LINE} d="{lines}"/>{stub}')
    assert 1590.0 < free_area(import_world(path, METRES), tmp_path) < 1600.0


TWELVE = [shapely.box(x, y, x + 4.0, y + 4.0) for x in (2, 7, 12, 17) for y in (2, 7, 12)]
HALL = shapely.box(2, 17, 12, 27)
BLOCK = shapely.box(1, 1, 22, 28) - shapely.union_all([*TWELVE, HALL])
"""Walls of thirteen rooms in one shape; their own area is larger than that of any room."""


def test_walls_drawn_as_one_filled_path_are_no_place(tmp_path: Path) -> None:
    assert BLOCK.area > HALL.area
    path = drawing(tmp_path, f'<path id="walls" d="{filled(BLOCK)}"/>')
    said = refusal(path)
    check_says(said, "100 m² … 288 m of walls beyond it … --from")
    room = Options(scale=1.0, origin=(4.0, 4.0))
    assert free_area(import_world(path, room), tmp_path) == pytest.approx(16.0)
    one = drawing(tmp_path, f'<path id="walls" d="{filled(HALL.buffer(0.3) - HALL)}"/>')
    assert free_area(import_world(one, METRES), tmp_path) == pytest.approx(HALL.area)


def test_an_open_room_of_filled_walls_is_asked_for(tmp_path: Path) -> None:
    """Where and how wide it is open; who says that robots go in the walls has his way."""
    ring = shapely.box(10, 10, 50, 30) - shapely.box(11, 11, 49, 29) - shapely.box(20, 9, 21.5, 12)
    path = drawing(tmp_path, f'<path id="walls" d="{filled(ring)}"/>')
    check_says(refusal(path), "'walls' … open at (20.75, 10.50), 1.5 m wide … boundary … --from")
    in_room = refusal(path, Options(scale=1.0, origin=(30.0, 20.0)))
    check_says(in_room, "--from (30.00, 20.00) … open at (20.75, 10.50), 1.5 m wide")
    in_wall = import_world(path, Options(scale=1.0, origin=(30.0, 10.5)))
    assert free_area(in_wall, tmp_path) == pytest.approx(ring.area)
    outline = drawing(tmp_path, f'<path id="boundary" d="{filled(ring)}"/>')
    assert free_area(import_world(outline, METRES), tmp_path) == pytest.approx(ring.area)


@pytest.mark.parametrize("gap", [0.1, 0.9])
def test_a_path_in_an_open_room_is_told_where_it_is_open(tmp_path: Path, gap: float) -> None:
    sides = [(10, 10, 40, 1), (10, 29, 40, 1), (10, 11 + gap, 1, 18 - gap), (49, 10, 1, 20)]
    walls = "".join(
        f'<rect x="{x}" y="{60 - y - h}" width="{w}" height="{h}"/>' for x, y, w, h in sides
    )
    body = f'<g id="walls" {LINE}>{walls}</g><path id="path" d="M 14,40 H 45"/>'
    said = refusal(drawing(tmp_path, body))
    check_says(said, f"'path' … (10.50, {11 + gap / 2:.2f}), {gap:g} m wide")


def test_a_wall_of_a_plan_is_solid_though_it_is_the_only_one(tmp_path: Path) -> None:
    site, block = ("boundary", shapely.box(0, 0, 20, 10)), shapely.box(5, -1, 25, 11)
    made = import_world(geojson(tmp_path, [site, ("wall", block)]))
    assert free_area(made, tmp_path) == pytest.approx(50.0)
    said = refusal(geojson(tmp_path, [("wall", shapely.box(0, 0, 20, 10))]))
    check_says(said, "what they fill themselves … boundary")


def test_dissolved_walls_with_a_door_are_no_place(tmp_path: Path) -> None:
    """All rooms are joined by doors, and the outer wall has one: there is no hole."""
    doors = [shapely.box(3, y, 20, y + 1) for y in (4, 9, 14, 20)] + [shapely.box(3, 3, 4, 20)]
    walls = BLOCK - shapely.union_all([*doors, shapely.box(0, 20, 3, 21)])
    largest = max(shapely.get_parts(walls), key=lambda one: one.area)
    assert not largest.interiors
    said = refusal(geojson(tmp_path, [("wall", one) for one in shapely.get_parts(walls)]))
    check_says(said, "enclose no area … open at (1.50, 20.50), 1 m wide")


@pytest.mark.parametrize("corners", [2000, 2001])
def test_a_hole_is_no_place_however_many_corners_it_has(tmp_path: Path, corners: int) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)
    hole = 44.0 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    road = shapely.Polygon(shapely.Point(0, 0).buffer(50.0, 64).exterior, [hole])
    path = tmp_path / "road.wkt"
    path.write_text(road.wkt)
    assert free_area(import_world(path), tmp_path) == pytest.approx(road.area, rel=1e-3)


@pytest.mark.parametrize("layer", ["wall", "Walls", "WALLS", "wall_ext"])
def test_layers_are_roles_in_the_plural_too(tmp_path: Path, layer: str) -> None:
    path = geojson(tmp_path, [("boundary", shapely.box(0, 0, 24, 14)),
                              ("wall", shapely.LineString([(12, 0), (12, 6)]))])  # fmt: skip
    text = path.read_text().replace('{"role": "wall", ', f'{{"role": "", "Layer": "{layer}", ')
    assert layer in text
    path.write_text(text)
    made = import_world(path)
    assert made.world.boundaries is not None
    assert sorted(map(len, made.world.boundaries)) == [2, 5]


def test_a_layer_that_is_no_role_is_told(tmp_path: Path) -> None:
    """A line without a role is the path."""
    path = geojson(tmp_path, [("boundary", shapely.box(0, 0, 24, 14)),
                              ("wall", shapely.LineString([(2, 7), (20, 7)]))])  # fmt: skip
    path.write_text(path.read_text().replace('"role": "wall"', '"layer": "wals"'))
    check_says(only(import_world(path), '"wals"'), 'no role … 1 shape … path … mean "walls"')
    path = geojson(tmp_path, [("wall", shapely.LineString([(2, 7), (20, 7)]))])
    path.write_text(path.read_text().replace('"role": "wall"', '"layer": "wals"'))
    check_says(refusal(path), 'no polygon … "wals" … no role … mean "walls"')


def test_walls_over_each_other_in_one_path_have_no_holes(tmp_path: Path) -> None:
    """The corners, which two of them fill, are holes by the even-odd rule alone."""
    sides = [(10, 10, 40, 2), (10, 28, 40, 2), (10, 10, 2, 20), (48, 10, 2, 8), (48, 20, 2, 10)]
    data = " ".join(f"M {x},{60 - y - h} h {w} v {h} h {-w} Z" for x, y, w, h in sides)
    path = drawing(tmp_path, f'<path id="walls" d="{data}"/>')
    check_says(refusal(path), "open at (49.00, 19.00), 2 m wide")


@pytest.mark.parametrize("fill", ['fill="#eee"', ""])
@pytest.mark.parametrize("named", ["boundary", "asked for", "in walls"])
def test_a_painted_floor_is_the_place_if_it_is_called_so(
    tmp_path: Path, fill: str, named: str
) -> None:
    """In a layer of walls it may as well be the rock about a tunnel."""
    group, own = {"boundary": ("boundary", "a"), "asked for": ("floor", "a"),
                  "in walls": ("walls", "boundary")}[named]  # fmt: skip
    floor = f'<path id="{own}" {fill} d="M 10,10 H 50 V 40 H 30 V 25 H 10 Z"/>'
    body = f'<g id="{group}">{floor}<rect x="40" y="30" width="1" height="1"/></g>'
    asked = Options(scale=1.0, boundary=("floor",) if named == "asked for" else ())
    made = import_world(drawing(tmp_path, body), asked)
    assert free_area(made, tmp_path) == pytest.approx(900.0 - 1.0)
    walls = drawing(tmp_path, body.replace('"boundary"', '"a"').replace('id="floor"', 'id="walls"')
                    .replace('<g id="a"', '<g id="walls"'))  # fmt: skip
    check_says(refusal(walls), "fill themselves … boundary, not wall … --from")
    inside = Options(scale=1.0, origin=(45.0, 25.0))
    assert free_area(import_world(walls, inside), tmp_path) == pytest.approx(900.0 - 1.0)


DOOR = [(0, 4), (0, 0), (20, 0), (20, 10), (0, 10), (0, 5)]
"""[m] the outer wall of a hall with a door"""


@pytest.mark.parametrize(
    "room",
    [shapely.box(20, 3, 23, 6), shapely.box(17, 0, 20, 3), shapely.box(30, 0, 36, 9)],
    ids=["annex", "closet", "shed"],
)
@pytest.mark.parametrize("thick", [0.0, 0.3])
def test_a_small_room_is_not_taken_for_an_open_hall(
    tmp_path: Path, room: Any, thick: float
) -> None:
    """Neither beside it nor in it."""
    hall = shapely.LineString(DOOR)
    parts = [hall, room.exterior]
    if thick:
        walls = shapely.union_all([one.buffer(thick / 2, join_style="mitre") for one in parts])
        parts = list(shapely.get_parts(walls))
    said = refusal(geojson(tmp_path, [("wall", one) for one in parts]))
    check_says(said, "hardly the place … --from")
    x, y = room.centroid.coords[0]
    here = import_world(geojson(tmp_path, [("wall", one) for one in parts]),
                        Options(origin=(x, y)))  # fmt: skip
    assert free_area(here, tmp_path) == pytest.approx((room.buffer(-thick / 2)).area, rel=0.02)


@pytest.mark.parametrize("angle", [0.0, 33.3])
@pytest.mark.parametrize("gap", [0.0, 0.005, 1.0])
def test_a_table_without_a_role_is_asked_for(tmp_path: Path, angle: float, gap: float) -> None:
    """Whether or not the walls about it are drawn to meet."""
    ends = [[(0, 0), (40, 0)], [(40, 0), (40, 20)], [(40, 20), (0, 20)], [(0, 20), (0, gap)]]
    shapes = [shapely.box(30, 10, 32, 12), *map(shapely.LineString, ends)]
    turned = [shapely.affinity.rotate(one, angle, origin=(0, 0)) for one in shapes]
    parts = [("" if k == 0 else "wall", one) for k, one in enumerate(turned)]
    check_says(refusal(geojson(tmp_path, parts)), "4 m² … no role … boundary … obstacle")


@pytest.mark.parametrize("thick", [0.3, 1.0])
def test_a_floor_without_a_role_is_the_place_within_its_walls(tmp_path: Path, thick: float) -> None:
    floor = shapely.box(0, 0, 20, 10)
    walls = floor.buffer(thick, join_style="mitre") - floor
    made = import_world(geojson(tmp_path, [("", floor), ("wall", walls)]))
    assert free_area(made, tmp_path) == pytest.approx(200.0)


@pytest.mark.parametrize(
    ("name", "role"),
    [("reference path", "path"), ("reference_path", "path"), ("path start-goal", "path"),
     ("obstacle areas", "obstacle"), ("boundary of track", "boundary"), ("wall_start", "wall"),
     ("Wall-left", "wall"), ("robot route 0", ""), ("robot path", ""), ("path labels", ""),
     ("wallpaper", ""), ("A-WALL", "")],
)  # fmt: skip
def test_a_role_is_the_first_word_of_a_name(name: str, role: str) -> None:
    assert role_named(name)[0] == role


def test_rooms_side_by_side_are_no_walls_about_a_room(tmp_path: Path) -> None:
    rooms = "".join(f'<rect x="{x}" y="10" width="{w}" height="10"/>' for x, w in
                    ((10, 10), (20, 11), (31, 10)))  # fmt: skip
    made = import_world(drawing(tmp_path, f'<g id="boundary" {LINE}>{rooms}</g>'), METRES)
    assert free_area(made, tmp_path) == pytest.approx(110.0)
    check_says(only(made, "areas"), "3 areas … 110.0 m²")


@pytest.mark.parametrize(
    "rule", ['fill-rule="evenodd"', 'style="fill-rule:EvenOdd;fill:#000"', 'class="walls"']
)
@pytest.mark.parametrize("in_group", [True, False])
def test_a_fill_rule_is_read_wherever_it_stands(tmp_path: Path, rule: str, in_group: bool) -> None:
    """Both lines go round the same way: by the other rule all within is painted."""
    ring = '<path PLACE d="M 10,10 H 50 V 40 H 10 Z M 11,11 H 49 V 39 H 11 Z"/>'
    group = f'<g id="walls" {rule if in_group else ""}>{ring}</g>'
    sheet = "<style>.walls {fill-rule: evenodd}</style>"
    body = sheet + group.replace("PLACE", "" if in_group else rule)
    made = import_world(drawing(tmp_path, body), METRES)
    assert free_area(made, tmp_path) == pytest.approx(38.0 * 28.0)
    body = body.replace("EvenOdd", "evenodd").replace("evenodd", "nonzero")
    assert "fill themselves" in refusal(drawing(tmp_path, body))


@pytest.mark.parametrize("post", ["", '<rect x="15" y="35" width="2" height="2"/>'])
def test_a_robot_in_an_open_hall_is_told_where_it_is_open(tmp_path: Path, post: str) -> None:
    hall = '<path d="M 10,20 V 10 H 50 V 40 H 10 V 22"/>'
    robot = '<g id="robot"><rect x="30" y="24" width="1.8" height="1"/></g>'
    said = refusal(drawing(tmp_path, f'<g id="boundary" {LINE}>{hall}{post}</g>{robot}'))
    assert "(10.00, 38.00)" in said or "(10.00, 39.00)" in said
    assert "2 m" in said


def test_a_route_begins_at_the_robots_that_are_drawn(tmp_path: Path) -> None:
    """At the one behind, with the others on its way: the longest route would begin elsewhere."""
    robots = [("robot", shapely.box(x, 4.5, x + 1.8, 5.5)) for x in (26, 23)]
    made = import_world(geojson(tmp_path, [("boundary", shapely.box(0, 0, 60, 10)), *robots]))
    path = np.asarray(made.world.reference_path)
    assert path[0] == pytest.approx((23.9, 5.0), abs=1.5)
    assert abs(path[-1, 0] - 60.0) < 4.0


@pytest.mark.parametrize("door", ["line", "thick"])
def test_a_path_through_a_closed_door_is_told_where(tmp_path: Path, door: str) -> None:
    wall = shapely.LineString([(20, 0), (20, 25)])
    parts: list[tuple[str, Any]] = [
        ("boundary", shapely.box(0, 0, 40, 25)),
        ("wall", wall if door == "line" else wall.buffer(0.15, cap_style="flat")),
        ("path", shapely.LineString([(3, 12), (35, 12)])),
        ("robot", shapely.box(6, 11.5, 7.8, 12.5)),
    ]
    said = refusal(geojson(tmp_path, parts))
    x = 20.0 if door == "line" else 19.85
    check_says(said, f"({x:.2f}, 12.00) … wall")


@pytest.mark.parametrize("first", [True, False])
def test_a_line_without_a_role_is_no_path_beside_one(tmp_path: Path, first: bool) -> None:
    """Such as a dimension line, wherever it stands in the file."""
    ways = (("", [(3, 3), (20, 3)]), ("path", [(2, 7), (20, 7)]))
    lines = [(role, shapely.LineString(points)) for role, points in ways]
    place = ("boundary", shapely.box(0, 0, 24, 14))
    made = import_world(geojson(tmp_path, [place, *(lines if first else lines[::-1])]))
    assert {y for _, y in made.world.reference_path or ()} == {7.0}
    check_says(only(made, "no role"), "(3.00, 3.00) … left out")


def test_a_polygon_without_a_role_is_named_as_the_place(tmp_path: Path) -> None:
    ring = shapely.box(0, 0, 40, 25) - shapely.box(0.3, 0.3, 39.7, 24.7)
    table = shapely.box(30, 20, 31, 21)
    way = shapely.LineString([(5, 12), (35, 12)])
    said = refusal(geojson(tmp_path, [("wall", ring), ("", table), ("path", way)]))
    check_says(said, "polygon of 1 m² about (30.50, 20.50) … no role … boundary … obstacle")
    assert "(30.50, 20.50)" in refusal(geojson(tmp_path, [("wall", ring), ("", table)]))


ANGLES = np.linspace(3.0, 87.0, 15)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("kind", ["lines", "outlines"])
def test_walls_that_end_at_the_side_of_others_meet_them_at_any_angle(
    tmp_path: Path, kind: str, angle: float
) -> None:
    """Drawn without a gap; rounded to the millimetre they would leave one, or cross."""
    if kind == "lines":
        parts = [[(0, 10), (40, 10)], [(0, 30), (40, 30)], [(4, 10), (4, 30)], [(30, 10), (30, 30)]]
        shapes: list[Any] = [shapely.LineString(part) for part in parts]
        area = 26.0 * 20.0
    else:
        boxes = [(0, 10, 40, 1), (0, 29, 40, 1), (4, 11, 1, 18), (30, 11, 1, 18)]
        shapes = [shapely.box(x, y, x + w, y + h) for x, y, w, h in boxes]
        area = 25.0 * 18.0
    turned = [shapely.affinity.rotate(one, angle, origin=(20, 20)) for one in shapes]
    lines = [one if kind == "lines" else one.exterior for one in turned]
    way = shapely.affinity.rotate(shapely.LineString([(8, 20), (26, 20)]), angle, origin=(20, 20))
    close = "" if kind == "lines" else " Z"
    walls = "".join(f'<path {LINE} d="{svg_path(line.coords)}{close}"/>' for line in lines)
    body = f'<g id="walls">{walls}</g><path id="path" d="{svg_path(way.coords)}"/>'
    made = import_world(drawing(tmp_path, body), METRES)
    assert free_area(made, tmp_path) == pytest.approx(area, abs=0.1)


def test_very_many_open_walls_are_joined_at_their_gap(tmp_path: Path) -> None:
    corners = shapely.box(0, 0, 50, 50).exterior.segmentize(0.4).coords
    lines = [shapely.LineString(pair) for pair in zip(corners, corners[1:], strict=False)]
    assert len(lines) > 400
    x, y = lines[0].coords[1]
    lines[0] = shapely.LineString([lines[0].coords[0], (x, y - 0.05)])
    made = import_world(geojson(tmp_path, [("wall", line) for line in lines]))
    assert only(made, "0.050 m apart")
    assert free_area(made, tmp_path) == pytest.approx(2500.0)


def test_a_partition_at_a_corner_leaves_the_wall_its_join(tmp_path: Path) -> None:
    """The nearest end to that of the wall is not the one that closes the room."""
    lines = ["M 0.2,0 H 40", "M 40,0 V 40", "M 40,40 H 0", "M 0,40 V 0.2", "M 0.15,0.05 L 10,12"]
    body = "".join(f'<path d="{line}"/>' for line in lines)
    path = drawing(tmp_path, f'<g id="boundary" {LINE}>{body}</g>')
    assert free_area(import_world(path, METRES), tmp_path) == pytest.approx(1600.0, abs=0.5)


def test_what_is_not_wider_than_a_wall_is_asked_for(tmp_path: Path) -> None:
    """One of four walls that do not touch: their sizes alone do not tell a wall from a corridor."""
    sides = [(10, 10, 40, 0.5), (10, 29, 40, 0.5), (10, 11, 0.5, 17), (49, 11, 0.5, 17)]
    walls = "".join(f'<rect x="{x}" y="{y}" width="{w}" height="{h}"/>' for x, y, w, h in sides)
    path = drawing(tmp_path, f'<g id="boundary" {LINE}>{walls}</g>')
    check_says(refusal(path), "not wider than 0.6 m … --from … --scale")
    made = import_world(path, Options(scale=1.0, origin=(30.0, 49.75)))
    assert free_area(made, tmp_path) == pytest.approx(20.0)


def test_walls_are_as_many_as_obstacles_at_most(tmp_path: Path) -> None:
    posts = [("wall", shapely.box(x, y, x + 0.5, y + 0.5)) for x in range(60) for y in range(60)]
    said = refusal(geojson(tmp_path, [("boundary", shapely.box(-5, -5, 65, 65)), *posts]))
    check_says(said, "3601 closed walls … 3000")


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


@pytest.mark.parametrize("over", [0.0004, 0.001, 0.0014, 0.003])
@pytest.mark.parametrize("angle", [0.0, 20.0])
def test_walls_that_overlap_by_a_grain_stay_closed(
    tmp_path: Path, over: float, angle: float
) -> None:
    """Corners that lie within the other wall must not draw its side back to themselves."""
    boxes = [(0, 0, 40, 1), (0, 19, 40, 1), (0, 1 - over, 1, 18 + 2 * over),
             (39, 1 - over, 1, 18 + 2 * over)]  # fmt: skip
    walls = [
        shapely.affinity.rotate(shapely.box(x, y, x + w, y + h), angle, origin=(20, 10))
        for x, y, w, h in boxes
    ]
    made = import_world(geojson(tmp_path, [("wall", one) for one in walls]))
    assert free_area(made, tmp_path) == pytest.approx(38.0 * 18.0, abs=0.2)
    lines = "".join(f'<path {LINE} d="{svg_path(one.exterior.coords)} Z"/>' for one in walls)
    way = shapely.affinity.rotate(shapely.LineString([(4, 10), (36, 10)]), angle, origin=(20, 10))
    body = f'<g id="walls">{lines}</g><path id="path" d="{svg_path(way.coords)}"/>'
    drawn = import_world(drawing(tmp_path, body), METRES)
    assert free_area(drawn, tmp_path) == pytest.approx(38.0 * 18.0, abs=0.2)


def test_a_thin_wall_stays_whole_at_any_angle(tmp_path: Path) -> None:
    """Its corners lie so near its own other side that they could be taken to lie on it."""
    rng = np.random.default_rng(1)
    for angle, thick in zip(rng.uniform(0, 90, 20), rng.uniform(0.0012, 0.002, 20), strict=True):
        ring = shapely.box(0, 0, 20, 10) - shapely.box(thick, thick, 20 - thick, 10 - thick)
        parts = [ring, shapely.box(8, 4, 9, 5)]
        walls = [shapely.affinity.rotate(one, angle, origin=(0, 0)) for one in parts]
        made = import_world(geojson(tmp_path, [("wall", one) for one in walls]))
        assert free_area(made, tmp_path) == pytest.approx(199.0, abs=0.2)


def test_a_polygon_with_a_role_is_the_place_beside_larger_ones(tmp_path: Path) -> None:
    site, hall = shapely.box(0, 0, 60, 40), shapely.box(5, 5, 25, 15)
    made = import_world(geojson(tmp_path, [("", site), ("boundary", hall)]))
    assert free_area(made, tmp_path) == pytest.approx(hall.area)


@pytest.mark.parametrize("thick", [0.002, 0.0025, 0.004])
def test_a_thin_wall_is_not_knit_to_its_own_other_side(tmp_path: Path, thick: float) -> None:
    ring = shapely.box(0, 0, 20, 10) - shapely.box(thick, thick, 20 - thick, 10 - thick)
    turned = shapely.affinity.rotate(ring, 17.0, origin=(0, 0))
    stub = shapely.affinity.rotate(shapely.box(8, 4, 9, 5), 17.0, origin=(0, 0))
    made = import_world(geojson(tmp_path, [("wall", turned), ("wall", stub)]))
    assert free_area(made, tmp_path) == pytest.approx(199.0 - 60.0 * thick, abs=0.02)


def test_a_wall_that_divides_a_polygon_does_so_at_any_angle(tmp_path: Path) -> None:
    for angle in ANGLES:
        place = shapely.affinity.rotate(shapely.box(0, 0, 20, 10), angle, origin=(0, 0))
        wall = shapely.affinity.rotate(shapely.LineString([(8, 0), (8, 10)]), angle, origin=(0, 0))
        made = import_world(geojson(tmp_path, [("boundary", place), ("wall", wall)]))
        assert free_area(made, tmp_path) == pytest.approx(120.0, abs=0.1)


def test_an_opening_is_named_beside_a_wall(tmp_path: Path) -> None:
    """Nearer to a wall than half its width: the walls grow over the path before they close it."""
    body = f'<path id="boundary" {LINE} d="M 10,24 V 10 H 50 V 40 H 10 V 28"/>'
    post = '<rect id="boundary 2" fill="none" stroke="red" x="30" y="30" width="2" height="2"/>'
    way = '<path id="path" d="M 12,11 H 48"/>'
    check_says(refusal(drawing(tmp_path, body + post + way)), "(10.00, 34.00), 4 m wide")


def test_the_end_of_a_partition_is_no_opening(tmp_path: Path) -> None:
    lines = ["M 0,20 H 40", "M 0,26 H 40", "M 20,20 V 23", "M 0,20 V 26"]
    body = "".join(f'<path d="{line}"/>' for line in lines)
    said = refusal(drawing(tmp_path, f'<g id="boundary" {LINE}>{body}</g>'))
    check_says(said, "(40.00, 40.00) and (40.00, 34.00)")


def test_an_opening_is_that_of_the_place_that_is_asked_for(tmp_path: Path) -> None:
    """Of two halls with doors of two widths."""
    halls = [shapely.LineString([(x + a, b) for a, b in DOOR]) for x in (0, 40)]
    halls[1] = shapely.LineString([*list(halls[1].coords)[:-1], (40, 7)])
    walls = [("wall", one.buffer(0.15, join_style="mitre", cap_style="flat")) for one in halls]
    path = geojson(tmp_path, walls)
    for x, said in ((10, "(0.00, 4.50), 1 m wide"), (50, "(40.00, 5.50), 3 m wide")):
        assert said in refusal(path, Options(origin=(float(x), 5.0)))


@pytest.mark.parametrize(
    "other", [[(45, 9), (5, 9)], [(25, 11), (25, 1)]], ids=["against", "across"]
)
def test_robots_that_go_another_way_are_no_formation(
    tmp_path: Path, other: list[tuple[float, float]]
) -> None:
    """It would have those behind stop as far before their ends, after a step."""
    x, y = other[0]
    parts = [
        ("boundary", shapely.box(0, 0, 50, 12)), ("path", shapely.LineString([(3, 4), (47, 4)])),
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


def test_polygons_side_by_side_are_told_as_areas_of_their_own(tmp_path: Path) -> None:
    path = tmp_path / "halves.wkt"
    halves = [shapely.box(0, 0, 20, 8), shapely.box(20, 0, 40, 8)]
    rows = [*halves, shapely.LineString([(2, 4), (38, 4)])]
    path.write_text("\n".join(one.wkt for one in rows))
    check_says(refusal(path, Options()), "(20.00, 4.00) … 2 polygons … dissolve")


@pytest.mark.parametrize("side", ["above", "below"])
def test_partitions_from_both_sides_of_a_wall_divide_the_rooms(tmp_path: Path, side: str) -> None:
    """A wall that is drawn to the end of one must not leave that of the other behind."""
    wrong = []
    for angle in np.linspace(1.0, 89.0, 25):
        lines = [[(0, 10), (30, 10)], [(11, 10), (11, 20)], [(17.3, 0), (17.3, 10)]]
        shapes = [shapely.box(0, 0, 30, 20), *map(shapely.LineString, lines)]
        turned = [shapely.affinity.rotate(one, angle, origin=(0, 0)) for one in shapes]
        at = shapely.Point((20.0, 15.0) if side == "above" else (5.0, 5.0))
        point = shapely.affinity.rotate(at, angle, origin=(0, 0))
        parts = [("boundary" if k == 0 else "wall", one) for k, one in enumerate(turned)]
        made = import_world(geojson(tmp_path, parts), Options(origin=(point.x, point.y)))
        right = 190.0 if side == "above" else 173.0
        wrong += [angle] if abs(free_area(made, tmp_path) - right) > 0.1 else []
    assert not wrong


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
def test_a_queue_of_robots_with_paths_of_their_own_is_a_formation(
    tmp_path: Path, order: tuple[int, ...]
) -> None:
    """On the path of the last: the others do not begin where it stands."""
    parts: list[tuple[str, Any]] = [("boundary", shapely.box(0, 0, 50, 10))]
    for x in order:
        parts += [(f"robot r{x}", shapely.box(x - 0.9, 4.5, x + 0.9, 5.5)),
                  (f"path r{x}", shapely.LineString([(x, 5), (x + 25, 5)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert made.world.reference_path is not None
    assert made.world.reference_path[0] == pytest.approx((3.0, 5.0))
    assert made.world.formation is not None


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
def test_a_closed_path_begins_at_the_last_robot_on_it(
    tmp_path: Path, kind: str, start: int
) -> None:
    """Wherever it was drawn from; a robot that has begun a lap drives the whole of it."""
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
    first = (26.0, abs(flip - 6.4))
    assert made.world.reference_path is not None
    assert made.world.reference_path[0] == pytest.approx(first, abs=0.101)
    assert shapely.LineString(made.world.reference_path).length == pytest.approx(60.0)
    assert only(made, "closed path begun")
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
    assert made.world.formation is not None
