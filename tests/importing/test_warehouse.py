"""The shipped warehouse is the map that docs/IMPORTING.md says it is, as far off as it says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely

from physim.world.file import load_world

ROOT = Path(__file__).parents[2]
MAP = ROOT.parent / "shared" / "cases" / "maps" / "aws_small_warehouse.json"


def corners(area: shapely.Polygon) -> int:
    return sum(len(ring.coords) - 1 for ring in (area.exterior, *area.interiors))


@pytest.mark.skipif(not MAP.exists(), reason="the maps are not here")
def test_the_warehouse_is_its_map_simplified_as_told() -> None:
    known, world = json.loads(MAP.read_text()), load_world("warehouse")
    full = shapely.Polygon(known["outer"], known["holes"])
    shipped = shapely.Polygon(world.boundaries[0], world.obstacles)
    assert full.simplify(0.15).symmetric_difference(shipped).area < 0.01
    off = np.sort(shapely.distance(shapely.points(shapely.get_coordinates(full)), shipped.boundary))
    path = shapely.LineString(world.reference_path)
    other = full.simplify(0.17)
    told = " ".join((ROOT / "docs" / "IMPORTING.md").read_text(encoding="utf-8").split())
    assert f"Of the {corners(full)} corners of the map {corners(shipped)} are left" in told
    assert f"one corner lies {off[-1]:.3f} m from the new outline" in told
    assert off[-2] < 0.15
    assert f"grows from {full.area:.1f} to {shipped.area:.1f} m²" in told
    rooms = [path.distance(area.boundary) for area in (shipped, full, other)]
    assert f"has {rooms[0]:.2f} m to the nearest wall, {rooms[1]:.2f} m in the map itself" in told
    assert rooms[2] == pytest.approx(rooms[0], abs=0.005)
    assert corners(shipped) - corners(other) == 5
    assert f"and {other.area - shipped.area:.1f} m² be added" in told
