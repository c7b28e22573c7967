"""Which area of a drawing is the place of the robots, and where it is open or in doubt."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim.authoring.importing import Imported, ImportSourceError, Options, import_world
from physim.world.checks import check_world
from tests.helpers import inside
from tests.importing.plans import check_says, only, svg, svg_path
from tests.importing.test_joining import geojson

role_named = inside("physim.authoring.importing", "role_named")
accessible_area = inside("physim.geometry", "accessible_area")

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


@pytest.mark.parametrize(("side", "length"), [(40, 30), (12, 58)], ids=["larger", "smaller"])
def test_lines_beside_a_closed_room_make_no_room_of_their_own(
    tmp_path: Path, side: int, length: int
) -> None:
    kerbs = f'<path d="M 0,50 H {length}"/><path d="M 0,58 H {length}"/>'
    room = f'<path d="M 0,0 H {side} V {side} H 0 Z"/>'
    body = f'<g id="boundary" {LINE}>{room}{kerbs}</g>'
    told = f"{2 * length} m of lines beyond it … leave them out"
    check_says(refusal(drawing(tmp_path, body)), told)
    made = import_world(drawing(tmp_path, body), Options(scale=1.0, origin=(6.0, 54.0)))
    assert free_area(made, tmp_path) == pytest.approx(side**2)
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
