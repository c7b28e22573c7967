"""A known place written down in each format comes back, and what is imported runs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from physim import Simulation, build_scene, simulate
from physim.authoring.importing import Imported, Options, import_world
from physim.record import Record
from physim.world.file import load_world
from tests.authoring.importing.plans import (
    CELL,
    SAMPLES,
    free_cells,
    geojson,
    map_yaml,
    office,
    pgm,
    svg,
    svg_path,
    write_map,
)
from tests.helpers import inside

MILLIMETRE = 0.001
ROUNDED = 0.75 * MILLIMETRE
"""[m] farthest that a corner moves when both coordinates are rounded to the millimetre"""
FIT = Options(robot="fit")


def outline(world: Any) -> Any:
    """All walls of a world."""
    lines = [shapely.LineString(line) for line in world.boundaries or ()]
    rings = [shapely.LinearRing(ring) for ring in world.obstacles]
    return shapely.union_all([*lines, *rings])


def apart(a: Any, b: Any) -> float:
    """Hausdorff distance [m], the lines looked at every centimetre."""
    return float(
        shapely.hausdorff_distance(shapely.segmentize(a, 0.05), shapely.segmentize(b, 0.05))
    )


def gentle(n: int = 400) -> Any:
    x = np.linspace(0.0, 60.0, n)
    return np.stack([x, 6.0 * np.sin(x / 12.0)], axis=1)


def track_csv(points: Any, right: float, left: float, separator: str = ",") -> str:
    rows = [separator.join(f"{v:.6f}" for v in (*p, right, left)) for p in points]
    return "\n".join([f"# x_m{separator}y_m{separator}w_tr_right_m{separator}w_tr_left_m", *rows])


@pytest.mark.parametrize("separator", [",", ";"])
def test_the_edges_of_a_track_lie_at_the_stated_widths(tmp_path: Path, separator: str) -> None:
    path = tmp_path / "t.csv"
    path.write_text(track_csv(gentle(), 2.0, 3.0, separator))
    world = import_world(path).world
    line = shapely.LineString(gentle())
    sides = [line.offset_curve(offset, quad_segs=64) for offset in (3.0, -2.0)]
    caps = [shapely.LineString([one.coords[k] for one in sides]) for k in (0, -1)]
    assert apart(outline(world), shapely.union_all([*sides, *caps])) < 0.002
    reference = shapely.LineString(world.reference_path)
    assert reference.length == pytest.approx(line.length - 6.0, abs=0.01)
    assert max(line.distance(shapely.Point(p)) for p in reference.coords) < ROUNDED


def test_shipped_corridor_comes_back_from_csv(tmp_path: Path) -> None:
    """The walls of ten_robots, by its own mitred corners, against those at the stated widths."""
    corridor = load_world("ten_robots").corridor
    assert corridor is not None
    points, width = np.array(corridor.centreline), np.array(corridor.width)
    rows = [f"{x},{y},{w / 2},{w / 2}" for (x, y), w in zip(points, width, strict=True)]
    path = tmp_path / "t.csv"
    path.write_text("x_m,y_m,w_tr_right_m,w_tr_left_m\n" + "\n".join(rows))
    world = import_world(path, Options(robots=6, lanes=2, robot="fit")).world
    offset_polyline = inside("physim.world.ground", "offset_polyline")

    for side in (0.5, -0.5):
        true = shapely.LineString(offset_polyline(points, side * width))
        away = shapely.distance(outline(world), shapely.points(np.array(true.coords)))
        assert away.max() < 0.2  # mitre against normal, half-widths of 6 m
    assert not world.obstacles


def test_closed_track_is_cut_open_where_asked(tmp_path: Path) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 240, endpoint=False)
    ring = 20.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    path = tmp_path / "ring.csv"
    path.write_text(track_csv(ring, 2.0, 3.0))
    quarter = 0.25 * 2.0 * np.pi * 20.0
    imported = import_world(path, Options(start=quarter, gap=4.0))
    assert "cut open at station 31.4159 m, (0.00, 20.00)" in "\n".join(imported.changes)
    road = shapely.Polygon((imported.world.boundaries or ())[0])
    away = np.hypot(*shapely.get_coordinates(road.exterior).T)
    assert (np.minimum(np.abs(away - 17.0), np.abs(away - 22.0)) < 0.005).all()
    gap = 4.0 / 20.0 * (22.0**2 - 17.0**2) / 2.0
    assert road.area == pytest.approx(np.pi * (22.0**2 - 17.0**2) - gap, rel=1e-3)
    assert road.exterior.distance(shapely.Point(0.0, 20.0)) < 2e-3  # the cap stands on the y axis


@pytest.mark.parametrize(("tolerance", "plain"), [(None, True), (0.02, False)])
def test_map_outlines_are_within_the_tolerance(
    tmp_path: Path, tolerance: float | None, plain: bool
) -> None:
    """Cells decide to half a diagonal; simplifying adds at most the tolerance."""
    free, corner = free_cells(office())
    path = write_map(tmp_path, free, corner)
    (tmp_path / "map.pgm").write_bytes(pgm(np.where(free, 254, 0), plain))
    world = import_world(path, Options(tolerance=tolerance, robot="fit")).world
    limit = (CELL if tolerance is None else tolerance) + CELL * np.sqrt(0.5) + ROUNDED
    assert apart(outline(world), office().boundary) <= limit


def test_map_that_lies_along_cells_comes_back_exactly(tmp_path: Path) -> None:
    plan = shapely.box(0, 0, 12, 8).difference(shapely.box(5, 3, 6, 5))
    free, corner = free_cells(plan)
    world = import_world(write_map(tmp_path, free, corner), FIT).world
    assert apart(outline(world), plan.boundary) < ROUNDED
    assert len(world.boundaries or ()) == 1
    assert len((world.boundaries or ((),))[0]) == 5
    assert [len(ring) for ring in world.obstacles] == [4]


def test_map_turned_by_its_origin(tmp_path: Path) -> None:
    plan = shapely.box(0, 0, 12, 8)
    free, _ = free_cells(plan, margin=0)
    (tmp_path / "map.pgm").write_bytes(pgm(np.where(free, 254, 0)))
    path = tmp_path / "map.yaml"
    path.write_text(map_yaml("map.pgm", CELL, (0, 0)).replace("0.0, 0.0, 0.0", "3.0, -2.0, 0.5"))
    turned = shapely.affinity.translate(
        shapely.affinity.rotate(plan, 0.5, origin=(0, 0), use_radians=True), 3.0, -2.0
    )
    assert apart(outline(import_world(path).world), turned.boundary) < ROUNDED


def test_svg_with_transforms_comes_back(tmp_path: Path) -> None:
    plan = office()
    rings = [plan.exterior, *plan.interiors]
    drawn = [np.array(ring.coords) * (1, -1) + (0, 14) for ring in rings]  # y down
    placed = " ".join(svg_path((ring - (3.0, 1.0)) / 2.0) + " Z" for ring in drawn)
    body = f'<g id="boundary" transform="translate(3,1) scale(2)"><path d="{placed}"/></g>'
    path = tmp_path / "plan.svg"
    path.write_text(svg(body))
    assert (
        apart(
            outline(import_world(path, Options(scale=1.0, robot="fit", origin=(12.0, 1.5))).world),
            plan.boundary,
        )
        < ROUNDED
    )
    path.write_text(svg(body, 'width="1200cm" height="700cm" viewBox="0 0 24 14"'))
    half = shapely.affinity.scale(plan.boundary, 0.5, 0.5, origin=(0, 0))
    assert (
        apart(outline(import_world(path, Options(robot="fit", origin=(6.0, 0.75))).world), half)
        < ROUNDED
    )


def test_curves_are_within_the_stated_tolerance(tmp_path: Path) -> None:
    """Circle, cubic, quadratic and elliptic arc, each against its formula."""
    tolerance = 0.01  # [m]
    t = np.linspace(0.0, 1.0, 2001)[:, None]
    cubic = [np.array(p) for p in ((0.0, 0.0), (8.0, 6.0), (16.0, -6.0), (24.0, 0.0))]
    true = (
        (1 - t) ** 3 * cubic[0] + 3 * (1 - t) ** 2 * t * cubic[1]
        + 3 * (1 - t) * t**2 * cubic[2] + t**3 * cubic[3]
    )  # fmt: skip
    body = (
        '<path id="boundary" d="M 0,14 C 8,20 16,8 24,14 V 0 Q 12,4 0,0 Z"/>'
        '<circle id="obstacle" cx="12" cy="7" r="1.5"/>'
    )
    path = tmp_path / "c.svg"
    path.write_text(svg(body))
    world = import_world(path, Options(scale=1.0, tolerance=tolerance, robot="fit")).world
    ring = np.array(world.obstacles[0]) - (12.0, 7.0)
    middles = 0.5 * (ring + np.roll(ring, 1, axis=0))
    assert np.abs(np.hypot(*ring.T) - 1.5).max() < ROUNDED
    assert 1.5 - np.hypot(*middles.T).min() < tolerance + ROUNDED
    wall = shapely.LineString((world.boundaries or ((),))[0])
    curve = shapely.LineString(true * (1, -1))
    away = shapely.distance(wall, shapely.points(true * (1, -1)))
    assert away.max() < tolerance + ROUNDED
    near = [p for p in np.array(wall.coords) if abs(p[1]) < 3.0]
    assert max(curve.distance(shapely.Point(p)) for p in near) < 2.0 * MILLIMETRE
    quadratic = (1 - t) ** 2 * (24.0, 14.0) + 2 * (1 - t) * t * (12.0, 10.0) + t**2 * (0.0, 14.0)
    assert shapely.distance(wall, shapely.points(quadratic)).max() < tolerance + ROUNDED


def test_wkt_and_geojson_come_back(tmp_path: Path) -> None:
    plan = office()
    wkt, geojson = tmp_path / "p.wkt", tmp_path / "p.json"
    wkt.write_text(plan.wkt)
    geojson.write_text(json.dumps(shapely.geometry.mapping(plan)))
    for path in (wkt, geojson):
        world = import_world(path, FIT).world
        assert apart(outline(world), plan.boundary) < ROUNDED
        assert len(world.obstacles) == len(plan.interiors)
    half = import_world(wkt, Options(scale=0.5, robot="fit")).world
    scaled = shapely.affinity.scale(plan.boundary, 0.5, 0.5, origin=(0, 0))
    assert apart(outline(half), scaled) < ROUNDED


CONTROLLER, make_part = inside("physim.parts", "CONTROLLER", "make_part")
record_run = inside("physim.simulation", "record_run")


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
    path = shapely.LineString(imported.world.reference_path)
    first, last = (shapely.points(record.pose[k, :, :2]) for k in (0, -1))
    return np.asarray(
        shapely.line_locate_point(path, last) - shapely.line_locate_point(path, first)
    )


FORMATS = {
    "track.csv": Options(robots=6, lanes=2),
    "hall.svg": Options(scale=0.1),
    "office.yaml": Options(robots=5, robot="fit"),
    "office.wkt": Options(robots=4, robot="fit"),
    "office.geojson": Options(robots=3, robot="fit", origin=(1.5, 1.5), goal=(22.0, 12.0)),
}


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_runs_for_a_minute(name: str) -> None:
    imported = import_world(SAMPLES / name, FORMATS[name])
    record = run(imported)
    assert len(record.contacts) == 0
    speed = imported.world.formation.speed if imported.world.formation else 1.0
    length = shapely.LineString(imported.world.reference_path).length
    came = advance(record, imported)
    assert (came > 0.5 * min(60.0 * speed, 0.7 * length)).all()
    assert record.extremes["boundary_clearance"].min() > 0.05
    if length < 50.0:
        assert record.ended == "finished"


def test_robots_that_had_to_stop_before_a_corner_go_on(tmp_path: Path) -> None:
    """To and fro through the aisles of a warehouse; as the controller's default has it some stand
    before a corner for ever."""
    racks, aisle, wide, robots = 1, 4.0, 21.2, 3
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
