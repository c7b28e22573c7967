"""Sources that cannot be imported: one message that says what, where and what to do."""

from __future__ import annotations

import json
import os
import struct
import zlib
from itertools import pairwise
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from physim.authoring.importing import ImportSourceError, Options, import_world, importing
from physim.errors import PhysimError, WorldError
from tests.helpers import facts, inside
from tests.importing.plans import SAMPLES, check_says, map_yaml, pgm, svg
from tests.importing.test_joining import geojson

shipped_folder = inside("physim.world.file", "shipped_folder")

HEADER = "# x_m,y_m,w_tr_right_m,w_tr_left_m\n"
ROUND = np.linspace(0.0, 6.28, 200)
ROWS = "".join(f"{x},0,3,3\n" for x in range(0, 40, 2))


def refusal(path: Path, options: Options | None = None) -> str:
    with pytest.raises(PhysimError) as caught:
        import_world(path, options)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(str(path))
    return message.removeprefix(str(path))


TRACKS = {
    "nan": (HEADER + "0,0,3,3\n5,nan,3,3\n", ":3: … y_m … nan"),
    "infinite": (HEADER + "0,0,3,3\n5,0,inf,3\n", ":3: … w_tr_right_m … inf"),
    "negative width": (HEADER + "0,0,3,3\n5,0,3,-1\n", ":3: … w_tr_left_m … -1 m … 0"),
    "no width": (HEADER + "0,0,0,3\n5,0,3,1\n", ":2: … w_tr_right_m … 0 m"),
    "text": (HEADER + "0,0,3,3\n5,zero,3,3\n", ':3: … y_m … "zero" … number'),
    "underscore": (HEADER + "0,0,3,3\n5,1_0,3,3\n", ":3: … y_m … nan"),
    "cut row": (HEADER + "0,0,3,3\n5,0\n", ":3: … 2 values … 4"),
    "decimal comma": ("0,5;0;3;3\n1;0;3;3\n", ":1: … comma … point"),
    "decimal commas below names": (
        HEADER + "10,0,20,5,3,5,3,5\n",
        ":2: … 8 values in 4 columns … decimal comma … point",
    ),
    "a value without end": ("0,0,3,3\n" + "1" * 140_000 + ",0,3,3\n", ":2: … none of a table"),
    "a fifth value": ("0,0,3,3\n5,0,3,3,x\n", ":2: … 5 values in 4 columns"),
    "spaces": ("0 0 3 3\n1 0 3 3\n", ":1: … spaces … commas"),
    "other columns": (
        "# s_m; x_m; y_m; psi_rad\n0;0;0;0\n",
        ":1: … w_tr_right_m … s_m, x_m, y_m, psi_rad",
    ),
    "two columns": ("0,0\n1,0\n", ":1: … 2 columns … 4 … x_m, y_m, w_tr_right_m, w_tr_left_m"),
    "empty": ("", "begins with a number … x_m, y_m, w_tr_right_m, w_tr_left_m"),
    "one point": (HEADER + "0,0,3,3\n", "1 points … 2"),
    "far away": (HEADER + "0,0,3,3\n5e6,0,3,3\n", ":3: … x_m … 5e+06 m … 1e+06 m … --scale"),
    "a point of a grid left at 0": (
        HEADER + "500000,5400000,3,3\n500009,5400000,3,3\n0,0,3,3\n500018,5400000,3,3\n",
        ":4: … y_m … 0 m … 5.4e+06 m … 1e+06 m … check it",
    ),
    "words below": (HEADER + ROWS + "the end\n", ':22: … "the end" … numbers'),
    "other names": (
        "x,y,width_left,width_right\n0,0,2,3\n10,0,2,3\n",
        ":1: … no column x_m … x, y, width_left, width_right … rename x to x_m … y to y_m … "
        "width_right to w_tr_right_m … width_left to w_tr_left_m",
    ),
    "other names, commented": ("# by hand\n# x,y,left,right\n0,0,2,3\n", ":2: … no column x_m"),
    "other names, semicolons": ("x;y;width_left;width_right\n0;0;2;3\n", ":1: … no column x_m"),
    "fewer names": ("# x, y, width\n0,0,2,3\n9,0,2,3\n", ":1: … no column x_m … x, y, width"),
    "units": (
        "# X [m], Y [m], right (m), left (m)\n0,0,2,3\n9,0,2,3\n",
        "x [m] to x_m … y [m] to y_m",
    ),
    "words": ("# north,east,a,b\n0,0,2,3\n9,0,2,3\n", ":1: … no column x_m … north, east, a, b"),
    "misspelt": ("x_m,y_m,w_tr_right_m,w_tr_lft_m\n0,0,2,3\n", "w_tr_lft_m to w_tr_left_m"),
    "a title": ("Monza\n# x_m,y_m,w_tr_right_m,w_tr_left_m\n0,0,2,3\n", ':1: … "Monza" … #'),
    "figure of eight": (
        HEADER + "".join(f"{np.sin(a) * 30},{np.sin(2 * a) * 15},2,2\n" for a in ROUND),
        "edge crosses itself at … noisy … smoothed or thinned",
    ),
}


