"""Maps of ROS: which cells are free, and what is left out of them."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity
from PIL import Image

from physim.authoring.importing import ImportSourceError, Options, import_world
from tests.authoring.importing.plans import (
    CELL,
    check_says,
    free_cells,
    map_yaml,
    only,
    pgm,
    refusal,
    write_map,
)


def test_specks_regions_and_doors_of_a_map(tmp_path: Path) -> None:
    plan = shapely.box(0, 0, 12, 8)
    free, corner = free_cells(plan, margin=30)
    free[60, 60:62] = False  # two cells: left out
    free[80:83, 80] = False  # three: kept
    free[2:5, 2:6] = True  # outside: another region
    imported = import_world(write_map(tmp_path, free, corner), Options(robot="fit"))
    rows = len(free)
    x, y = corner[0] + 61.0 * CELL, corner[1] + (rows - 60.5) * CELL
    check_says(only(imported, "speck"), f"0.02 m² … ({x:.2f}, {y:.2f}) … left out … --specks")
    check_says(only(imported, "region"), "0.12 m² … left out")
    assert [len(ring) for ring in imported.world.obstacles] == [4]
    kept = import_world(tmp_path / "map.yaml", Options(specks=1e-6, robot="fit"))
    assert len(kept.world.obstacles) == 2
    there = import_world(tmp_path / "map.yaml", Options(specks=0.031, robot="fit"))
    assert len(there.world.obstacles) == 0


def test_hundreds_of_small_patches_are_doubted_with_the_value_that_leaves_them_out(
    tmp_path: Path,
) -> None:
    free = np.pad(np.ones((200, 300), dtype=bool), 3)
    for row in range(10, 200, 20):
        for column in range(10, 300, 20):
            free[row, column : column + 3] = False
    path = write_map(tmp_path, free, (0.0, 0.0))
    said = only(import_world(path, Options(robot="fit")), "noise")
    check_says(said, "150 obstacles … 10 cells … --specks 0.03")
    check_says(refusal(path, Options(robots=3, lanes=3)), "no route … --specks 0.03")
    assert import_world(path, Options(specks=0.03)).world.obstacles == ()


def test_cells_that_meet_at_a_corner_are_no_passage(tmp_path: Path) -> None:
    free = np.zeros((80, 120), dtype=bool)
    free[5:40, 5:60] = True
    free[40:75, 60:115] = True
    free[40:70, 5:60] = False
    imported = import_world(write_map(tmp_path, free, (0.0, 0.0)), Options(robot="fit"))
    boundaries = imported.world.boundaries or ()
    assert shapely.Polygon(boundaries[0]).area == pytest.approx(5.5 * 3.5)
    check_says(only(imported, "region"), "not connected … left out")


GREY = np.array([254, 205, 128, 100, 10, 0])


@pytest.mark.parametrize(
    ("kind", "more", "free"),
    [
        ("P5", {}, [1, 0, 0, 0, 0, 0]),
        ("P2", {}, [1, 0, 0, 0, 0, 0]),
        ("png", {}, [1, 0, 0, 0, 0, 0]),
        ("png16", {}, [1, 0, 0, 0, 0, 0]),
        ("colour", {}, [1, 0, 0, 0, 0, 0]),
        ("P5", {"free_thresh": 0.25}, [1, 1, 0, 0, 0, 0]),
        ("png", {"negate": 1}, [0, 0, 0, 0, 1, 1]),
        ("png", {"mode": "raw"}, [0, 0, 0, 0, 1, 1]),
        ("P5", {"mode": "raw", "free_thresh": 0.05}, [0, 0, 0, 0, 0, 1]),
    ],
)
def test_thresholds_and_modes(
    tmp_path: Path, kind: str, more: dict[str, Any], free: list[int]
) -> None:
    """Bands of grey, 20 cells each: the free ones are the world."""
    pixels = np.repeat(np.repeat(GREY[None], 40, axis=0), 20, axis=1)
    if kind in ("P5", "P2"):
        data = pgm(pixels, kind == "P2")
    else:
        image = pixels.astype(np.uint8)
        if kind == "png16":
            image = image.astype(np.uint16) * 257
        elif kind == "colour":
            image = np.stack([image, image, image, np.full_like(image, 255)], axis=2)
        written = io.BytesIO()
        Image.fromarray(image).save(written, "png")
        data = written.getvalue()
    (tmp_path / "map.img").write_bytes(data)
    (tmp_path / "map.yaml").write_text(map_yaml("map.img", 0.5, (0, 0), **more))
    imported = import_world(tmp_path / "map.yaml", Options(tolerance=0.1))
    assert any("205" in one for one in imported.changes) == (more == {"free_thresh": 0.25})
    assert any("counts as occupied" in one for one in imported.facts) == (
        more != {"free_thresh": 0.25}
    )
    x0, y0, x1, y1 = shapely.LineString((imported.world.boundaries or ())[0]).bounds
    bands = np.flatnonzero(free)
    assert (x0, x1) == (10.0 * bands[0], 10.0 * (bands[-1] + 1))
    assert (y0, y1) == (0.0, 20.0)


def test_transparent_cells_are_unknown(tmp_path: Path) -> None:
    image = np.full((40, 80, 4), 255, dtype=np.uint8)
    image[:, 40:, 3] = 0
    Image.fromarray(image).save(tmp_path / "map.png")
    for mode, width in (("scale", 20.0), ("trinary", 20.0), ("raw", None)):
        (tmp_path / "map.yaml").write_text(map_yaml("map.png", 0.5, (0, 0), mode=mode))
        if width is None:  # 255 is unknown in percent
            with pytest.raises(ImportSourceError, match="0 % of the cells are free"):
                import_world(tmp_path / "map.yaml")
            continue
        line = shapely.LineString((import_world(tmp_path / "map.yaml").world.boundaries or ())[0])
        assert line.bounds == (0.0, 0.0, width, 20.0)


def test_the_margin_round_a_track_is_not_taken_for_it(tmp_path: Path) -> None:
    """It is the largest free region, and reaches the edge of the image: which is meant is asked."""
    track = shapely.box(10, 10, 40, 30) - shapely.box(14, 14, 36, 26)
    walls = shapely.box(9, 9, 41, 31) - shapely.box(15, 15, 35, 25) - track
    plan = shapely.box(0, 0, 50, 40) - walls
    path = write_map(tmp_path, *free_cells(plan, 0.5, margin=0), 0.5)
    said = refusal(path, Options())
    check_says(said, "3 free regions … edge of the image … --from X,Y … 1296 m² … 336 m² … 200 m²")
    x, y = map(float, re.findall(r"1296 m² about \((.*?), (.*?)\)", said)[0])
    assert 4.0 < min(x, y, 50.0 - x, 40.0 - y) < 6.0  # in the middle of the margin of 9 m
    x, y = re.findall(r"336 m² about \((.*?), (.*?)\)", said)[0]
    there = import_world(path, Options(origin=(float(x), float(y)), robot="fit"))
    assert shapely.Polygon((there.world.boundaries or ())[0]).bounds == (10, 10, 40, 30)


@pytest.mark.parametrize(
    ("more", "says"),
    [({"negate": 1}, "0.67 % … negate: 0 99 %"), ({"mode": "raw"}, "0.67 % … mode: trinary 99 %")],
)
def test_a_map_with_hardly_a_free_cell_names_what_may_be_wrong(
    tmp_path: Path, more: dict[str, Any], says: str
) -> None:
    pixels = np.full((40, 60), 254)
    pixels[10:12, 10:18] = 0
    (tmp_path / "map.pgm").write_bytes(pgm(pixels))
    (tmp_path / "map.yaml").write_text(map_yaml("map.pgm", 0.5, (0, 0), **more))
    check_says(refusal(tmp_path / "map.yaml", Options(specks=0.0)), says)


def test_a_refusal_says_what_may_be_wrong_with_the_reading(tmp_path: Path) -> None:
    pixels = np.full((100, 150), 205)
    pixels[10:90, 10:140] = 0
    pixels[30:70, 30:120] = 254
    (tmp_path / "map.pgm").write_bytes(pgm(pixels))
    path = tmp_path / "map.yaml"
    path.write_text(map_yaml("map.pgm", 0.1, (0, 0), free_thresh=0.25))
    check_says(refusal(path, Options()), "--from X,Y … grey 205 … counts as free … 0.25 … 0.196")
    pixels[30:70, 30:120], pixels[10:90, 10:12] = 205, 254
    pixels[28:30, 10:140] = 0
    pixels[32:68, 32:118] = 254
    (tmp_path / "map.pgm").write_bytes(pgm(254 - pixels))
    path.write_text(map_yaml("map.pgm", 0.1, (0, 0)))
    check_says(refusal(path, Options()), "no route … % of the cells are free: see negate")


def test_an_end_that_is_moved_is_told(tmp_path: Path) -> None:
    path = write_map(tmp_path, np.ones((100, 300), dtype=bool), (0.0, 0.0))
    made = import_world(path, Options(origin=(0.5, 5.0), goal=(25.0, 5.0)))
    check_says(only(made, "moved"), "--from (0.50, 5.00): moved by 1.31 m")
    said = refusal(path, Options(origin=(5.0, 5.0), goal=(5.0, 5.0)))
    check_says(said, "--from and --to are the same place, (5.00, 5.00)")
    narrow = refusal(path, Options(origin=(5.0, 5.0), goal=(25.0, 5.0), robot=(20.0, 12.0)))
    check_says(narrow, "no route … --robot fit")
