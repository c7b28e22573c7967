"""Honest files that other programs write, read as they are meant."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import shapely

from physim.authoring.importing import Imported, Options, import_world
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


WALLS = '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
PATH = '<path id="path" d="M 2,7 L 20,7"/>'
PILLAR = '<rect x="10" y="10" width="1" height="1" {}/>'
UNSEEN = {
    "attribute": ('<g id="obstacle">{}</g>', 'visibility="hidden"', 0),
    "style": ('<g id="obstacle">{}</g>', 'style="fill:red; visibility:collapse"', 0),
    "group": ('<g id="obstacle" visibility="hidden">{}</g>', "", 0),
    "sheet": ('<style>.off {{visibility:hidden}}</style><g id="obstacle">{}</g>', 'class="off"', 0),
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