@pytest.mark.parametrize("name", TRACKS)
def test_tracks(tmp_path: Path, name: str) -> None:
    text, message = TRACKS[name]
    path = tmp_path / "t.csv"
    path.write_text(text)
    check_says(refusal(path), message)


def huge_png(width: int, height: int) -> bytes:
    """A PNG that says it is that large, and holds next to nothing."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return (
            struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        )

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    body = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"\0")) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def maps() -> dict[str, tuple[str, bytes | None, str]]:
    good = pgm(np.full((40, 60), 254))
    png = cv2.imencode(".png", np.random.default_rng(1).integers(0, 255, (40, 60)))[1].tobytes()
    yaml = map_yaml("map.pgm", 0.05, (0, 0))
    return {
        "missing image": (yaml.replace("map.pgm", "mop.pgm"), good, ':1: … image: … "mop.pgm"'),
        "nearest image": (yaml.replace("map.pgm", "mop.pgm"), good, '"mop.pgm" … "map.pgm"'),
        "escape": (
            yaml.replace("map.pgm", "../../etc/passwd"),
            good,
            ':1: … image: … "../../etc/passwd" … outside the folder',
        ),
        "absolute": (
            yaml.replace("map.pgm", "/etc/passwd"),
            good,
            'image: … "/etc/passwd" … outside the folder',
        ),
        "no image": (
            yaml.replace("image: map.pgm\n", ""),
            good,
            ":1: … image: missing … image, resolution, origin",
        ),
        "misspelt": (yaml.replace("resolution", "resolutoin"), good, ":2: … resolution: missing"),
        "nearest key": (yaml.replace("resolution", "resolutoin"), good, '"resolutoin"'),
        "resolution": (
            yaml.replace("0.05", "0.0"),
            good,
            ":2: … resolution: … 0 m … 1e-6 to 1000",
        ),
        "text": (
            yaml.replace("resolution: 0.05", "resolution: five"),
            good,
            ':2: … resolution: … "five" … number',
        ),
        "origin": (yaml.replace("[0.0, 0.0, 0.0]", "0.0"), good, ":3: … origin: … [x, y, yaw]"),
        "negate": (
            yaml.replace("negate: 0", "negate: maybe"),
            good,
            ':4: … negate: … 0 or 1 … "maybe"',
        ),
        "thresholds": (
            yaml.replace("0.196", "0.9"),
            good,
            ":6: … free_thresh: … 0.9 … occupied_thresh … 0.65",
        ),
        "share": (yaml.replace("0.65", "65.0"), good, ":5: … occupied_thresh: … 65 … 0 to 1"),
        "mode": (yaml + "mode: binary\n", good, ':7: … mode: … trinary, scale, raw … "binary"'),
        "nan": (yaml.replace("0.65", ".nan"), good, ":5:18: … occupied_thresh: … .nan"),
        "duplicate": (yaml + "negate: 1\n", good, ":7:1: … negate: … twice"),
        "a list": ("- image: map.pgm\n", good, ":1: … mapping of keys … image, resolution, origin"),
        "empty": ("", good, ":1: … empty"),
        "no YAML": ("image: [", good, "YAML"),
        "tag": ("image: !!python/object/apply:os.system [ls]\n", good, "tag"),
        "not an image": (yaml, b"hello", "map.pgm: … P2, P5 … PNG"),
        "cut PGM": (yaml, good[:-1], "map.pgm: … cut short … 2399 of 2400 pixels"),
        "cut plain PGM": (
            yaml,
            pgm(np.full((4, 6), 254), True)[:-4],
            "cut short … 23 of 24 pixels",
        ),
        "header": (yaml, b"P5\n60 forty\n255\n", 'header: … height … "forty"'),
        "header only": (yaml, b"P5\n60", "header: … height … nothing"),
        "huge PGM": (yaml, b"P5\n100000 100000\n255\n", "100000 x 100000 pixels … 50 000 000"),
        "wide PGM": (yaml, b"P5\n1000001 1\n255\n" + b"\0" * 1_000_001, "at most 1000000 a side"),
        "huge PNG": (yaml, huge_png(100_000, 100_000), "100000 x 100000 pixels"),
        "cut PNG": (yaml, png[: len(png) // 2], "cut short … PNG"),
        "damaged PNG": (yaml, png[:60] + b"X" + png[61:], "check sum … PNG"),
        "nothing free": (yaml, pgm(np.zeros((40, 60))), "no cell … free … negate … free_thresh"),
        "an image for a folder": (yaml.replace("map.pgm", "."), good, "is a folder"),
    }


MAPS = maps()


@pytest.mark.parametrize("name", MAPS)
def test_maps(tmp_path: Path, name: str) -> None:
    text, image, message = MAPS[name]
    path = tmp_path / "map.yaml"
    path.write_text(text)
    if image is not None:
        (tmp_path / "map.pgm").write_bytes(image)
    with pytest.raises(PhysimError) as caught:
        import_world(path)
    check_says(str(caught.value), message)
    assert "\n" not in str(caught.value)


def test_a_damaged_image_is_one_message_and_no_line_of_a_decoder(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Its check sums are right, so that the decoder is the one to find it."""
    size = struct.pack(">IIBBBBB", 60, 40, 8, 0, 0, 0, 0)
    parts = ((b"IHDR", size), (b"IDAT", b"no pixels"), (b"IEND", b""))
    chunks = (
        struct.pack(">I", len(b)) + k + b + struct.pack(">I", zlib.crc32(k + b)) for k, b in parts
    )
    (tmp_path / "map.png").write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(chunks))
    (tmp_path / "map.yaml").write_text(map_yaml("map.png", 0.05, (0, 0)))
    with pytest.raises(PhysimError, match="damaged"):
        import_world(tmp_path / "map.yaml")
    assert capfd.readouterr().err == ""
    os.write(2, b"heard again")
    assert capfd.readouterr().err == "heard again"


