"""What is imported runs: robots move along the path, without contact, and those of a short path
arrive.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely

from physim.importing import Imported, Options, import_world
from physim.record import Record
from physim.recording import record_run
from physim.registry import make_controller
from physim.scene_builder import build_scene
from physim.simulation import Simulation
from tests.importing.plans import SAMPLES

MAPS = Path(__file__).parents[2].parent / "shared" / "cases" / "maps"
MAP_NAMES = (
    "aws_small_warehouse", "mrpb_maze", "mrpb_narrow_graph", "mrpb_office01add", "mrpb_office02",
    "mrpb_room02", "mrpb_shopping_mall", "mrpb_track", "turtlebot3_world",
)  # fmt: skip


def run(imported: Imported, seconds: float = 60.0) -> Record:
    time = imported.world.time
    world = imported.world.changed(
        time={"step": time.step, "duration": seconds, "record_every": 10}
    )
    choice = world.controller
    controller = make_controller(choice.type, choice.settings)
    return record_run(Simulation(build_scene(world), controller=controller))


def advance(record: Record, imported: Imported) -> np.ndarray:
    """[m] How far along the reference path every robot came, by shapely."""
    path = shapely.LineString(imported.world.reference)
    first, last = (shapely.points(record.pose[k, :, :2]) for k in (0, -1))
    return np.asarray(
        shapely.line_locate_point(path, last) - shapely.line_locate_point(path, first)
    )


FORMATS = {
    "track.csv": Options(robots=6, lanes=2),
    "hall.svg": Options(scale=0.1),
    "office.yaml": Options(robots=5),
    "office.wkt": Options(robots=4, lanes=2),
    "office.geojson": Options(robots=3, origin=(1.5, 1.5), goal=(22.0, 12.0)),
}


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_runs_for_a_minute(name: str) -> None:
    imported = import_world(SAMPLES / name, FORMATS[name])
    record = run(imported)
    assert len(record.contacts) == 0
    speed = imported.world.formation.speed if imported.world.formation else 1.0
    length = shapely.LineString(imported.world.reference).length
    came = advance(record, imported)
    assert (came > 0.5 * min(60.0 * speed, 0.7 * length)).all()
    assert record.extremes["boundary_clearance"].min() > 0.05
    if length < 50.0:
        assert record.ended == "finished"


@pytest.mark.skipif(not MAPS.is_dir(), reason="the maps are not here")
@pytest.mark.parametrize("name", MAP_NAMES)
def test_building_maps(name: str, tmp_path: Path) -> None:
    """Nine buildings as GeoJSON: five robots in each for a minute, without contact."""
    given = json.loads((MAPS / f"{name}.json").read_text())
    plan = shapely.Polygon(given["outer"], given["holes"])
    path = tmp_path / f"{name}.geojson"
    path.write_text(json.dumps(shapely.geometry.mapping(plan)))
    imported = import_world(path, Options(robots=5))
    assert not any("mended" in change for change in imported.changes)
    world = imported.world
    walls = shapely.union_all(
        [shapely.LineString(line) for line in world.boundaries or ()]
        + [shapely.LinearRing(ring) for ring in world.obstacles]
    )
    assert shapely.hausdorff_distance(walls, plan.boundary) <= 0.001
    record = run(imported)
    assert len(record.contacts) == 0
    assert record.extremes["clearance"].min() > 0.05
    assert (advance(record, imported) > 0.5).all()
