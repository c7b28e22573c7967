"""Maps of ROS: which cells are free, and what is left out of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import shapely
import shapely.affinity

from physim.authoring.importing import ImportSourceError, Options, import_world
from tests.authoring.importing.plans import (
    CELL,
    check_says,
    free_cells,
    map_yaml,
    office,
    only,
    pgm,
    write_map,
)


def test_specks_regions_and_doors_of_a_map(tmp_path: Path) -> None:
    plan = shapely.box(0, 0, 12, 8)
    free, corner = free_cells(plan, margin=30)
    free[60, 60:62] = False  # two cells: left out
    free[80:83, 80] = False  # three: kept
    free[2:5, 2:6] = True  # outside: another region
    imported = import_world(write_map(tmp_path, free, corner))
    rows = len(free)
    x, y = corner[0] + 61.0 * CELL, corner[1] + (rows - 60.5) * CELL
    check_says(only(imported, "speck"), f"0.02 m² … ({x:.2f}, {y:.2f}) … left out … --specks")
    check_says(only(imported, "region"), "0.12 m² … (-2.60, … left out")
    assert [len(ring) for ring in imported.world.obstacles] == [4]
    kept = import_world(tmp_path / "map.yaml", Options(specks=1e-6))
    assert len(kept.world.obstacles) == 2
    there = import_world(tmp_path / "map.yaml", Options(specks=0.031))
    assert len(there.world.obstacles) == 0


def test_cells_that_meet_at_a_corner_are_no_passage(tmp_path: Path) -> None:
    free = np.zeros((80, 120), dtype=bool)
    free[5:40, 5:60] = True
    free[40:75, 60:115] = True
    free[40:70, 5:60] = False
    imported = import_world(write_map(tmp_path, free, (0.0, 0.0)))
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
        data = cv2.imencode(".png", image)[1].tobytes()
    (tmp_path / "map.img").write_bytes(data)
    (tmp_path / "map.yaml").write_text(map_yaml("map.img", 0.5, (0, 0), **more))
    imported = import_world(tmp_path / "map.yaml", Options(tolerance=0.1))
    x0, y0, x1, y1 = shapely.LineString((imported.world.boundaries or ())[0]).bounds
    bands = np.flatnonzero(free)
    assert (x0, x1) == (10.0 * bands[0], 10.0 * (bands[-1] + 1))
    assert (y0, y1) == (0.0, 20.0)


def test_transparent_cells_are_unknown(tmp_path: Path) -> None:
    image = np.full((40, 80, 4), 255, dtype=np.uint8)
    image[:, 40:, 3] = 0
    cv2.imwrite(str(tmp_path / "map.png"), image)
    for mode, width in (("scale", 20.0), ("trinary", 20.0), ("raw", None)):
        (tmp_path / "map.yaml").write_text(map_yaml("map.png", 0.5, (0, 0), mode=mode))
        if width is None:  # 255 is unknown in percent
            with pytest.raises(ImportSourceError, match="no cell"):
                import_world(tmp_path / "map.yaml")
            continue
        line = shapely.LineString((import_world(tmp_path / "map.yaml").world.boundaries or ())[0])
        assert line.bounds == (0.0, 0.0, width, 20.0)


def test_a_path_that_ends_far_from_where_it_was_asked_to_is_told_first(tmp_path: Path) -> None:
    """A room of 12 m with a bay of 3 m, not deep, where robots that fit elsewhere have no room.

    For a deep one they are smaller.
    """
    plan = shapely.union(shapely.box(0.0, 0.0, 30.0, 12.0), shapely.box(30.0, 4.5, 34.0, 7.5))
    there = write_map(tmp_path, *free_cells(plan))
    asked = Options(origin=(4.0, 6.0), goal=(33.0, 6.0))
    far = import_world(there, asked)
    end = np.array((far.world.reference_path or ())[-1])
    away = float(np.hypot(*(end - (33.0, 6.0))))
    assert away > 3.6
    check_says(far.changes[0], f"{away:.2f} m … --to (33.00, 6.00) … --robot")
    assert only(far, "--to") == far.changes[0]
    near = import_world(there, Options(origin=(4.0, 6.0), goal=(33.0, 6.0), robot=(0.6, 0.4)))
    assert not any("--to" in change for change in near.changes)
    back = import_world(there, Options(origin=(33.0, 6.0), goal=(4.0, 6.0)))
    check_says(only(back, "--from"), "--from (33.00, 6.00)")
    deep = shapely.union(shapely.box(0.0, 0.0, 30.0, 12.0), shapely.box(30.0, 4.5, 40.0, 7.5))
    small = import_world(
        write_map(tmp_path, *free_cells(deep)), Options(origin=(4.0, 6.0), goal=(38.0, 6.0))
    )
    assert not any("--to" in change for change in small.changes)
    assert max(np.hypot(*np.ptp(one.outline, axis=0)) for one in small.world.robots) < 2.0


@pytest.mark.parametrize(("cell", "is_doubted"), [(5.0, True), (0.5, False)])
def test_a_resolution_that_is_hardly_in_metres_is_doubted(
    tmp_path: Path, cell: float, is_doubted: bool
) -> None:
    free, corner = free_cells(office(), 0.5)
    path = write_map(tmp_path, free, corner, cell)
    told = [one for one in import_world(path).changes if "check the scale" in one]
    assert bool(told) == is_doubted
    assert not told or "5 m" in told[0]
