"""Bounds on the work of an import: what is beyond one is refused before the work is done."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import svgelements

from physim.authoring.importing import (
    ImportSourceError,
    Options,
    enclosure,
    parts,
    ros_map,
    source,
    svg_guard,
    track_file,
    work,
)
from tests.helpers import inside
from tests.importing.plans import check_says

Drawing, read_geojson = inside("physim.authoring.importing", "Drawing", "read_geojson")
read_wkt, subpaths = inside("physim.authoring.importing", "read_wkt", "subpaths")
look_at, read_track_file = inside("physim.authoring.importing", "look_at", "read_track_file")

PLACE = Path("plan")
RING = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


def circle(count: int, radius: float = 100.0) -> np.ndarray:
    turn = 2.0 * np.pi * np.arange(count) / count
    return radius * np.stack((np.cos(turn), np.sin(turn)), axis=1)


def teeth(count: int) -> np.ndarray:
    """A line that goes up and down, each time a little further on."""
    return np.stack((0.05 * np.arange(count), 20.0 * (np.arange(count) % 2)), axis=1)


def zigzag(count: int) -> np.ndarray:
    """A line that goes up and down through all the places it has been at."""
    k = np.arange(count)
    return np.stack((0.001 * (k * 389 % 997), 20.0 * (k % 2)), axis=1)


LINES = {
    "points": ([circle(work.MOST_POINTS)], [circle(work.MOST_POINTS + 1)], "50001 points"),
    "extent": (
        [np.array([[0.0, 0.0], [work.FARTHEST, 0.0]])],
        [np.array([[0.0, 0.0], [work.FARTHEST + 1.0, 0.0]])],
        "50000 m … --scale",
    ),
    "numbers": ([RING], [RING * np.array([1e308, np.nan])], "largest number … --scale"),
    "meetings": ([zigzag(100)], [zigzag(1000)], "over each other"),
    "density": ([teeth(1000)], [teeth(work.MOST_ACROSS + 3)], "to and fro"),
}


@pytest.mark.parametrize("bound", LINES)
def test_lines_beyond_a_bound_are_refused_and_those_within_are_read(bound: str) -> None:
    within, beyond, told = LINES[bound]
    work.check_work(PLACE, within)
    with pytest.raises(ImportSourceError) as caught:
        work.check_work(PLACE, beyond)
    check_says(str(caught.value), f"plan: … {told}")


def svg(inner: str) -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9">{inner}</svg>'


def nested(depth: int, inside: int) -> str:
    return svg("<g>" * depth + "<path/>" * inside + "</g>" * depth)


def doubled(times: int) -> str:
    """A drawing with an element that is there 2 to the power of so many times by copies."""
    link = "".join(
        f'<g id="g{k}"><use href="#g{k + 1}"/><use href="#g{k + 1}"/></g>' for k in range(times)
    )
    return svg(f'{link}<path id="g{times}"/>')


def chained(length: int) -> str:
    link = "".join(f'<g id="g{k}"><use href="#g{k + 1}"/></g>' for k in range(length))
    return svg(f'<use href="#g0"/><defs>{link}<path id="g{length}"/></defs>')


SVGS = {
    "elements": (svg("<g/>" * 1000), svg("<g/>" * svg_guard.MOST_ELEMENTS), "1: … 100000 elements"),
    "copies written out": (doubled(10), doubled(20), "100000 elements, copies written out"),
    "copies of copies": (
        chained(svg_guard.MOST_COPIES // 2), chained(svg_guard.MOST_COPIES + 10), "copies",
    ),
    "nested": (nested(150, 1000), nested(150, 14_000), "1: … groups within each other"),
    "numbers": (
        svg(f'<path d="M{" 1" * 1000}"/>'),
        svg(f'<path d="M{" 1" * (svg_guard.MOST_NUMBERS + 1)}"/>'),
        "300000 numbers",
    ),
}  # fmt: skip


@pytest.mark.parametrize("bound", SVGS)
def test_drawings_beyond_a_bound_are_refused_before_they_are_read(bound: str) -> None:
    within, beyond, told = SVGS[bound]
    look_at(PLACE, within)
    with pytest.raises(ImportSourceError) as caught:
        look_at(PLACE, beyond)
    check_says(str(caught.value), f"plan: … {told}")


def test_curves_make_no_more_points_than_are_read() -> None:
    path = svgelements.Path("M0 0 L1 0 L2 0 L3 0 L4 0")
    assert len(subpaths(path, 0.1, 4)[0][0]) == 5
    with pytest.raises(ValueError, match="points up to here"):
        subpaths(path, 0.1, 3)


def test_no_more_geometries_are_read_than_stated(tmp_path: Path) -> None:
    count = parts.MOST_GEOMETRIES + 1
    wkt, geojson = tmp_path / "a.wkt", tmp_path / "a.geojson"
    wkt.write_text("POINT (1 2)\n" * count)
    points = ",".join(['{"type": "Point", "coordinates": [1, 2]}'] * count)
    geojson.write_text(f'{{"type": "GeometryCollection", "geometries": [{points}]}}')
    for read, path in ((read_wkt, wkt), (read_geojson, geojson)):
        with pytest.raises(ImportSourceError, match="10000 geometries"):
            read(path, Options())


def test_no_more_obstacles_are_read_than_stated() -> None:
    walls = [10.0 * np.array([[-9, -9], [9, -9], [9, 9], [-9, 9], [-9, -9]], dtype=float)]
    drawing = Drawing("plan", list(walls), [RING] * (enclosure.MOST_OBSTACLES + 1))
    with pytest.raises(ImportSourceError, match="3001 obstacles"):
        enclosure.check_sound(PLACE, drawing)


def test_no_more_rows_of_a_track_are_read_than_stated() -> None:
    rows = "\n".join(f"{k},0,3,3" for k in range(track_file.MOST_POINTS + 1))
    with pytest.raises(ImportSourceError, match="15000 points"):
        read_track_file(PLACE, f"# x_m,y_m,w_tr_right_m,w_tr_left_m\n{rows}\n", 1.0)


@pytest.mark.parametrize("bound", [source.MOST_TEXT, source.MOST_IMAGE])
def test_a_file_larger_than_stated_is_not_read(tmp_path: Path, bound: int) -> None:
    path = tmp_path / "plan"
    with path.open("wb") as file:
        file.truncate(bound + 1)
    read = source.read_text if bound == source.MOST_TEXT else source.read_image
    with pytest.raises(ImportSourceError, match=f"at most {bound / 1e6:.0f} MB"):
        read(path)


def test_lines_of_a_track_are_counted_before_they_are_worked_on() -> None:
    head, row = "x_m,y_m,w_tr_right_m,w_tr_left_m\n", "0,0,3,3\n1,0,3,3\n"
    empty = track_file.MOST_LINES - head.count("\n") - row.count("\n")
    assert len(read_track_file(PLACE, head + row + "\n" * empty, 1.0).points) == 2
    with pytest.raises(ImportSourceError) as caught:
        read_track_file(PLACE, head + row + "\n" * (empty + 1), 1.0)
    check_says(str(caught.value), f"plan: … {track_file.MOST_LINES + 1} lines")


def test_pixels_as_text_are_no_more_than_a_text_may_be(tmp_path: Path) -> None:
    path = tmp_path / "map.pgm"
    head = b"P2\n2 1\n255\n1 1"
    path.write_bytes(head.ljust(source.MOST_TEXT))
    assert source.read_image(path)[0].shape == (1, 2)
    path.write_bytes(head.ljust(source.MOST_TEXT + 1))
    with pytest.raises(ImportSourceError) as caught:
        source.read_image(path)
    check_says(str(caught.value), "map.pgm: … P2 … 20 MB … P5")


def test_patches_of_noise_are_counted_before_their_outlines_are_worked_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A map of 300 x 300 cells took 41 s, and was refused then."""

    def worked_on(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(ros_map, "_simplified", worked_on)
    cells = np.ones((113, 113), bool)
    cells[1::2, 1::2] = False
    with pytest.raises(ImportSourceError) as caught:
        ros_map.outline_map(
            PLACE, Drawing(kind="map"), cells, 1.0, (0.0, 0.0, 0.0), Options(specks=0.0)
        )
    check_says(str(caught.value), "plan: 3136 occupied patches … at most 3000 … --specks")


def test_outlines_that_cross_when_simplified_are_simplified_less() -> None:
    """Shapely's rounding raises at some that cross."""
    drawing = Drawing(kind="map")
    cells = np.random.default_rng(15).random((24, 24)) < 0.6
    ros_map.outline_map(PLACE, drawing, cells, 0.1, (0.0, 0.0, 0.0), Options())
    assert drawing.area.is_valid
    assert "moved by at most 0.0" in drawing.facts[-1]


def test_noise_is_no_map(monkeypatch: pytest.MonkeyPatch) -> None:
    cells = np.ones((12, 12), bool)
    cells[3, 3] = False  # four edges
    monkeypatch.setattr(ros_map, "MOST_BORDERS", 4)
    ros_map.outline_map(PLACE, Drawing(kind="map"), cells, 1.0, (0.0, 0.0, 0.0), Options())
    cells[3, 8] = False
    with pytest.raises(ImportSourceError) as caught:
        ros_map.outline_map(PLACE, Drawing(kind="map"), cells, 1.0, (0.0, 0.0, 0.0), Options())
    check_says(str(caught.value), "plan: … 8 edges … at most 4 … noise")


BLANKS = " " * 100_000
SLOW = {
    "comments.xml": "<!-- a -->\n" * 60 + "<foo/>",
    "comments.svg": "<!DOCTYPE svg>" + "<!--" * 100_000,
    "brackets.svg": "<!DOCTYPE svg" + "[" * 100_000,
    "length.svg": svg(f'<rect id="wall" x="1{BLANKS}y" width="9" height="9"/>'),
    "width.svg": f'<svg xmlns="http://www.w3.org/2000/svg" width="200{BLANKS}!"/>',
    "unit.svg": f'<svg xmlns="http://www.w3.org/2000/svg" width="1{"v" * 100_000}%"/>',
    "view.svg": f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0{BLANKS}0{BLANKS}0{BLANKS}x"/>',
    "origin.svg": svg(
        f'<g id="wall" transform-origin="{"0" * 100_000}x" transform="rotate(3)">'
        '<path d="M0,0h1"/></g>'
    ),
    "declared.svg": "<?xml " + 'encoding="x" ' * 80_000,
    "srid.wkt": f"SRID=1{BLANKS}(\nPOLYGON ((0 0, 9 0, 9 9, 0 0))",
    "crs.geojson": '{"type":"Polygon","crs":"' + "epsg" * 100_000 + '","coordinates":[]}',
    "lists.geojson": '{"type":"LineString","coordinates":[' + "[],\n" * 1_000_001 + "]}",
    "row.csv": "0,0,3,3\n" + "1" * 1_000_000,
}  # fmt: skip


@pytest.mark.parametrize("name", SLOW)
def test_texts_that_go_on_for_long_are_refused_in_their_length(tmp_path: Path, name: str) -> None:
    """Minutes, or for ever, where each character is looked at anew from each before it."""
    path = tmp_path / name
    path.write_text(SLOW[name])
    done = subprocess.run(
        [sys.executable, "-m", "physim", "import", str(path), "-o", str(tmp_path / "w.yaml")],
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert len(done.stderr) < 2_000
    assert "Traceback" not in done.stderr
