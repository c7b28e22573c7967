"""What is imported runs: robots move along the path, without contact, and those of a short path
arrive.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely

from physim import Simulation, build_scene, simulate
from physim.authoring.importing import Imported, Options, import_world
from physim.record import Record
from tests.helpers import inside
from tests.importing.plans import SAMPLES, svg
from tests.importing.test_joining import geojson

CONTROLLER, make_part = inside("physim.parts", "CONTROLLER", "make_part")
record_run = inside("physim.simulation", "record_run")

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
    controller = make_part(CONTROLLER, choice.type, choice.settings)
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


@pytest.mark.parametrize(
    ("racks", "aisle", "wide", "robots"), [(1, 4.0, 21.2, 3), (2, 4.0, 24.2, 2)]
)
def test_robots_that_had_to_stop_before_a_corner_go_on(
    tmp_path: Path, racks: int, aisle: float, wide: float, robots: int
) -> None:
    """To and fro through the aisles of a warehouse; as the controller's default has it some stand
    before a corner for ever."""
    pitch = aisle + 0.8
    high = racks * pitch + aisle
    ends = [(1.8, wide - 1.8)[:: 1 if k % 2 == 0 else -1] for k in range(racks + 1)]
    way = [(x, aisle / 2 + k * pitch) for k, two in enumerate(ends) for x in two]
    parts = [
        ("boundary", shapely.box(0, 0, wide, high)), ("path", shapely.LineString(way)),
        *(("obstacle", shapely.box(3.6, aisle + k * pitch, wide - 3.6, (k + 1) * pitch))
          for k in range(racks)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts), Options(robots=robots))
    ended = {}
    for high_time in (made.world.controller.settings.get("boundary_time_high"), None):
        settings = {"type": "mode_switching"}
        if high_time is not None:
            settings |= {"boundary_time_high": high_time}
        with simulate(made.world.changed(controller=settings)) as record:
            ended[high_time is None] = record.ended
            assert len(record.contacts) == 0
    assert ended == {False: "finished", True: "duration"}


def hallway(end: float) -> str:
    """Hall of 40 x 8 m with an obstacle 0.9 m right of the path, which runs to x = ``end`` [m]."""
    return svg(
        '<rect id="boundary" width="40" height="8"/>'
        '<rect id="obstacle" x="19" y="4.9" width="1" height="1"/>'
        f'<path id="path" d="M 3,4 H {end}"/>'
        '<g id="robot"><rect x="5" y="2.5" width="1.8" height="1"/>'
        '<rect x="9" y="5" width="1.8" height="1"/></g>',
        'width="400mm" height="80mm" viewBox="0 0 40 8"',
    )


@pytest.mark.parametrize("end", [39.1, 37.0])
def test_lanes_keep_clear_of_an_obstacle_and_end_clear_of_the_wall(
    end: float, tmp_path: Path
) -> None:
    source = tmp_path / "hallway.svg"
    source.write_text(hallway(end))
    imported = import_world(source, Options(scale=1.0))
    left, right = imported.world.robots
    assert getattr(left.path, "offset", None) == 1.0  # it is 1.9 m clear of the obstacle
    way = shapely.LineString(np.asarray(right.path))
    assert way.distance(shapely.box(19.0, 2.1, 20.0, 3.1)) >= 1.15
    assert way.coords[-1][1] == pytest.approx(2.5)
    assert way.coords[-1][0] <= 38.2
    shortened = [change for change in imported.changes if "shortened" in change]
    assert len(shortened) == (1 if end > 38.0 else 0)
    record = run(imported)
    assert len(record.contacts) == 0
    assert record.ended == "finished"


@pytest.mark.parametrize("size", [(None), (1.8, 1.0)])
def test_a_path_up_to_a_wall_ends_where_the_wall_is_no_danger(
    size: tuple[float, float] | None, tmp_path: Path
) -> None:
    """Half a length and what the robot goes in `time_low` at the highest speed, to size."""
    source = tmp_path / "hall.svg"
    source.write_text(
        svg(
            '<rect id="boundary" width="40" height="8"/><path id="path" d="M 3,4 H 39.9"/>',
            'width="400mm" height="80mm" viewBox="0 0 40 8"',
        )
    )
    world = import_world(source, Options(scale=1.0, robot=size)).world
    assert world.robots[0].limits.v == 1.5
    assert 40.0 - world.reference[-1][0] >= 0.9 + 1.3 - 1e-3


def test_a_bent_hall_with_drawn_robots_finishes(tmp_path: Path) -> None:
    source = tmp_path / "bent.svg"
    source.write_text(
        svg(
            '<path id="boundary" d="M 1,2.5 h 26 v 16 h -7 v -9 l -2,-2 H 1 Z"/>'
            '<path id="obstacle" d="M 23,11.3 l 0.57,0.57 l -0.57,0.57 l -0.57,-0.57 z"/>'
            '<path id="path" d="M 2,5.3 H 20.5 C 22.5,5.3 24,6.5 24.5,8.5 V 17.7"/>'
            '<g id="robot"><rect x="5" y="4.2" width="1.8" height="1"/>'
            '<path d="m 8,5.5 l 1.8,0.5 l -1.8,0.5 l 0.4,-0.5 z"/></g>',
            'width="300mm" height="200mm" viewBox="0 0 30 20"',
        )
    )
    record = run(import_world(source, Options(scale=1.0)))
    assert len(record.contacts) == 0
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
    assert not any("repaired" in change for change in imported.changes)
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
