"""What a preview shows agrees with what a run uses."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from physim import build_scene, simulate
from physim.analysis import metrics
from physim.world.file import load_world, parse_world
from tests.drawing.preview.worlds import NARROW, shown, world
from tests.helpers import inside

items = inside("physim.drawing", "items")


@pytest.mark.parametrize("name", ["three_robots", "nonconvex"])
def test_starts_and_stops_are_those_of_the_run(name: str) -> None:
    loaded = load_world(name)
    scene = build_scene(loaded)
    seen = shown(loaded.to_yaml())
    assert np.array_equal(seen.scene.start, scene.start)
    for i in range(scene.robots):
        low, high = scene.paths.start[i], scene.paths.start[i + 1]
        path = shapely.LineString(scene.paths.points[low:high])
        stop = path.interpolate(scene.stop_station[i])
        assert np.allclose(seen.scene.stops[i], (stop.x, stop.y), rtol=0.0, atol=1e-6)
        assert seen.scene.reach[i] == pytest.approx(scene.shapes.radius[i], abs=1e-12)


@pytest.mark.parametrize("name", ["three_robots", "warehouse"])
def test_the_safe_area_is_that_of_the_run(name: str) -> None:
    """The accessible area without what is nearer than L to its edge, obstacles included."""
    loaded = load_world(name)
    scene, seen = build_scene(loaded), shown(loaded.to_yaml()).scene
    assert seen.safe_distance > 0.0
    region = inside("physim.drawing", "region")
    assert shapely.equals(region(seen.accessible), scene.area.polygon)
    edge = region(seen.safe).boundary
    gap = scene.area.polygon.boundary.distance(edge)
    assert gap == pytest.approx(seen.safe_distance, rel=0.01)
    rings = [shapely.LinearRing(ring) for ring in scene.area.safe_rings(seen.safe_distance)]
    assert shapely.hausdorff_distance(shapely.MultiLineString(rings), edge) < 1e-9


def test_paths_are_parted_at_the_edge_of_the_safe_area() -> None:
    seen = shown(NARROW)
    (route,) = seen.routes
    assert route.robots == (0, 1)
    line = shapely.LineString(seen.reference)
    near = shapely.MultiLineString(seen.scene.boundaries).buffer(seen.scene.safe_distance)
    for pieces, within in ((route.safe, False), (route.danger, True)):
        for piece in pieces:
            middle = shapely.LineString(piece).interpolate(0.5, normalized=True)
            obstacle = (
                shapely.Polygon(seen.scene.obstacles[0]).distance(middle) < seen.scene.safe_distance
            )
            assert (near.covers(middle) or obstacle) is within
    drawn = sum(shapely.LineString(p).length for p in (*route.safe, *route.danger))
    assert drawn == pytest.approx(line.length)
    assert route.danger


def test_obstacles_narrow_the_width_and_that_without_them_is_kept() -> None:
    seen = shown(NARROW)
    assert seen.boundary_widths is not None
    at = np.argmin(np.abs(seen.widths.station - 32.5))
    alone = np.interp(32.5, seen.boundary_widths.station, seen.boundary_widths.width)
    assert seen.widths.width[at] < alone - 1.0
    assert seen.widths.width[seen.widths.narrowest] == pytest.approx(1.5)
    assert shown(world()).boundary_widths is None


def test_a_preview_and_a_run_have_one_width() -> None:
    """Along the path of the first robot (Fig. 4), which here is not the reference path."""
    text = world(((0.0, 0.0), (20.0, 0.0), (34.0, 14.0)), (8.0, 5.0, 9.0))
    text = text.replace('"offset": 0.0', '"offset": 1.0')
    seen = shown(text)
    loaded = parse_world(text).changed(time={"step": 0.01, "duration": 0.1})
    told = metrics.corridor_width(simulate(loaded))
    same = np.interp(told.station, seen.widths.station, seen.widths.width)
    assert np.allclose(told.width, same, atol=0.02, rtol=0.0)
    assert seen.course_length == pytest.approx(told.station[-1], abs=0.1)
    assert seen.widths.width.min() == pytest.approx(np.nanmin(told.width), abs=0.02)
    assert not np.allclose(seen.course[0], seen.reference[0])


def test_a_path_along_the_edge_of_the_safe_area_is_safe() -> None:
    text = world(width=6.0).replace('"offset": 0.0', '"offset": 2.0')
    assert all(not route.danger for route in shown(text).routes)
