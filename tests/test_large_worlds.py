"""Large worlds: what robots share is worked out once, and quick ways say what slow ones say."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import physim.world.checks.room as room
import physim.world.layout.robots as robots_of
from physim import build_scene
from physim.world import World
from physim.world.checks.formation import _error_sums
from tests.helpers import inside

Area, accessible_area = inside("physim.geometry", "Area", "accessible_area")
corridor_boundaries = inside("physim.geometry", "corridor_boundaries")
Way = inside("physim.world.checks", "Way")
partial_layout = inside("physim.world.layout", "partial_layout")

BOX = {"length": 0.5, "width": 0.3}
TRIANGLE = [[0.3, 0.0], [-0.2, 0.2], [-0.2, -0.2]]
LANES = (-1.5, -0.5, 0.5, 1.5)


def crowd(robots: int, **keys: Any) -> World:
    """Robots in four lanes of a bent corridor, boxes and triangles in turn."""
    length = 20.0 + 1.2 * robots / len(LANES)
    return World(
        name="crowd",
        time={"step": 0.02, "duration": 1.0},
        corridor={"centreline": [[0.0, 0.0], [length, 0.0], [length + 20.0, 8.0]], "width": 6.0},
        robots=[
            {
                "name": f"r{i}",
                "footprint": BOX if i % 2 else TRIANGLE,
                "pose": [2.0 + 1.2 * (i // 4) + 0.01 * (i % 7), LANES[i % 4], 0.0],
                "path": {"offset": LANES[i % 4]},
            }
            for i in range(robots)
        ],
        **keys,
    )


def counted(monkeypatch: pytest.MonkeyPatch, module: Any, name: str, count: Counter[str]) -> None:
    """Count the calls of a function of a module."""
    real = getattr(module, name)

    def call(*args: Any, **named: Any) -> Any:
        count[name] += 1
        return real(*args, **named)

    monkeypatch.setattr(module, name, call)


def test_a_path_and_a_footprint_are_worked_out_once_however_many_robots_share_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    import physim.world.layout.scene_builder as builder

    calls: list[Counter[str]] = []
    for robots in (8, 80):
        count: Counter[str] = Counter()
        with monkeypatch.context() as patch:
            for module, name in (
                (robots_of, "offset_polyline"),
                (robots_of, "outline_fault"),
                (builder, "convex_parts"),
                (Area, "outside_stretches"),
            ):
                counted(patch, module, name, count)
            build_scene(crowd(robots))
        calls.append(count)
    assert calls[0] == calls[1]
    assert calls[1]["convex_parts"] == 2
    assert calls[1]["offset_polyline"] == len(LANES)


def test_the_room_along_a_path_is_measured_once_for_its_robots(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    count: Counter[str] = Counter()
    counted(monkeypatch, room, "_room_along", count)
    profiles = room.clearance_profiles(partial_layout(crowd(40)), 1.0)
    assert len(profiles) == 40
    assert count["_room_along"] == len(LANES)


CORNER = np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 20.0]])
PILLAR = np.array([[8.0, -1.0], [10.0, -1.0], [10.0, 1.0], [8.0, 1.0]])
AREA = accessible_area(
    list(corridor_boundaries(CORNER, np.full(3, 8.0), 3.0).values()), [PILLAR], CORNER
)
ON_THE_EDGE = st.sampled_from([(x, y) for ring in AREA.accessible_rings for x, y in ring.tolist()])
ANYWHERE = st.tuples(st.floats(-4.0, 25.0), st.floats(-5.0, 24.0))


@given(points=st.lists(ON_THE_EDGE | ANYWHERE, min_size=2, max_size=6, unique=True))
def test_a_path_far_from_the_edge_has_the_stretches_that_a_look_at_every_point_gives(
    points: list[tuple[float, float]],
) -> None:
    path = np.array(points)
    if np.hypot(*np.diff(path, axis=0).T).min() < 1e-6:
        return
    slow = AREA._stretches(shapely.LineString(path))
    assert AREA.outside_stretches(path).tobytes() == slow.tobytes()


def test_most_paths_are_not_looked_at_point_by_point(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(Area, "_stretches")
    inside = np.array([[0.0, 2.0], [18.0, 2.0], [18.0, 20.0]])
    assert AREA.outside_stretches(inside).shape == (0, 2)


@given(seed=st.integers(0, 10_000), points=st.integers(2, 7))
def test_a_way_agrees_with_shapely(seed: int, points: int) -> None:
    rng = np.random.default_rng(seed)
    path = rng.uniform(-10.0, 10.0, (points, 2))
    way, line = Way(path), shapely.LineString(path)
    stations = np.append(rng.uniform(0.0, line.length, 9), [0.0, line.length])
    places, direction = way.at(stations)
    assert places == pytest.approx(shapely.get_coordinates(line.interpolate(stations)), abs=1e-9)
    ahead = way.at(np.minimum(stations + 1e-6, way.station[-1]))[0] - places
    assert ((ahead * direction).sum(axis=1) >= 0.0).all()
    assert np.hypot(*direction.T) == pytest.approx(1.0)
    near = rng.uniform(-12.0, 12.0, (20, 2))
    gaps = np.hypot(*(way.at(way.nearest(near))[0] - near).T)
    assert gaps == pytest.approx(shapely.distance(line, shapely.points(near)), abs=1e-9)


def test_a_way_takes_the_smaller_of_two_stations() -> None:
    way = Way(np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 4.0], [0.0, 4.0], [0.0, 0.0]]))
    found = way.nearest(np.array([[0.0, 0.0], [5.0, 2.0], [10.0, 0.0], [-1.0, 2.0]]))
    assert found == pytest.approx([0.0, 5.0, 10.0, 26.0])


@pytest.mark.parametrize("neighbours", ["range", "all", [["r0", "r7"], ["r7", "r3"], ["r2", "r1"]]])
def test_error_sums_of_a_cluster_are_those_over_all_pairs(neighbours: Any) -> None:
    robots, reach = 37, 2.4
    leads = tuple(np.concatenate(([0.0], np.random.default_rng(1).normal(0.0, 3.0, robots - 1))))
    plan = {"spacing": leads, "range": reach, "neighbours": neighbours}
    laid = partial_layout(crowd(robots, formation=plan))
    line = shapely.LineString(laid.reference)
    station = np.array([line.project(shapely.Point(place)) for place in laid.start[:, :2]])
    sums, counts = np.zeros(robots), []
    pairs = neighbours if isinstance(neighbours, list) else []
    for i in range(robots):
        near = []
        for j in range(robots):
            listed = [f"r{i}", f"r{j}"] in pairs or [f"r{j}", f"r{i}"] in pairs
            within = neighbours == "range" and abs(station[j] - station[i]) <= reach
            if i != j and (neighbours == "all" or within or listed):
                near.append(j)
        sums[i] = sum((station[j] - station[i]) - (leads[j] - leads[i]) for j in near)
        counts.append(len(near))
    found, most = _error_sums(laid)
    assert found == pytest.approx(sums, abs=1e-9)
    assert most == max(counts)
