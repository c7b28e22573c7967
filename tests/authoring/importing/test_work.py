"""Bounds on the work of an import: what is beyond one is refused before the work is done."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from physim.authoring.importing import Options
from tests.authoring.importing.plans import METRES, check_says, geojson, map_yaml, pgm, refusal, svg

BLANKS = " " * 100_000
TEXTS = {
    "points.csv": ("".join(f"{k},0,3,3\n" for k in range(15_001)), "15000 points"),
    "lines.csv": ("0,0,3,3\n1,0,3,3\n" + "\n" * 300_001, "lines"),
    "row.csv": ("0,0,3,3\n" + "1" * 1_000_000, ":2: … 1 values in 4 columns"),
    "lists.geojson": ('{"type":"LineString","coordinates":[' + "[],\n" * 1_000_001 + "]}", ""),
    "crs.geojson": ('{"type":"Polygon","crs":"' + "epsg" * 100_000 + '","coordinates":[]}', ""),
    "srid.wkt": (f"SRID=1{BLANKS}(\nPOLYGON ((0 0, 9 0, 9 9, 0 0))", ""),
    "comments.xml": ("<!-- a -->\n" * 60 + "<foo/>", ""),
    "brackets.svg": ("<!DOCTYPE svg" + "[" * 100_000, ""),
    "length.svg": (svg(f'<rect id="wall" x="1{BLANKS}y" width="9" height="9"/>'), ""),
    "unit.svg": (svg("", f'width="1{"v" * 100_000}%"'), ""),
    "view.svg": (svg("", f'viewBox="0{BLANKS}0{BLANKS}0{BLANKS}x"'), ""),
    "declared.svg": ("<?xml " + 'encoding="x" ' * 80_000, ""),
}  # fmt: skip


@pytest.mark.parametrize("name", TEXTS)
def test_texts_that_go_on_for_long_are_refused_in_their_length(tmp_path: Path, name: str) -> None:
    """Minutes, or for ever, where each character is looked at anew from each before it."""
    text, told = TEXTS[name]
    path = tmp_path / name
    path.write_text(text)
    said = refusal(path, Options())
    assert len(said) < 2_000
    if told:
        check_says(said, told)


def circle(count: int) -> np.ndarray:
    turn = 2.0 * np.pi * np.arange(count) / count
    return 100.0 * np.stack((np.cos(turn), np.sin(turn)), axis=1)


ZIGZAG = [(0.001 * (k * 389 % 997), 20.0 * (k % 2)) for k in range(1000)]
TEETH = [(0.05 * k, 20.0 * (k % 2)) for k in range(12_000)]
LINES = {
    "points": ([("boundary", shapely.Polygon(circle(50_001)))], "50002 points"),
    "extent": ([("boundary", shapely.box(0, 0, 50_001, 9))], "50000 m … --scale"),
    "meetings": ([("wall", shapely.LineString(ZIGZAG))], "over each other"),
    "density": ([("wall", shapely.LineString(TEETH))], "to and fro"),
    "obstacles": (
        [("boundary", shapely.box(-9, -9, 99, 99)),
         *(("obstacle", shapely.box(k / 60, k % 60, k / 60 + 0.01, k % 60 + 0.5))
           for k in range(3600))],
        "3601 obstacles",
    ),
}  # fmt: skip


@pytest.mark.parametrize("bound", LINES)
def test_lines_beyond_a_bound_are_refused(tmp_path: Path, bound: str) -> None:
    parts, told = LINES[bound]
    check_says(refusal(geojson(tmp_path, parts), METRES), told)


@pytest.mark.parametrize(("name", "size"), [("plan.wkt", 20e6), ("map.pgm", 200e6)])
def test_a_file_larger_than_stated_is_not_read(tmp_path: Path, name: str, size: float) -> None:
    with (tmp_path / name).open("wb") as file:
        file.truncate(int(size) + 1)
    (tmp_path / "map.yaml").write_text(map_yaml("map.pgm", 0.1, (0, 0)))
    source = tmp_path / ("map.yaml" if name == "map.pgm" else name)
    check_says(refusal(source, Options()), f"at most {size / 1e6:.0f} MB")


def test_noise_is_no_map(tmp_path: Path) -> None:
    """A map of 300 x 300 cells took 41 s, and was refused then."""
    free = np.ones((113, 113), bool)
    free[1::2, 1::2] = False
    (tmp_path / "map.pgm").write_bytes(pgm(np.where(free, 254, 0)))
    (tmp_path / "map.yaml").write_text(map_yaml("map.pgm", 1.0, (0, 0)))
    told = refusal(tmp_path / "map.yaml", Options(specks=0.0))
    check_says(told, "3136 occupied patches … at most 3000 … --specks")
