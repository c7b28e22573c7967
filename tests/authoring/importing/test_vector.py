"""WKT and GeoJSON: which polygon is the area, what of it is lost, and what is said of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim.authoring.importing import Imported, ImportSourceError, Options, import_world
from tests.authoring.importing.plans import check_says, free_area, geojson, only

ROOM = [[0, 0], [30, 0], [30, 20], [0, 20], [0, 0]]


def polygons(folder: Path, rings: list[Any], crs: str = "") -> Path:
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
    "in the room": [[4, 8], [6, 8], [6, 10], [4, 10], [4, 8]],
}


@pytest.mark.parametrize(("name", "form"), [("at the wall", "geojson"), ("in the room", "wkt")])
def test_a_column_is_solid_wherever_it_stands(tmp_path: Path, name: str, form: str) -> None:
    """One that shares an edge with the outline was lost: robots went through it."""
    path = polygons(tmp_path, [ROOM, COLUMNS[name]])
    if form == "wkt":
        path = tmp_path / "plan.wkt"
        texts = (", ".join(f"{x} {y}" for x, y in ring) for ring in (ROOM, COLUMNS[name]))
        path.write_text("POLYGON (({}), ({}))".format(*texts))
    expected = shapely.Polygon(ROOM).difference(shapely.Polygon(COLUMNS[name]))
    found = room(import_world(path, Options(scale=1.0)))
    assert found.symmetric_difference(expected).area < 1e-6


def test_coordinates_of_a_national_grid_are_taken_from_an_origin(tmp_path: Path) -> None:
    crs = "urn:ogc:def:crs:EPSG::32633"
    imported = import_world(polygons(tmp_path, [moved(ROOM, 400_010.0, 5_812_345.5)], crs))
    check_says(" ".join(imported.facts), f"crs, {crs} … origin … 400000, 5812000")
    assert room(imported).bounds == (10.0, 345.5, 40.0, 365.5)
    near = import_world(polygons(tmp_path, [moved(ROOM, 900_000.0, 10.0)], "EPSG:3857"))
    assert room(near).bounds[0] == 900_000.0  # what can be had as it is stays so
    track = tmp_path / "track.csv"
    track.write_text("".join(f"{500_000 + x},5400123,4,4\n" for x in range(30)))
    imported = import_world(track)
    check_says(" ".join(imported.facts), "origin … 500000, 5400000")
    walls = shapely.MultiLineString(list(imported.world.boundaries or ()))
    assert walls.bounds == pytest.approx((0.0, 119.0, 29.0, 127.0))


DEGREES = [[-100.0, 30.0], [-70.0, 30.0], [-70.0, 50.0], [-100.0, 50.0], [-100.0, 30.0]]


def test_degrees_of_every_system_are_refused(tmp_path: Path) -> None:
    """Those of two systems alone were; the others became metres in silence."""
    code, wkt = 7844, tmp_path / "plan.wkt"
    wkt.write_text(f"SRID={code};POLYGON((" + ", ".join(f"{x:g} {y:g}" for x, y in DEGREES) + "))")
    for name in ("", f"urn:ogc:def:crs:EPSG:6.9:{code}"):
        path = polygons(tmp_path, [DEGREES], name) if name else wkt
        with pytest.raises(ImportSourceError) as caught:
            import_world(path, Options())
        check_says(str(caught.value), "degrees … --scale 1 if these are metres")
        assert room(import_world(path, Options(scale=1.0))).area == pytest.approx(600.0)


def test_a_geometry_goes_over_lines_until_its_brackets_are_closed(tmp_path: Path) -> None:
    path = tmp_path / "plan.wkt"
    path.write_text(
        "GEOMETRYCOLLECTION (\nPOLYGON ((0 0, 40 0,\n40 20, 0 20, 0 0)),\n"
        "LINESTRING (3 10, 37 10)\n)\n"
    )
    imported = import_world(path)
    assert np.array(imported.world.reference_path)[:, 1].tolist() == [10.0, 10.0]


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


def test_of_several_polygons_that_with_the_robots_is_taken(tmp_path: Path) -> None:
    """Though another one is larger."""
    shapes = {"boundary": ((0, 0, 40, 20), (50, 0, 74, 9)), "robot": ((53, 4, 54.8, 5),)}
    features = [
        {
            "type": "Feature",
            "properties": {"role": role},
            "geometry": shapely.geometry.mapping(shapely.box(*corners)),
        }
        for role, boxes in shapes.items()
        for corners in boxes
    ]
    path = tmp_path / "p.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    imported = import_world(path)
    check_says(only(imported, "polygon of"), "800.000 m² … left out")
    assert [robot.pose[:2] for robot in imported.world.robots] == [(53.9, 4.5)]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("2 5, 40 5", "leaves … (30.00, 5.00) … 10.00 m after … left out"),
        ("-5 5, 28 5", "enters … (0.00, 5.00) … 5.00 m before … left out"),
    ],
)
def test_a_path_that_leaves_the_area_is_cut_before_robots_are_sized(
    line: str, told: str, tmp_path: Path
) -> None:
    path = tmp_path / "p.wkt"
    path.write_text(f"POLYGON ((0 0, 30 0, 30 10, 0 10, 0 0))\nLINESTRING ({line})\n")
    imported = import_world(path, Options(robots=3))
    check_says(only(imported, "the area at"), told)
    footprint: Any = imported.world.robots[0].footprint
    assert (footprint.length, footprint.width) == (1.8, 1.0)
    path.write_text("POLYGON ((0 0, 30 0, 30 10, 0 10, 0 0))\nLINESTRING (2 5, 60 5)\n")
    with pytest.raises(
        ImportSourceError, match=r"the path leaves the area at \(30\.[01]\d, 5\.00\)"
    ):
        import_world(path)


@pytest.mark.parametrize("layer", ["Walls", "wall_ext"])
def test_layers_are_roles_in_the_plural_too(tmp_path: Path, layer: str) -> None:
    path = geojson(tmp_path, [("boundary", shapely.box(0, 0, 24, 14)),
                              ("wall", shapely.LineString([(12, 0), (12, 6)]))])  # fmt: skip
    text = path.read_text().replace('{"role": "wall", ', f'{{"role": "", "Layer": "{layer}", ')
    assert layer in text
    path.write_text(text)
    made = import_world(path)
    assert made.world.boundaries is not None
    assert sorted(map(len, made.world.boundaries)) == [2, 5]


@pytest.mark.deep
def test_a_hole_of_very_many_corners_is_no_place(tmp_path: Path) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 2001, endpoint=False)
    hole = 44.0 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    road = shapely.Polygon(shapely.Point(0, 0).buffer(50.0, 64).exterior, [hole])
    path = tmp_path / "road.wkt"
    path.write_text(road.wkt)
    assert free_area(import_world(path), tmp_path) == pytest.approx(road.area, rel=1e-3)