def test_a_link_out_of_the_folder_is_no_way_out(tmp_path: Path) -> None:
    folder = tmp_path / "maps"
    folder.mkdir()
    (tmp_path / "secret.pgm").write_bytes(pgm(np.full((40, 60), 254)))
    (folder / "map.pgm").symlink_to(tmp_path / "secret.pgm")
    (folder / "map.yaml").write_text(map_yaml("map.pgm", 0.05, (0, 0)))
    check_says(refusal(folder / "map.yaml"), "image: … outside the folder")


BILLION = (
    '<?xml version="1.0"?>\n<!DOCTYPE svg [\n<!ENTITY a "aaaaaaaaaa">\n'
    + "".join(f'<!ENTITY {b} "{f"&{a};" * 10}">\n' for a, b in pairwise("abcdefghi"))
    + ']>\n<svg xmlns="http://www.w3.org/2000/svg">&i;</svg>'
)  # fmt: skip
DOUBLING = "".join(
    f'<g id="g{k}"><use href="#g{k - 1}"/><use href="#g{k - 1}"/></g>' for k in range(1, 40)
)


def turned(transform: str) -> str:
    """A drawing with a wall in a group of this transform."""
    return svg(f'<g id="wall" transform="{transform}"><path d="M0,0H9"/></g>')


