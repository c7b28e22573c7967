"""WKT and GeoJSON: what each shape is, places that are united, and what is refused."""

from __future__ import annotations

import json
from math import pi
from pathlib import Path
from typing import Any

import pytest
import shapely

from physim.authoring.importing import ImportSourceError, Options, import_world
from tests.authoring.importing.plans import METRES, check_says
from tests.helpers import inside

read_wkt = inside("physim.authoring.importing", "read_wkt")
read_geojson = inside("physim.authoring.importing", "read_geojson")

ROOM = [[0, 0], [30, 0], [30, 20], [0, 20], [0, 0]]
TABLE = [[5, 5], [9, 5], [9, 9], [5, 9], [5, 5]]
BOW = [[5, 5], [7, 7], [7, 5], [5, 7], [5, 5]]


def feature(kind: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
    shape = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "properties": properties, "geometry": shape}


def collection(*features: Any, **more: Any) -> str:
    return json.dumps({"type": "FeatureCollection", "features": features, **more})


def beside(kind: str, coordinates: Any, **properties: Any) -> str:
    """A feature beside a place."""
    return collection(feature("Polygon", [ROOM], role="place"),
                      feature(kind, coordinates, **properties))  # fmt: skip


def polygon(ring: Any, **more: Any) -> str:
    return json.dumps({"type": "Polygon", "coordinates": [ring], **more})


def read(folder: Path, text: str, options: Options = METRES) -> Any:
    is_json = text.lstrip().startswith(("{", "["))
    path = folder / ("plan.geojson" if is_json else "plan.wkt")
    path.write_text(text)
    return (read_geojson if is_json else read_wkt)(path, options)


