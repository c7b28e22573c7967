"""Honest files that other programs write, read as they are meant."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
import shapely

from physim.authoring.importing import Imported, ImportSourceError, Options, import_world
from tests.importing.plans import check_says, svg

ROOM = [[0, 0], [30, 0], [30, 20], [0, 20], [0, 0]]


def geojson(folder: Path, rings: list[Any], crs: str = "") -> Path:
    shape = {"type": "Polygon", "coordinates": rings}
    about = {"crs": {"type": "name", "properties": {"name": crs}}} if crs else {}
    path = folder / "plan.geojson"
    path.write_text(json.dumps({**about, "type": "Feature", "properties": {}, "geometry": shape}))
    return path


def moved(ring: list[list[float]], x: float, y: float) -> list[list[float]]:
    return [[a + x, b + y] for a, b in ring]


def room(imported: Imported) -> Any:
    """Where robots may go."""
    world = imported.world
    outer, *holes = (shapely.Polygon(ring) for ring in world.boundaries or ())
    solid = [shapely.Polygon(ring) for ring in world.obstacles or ()]
    return outer.difference(shapely.union_all([*holes, *solid]))


COLUMNS = {
    "at the wall": [[0, 8], [2, 8], [2, 10], [0, 10], [0, 8]],
    "through the wall": [[-1, 8], [2, 8], [2, 10], [-1, 10], [-1, 8]],
    "at a corner": [[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]],
    "in the room": [[4, 8], [6, 8], [6, 10], [4, 10], [4, 8]],
}


@pytest.mark.parametrize("name", COLUMNS)
@pytest.mark.parametrize("form", ["geojson", "wkt"])
def test_a_column_is_solid_wherever_it_stands(tmp_path: Path, name: str, form: str) -> None:
    """One that shares an edge with the outline was lost: robots went through it."""
    path = geojson(tmp_path, [ROOM, COLUMNS[name]])
    if form == "wkt":
        path = tmp_path / "plan.wkt"
        texts = (", ".join(f"{x} {y}" for x, y in ring) for ring in (ROOM, COLUMNS[name]))
        path.write_text("POLYGON (({}), ({}))".format(*texts))
    expected = shapely.Polygon(ROOM).difference(shapely.Polygon(COLUMNS[name]))
    found = room(import_world(path, Options(scale=1.0)))
    assert found.symmetric_difference(expected).area < 1e-6


def test_coordinates_of_a_national_grid_are_taken_from_an_origin(tmp_path: Path) -> None:
    crs = "urn:ogc:def:crs:EPSG::32633"
    imported = import_world(geojson(tmp_path, [moved(ROOM, 400_010.0, 5_812_345.5)], crs))
    check_says(" ".join(imported.facts), f"crs, {crs} … origin … 400000, 5812000")
    assert room(imported).bounds == (10.0, 345.5, 40.0, 365.5)
    near = import_world(geojson(tmp_path, [moved(ROOM, 900_000.0, 10.0)], "EPSG:3857"))
    assert room(near).bounds[0] == 900_000.0  # what can be had as it is stays so
    track = tmp_path / "track.csv"
    track.write_text("".join(f"{500_000 + x},5400123,4,4\n" for x in range(30)))
    imported = import_world(track)
    check_says(" ".join(imported.facts), "origin … 500000, 5400000")
    walls = shapely.MultiLineString(list(imported.world.boundaries or ()))
    assert walls.bounds == pytest.approx((0.0, 119.0, 29.0, 127.0))


WALLS = '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
PATH = '<path id="path" d="M 2,7 L 20,7"/>'
PILLAR = '<rect x="10" y="10" width="1" height="1" {}/>'
UNSEEN = {
    "attribute": ('<g id="obstacle">{}</g>', 'visibility="hidden"', 0),
    "style": ('<g id="obstacle">{}</g>', 'style="fill:red; visibility:collapse"', 0),
    "group": ('<g id="obstacle" visibility="hidden">{}</g>', "", 0),
    "sheet": ('<style>.off {{visibility:hidden}}</style><g id="obstacle">{}</g>', 'class="off"', 0),
    "commented sheet": (
        '<style><![CDATA[<!-- @charset "x"; .off {{display:none}} -->]]></style>'
        '<g id="obstacle">{}</g>',
        'class="off"',
        0,
    ),
    "clear in a sheet": ('<style>.a {{opacity: 0}}</style><g id="obstacle">{}</g>', 'class="a"', 0),
    "style over attribute": ('<g id="obstacle">{}</g>', 'display="none" style="display:inline"', 1),
    "invisible, though displayed": (
        '<g id="obstacle">{}</g>',
        'visibility="hidden" style="display:inline"',
        0,
    ),
    "clear": ('<g id="obstacle">{}</g>', 'opacity="0.0"', 0),
    "clear group": ('<g id="obstacle" style="opacity:0%">{}</g>', "", 0),
    "nearly clear": ('<g id="obstacle">{}</g>', 'opacity="0.01"', 1),
    "box about a shape": (
        '<g id="obstacle">{}</g>',
        'class="BoundingBox" fill="none" stroke="none"',
        0,
    ),
    "an area that is not drawn": ('<g id="obstacle">{}</g>', 'fill="none"', 0),
    "a shape named by its role": ("{}", 'id="obstacle" fill="none"', 1),
    "as its group, which is not drawn": (
        '<g id="obstacle" fill="none">{}</g>',
        'fill="inherit"',
        0,
    ),
    "a group that is not drawn": (
        '<g id="obstacle" fill="none" stroke="none">{}</g>',
        "",
        0,
    ),
    "drawn in a group that is not": (
        '<g id="obstacle" fill="none" stroke="none">{}</g>',
        'stroke="red"',
        1,
    ),
    "as its group, which is drawn": (
        '<g id="obstacle" fill="none" style="stroke:red">{}</g>',
        'fill="inherit"',
        1,
    ),
    "a copy of what is hidden": (
        '<g visibility="hidden"><defs>{}</defs></g><g id="obstacle"><use href="#it"/></g>',
        'id="it"',
        1,
    ),
    "a hidden copy of what is seen": (
        '<defs>{}</defs><g id="obstacle"><use visibility="hidden" href="#it"/></g>',
        'id="it" visibility="visible"',
        1,
    ),
    "a hidden copy": (
        '<defs>{}</defs><g id="obstacle"><use visibility="hidden" href="#it"/></g>',
        'id="it"',
        0,
    ),
    "a copy that is not drawn": (
        '<defs>{}</defs><g id="obstacle" fill="none"><use href="#it"/></g>',
        'id="it"',
        0,
    ),
    "a copy, drawn where it stands": (
        '<defs><g id="it" fill="none">{}</g></defs><g id="obstacle" stroke="red">'
        '<use href="#it"/></g>',
        "",
        1,
    ),
    "outline": ('<g id="obstacle">{}</g>', 'fill="none" stroke="black"', 1),
    "area": ('<g id="obstacle">{}</g>', 'stroke="none"', 1),
    "painted by a sheet": (
        '<style>.w {{stroke: black}}</style><g id="obstacle">{}</g>',
        'class="w" fill="none" stroke="none"',
        1,
    ),
    "shown by a sheet": (
        '<style>.a rect {{fill: red; display: inline}}</style><g id="obstacle">{}</g>',
        "",
        1,
    ),
    "seen again": ('<g id="obstacle" visibility="hidden">{}</g>', 'visibility="visible"', 1),
    "inherited": ('<g id="obstacle" visibility="visible">{}</g>', 'visibility="inherit"', 1),
}


@pytest.mark.parametrize("how", UNSEEN)
def test_what_is_invisible_is_no_obstacle(tmp_path: Path, how: str) -> None:
    around, values, count = UNSEEN[how]
    path = tmp_path / "plan.svg"
    path.write_text(svg(f"{WALLS}\n{around.format(PILLAR.format(values))}\n{PATH}"))
    imported = import_world(path, Options(scale=1.0))
    assert len(imported.world.obstacles or ()) == count
    assert len([one for one in imported.changes if "hidden" in one]) == 1 - count


SELECTORS = (".k rect", ".k > rect", ".a.b", 'rect[id="x"]', "rect:not(.h)", ".h:hover")


@pytest.mark.parametrize("selector", SELECTORS)
@pytest.mark.parametrize("body", ["display:none", "visibility: hidden", "mask: url(#m)"])
def test_what_a_sheet_hides_in_ways_that_are_not_followed_is_refused(
    tmp_path: Path, selector: str, body: str
) -> None:
    path = tmp_path / "plan.svg"
    sheet = f"<style><![CDATA[.x, {selector} {{{body}}}]]></style>"
    path.write_text(svg(f'{WALLS}\n{sheet}<g id="obstacle">{PILLAR.format("")}</g>\n{PATH}'))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, Options(scale=1.0))
    check_says(str(caught.value), f"plan.svg:3 … <style> … {selector} … hides, cuts or moves")


def test_a_share_and_a_page_in_ems_are_refused(tmp_path: Path) -> None:
    """The one became an ellipse; the reason of the other was left empty."""
    path = tmp_path / "plan.svg"
    circle = '<circle cx="5" cy="5" r="10%"/>'
    path.write_text(svg(f'{WALLS}\n<g id="obstacle">{circle}</g>\n{PATH}'))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, Options(scale=1.0))
    check_says(str(caught.value), "plan.svg:3 … <circle> … 10% … alone or with px")
    text = svg(f"{WALLS}\n{PATH}")
    path.write_text(re.sub(r'width="[^"]*"', 'width="30em"', text, count=1))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, Options(scale=1.0))
    check_says(str(caught.value), 'plan.svg:1 … <svg> … width="30em" … length')


DEGREES = [[-100.0, 30.0], [-70.0, 30.0], [-70.0, 50.0], [-100.0, 50.0], [-100.0, 30.0]]


@pytest.mark.parametrize("code", [4269, 4490, 4674, 6318, 7844])
def test_degrees_of_every_system_are_refused(tmp_path: Path, code: int) -> None:
    """Those of two systems alone were; the others became metres in silence."""
    wkt = tmp_path / "plan.wkt"
    wkt.write_text(f"SRID={code};POLYGON((" + ", ".join(f"{x:g} {y:g}" for x, y in DEGREES) + "))")
    for name in ("", f"EPSG:{code}", f"urn:ogc:def:crs:EPSG:6.9:{code}"):
        path = geojson(tmp_path, [DEGREES], name) if name else wkt
        with pytest.raises(ImportSourceError) as caught:
            import_world(path, Options())
        check_says(str(caught.value), "degrees … --scale 1 if these are metres")
        assert room(import_world(path, Options(scale=1.0))).area == pytest.approx(600.0)


def test_lengths_of_an_srid_are_told(tmp_path: Path) -> None:
    path = tmp_path / "plan.wkt"
    path.write_text("SRID=2263;POLYGON((0 0, 30 0, 30 20, 0 20, 0 0))")
    check_says(" ".join(import_world(path, Options()).facts), "SRID, 2263 … as they are")


def test_a_solid_obstacle_with_a_courtyard_is_told(tmp_path: Path) -> None:
    path = geojson(tmp_path, [ROOM])
    value = json.loads(path.read_text())
    rings = [[[2, 2], [12, 2], [12, 12], [2, 12], [2, 2]], [[4, 4], [6, 4], [6, 6], [4, 6], [4, 4]]]
    building = {"type": "Polygon", "coordinates": rings}
    feature = {"type": "Feature", "properties": {"role": "obstacle"}, "geometry": building}
    own = {"type": "Feature", "properties": {"role": "boundary"}, "geometry": value}
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [own, feature]}))
    check_says(
        " ".join(import_world(path, Options(scale=1.0)).changes), "obstacle at … holes filled"
    )


def test_a_table_with_numbered_rows_is_read(tmp_path: Path) -> None:
    path = tmp_path / "track.csv"
    rows = (f"{k},{5.0 * k},0.0,3.0,3.0" for k in range(9))
    path.write_text("\n".join((",x_m,y_m,w_tr_right_m,w_tr_left_m", *rows)))
    walls = [
        point for wall in import_world(path, Options()).world.boundaries or () for point in wall
    ]
    assert {abs(y) for _, y in walls} == {3.0}
    assert (min(walls)[0], max(walls)[0]) == (0.0, 40.0)