DRAWINGS = {
    "entity bomb": (BILLION, ":3: … XML entity"),
    "external entity": (
        '<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>\n<svg>&x;</svg>',
        ":1: … XML entity",
    ),
    "copies of copies": (svg(f'<path id="g0" d="M 0,0 1,1"/>{DOUBLING}'), "more than 100000"),
    "copies itself": (svg('<g id="a"><use href="#a"/></g>'), '"a" … itself … use'),
    "copy from outside": (
        svg('<use href="other.svg#a"/>'),
        ':2: … "other.svg#a" … outside the file',
    ),
    "an entity that is told elsewhere": (
        '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "svg11.dtd">\n<!-- &nbsp; -->\n'
        + svg('<rect id="boundary" x="6&foo;0" width="9" height="9"/>'),
        ":4: … XML entity &foo;",
    ),
    "an entity of a document type": (
        "<!DOCTYPE svg [\n%x;]>\n" + svg('<rect id="boundary" width="9" height="9"/>'),
        "XML entity … %x;",
    ),
    "not XML": ("<svg><path</svg>", ":1: … XML"),
    "not SVG": ("<html></html>", ":1: … <html> … <svg>"),
    "deep": (svg("<g>" * 3000 + "</g>" * 3000), ":2: … groups … ungroup"),
    "path data": (svg('<path id="boundary" d="M 0,0 L garbage"/>'), ':2: … path data … "garbage"'),
    "path data without a start": (svg('<path id="boundary" d="L 5,5 6,9"/>'), ":2: … begin with M"),
    "path data of a close": (svg('<path id="boundary" d="Z L 5,5 6,9"/>'), ":2: … begin with M"),
    "path data of curves": (svg('<path id="boundary" d="t 5,5 6,9"/>'), ":2: … begin with M"),
    "path data of numbers": (svg('<path id="boundary" d="M 1e1e1 5"/>'), ':2: … data … "e1 5"'),
    "rotation": (
        svg('<path id="boundary" d="M 0,0 1,1" transform="scale(2) rotate(30,120)"/>'),
        ':2: … transform: … "rotate(30,120)" … 2 … 1 or 3',
    ),
    "turning": (
        svg('<g id="wall" transform="turn(30)"><path d="M0,0H9"/></g>'),
        ':2: … transform: … "turn(30)" … matrix',
    ),
    "degrees": (
        svg('<g id="wall" transform="rotate(30°)"><path d="M0,0H9"/></g>'),
        ':2: … transform: … "rotate(30°)" … numbers',
    ),
    "stray sign": (svg('<polygon id="path" points="1,1 4,1 4 4 - 5 6"/>'), ':2: … points: "- 5'),
    "two commas": (svg('<polygon id="path" points="1,1,,4,1 4,4"/>'), ':2: … points: ",,4'),
    "unclosed": (
        svg('<g id="wall" transform="rotate(30"><path d="M0,0H9"/></g>'),
        ':2: … transform: … "rotate(30"',
    ),
    **{
        f"comma {k}": (svg(f'<path id="boundary" d="{text}"/>'), ":2: … path data … comma")
        for k, text in enumerate(
            (
                "M20 20,,h90v90z",
                "M,20 20h90v90z",
                "M20,,20h90v90z",
                "M20 20h90v90 h,-20z",
                "M20 20h90v90z,m0 100h30v30z",
                "M20 20a20,20,0,,0,1,50,50",
                "M2 2 4 4,",
            )
        )
    },
    "a radius near to 0, in full": (
        svg(f'<path id="boundary" d="M50 50A0.{"0" * 60}1 1 0 0 1 70 50z"/>'),
        ":2: … data … 0",
    ),
    "a radius near to 0": (
        svg('<path id="boundary" d="M50 50A1e-200 1e-200 0 0 1 70 50z"/>'),
        ':2: … "1e-200" … 0',
    ),
    "beyond numbers": (svg('<path id="boundary" d="M 0,0 L 1e999,3 L 4,4 Z"/>'), '"1e999" … large'),
    "no boundary": (svg('<path id="fence" d="M 0,0 24,0 24,14 Z"/>'), "no line is a boundary"),
    "open boundary": (
        svg('<path id="boundary" d="M 0,0 24,0 24,14"/>'),
        "the boundaries enclose no area",
    ),
    "one wall in two pieces, with a gap": (
        svg('<path id="boundary" d="M 0,0 24,0 24,6 M 24,7 24,14 0,14 0,0"/>'),
        ":2: … the boundaries enclose no area … (24.00, 8.00) and (24.00, 7.00) … 1 m apart",
    ),
    "no units": (
        svg('<path id="boundary" d="M 0,0 24,0 24,14 Z"/>', 'width="240" height="140"'),
        ":1: … units … --scale",
    ),
    "path outside": (
        svg(
            '<path id="boundary" d="M 0,0 24,0 24,14 Z"/><path id="path" d="M 0,20 24,20"/>',
            'width="24000mm" height="14000mm" viewBox="0 0 24 14"',
        ),
        "no area … contains the path",
    ),
    "too small": (svg('<path id="boundary" d="M 0,0 24,0 24,14 Z"/>'), "0.24 x 0.14 m … --scale"),
}