def refusal(folder: Path, text: str, options: Options = METRES) -> str:
    with pytest.raises(ImportSourceError) as caught:
        read(folder, text, options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


ROLES: dict[str, tuple[str, list[tuple[str, str]]]] = {
    "a polygon alone": (polygon(ROOM), [("place", "")]),
    "no roles at all": (
        collection(feature("Polygon", [ROOM]), feature("LineString", [[1, 1], [9, 1]])),
        [("place", ""), ("path", "")],
    ),
    "WKT": ("POLYGON ((0 0, 30 0, 30 20, 0 0))\n\nLINESTRING (1 1,\n 9 1) # way\n",
            [("place", ""), ("path", "")]),
    "a name": (beside("LineString", [[1, 1], [9, 1]], role="path", name="ann"),
               [("place", ""), ("path", "ann")]),
    "a layer": (beside("Polygon", [TABLE], Layer="Robot ann"), [("place", ""), ("robot", "ann")]),
    "its role before its layer": (beside("Polygon", [TABLE], role="obstacle", layer="robot"),
                                  [("place", ""), ("obstacle", "")]),
    "lines about the place": (beside("Polygon", [ROOM, TABLE], role="boundary"),
                              [("place", ""), ("boundary", ""), ("boundary", "")]),
    "a wall of a line": (beside("LineString", [[1, 1], [9, 1]], layer="wall_ext"),
                         [("place", ""), ("boundary", "ext")]),
    "a wall of an area": (beside("Polygon", [TABLE], role="wall"),
                          [("place", ""), ("obstacle", "")]),
    "many in one": (beside("MultiPolygon", [[TABLE], [[[20, 9], [22, 9], [22, 11], [20, 9]]]],
                           role="obstacle"), [("place", ""), ("obstacle", ""), ("obstacle", "")]),
}  # fmt: skip


@pytest.mark.parametrize("how", ROLES)
def test_a_property_or_layer_says_the_role(tmp_path: Path, how: str) -> None:
    text, meant = ROLES[how]
    assert [(one.role, one.name) for one in read(tmp_path, text).shapes] == meant


def test_a_heading_is_in_degrees(tmp_path: Path) -> None:
    (robot,) = read(tmp_path, beside("Polygon", [TABLE], role="robot", heading=180)).of("robot")
    assert robot.heading == pytest.approx(pi)


def test_an_obstacle_keeps_its_holes(tmp_path: Path) -> None:
    (wall,) = read(tmp_path, beside("Polygon", [ROOM, TABLE], role="obstacle")).of("obstacle")
    assert wall.geometry.area == 600.0 - 16.0


JUPEDSIM = """GEOMETRYCOLLECTION (POLYGON ((0 0, 10 0, 10 5, 0 5, 0 0)),
 POLYGON ((10.0004 1, 20 1, 20 4, 10.0004 4, 10.0004 1)), POLYGON ((18 3, 25 3, 25 9, 18 9, 18 3)))
"""


def test_places_that_overlap_or_abut_are_one(tmp_path: Path) -> None:
    """As JuPedSim writes a geometry; half a millimetre is left by rounding."""
    drawing = read(tmp_path, JUPEDSIM)
    (whole,) = drawing.of("place")
    assert whole.geometry.area == pytest.approx(50.0 + 30.0 + 42.0 - 2.0, abs=0.01)
    check_says(drawing.facts[-1], "3 polygons united … 1.5 mm … 120.0 m²")
    apart = read(tmp_path, "MULTIPOLYGON (((0 0, 9 0, 9 9, 0 0)), ((9.01 0, 20 0, 20 9, 9.01 0)))")
    assert len(apart.of("place")) == 2


def test_a_world_of_united_places(tmp_path: Path) -> None:
    path = tmp_path / "hall.wkt"
    path.write_text(JUPEDSIM + "LINESTRING (2 2.5, 17 2.5)\n")
    made = import_world(path, Options(robot=(0.6, 0.4)))
    (wall,) = made.world.boundaries or ()
    assert shapely.Polygon(wall).area == pytest.approx(120.0, abs=0.01)


def test_coordinates_of_a_national_grid_are_taken_from_an_origin(tmp_path: Path) -> None:
    for x, y, bounds in ((400_010.0, 5_812_345.5, (10.0, 345.5)), (900_000.0, 10.0, (900_000, 10))):
        ring = [[a + x, b + y] for a, b in ROOM]
        drawing = read(tmp_path, polygon(ring, crs={"name": "EPSG:25832"}), Options())
        assert drawing.shapes[0].geometry.bounds[:2] == bounds
        assert "EPSG:25832" in drawing.facts[1]
        assert ("400000, 5812000" in " ".join(drawing.facts)) == (bounds[0] == 10.0)


def test_what_points_have_beside_their_place_is_told(tmp_path: Path) -> None:
    for kind, said in (("Z", ["heights"]), ("M", ["(M)"]), ("ZM", ["heights", "(M)"])):
        more = " 1" * len(kind)
        text = f"POLYGON {kind} ((0 0{more}, 40 0{more}, 40 20{more}, 0 0{more}))"
        told = " ".join(read(tmp_path, text).changes)
        assert [one for one in ("heights", "(M)") if one in told] == said


def test_a_neck_below_a_millimetre_parts_a_place(tmp_path: Path) -> None:
    neck = "20 0, 20 9.9998, 23 9.9998, 23 0, 42 0, 42 20, 23 20, 23 10.0001, 20 10.0001, 20 20"
    drawing = read(tmp_path, f"POLYGON ((0 0, {neck}, 0 20, 0 0))")
    assert sorted(one.geometry.area for one in drawing.of("place")) == [380.0, 400.0]
    assert "millimetre" in drawing.changes[0]


def test_what_has_no_role_where_others_do_is_asked_about(tmp_path: Path) -> None:
    text = beside("Polygon", [TABLE], name="table", layer="obstacels")
    check_says(refusal(tmp_path, text), 'feature 2 "table" … "obstacels"; did you mean "obstacles"?'
               ' … --ignore "table" … --ignore-others')  # fmt: skip
    for options in ({"ignore": ("obstacels",)}, {"ignore_others": True}):
        assert len(read(tmp_path, text, METRES.changed(**options)).shapes) == 1


DEGREES = [[13.4049, 52.52], [13.4052, 52.52], [13.4052, 52.5201], [13.4049, 52.52]]
CRS = {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}
FAULTS = {
    "degrees": (polygon(DEGREES), "180 by 90 units: degrees? … ogr2ogr … --scale 1 if metres"),
    "a crs": (polygon(ROOM, crs=CRS), "180 by 90 … CRS84 … degrees?"),
    "a crs of its own": (
        json.dumps({"type": "Feature", "geometry": json.loads(polygon(ROOM, crs=CRS))}),
        "feature 1: … crs of its own",
    ),
    "srid": ("SRID=4326;POLYGON ((13 52, 14 52, 14 53, 13 52))", "SRID=4326 … degrees?"),
    "nul": ("POLYGON ((0 0, 9 0, 9 9, 0 0))\0 oops (", ":1: … NUL"),
    "a key twice": (
        polygon(ROOM).replace('"coordinates"', '"coordinates": [], "coordinates"'),
        '"coordinates" twice',
    ),
    "cut JSON": (polygon(ROOM)[:-5], ":1: … JSON"),
    "not a number": (polygon(ROOM).replace("20", "NaN"), "NaN … finite"),
    "too large": (polygon(ROOM).replace("20", "1e999"), "feature 1: … finite"),
    "a list": ("[1]", 'GeoJSON … "type"'),
    "a flag": (polygon([[0, True], *ROOM]), 'feature 1: … "Polygon" … [x, y]'),
    "null": (polygon([[0, None], *ROOM]), '"Polygon" … [x, y]'),
    "role": (beside("Polygon", [TABLE], role="obsacle"),
             'feature 2: role: "obsacle" … place, boundary, obstacle, path, robot … "obstacle"'),
    "a role by another property": (
        collection(feature("Polygon", [ROOM], type="place"),
                   feature("Polygon", [TABLE], type="obstacle")),
        '2 shapes without a role: feature 1, feature 2; … property "role"',
    ),
    "a role by its name": (
        beside("LineString", [[1, 1], [9, 1]], name="path"),
        'feature 2 "path"; give it the property "role": place, boundary, obstacle, path or robot, ',
    ),
    "a place within another": (
        collection(feature("Polygon", [ROOM]), feature("Polygon", [TABLE], name="table")),
        'feature 2 "table": lies within the place of feature 1; … property "role"',
    ),
    "a place within another, WKT": (
        "POLYGON ((0 0, 30 0, 30 20, 0 0))\nPOLYGON ((9 1, 20 1, 20 2, 9 1))",
        ":2: … within … line 1; … a hole",
    ),
    "an open ring": ("POLYGON ((0 0, 30 0, 30 10, 0 10))", ":1: … repeat the first point"),
    "heading": (beside("Polygon", [TABLE], role="robot", heading="north"), "heading … degrees"),
    "an obstacle of a line": (beside("LineString", ROOM, role="obstacle"),
                              'feature 2: … LineString … "obstacle" … Polygon'),
    "a path of an area": (beside("Polygon", [TABLE], role="path"), '"path" … LineString'),
    "a robot with a hole": (beside("Polygon", [ROOM, TABLE], role="robot"), "one outline"),
    "crosses itself": (beside("Polygon", [BOW], role="obstacle"),
                       "feature 2: … self-intersection at (6.00, 6.00)"),
    "a hole at the outline": (json.dumps({"type": "Polygon", "coordinates": [
        ROOM, [[0, 8], [2, 8], [2, 10], [0, 10], [0, 8]]]}), "self-intersection at (0.00, 10.00)"),
    "nothing": (collection(), "no polygon"),
    "nothing to ignore": (polygon(ROOM), "--ignore", {"ignore": ("table",)}),
    "deep JSON": ('{"type":"Feature","geometry":' * 5000 + "1" + "}" * 5000, "nested"),
    "a comma": ("POLYGON ((0 0, 30 0, 30 10, 0 10 0 0))", ":1: … not valid WKT"),
    "a bracket": ("POLYGON ((0 0, 30 0, 30 10, 0 10, 0 0)\nLINESTRING (2 5, 9 5)\n",
                  ":1: … 3 opening and 2 closing"),
    "a word": ("POLIGON ((0 0, 30 0, 30 10, 0 0))", ":1: … WKT … 'POLIGON'"),
    "a line alone": ("LINESTRING (0 0, 10 0)", "no polygon … where robots may go"),
    "no geometry": ("# none\n", "holds no geometry"),
    "thin": ("POLYGON ((0 0, 10 0, 10 1e-4, 0 0))", "no area to the millimetre"),
    "far": ("POLYGON ((0 0, 1e9 0, 1e9 1e9, 0 0))", "1e+09 m … --scale"),
    "deep WKT": ("GEOMETRYCOLLECTION(" * 500 + "POINT(0 0)" + ")" * 500, "nested … 20"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_refusal_says_what_is_wrong_and_where(tmp_path: Path, name: str) -> None:
    text, message, *options = FAULTS[name]
    check_says(refusal(tmp_path, text, Options(**(options[0] if options else {}))), message)
