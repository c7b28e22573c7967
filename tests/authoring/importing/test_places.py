"""Which area of a drawing is the place of the robots, and how its lines and paths are joined."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim.authoring.importing import ImportSourceError, Options, import_world
from tests.authoring.importing.plans import (
    LINE,
    METRES,
    check_says,
    drawing,
    free_area,
    geojson,
    only,
    refusal,
    svg,
    svg_path,
)


def filled(shape: Any) -> str:
    """Path data of a shapely polygon with its holes, y turned down as on a page of 60."""
    rings = [shape.exterior, *shape.interiors]
    return " ".join(f"{svg_path([(x, 60 - y) for x, y in ring.coords])} Z" for ring in rings)


ROOM = "M 0,0 H 40 V 40 H 0 V 0.1"


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


ANGLES = (3.0, 17.0, 45.0, 87.0)


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


THICK = ((0, 0, 40, 1), (0, 19, 40, 1), (0, 0, 1, 20), (39, 0, 1, 20), (20, 0, 1, 5))


def walls_as_drawn(folder: Path) -> Path:
    shapes = "".join(
        f'<rect x="{x}" y="{19 - y + 1 - h}" width="{w}" height="{h}"/>' for x, y, w, h in THICK
    )
    path = folder / "thick.svg"
    page = 'width="40" height="20"'
    path.write_text(svg(f'<g id="walls">{shapes}</g><path id="path" d="M 4,10 H 36"/>', page))
    return path


def walls_of_a_plan(folder: Path) -> Path:
    shapes = [("wall", shapely.box(x, y, x + w, y + h)) for x, y, w, h in THICK]
    return geojson(folder, [*shapes, ("path", shapely.LineString([(4, 10), (36, 10)]))])


@pytest.mark.parametrize("drawn", [walls_as_drawn, walls_of_a_plan])
def test_walls_that_lie_over_each_other_enclose_the_room(tmp_path: Path, drawn: Any) -> None:
    made = import_world(drawn(tmp_path), METRES)
    assert free_area(made, tmp_path) == pytest.approx(38.0 * 18.0 - 4.0, abs=1e-3)
    told = "5 boundaries cross" if drawn is walls_as_drawn else "5 walls that meet or cross"
    assert only(made, told)


OPEN = (*THICK[:3], (39, 0, 1, 8), (39, 9, 1, 11))


def test_solid_walls_that_leave_the_room_open_are_refused(tmp_path: Path) -> None:
    boxes = [("wall", shapely.box(x, y, x + w, y + h)) for x, y, w, h in OPEN]
    with pytest.raises(ImportSourceError) as caught:
        import_world(geojson(tmp_path, boxes))
    check_says(str(caught.value), "walls enclose no area … open at (39.50, 8.50), 1 m wide")


PIECES = {
    "in turn": ["M 2,7 H 8", "M 8,7 H 14", "M 14,7 H 20"],
    "in another order": ["M 2,7 H 8", "M 14,7 H 20", "M 8,7 H 14"],
    "drawn against it": ["M 2,7 H 8", "M 20,7 H 14", "M 14,7 H 8"],
    "nearly met": ["M 2,7 H 8", "M 8.05,7.02 H 14", "M 13.9,7 H 20"],
}


@pytest.mark.parametrize("pieces", PIECES.values(), ids=PIECES)
def test_pieces_of_a_path_are_joined_where_they_meet(tmp_path: Path, pieces: list[str]) -> None:
    path = tmp_path / "plan.svg"
    shapes = "".join(f'<path d="{piece}"/>' for piece in pieces)
    ring = '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
    path.write_text(svg(f'{ring}<g id="path">{shapes}</g>'))
    made = import_world(path, METRES)
    line = made.world.reference_path
    assert line is not None
    assert shapely.LineString(line).length == pytest.approx(17.1, abs=0.1)
    assert (np.diff(np.asarray(line)[:, 0]) >= 0.0).all()  # as the first piece goes
    check_says(only(made, "pieces joined"), "3 pieces … from (2.00, 7.00) to (20.00, 7.00)")


@pytest.mark.parametrize(
    ("pieces", "length"),
    [
        ([("path a", [(2, 7), (20, 7)]), ("path b", [(2, 7), (2, 12)])], 18.0),
        ([("path", [(2, 7), (12, 7)]), ("path", [(12.05, 7), (20, 7)]),
          ("path", [(12.02, 7.1), (12, 12)])], 10.0),
    ],
    ids=["other names", "fork"],
)  # fmt: skip
def test_paths_of_other_names_and_forks_are_not_joined(
    tmp_path: Path, pieces: list[Any], length: float
) -> None:
    lines = [(role, shapely.LineString(points)) for role, points in pieces]
    made = import_world(geojson(tmp_path, [("boundary", shapely.box(0, 0, 24, 14)), *lines]))
    assert not [one for one in made.changes if "joined" in one]
    left = [one for one in made.changes if "left out" in one]
    assert len(left) == len(pieces) - 1
    assert all("fork" in one for one in left) == (pieces[0][0] == "path")
    assert made.world.reference_path is not None
    cut = shapely.LineString(made.world.reference_path).length
    assert length - 3.0 < cut <= length  # shortened at walls


def test_a_polygon_that_crosses_itself_is_named_as_a_cause(tmp_path: Path) -> None:
    bow = shapely.Polygon([(0, 0), (30, 20), (30, 0), (0, 20)])
    parts = [("boundary", bow), ("path", shapely.LineString([(2, 4), (28, 4)]))]
    with pytest.raises(ImportSourceError) as caught:
        import_world(geojson(tmp_path, parts))
    check_says(str(caught.value), "path leaves the area … cause … [15 10]")


@pytest.mark.parametrize("name", ["rim", "outline"])
def test_a_shape_or_its_group_is_taken_for_a_wall(tmp_path: Path, name: str) -> None:
    rim = f'<path id="rim" {LINE} d="M 2,2 H 28 V 13 H 2 Z"/>'
    desk = '<rect id="desk" x="10" y="6" width="2" height="1"/>'
    path = drawing(tmp_path, f'<g id="floor"><g id="outline">{rim}</g>{desk}</g>', 15.0)
    world = import_world(path, Options(scale=1.0, boundary=(name,))).world
    (wall,) = world.boundaries or ()
    assert {tuple(point) for point in wall} == {(2, 2), (28, 2), (28, 13), (2, 13)}
    assert not world.obstacles


ROOMS = f"""<g id="boundary" {LINE}><path d="M 2,2 H 28 V 13 H 2 Z"/><path d="M 12,2 V 9"/></g>"""


def test_a_wall_between_two_rooms_is_kept_clear_of(tmp_path: Path) -> None:
    way = f'<path id="path" {LINE} d="M 4,10.5 H 26"/>'
    made = import_world(drawing(tmp_path, ROOMS + way, 15.0), METRES)
    told = next(fact for fact in made.facts if "narrowest" in fact)
    assert 11.9 < float(told.split("narrowest at (")[1].split(",")[0]) < 12.1
    assert "1.50 m" in told


def test_a_path_is_found_through_the_door(tmp_path: Path) -> None:
    ends = Options(scale=1.0, origin=(5.0, 12.0), goal=(25.0, 12.0))
    world = import_world(drawing(tmp_path, ROOMS, 15.0), ends).world
    wall = shapely.LineString([(12, 13), (12, 6)])
    assert shapely.LineString(world.reference_path).distance(wall) > 0.5