UNSCALED = ("beyond numbers", "open boundary", "one wall in two pieces, with a gap")


@pytest.mark.parametrize("name", DRAWINGS)
def test_drawings(tmp_path: Path, name: str) -> None:
    text, message = DRAWINGS[name]
    path = tmp_path / "d.svg"
    path.write_text(text)
    scale = 1.0 if name in UNSCALED else None
    check_says(refusal(path, Options(scale=scale)), message)


SQUARE = [[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]
DEGREES = [[13.4049, 52.52], [13.4052, 52.52], [13.4052, 52.5201], [13.4049, 52.52]]


def polygon(ring: Any, **more: Any) -> str:
    return json.dumps({"type": "Polygon", "coordinates": [ring], **more})


def featured(kind: str, coordinates: Any, **properties: Any) -> str:
    """Feature beside a square place."""
    shapes = [{"type": "Polygon", "coordinates": [SQUARE]},
              {"type": kind, "coordinates": coordinates}]  # fmt: skip
    features = [
        {"type": "Feature", "properties": about, "geometry": shape}
        for about, shape in zip(({}, properties), shapes, strict=True)
    ]
    return json.dumps({"type": "FeatureCollection", "features": features})


POLYGONS = {
    "degrees.geojson": (polygon(DEGREES), "degrees … ogr2ogr"),
    "crs.geojson": (
        polygon(SQUARE, crs={"type": "name", "properties": {"name": "OGC:1.3:CRS84"}}),
        "degrees … crs",
    ),
    "escaped.geojson": (
        polygon(SQUARE, crs={"type": "name", "properties": {"name": "EPSG::4326\x1b"}}),
        "degrees … crs",
    ),
    "numbered.geojson": (
        polygon(SQUARE, crs={"properties": {"code": 4326}, "type": "EPSG"}),
        "degrees … crs",
    ),
    **{
        f"{name.replace(' ', '-')}.geojson": (
            polygon(SQUARE, crs={"type": "name", "properties": {"name": name}}),
            "degrees … crs",
        )
        for name in ("WGS 84", "wgs1984", "+proj=longlat +datum=WGS84", "+proj=latlong")
    },
    **{
        f"{k}.geojson": (polygon(SQUARE, crs={"properties": about}), "degrees … crs")
        for k, about in enumerate(
            (
                {"name": "EPSG:4326+EPSG:3855"},
                {"name": "NAD83"},
                {"name": "ESRI:104305"},
                {"href": "http://spatialreference.org/ref/epsg/4326/proj4/", "type": "proj4"},
            )
        )
    },
    "digits.geojson": (polygon(SQUARE, crs=4326), "degrees … crs"),
    "zeros.wkt": (
        "SRID=0000000004326;POLYGON ((0 0, 9 0, 9 9, 0 0))",
        ":1: … degrees … 0000000004326",
    ),
    "nul.wkt": ("POLYGON ((0 0, 9 0, 9 9, 0 0))\0 oops (", ":1: … NUL"),
    "own.geojson": (
        json.dumps(
            {"type": "Feature", "geometry": {**json.loads(polygon(SQUARE)), "crs": {"name": "x"}}}
        ),
        "crs of its own … the file",
    ),
    "twice.geojson": (
        polygon(SQUARE).replace('"coordinates"', '"coordinates": [], "coordinates"'),
        '"Polygon" … "coordinates" twice',
    ),
    "cut.geojson": (polygon(SQUARE)[:-5], ":1: … JSON"),
    "nan.geojson": (polygon(SQUARE).replace("20", "NaN"), "NaN … finite"),
    "list.geojson": ("[1]", 'GeoJSON … "type"'),
    "kind.geojson": ('{"type": "Circle", "coordinates": [0, 0]}', 'geometry "Circle"'),
    "text.geojson": (polygon("abc"), '"Polygon" … "abc" … number'),
    "quoted.geojson": (polygon([[0, "4"], *SQUARE]), '"Polygon" … "4" … number'),
    "flag.geojson": (polygon([[0, True], *SQUARE]), "true … number … [x, y]"),
    "null.geojson": (polygon([[0, None], *SQUARE]), '"Polygon" … [x, y]'),
    "flat.geojson": (polygon([1, 2, 3]), '"Polygon" … [x, y]'),
    "role.geojson": (
        featured("Polygon", [SQUARE], role="obsacle"),
        'role: … "obsacle" … boundary, wall, obstacle, path, robot … "obstacle"',
    ),
    "number.geojson": (
        featured("Polygon", [SQUARE], role=3),
        'role: … "3" … boundary, wall, obstacle, path, robot',
    ),
    "fence.geojson": (
        featured("LineString", SQUARE, role="obstacle"),
        'LineString … "obstacle" … Polygon',
    ),
    "way.geojson": (featured("Polygon", [SQUARE], role="path"), 'Polygon … "path" … LineString'),
    "none.geojson": ('{"type": "FeatureCollection", "features": []}', "holds no polygon"),
    "features.geojson": ('{"type": "FeatureCollection"}', '"features" … list'),
    "deep.geojson": ('{"type":"Feature","geometry":' * 5000 + "1" + "}" * 5000, "nested"),
    "comma.wkt": (
        "POLYGON ((0 0, 30 0, 30 10, 0 10 0 0))",
        'comma is missing … "0 10 0 0"',
    ),
    "bracket.wkt": (
        "POLYGON ((0 0, 30 0, 30 10, 0 10, 0 0)\nLINESTRING (2 5, 9 5)\n",
        ":1: … bracket is missing … 3 opening, 2 closing … one closing",
    ),
    "curve of lines.wkt": (
        "CURVEPOLYGON (CIRCULARSTRING (0 0, 4 0, 4 4, 0 4, 0 0))",
        "curves … lines",
    ),
    "brackets.wkt": ("POLYGON ((0 0, 30 0, 30 10\n", "bracket is missing … 2 closing more"),
    "word.wkt": ("POLIGON ((0 0, 30 0, 30 10, 0 0))", ":1: … WKT … 'POLIGON'"),
    "line.wkt": ("LINESTRING (0 0, 10 0)", "no polygon … where robots may go"),
    "bad.wkt": ("# comment\nPOLYGON ((0 0, 10 0", ":2: … WKT"),
    "srid.wkt": ("SRID=4326;POLYGON ((13 52, 14 52, 14 53, 13 52))", ":1: … degrees … 4326"),
    "empty.wkt": ("\n", "holds no geometry"),
    "curve.wkt": ("CURVEPOLYGON (CIRCULARSTRING (0 0, 4 0, 4 4, 0 4, 0 0))", ":1:"),
    "thin.wkt": ("POLYGON ((0 0, 10 0, 5 0, 0 0))", "encloses no area"),
    "far.wkt": ("POLYGON ((0 0, 1e9 0, 1e9 1e9, 0 0))", ":1: … 1e+09 m … 1e+06 m"),
    "nan.wkt": ("POLYGON ((0 0, nan 0, 10 10, 0 0))", ":1:"),
    "deep.wkt": ("GEOMETRYCOLLECTION(" * 500 + "POINT(0 0)" + ")" * 500, "nested … 20"),
}


@pytest.mark.parametrize("name", POLYGONS)
def test_polygons(tmp_path: Path, name: str) -> None:
    text, message = POLYGONS[name]
    path = tmp_path / name
    path.write_text(text)
    check_says(refusal(path), message)


FILES = {
    "missing.csv": (None, "no such file"),
    "image.png": (b"\x89PNG", "image … scale … map.yaml"),
    "drawing.svgz": (b"\x1f\x8b", "compressed … unpack"),
    "latin.csv": ("gr\xfc\xdfe,1\n".encode("latin-1"), ":1: … 0xfc … UTF-8"),
    "what.txt": (b"hello", "--format track|ros-map|svg|wkt|geojson"),
}


@pytest.mark.parametrize("name", FILES)
def test_files(tmp_path: Path, name: str) -> None:
    content, message = FILES[name]
    if content is not None:
        (tmp_path / name).write_bytes(content)
    check_says(refusal(tmp_path / name), message)


def test_a_world_is_no_map(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_bytes((shipped_folder() / "straight.yaml").read_bytes())
    check_says(refusal(path), ": is … a world of physim already")


def test_folder_and_pipe(tmp_path: Path) -> None:
    assert ": is a folder" in refusal(tmp_path, Options(format="wkt"))


OPTIONS = {
    "start beyond": (Options(start=1e4), "--start 10000 … 248.1 m"),
    "gap beyond": (Options(gap=200.0), "--gap 200 … more than 0 … half of 248.1 m"),
    "too many": (Options(robots=200), "of 200 robots … 1.8 x 1.0 m … --robots"),
    "too wide": (Options(robot=(9.0, 8.0)), "robot 8 m wide … --robot"),
    "too small": (Options(robot=(1e-9, 1e-9)), "--robot 1e-09,1e-09 … at least 0.001 m"),
    "below a millimetre": (Options(robot=(1.8, 5e-4)), "--robot 1.8,0.0005 … at least 0.001 m"),
    "too thin": (Options(robot=(1.0, 0.001)), "time.step … another --robot LENGTH,WIDTH"),
    "from outside": (Options(origin=(0.0, 0.0)), "--from (0.00, 0.00) … not in the area"),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_options(name: str) -> None:
    options, message = OPTIONS[name]
    check_says(refusal(SAMPLES / "track.csv", options), message)


def test_what_a_place_asked_for_lies_beside_is_told(tmp_path: Path) -> None:
    rooms = [[(0, 0), (30, 0), (30, 20), (0, 20)], [(40, 0), (70, 0), (70, 20), (40, 20)]]
    parts = [("boundary", shapely.Polygon(one)) for one in rooms]
    parts.append(("path", shapely.LineString([(1.5, 10), (28, 10)])))
    message = refusal(geojson(tmp_path, parts), Options(origin=(42.0, 10.0), goal=(68.0, 10.0)))
    check_says(message, "--from (42.00, 10.00) … not in … path of the source")
    made = import_world(geojson(tmp_path, parts[:2]), Options(origin=(42.0, 10.0)))
    assert np.array(made.world.reference_path)[0] == pytest.approx([42.0, 10.0], abs=2.0)


def test_own_paths_of_robots_that_are_left_out_are_told(tmp_path: Path) -> None:
    parts = [("boundary", shapely.box(0, 0, 40, 20))]
    for name, y in (("a", 5.0), ("b", 10.0), ("c", 15.0)):
        parts.append((f"robot {name}", shapely.box(2, y - 0.5, 3.8, y + 0.5)))
        parts.append((f"path {name}", shapely.LineString([(3, y), (37 - y, y)])))
    made = import_world(geojson(tmp_path, parts), Options(robots=2))
    told = [one for one in made.changes if "left out (--robots)" in one]
    names = {"path of a", "path of b", "path of c", "3 robots of the drawing"}
    assert {one.removesuffix(" left out (--robots)") for one in told} == names - {"path of a"}
    assert not [one for one in import_world(geojson(tmp_path, parts)).changes if "--robots" in one]


def test_lanes_beyond_one_of_each_robot_are_told() -> None:
    facts_of = import_world(SAMPLES / "track.csv", Options(robots=2, lanes=5)).facts
    check_says(" ".join(facts_of), "2 robots in 2 lanes … 5 asked for")


SAMPLE_OF = {
    "track": "track.csv",
    "ros-map": "office.yaml",
    "svg": "hall.svg",
    "wkt": "office.wkt",
    "geojson": "office.geojson",
}
USED_BY = {
    "start": (Options(start=5.0), "track", "closed track"),
    "gap": (Options(gap=3.0), "track", "closed track"),
    "open": (Options(open=True), "track", "track"),
    "specks": (Options(specks=4.0), "ros-map", "ROS map"),
    "boundary": (Options(boundary=("a",)), "svg", "SVG drawing"),
}


@pytest.mark.parametrize(
    ("name", "kind"),
    [(name, kind) for name, (_, only, _) in USED_BY.items() for kind in SAMPLE_OF if kind != only],
)
def test_an_option_that_a_kind_of_source_does_not_use_is_refused(name: str, kind: str) -> None:
    options, _, what = USED_BY[name]
    check_says(refusal(SAMPLES / SAMPLE_OF[kind], options), f"--{name} … {what} … {kind}")


@pytest.mark.parametrize("asked", [{"lanes": 2}, {"robot": (1.0, 0.5)}])
def test_drawn_robots_are_neither_ranked_nor_sized(asked: dict[str, Any]) -> None:
    """`--lanes` and `--robot` are of boxes that are placed; in silence they would do nothing."""
    key = next(iter(asked))
    hall = SAMPLES / "hall.svg"
    check_says(refusal(hall, Options(scale=0.1, **asked)), f"--{key} … drawn … --robots N")
    assert import_world(hall, Options(scale=0.1, robots=2, **asked)).world.robots


def test_lines_that_cannot_be_worked_out_are_one_message(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Shapely raises at odd lines, at any of its calls."""
    path = tmp_path / "t.csv"
    path.write_text(HEADER + ROWS)

    def fails(*_: Any) -> None:
        raise shapely.errors.GEOSException("TopologyException: side location conflict at 1 2")

    monkeypatch.setattr(importing, "fit", fails)
    check_says(refusal(path), ": … side location conflict at 1 2 … draw each once")


def test_room_for_none_is_told_without_advice_that_cannot_help(tmp_path: Path) -> None:
    path = tmp_path / "narrow.wkt"
    path.write_text("POLYGON ((0 0, 30 0, 30 1.2, 0 1.2, 0 0))\nLINESTRING (1 0.6, 29 0.6)")
    message = refusal(path, Options(robots=4, robot=(1.8, 1.0)))
    check_says(message, "no room … 1.8 x 1.0 m … --robot LENGTH,WIDTH")
    assert "--lanes" not in message
    assert "--robots" not in message


SOURCES = {
    name: (SAMPLES / name).read_bytes() for name in ("office.wkt", "hall.svg", "office.geojson")
}
SOURCES["short.csv"] = (HEADER + ROWS).encode()


@settings(max_examples=150)
@given(data=st.data())
def test_cut_and_flipped_sources_give_a_world_or_one_message(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    """Never a traceback: only PhysimError leaves the import."""
    name = data.draw(st.sampled_from(sorted(SOURCES)))
    content = bytearray(SOURCES[name])
    if data.draw(st.booleans()):
        content = content[: data.draw(st.integers(0, len(content)))]
    for _ in range(data.draw(st.integers(0, 3))):
        if content:
            content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path_factory.mktemp("broken") / name
    path.write_bytes(bytes(content))
    message = told(path, Options(scale=0.1 if name == "hall.svg" else None))
    assert message is None or (message.startswith(str(path)) and "\n" not in message)


def told(path: Path, options: Options) -> str | None:
    try:
        import_world(path, options)
    except ImportSourceError as error:
        return str(error)
    return None


@pytest.mark.parametrize(("given", "parts"), [
    ({"robots": 0}, ("robots", "at least 1", "0")),
    ({"lanes": -1}, ("lanes", "at least 1", "-1")),
    ({"format": "SVG"}, ("format", "track, ros-map, svg", '"SVG"', '"svg"')),
    ({"specks": -1.0}, ("specks", "at least 0", "-1.0")),
    ({"tolerance": float("nan")}, ("tolerance", "finite", "nan")),
    ({"boundary": "path"}, ("boundary", "list", '"path"')),
    ({"origin": (1.0,)}, ("origin[1]", "missing")),
    ({"scal": 1.0}, ("scal", "unknown", '"scale"')),
])  # fmt: skip
def test_options_from_python_are_looked_at_as_those_of_the_command_line(
    given: dict[str, Any], parts: tuple[str, ...]
) -> None:
    """They ended in tracebacks, or went by in silence."""
    with pytest.raises(WorldError, match=facts(*parts)):
        Options(**given)
    assert Options(robot=[1.2, 0.8]).robot == (1.2, 0.8)  # type: ignore[arg-type]
