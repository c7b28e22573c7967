"""Lines drawn in pieces, walls that lie over each other, and what is said of lines left out."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim.authoring.importing import ImportSourceError, Options, import_world
from physim.world.checks import check_world
from tests.importing.plans import check_says, only, svg, svg_path

METRES = Options(scale=1.0)
THICK = ((0, 0, 40, 1), (0, 19, 40, 1), (0, 0, 1, 20), (39, 0, 1, 20), (20, 0, 1, 5))
"""[m] x, y, width and height of four walls of a room and one that stands in it"""
ROOM = shapely.box(0, 0, 40, 20).difference(
    shapely.union_all([shapely.box(x, y, x + w, y + h) for x, y, w, h in THICK])
)


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


def geojson(folder: Path, parts: list[tuple[str, Any]], **names: str) -> Path:
    path = folder / "plan.geojson"
    features = [
        {
            "type": "Feature",
            "properties": {"role": role.split(" ")[0], "name": role.partition(" ")[2]},
            "geometry": shapely.geometry.mapping(shape),
        }
        for role, shape in parts
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


def area_of(text: str, folder: Path) -> float:
    """[m²] that a world has by its check, which must find no error."""
    world = folder / "made.yaml"
    world.write_text(text)
    assert not check_world(world).errors
    made = import_lines(text)
    return float(max(shapely.get_parts(shapely.polygonize(made)), key=lambda one: one.area).area)


def import_lines(text: str) -> list[Any]:
    from physim.world.file import parse_world

    boundaries = parse_world(text, "made").boundaries
    assert boundaries is not None
    return [shapely.LineString(line) for line in boundaries]


@pytest.mark.parametrize("drawn", [walls_as_drawn, walls_of_a_plan])
def test_walls_that_lie_over_each_other_enclose_the_room(tmp_path: Path, drawn: Any) -> None:
    made = import_world(drawn(tmp_path), METRES)
    assert area_of(made.text, tmp_path) == pytest.approx(ROOM.area, abs=1e-3)
    told = "5 boundaries cross" if drawn is walls_as_drawn else "5 walls that meet or cross"
    assert only(made, told)


def test_walls_that_only_touch_stay_as_they_are_drawn(tmp_path: Path) -> None:
    ring = '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
    path = tmp_path / "plan.svg"
    path.write_text(svg(f'{ring}<path id="wall" d="M 12,0 V 5"/><path id="path" d="M 2,7 H 20"/>'))
    made = import_world(path, METRES)
    assert not [one for one in made.changes if "cross" in one]
    assert made.world.boundaries is not None
    assert [len(line) for line in made.world.boundaries] == [5, 2]


PIECES = {
    "in turn": ["M 2,7 H 8", "M 8,7 H 14", "M 14,7 H 20"],
    "in another order": ["M 2,7 H 8", "M 14,7 H 20", "M 8,7 H 14"],
    "drawn against it": ["M 2,7 H 8", "M 20,7 H 14", "M 14,7 H 8"],
    "begun within": ["M 8,7 H 14", "M 2,7 H 8", "M 14,7 H 20"],
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


def test_very_many_pieces_of_a_path_are_joined(tmp_path: Path) -> None:
    x = np.linspace(2.0, 22.0, 2001)
    pieces = [shapely.LineString([(a, 7.0), (b, 7.0)]) for a, b in pairwise(x)]
    turned = [piece.reverse() if k % 3 else piece for k, piece in enumerate(pieces)]
    order = [0, *(1 + np.random.default_rng(1).permutation(len(turned) - 1)).tolist()]
    place = ("boundary", shapely.box(0, 0, 24, 14))
    made = import_world(geojson(tmp_path, [place, *(("path", turned[k]) for k in order)]))
    check_says(only(made, "pieces joined"), "2000 pieces … from (2.00, 7.00) to (22.00, 7.00)")


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


@pytest.mark.parametrize("again", [[(2, 7), (12, 7)], [(12, 7), (2, 7)]])
def test_a_piece_of_a_path_that_is_drawn_twice_counts_once(
    tmp_path: Path, again: list[tuple[float, float]]
) -> None:
    pieces = [[(2, 7), (12, 7)], again, [(12, 7), (20, 7)]]
    lines = [("path", shapely.LineString(points)) for points in pieces]
    made = import_world(geojson(tmp_path, [("boundary", shapely.box(0, 0, 24, 14)), *lines]))
    assert shapely.LineString(made.world.reference_path or []).length == pytest.approx(
        17.5, abs=0.5
    )
    assert only(made, "drawn twice")


def test_a_path_does_not_turn_back_at_a_piece_beside_it(tmp_path: Path) -> None:
    lanes = [("path", shapely.LineString([(5, y), (235, y)])) for y in (40.0, 41.5)]
    made = import_world(geojson(tmp_path, [("boundary", shapely.box(0, 0, 240, 80)), *lanes]))
    assert {y for _, y in made.world.reference_path or ()} == {40.0}
    check_says(only(made, "left out"), "(5.00, 41.50) … turn back")


def test_pieces_that_lie_over_one_another_are_cut_at_their_joint(tmp_path: Path) -> None:
    """Finely drawn ones would go to and fro there."""
    ends = (((10, 7), (50, 7)), ((49.7, 7.02), (90, 7.02)))
    pieces = [shapely.LineString(line).segmentize(0.02) for line in ends]
    parts = [("boundary", shapely.box(0, 0, 100, 14)), *(("path", one) for one in pieces)]
    made = import_world(geojson(tmp_path, parts))
    assert only(made, "2 pieces joined")
    assert (np.diff(np.asarray(made.world.reference_path)[:, 0]) > 0.0).all()


@pytest.mark.parametrize("head", ["M 20,7 l -0.5,-0.3 v 0.6 z", "M 20,7 l -0.5,-2 v 4 z"])
@pytest.mark.parametrize("first", [True, False])
def test_the_head_of_an_arrow_is_no_path(tmp_path: Path, head: str, first: bool) -> None:
    shapes = [f'<path d="{head}"/>', '<path fill="none" stroke="red" d="M 2,7 H 20"/>']
    body = "".join(shapes if first else shapes[::-1])
    path = tmp_path / "plan.svg"
    ring = '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
    path.write_text(svg(f'{ring}<g id="path">{body}</g>'))
    made = import_world(path, METRES)
    assert np.ptp(np.asarray(made.world.reference_path), axis=0)[1] == 0.0
    assert only(made, "closed, beside an open path")


def test_pieces_of_a_path_that_do_not_meet_are_left_out_and_told(tmp_path: Path) -> None:
    path = tmp_path / "plan.wkt"
    path.write_text(
        "POLYGON ((0 0, 24 0, 24 14, 0 14, 0 0))\nLINESTRING (2 7, 12 7)\nLINESTRING (14 7, 20 7)\n"
    )
    made = import_world(path)
    assert only(made, "(14.00, 7.00) to (20.00, 7.00)").endswith("left out")
    assert made.world.reference_path is not None
    assert max(x for x, _ in made.world.reference_path) < 12.01


@pytest.mark.parametrize("first", ["robot", "path"])
def test_a_path_is_that_of_its_robot_wherever_that_stands(tmp_path: Path, first: str) -> None:
    robot = ("robot arrow", shapely.box(3, 4, 5, 5))
    own = ("path arrow", shapely.LineString([(4, 4.5), (20, 4.5)]))
    place = ("boundary", shapely.box(0, 0, 24, 14))
    way = ("path", shapely.LineString([(2, 9), (20, 9)]))
    parts = [place, robot, own, way] if first == "robot" else [place, own, robot, way]
    made = import_world(geojson(tmp_path, parts))
    assert made.world.reference_path is not None
    assert {y for _, y in made.world.reference_path} == {9.0}
    assert [y for _, y in made.world.robots[0].path] == [4.5, 4.5]


def test_a_robot_keeps_the_first_of_two_paths(tmp_path: Path) -> None:
    parts = [
        ("boundary", shapely.box(0, 0, 24, 14)), ("robot arrow", shapely.box(3, 4, 5, 5)),
        ("path arrow", shapely.LineString([(4, 4.5), (20, 4.5)])),
        ("path arrow", shapely.LineString([(4, 9), (20, 9)])),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert [y for _, y in made.world.robots[0].path] == [4.5, 4.5]
    assert only(made, "(4.00, 9.00) to (20.00, 9.00)").endswith("left out")


@pytest.mark.parametrize(
    ("layer", "near"), [("obstacels", '"obstacles"'), ("wals", '"walls"'), ("notes", "")]
)
def test_a_layer_that_is_none_is_told_once_by_its_name(
    tmp_path: Path, layer: str, near: str
) -> None:
    path = tmp_path / "plan.svg"
    shapes = '<rect id="rect88" x="9" y="2" width="1" height="1"/>' * 3
    path.write_text(
        svg(
            '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>\n<path id="path" d="M 2,7 H 20"/>\n'
            f'<g inkscape:label="{layer}">{shapes}</g>'
        )
    )
    told = only(import_world(path, METRES), "in no layer")
    check_says(told, f"line 4: … 'rect88' and 2 more … '{layer}'")
    assert told.endswith(f"did you mean {near}?") if near else "did you mean" not in told


def test_a_polygon_that_crosses_itself_is_named_as_a_cause(tmp_path: Path) -> None:
    bow = shapely.Polygon([(0, 0), (30, 20), (30, 0), (0, 20)])
    parts = [("boundary", bow), ("path", shapely.LineString([(2, 4), (28, 4)]))]
    with pytest.raises(ImportSourceError) as caught:
        import_world(geojson(tmp_path, parts))
    check_says(str(caught.value), "path leaves the area … cause … [15 10]")


@pytest.mark.parametrize(("unit", "asked"), [(1.0, False), (0.001, True)])
def test_a_place_too_narrow_in_kilometres_is_asked_for_its_scale(
    tmp_path: Path, unit: float, asked: bool
) -> None:
    path = tmp_path / "plan.wkt"
    place = shapely.box(0, 0, 4000, 12) - shapely.box(1999, 0.5, 2001, 11.5)
    way = shapely.LineString([(9, 6), (3990, 6)])
    rows = (shapely.transform(one, lambda points: points * unit).wkt for one in (place, way))
    path.write_text("\n".join(rows))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path)
    assert ("--scale" in str(caught.value)) == asked


OPEN = (*THICK[:3], (39, 0, 1, 8), (39, 9, 1, 11))
"""[m] the walls with a door to the outside: what they enclose then is the inside of each"""


def test_solid_walls_that_leave_the_room_open_are_refused(tmp_path: Path) -> None:
    boxes = [("wall", shapely.box(x, y, x + w, y + h)) for x, y, w, h in OPEN]
    with pytest.raises(ImportSourceError) as caught:
        import_world(geojson(tmp_path, boxes))
    check_says(str(caught.value), "walls enclose no area … open at (39.50, 8.50), 1 m wide")


def test_the_inside_of_solid_walls_is_no_place(tmp_path: Path) -> None:
    """As plans have them that are dissolved into one shape: twelve rooms, less than the walls."""
    rooms = [shapely.box(x, y, x + 2.0, y + 2.0) for x in (2, 6, 10, 14) for y in (2, 6, 10)]
    largest = shapely.box(2, 14, 6, 18)
    block = shapely.box(0, 0, 20, 20) - shapely.union_all([*rooms, largest])
    with pytest.raises(ImportSourceError, match="--from"):
        import_world(geojson(tmp_path, [("wall", block)]))
    here = Options(origin=(4.0, 16.0))
    made = import_world(geojson(tmp_path, [("wall", block)]), here)
    assert area_of(made.text, tmp_path) == pytest.approx(largest.area)


@pytest.mark.parametrize(
    ("angle", "gap"),
    [*((angle, 0.0) for angle in np.linspace(1.0, 89.0, 12)), (0.0, 2e-4), (90.0, 2e-4)],
)
def test_walls_that_meet_at_any_angle_enclose_the_room(
    tmp_path: Path, angle: float, gap: float
) -> None:
    """End against side, or nearer than the millimetre of the world."""
    boxes = [(0, 0, 40, 1), (0, 19, 40, 1), (0, 1 + gap, 1, 18 - 2 * gap), (39, 1, 1, 18)]
    walls = shapely.MultiPolygon([shapely.box(x, y, x + w, y + h) for x, y, w, h in boxes])
    turned = shapely.affinity.rotate(walls, angle, origin=(0, 0))
    made = import_world(geojson(tmp_path, [("wall", one) for one in turned.geoms]))
    assert area_of(made.text, tmp_path) == pytest.approx(38.0 * 18.0, abs=0.2)


@pytest.mark.parametrize("pillar", ["", '<rect id="wall 2" x="9" y="6" width="1" height="1"/>'])
@pytest.mark.parametrize(
    "walls",
    ["M 0,0.1 V 14 H 24 V 0 H 0", "M 0,0 H 24 M 24,14 H 0"],
    ids=["a gap", "two open walls"],
)
def test_open_walls_are_closed_whatever_stands_between_them(
    tmp_path: Path, pillar: str, walls: str
) -> None:
    path = tmp_path / "plan.svg"
    path.write_text(
        svg(
            f'<path id="boundary" fill="none" stroke="red" d="{walls}"/>{pillar}'
            '<path id="path" d="M 2,3 H 20"/>'
        )
    )
    made = import_world(path, METRES)
    assert area_of(made.text, tmp_path) == pytest.approx(24 * 14, abs=1.1)


def test_a_passage_between_walls_in_a_closed_one_stays_open(tmp_path: Path) -> None:
    """As wide as a gap between ends that are joined, where nothing is enclosed otherwise."""
    path = tmp_path / "plan.svg"
    path.write_text(
        svg(
            '<path id="boundary" d="M 0,0 H 240 V 140 H 0 Z"/>'
            '<path id="wall 1" fill="none" stroke="red" d="M 120,0 V 69"/>'
            '<path id="wall 2" fill="none" stroke="red" d="M 120,71 V 140"/>'
            '<path id="path" d="M 20,70 H 200"/>'
        )
    )
    made = import_world(path, METRES)
    assert not [one for one in made.changes if "joined" in one]


def test_walls_about_a_polygon_leave_it_the_area(tmp_path: Path) -> None:
    """Without a path to say so: what is between the walls of a building and it is larger."""
    hall, building = shapely.box(10, 10, 40, 30), shapely.box(0, 0, 100, 60)
    parts = [("boundary", hall), ("wall", building.exterior), ("wall", shapely.LineString(
        [(20, 10), (20, 16)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert area_of(made.text, tmp_path) == pytest.approx(hall.area)


def test_plans_of_walls_over_each_other_have_no_crossings(tmp_path: Path) -> None:
    """Turned by any angle, with pillars that touch walls or lie over them."""
    rng = np.random.default_rng(5)
    for k in range(25):
        corners = rng.uniform((1, 1), (34, 16), (6, 2))
        sizes = rng.choice([0.3, 1.0, 2.0, 4.0], (6, 2))
        boxes = [shapely.box(x, y, x + w, y + h) for x, y, w, h in THICK[:4]]
        boxes += [
            shapely.box(*low, *(low + size)) for low, size in zip(corners, sizes, strict=True)
        ]
        angle = float(rng.uniform(0, 90)) if k > 5 else 0.0
        turned = shapely.affinity.rotate(shapely.MultiPolygon(boxes), angle, origin=(20, 10))
        path = tmp_path / "plan.svg"
        walls = "".join(f'<path d="{svg_path(one.exterior.coords)} Z"/>' for one in turned.geoms)
        path.write_text(svg(f'<g id="walls">{walls}</g>', 'width="60" height="60"'))
        made = import_world(path, METRES)
        (tmp_path / "made.yaml").write_text(made.text)
        assert not [
            one for one in check_world(tmp_path / "made.yaml").errors if "cross" in str(one)
        ]
