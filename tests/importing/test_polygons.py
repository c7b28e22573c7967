"""WKT and GeoJSON: which polygon is the area, what of it is lost, and what is said of it."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from physim.authoring.importing import Options, import_world
from tests.helpers import inside
from tests.importing.plans import check_says, only

Outline, smooth = inside("physim.authoring.importing", "Outline", "smooth")


def test_a_geometry_goes_over_lines_until_its_brackets_are_closed(tmp_path: Path) -> None:
    path = tmp_path / "plan.wkt"
    path.write_text(
        "GEOMETRYCOLLECTION (\nPOLYGON ((0 0, 40 0,\n40 20, 0 20, 0 0)),\n"
        "LINESTRING (3 10, 37 10)\n)\n"
    )
    imported = import_world(path)
    assert np.array(imported.world.reference_path)[:, 1].tolist() == [10.0, 10.0]


def test_robots_of_one_name_have_names_of_their_own(tmp_path: Path) -> None:
    """Keys of properties are in capitals, as those of shapefiles may be."""
    corners = [[3, 3], [5, 3], [5, 4], [3, 4], [3, 3]]
    other = [[x, y + 4] for x, y in corners]
    features = [
        {"type": "Feature", "properties": {"ROLE": role, "Name": "q "}, "geometry": geometry}
        for role, geometry in (
            ("robot", {"type": "MultiPolygon", "coordinates": [[corners], [other]]}),
            ("path", {"type": "LineString", "coordinates": [[3, 5], [37, 5]]}),
            ("boundary", {"type": "Polygon", "coordinates": [ROUND]}),
        )
    ]
    path = tmp_path / "plan.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    imported = import_world(path, Options(scale=1.0))
    assert [robot.name for robot in imported.world.robots] == ["q", "q_2"]
    assert [one for one in imported.changes if "q_2" in one] == ["a second robot q is called q_2"]


ROUND = [[0, 0], [40, 0], [40, 12], [0, 12], [0, 0]]


NECK = "20 0, 20 9.9998, 23 9.9998, 23 0, 42 0, 42 20, 23 20, 23 10.0001, 20 10.0001, 20 20"


def test_halves_joined_by_a_neck_below_a_millimetre_are_told_apart(tmp_path: Path) -> None:
    """That with the path in it is the area; the other is listed with its size."""
    path = tmp_path / "plan.wkt"
    halves = {"LINESTRING (2 3, 18 3)": 20.0, "LINESTRING (25 3, 40 3)": 19.0}
    for line, width in halves.items():
        path.write_text(f"POLYGON ((0 0, {NECK}, 0 20, 0 0))\n{line}\n")
        imported = import_world(path)
        (wall,) = imported.world.boundaries
        assert np.ptp(np.array(wall, dtype=float), axis=0).tolist() == [width, 20.0]
        check_says(only(imported, "parts"), "2 parts … millimetre")
        check_says(only(imported, "not the area"), f"{(39.0 - width) * 20.0:.3f} m² … left out")


@pytest.mark.parametrize(
    "wall",
    [
        "0 20, 0 0), (20 3, 20.0004 3, 20.0004 19, 20 19, 20 3)",
        "20.0004 20, 20.0004 2, 20 2, 20 20, 0 20, 0 0)",
        "20 20, 20 2, 20 20, 0 20, 0 0)",
    ],
)
def test_walls_below_a_millimetre_are_told(tmp_path: Path, wall: str) -> None:
    """A hole, a slit, and a line to and fro; a wall of two millimetres stays."""
    path = tmp_path / "plan.wkt"
    path.write_text(f"POLYGON ((0 0, 40 0, 40 20, {wall})\nLINESTRING (3 1.5, 37 0.6)\n")
    imported = import_world(path)
    assert not imported.world.obstacles
    check_says(only(imported, "thinner"), "millimetre … left out … (20.00,")
    path.write_text(path.read_text().replace("20.0004", "20.002"))
    if "20.002" in path.read_text():
        imported = import_world(path)
        assert not [one for one in imported.changes if "thinner" in one]


def test_what_points_have_beside_their_place_is_told(tmp_path: Path) -> None:
    path = tmp_path / "plan.wkt"
    for kind, said in (("Z", ["height"]), ("M", ["(M)"]), ("ZM", ["height", "(M)"])):
        more = " 1" * len(kind)
        path.write_text(f"POLYGON {kind} ((0 0{more}, 40 0{more}, 40 20{more}, 0 0{more}))")
        told = [one for one in import_world(path).changes if "left out" in one]
        assert len(told) == len(said)
        for one, what in zip(told, said, strict=True):
            assert what in one


def test_a_polygon_that_crosses_itself_is_repaired(tmp_path: Path) -> None:
    path = tmp_path / "p.wkt"
    path.write_text("POLYGON ((0 0, 20 0, 20 10, 4 10, 4 12, 3 12, 3 10, 6 10, 0 10, 0 0))")
    told = only(import_world(path), "repaired")
    check_says(told, "repaired … Self-intersection")
    path.write_text("MULTIPOLYGON (((0 0, 20 0, 20 10, 0 10, 0 0)), ((30 0, 34 0, 34 2, 30 0)))")
    assert only(import_world(path), "polygon of 4.000 m² at")


def test_a_way_too_long_for_points_close_to_each_other_stays_where_there_is_room() -> None:
    """Its points were 16 m apart, and stretches between them led through walls."""
    turns, pitch = 60, 10.0
    angle = np.linspace(0.0, 2.0 * math.pi * turns, 12_000)
    radius = pitch * (1.0 + angle / (2.0 * math.pi))
    way, outer, inner = (
        (radius - less)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        for less in (4.7, 0.5, 9.0)
    )
    place = shapely.Polygon(np.vstack([outer, inner[::-1]]))
    assert place.is_valid
    area = Outline(place)
    assert not area.crossed([shapely.LineString(smooth(way[50:-50], area, 1.5))]).size


@pytest.mark.parametrize("layer", ["Room", "hall", "bath", "0", ""])
def test_layers_may_have_any_name(tmp_path: Path, layer: str) -> None:
    """As programs that draw write them; those of roles have these."""
    place = shapely.geometry.mapping(shapely.box(0, 0, 24, 14))
    pillar = shapely.geometry.mapping(shapely.box(3, 2, 5, 4))
    path = tmp_path / "plan.geojson"
    features = [
        {"type": "Feature", "properties": {"Layer": name}, "geometry": shape}
        for name, shape in ((layer, place), ("obstacle", pillar))
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    made = import_world(path)
    assert made.world.obstacles is not None
    assert len(made.world.obstacles) == 1


@pytest.mark.parametrize("key", ["name", "id"])
def test_a_name_may_be_the_number_nought(tmp_path: Path, key: str) -> None:
    """As geographic information systems count."""
    features = [("boundary", None, shapely.box(0, 0, 40, 20)),
                ("path", None, shapely.LineString([(2, 5), (36, 5)])),
                *(("robot", k, shapely.box(2, y, 4, y + 1)) for k, y in ((1, 4.5), (0, 14.5))),
                ("path", 0, shapely.LineString([(3, 15), (36, 15)]))]  # fmt: skip
    path = tmp_path / "plan.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [
        {"type": "Feature", "geometry": shapely.geometry.mapping(shape),
         **({"id": name} if key == "id" and role == "robot" else {}),
         "properties": {"role": role, "name": None if key == "id" and role == "robot" else name}}
        for role, name, shape in features]}))  # fmt: skip
    made = import_world(path)
    assert [one.name for one in made.world.robots] == ["1", "0"]
    assert isinstance(made.world.robots[1].path, tuple)
    assert not [one for one in made.changes if "left out" in one]
