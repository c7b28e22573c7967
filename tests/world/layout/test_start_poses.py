"""Robots placed by the seed: apart from everything, inside their region, the same every time."""

from __future__ import annotations

import itertools
import math
import re

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import affinity

from physim import build_scene, simulate
from physim.errors import WorldError
from physim.geometry import polyline, signed_distance
from physim.record import Record
from physim.world import World
from physim.world.file import parse_world
from tests.helpers import examples, facts, inside

is_random = inside("physim.world.layout", "is_random")


BOX = {"length": 1.8, "width": 1.0}
ELL = [[-0.9, -0.6], [0.9, -0.6], [0.9, 0.0], [-0.2, 0.0], [-0.2, 0.6], [-0.9, 0.6]]
ARROW = [[2.0, 0.0], [0.6, 0.5], [0.9, 0.0], [0.6, -0.5]]
SHAPES = (BOX, ELL, ARROW)
REGION = [[1.0, -3.5], [14.0, -3.5], [14.0, 3.5], [6.0, 3.5], [6.0, 0.0], [1.0, 0.0]]
PILLAR = [[9.0, 0.5], [10.0, 0.5], [10.0, 2.0], [9.0, 2.0]]


def road(n: int, start: dict | None, **more) -> World:
    """A road 8 m wide, 0 to 40 m, with a pillar and n robots of three shapes without a pose."""
    robots = [
        {
            "name": f"r{i + 1}",
            "footprint": SHAPES[i % 3],
            "path": {"offset": (1.5, 0.0, -1.5)[i % 3]},
        }
        for i in range(n)
    ]
    values = {
        "name": "road",
        "time": {"step": 0.01, "duration": 1.0},
        "corridor": {"centreline": [[0, 0], [40, 0]], "width": 8.0},
        "obstacles": [PILLAR],
        "start": start,
        "robots": robots,
    }
    return World(**{**values, **more})


def placed(world: World, pose: np.ndarray, i: int) -> shapely.Polygon:
    """Outline at a pose, by shapely's own transformations."""
    shape = affinity.rotate(
        shapely.Polygon(world.robots[i].outline), pose[2], origin=(0, 0), use_radians=True
    )
    return affinity.translate(shape, pose[0], pose[1])


@examples(20, deep=100)
@given(
    seed=st.integers(0, 10**9),
    n=st.integers(1, 7),
    gap=st.sampled_from([0.0, 0.3, 0.55]),
    heading=st.sampled_from(["random", "along", 0.7]),
    abreast=st.sampled_from([None, 2]),
)
def test_all_are_in_the_region_and_min_gap_apart(seed, n, gap, heading, abreast) -> None:
    start = {"region": REGION, "heading": heading, "min_gap": gap, "abreast": abreast}
    world = road(n, start)
    poses = build_scene(world, seed).start
    shapes = [placed(world, pose, i) for i, pose in enumerate(poses)]
    walls = [[[-3, 4], [43, 4]], [[-3, -4], [43, -4]], [[-3, 4], [-3, -4]], [[43, 4], [43, -4]]]
    region = shapely.Polygon(REGION)
    for a, b in itertools.combinations(shapes, 2):
        assert a.distance(b) >= gap
        assert not a.intersects(b)
    for shape in shapes:
        assert region.buffer(1e-12).covers(shape)
        assert shape.distance(shapely.Polygon(PILLAR)) >= gap
        assert not shape.intersects(shapely.Polygon(PILLAR))
        assert all(shape.distance(shapely.LineString(wall)) >= gap for wall in walls)
    corners = [shapely.get_coordinates(shape)[:-1] for shape in shapes]
    for a, b in itertools.combinations(corners, 2):  # the kernels that judge the run agree
        assert signed_distance(a, b) >= max(gap, 1e-9)
    for a in corners:
        assert signed_distance(a, PILLAR) >= max(gap, 1e-9)
        assert all(signed_distance(a, polyline(wall)) >= max(gap, 1e-9) for wall in walls)


def test_same_seed_same_start_and_another_seed_another() -> None:
    world = road(5, {"region": REGION})
    assert is_random(world)
    first, again, other = (build_scene(world, seed).start for seed in (4, 4, 5))
    assert np.array_equal(first, again)
    assert (first != other).all()


def test_headings_are_those_that_a_pose_would_get() -> None:
    """So a region in the place of poses changes places alone."""
    world = road(3, {"region": REGION})
    robots = [{**robot(world, i), "pose": [20.0 + 4 * i, 0.0, "random"]} for i in range(3)]
    posed = world.changed(robots=robots, start=None)
    assert np.array_equal(build_scene(world, 3).start[:, 2], build_scene(posed, 3).start[:, 2])


def robot(world: World, i: int) -> dict:
    chosen = world.robots[i]
    return {"name": chosen.name, "footprint": chosen.footprint, "path": chosen.path}


def test_along_is_the_direction_of_the_reference_path() -> None:
    bent = {"centreline": [[0, 0], [10, 0], [10, 20]], "width": 6.0}
    region = [[8.0, 8.0], [12.0, 8.0], [12.0, 18.0], [8.0, 18.0]]
    world = road(2, {"region": region, "heading": "along"}, corridor=bent, obstacles=[])
    assert build_scene(world).start[:, 2] == pytest.approx([math.pi / 2] * 2)
    fixed = world.changed(start={"region": region, "heading": -1.0})
    assert build_scene(fixed).start[:, 2].tolist() == [-1.0, -1.0]


def test_rows_stand_in_the_order_of_the_robots_and_of_their_paths() -> None:
    region = [[1.0, -3.5], [25.0, -3.5], [25.0, 3.5], [1.0, 3.5]]
    world = road(8, {"region": region, "abreast": 3, "heading": "along"}, obstacles=[])
    for seed in range(10):
        x, y, _ = build_scene(world, seed).start.T
        assert x[:3].min() > x[3:6].max() > x[3:6].min() > x[6:].max()
        assert (y[[0, 3, 6]] > y[[1, 4, 7]]).all()  # offset 1.5 stands left of offset 0
        assert (y[[1, 4]] > y[[2, 5]]).all()


def test_robots_with_a_pose_stay_and_are_kept_clear_of() -> None:
    world = road(4, {"region": REGION, "min_gap": 0.5})
    robots = [{**robot(world, 0), "pose": [12.0, 2.0, 0.3]}]
    robots += [{**robot(world, i)} for i in (1, 2)]
    own = {"region": [[30.0, -3.0], [36.0, -3.0], [36.0, 3.0], [30.0, 3.0]], "heading": 3.0}
    world = world.changed(robots=[*robots, {**robot(world, 3), "start": own}])
    for seed in range(20):
        start = build_scene(world, seed).start
        shapes = [placed(world, pose, i) for i, pose in enumerate(start)]
        assert start[0].tolist() == [12.0, 2.0, 0.3]
        assert min(shapes[0].distance(shape) for shape in shapes[1:]) >= 0.5
        assert shapely.Polygon(own["region"]).covers(shapes[3])
        assert start[3, 2] == 3.0


def fault(world: World) -> tuple:
    with pytest.raises(WorldError) as caught:
        build_scene(world, 1)
    (only,) = caught.value.faults
    return only.location, only.message


def test_too_many_are_refused_with_figures_and_what_would_do() -> None:
    small = [[1.0, -2.0], [6.0, -2.0], [6.0, 2.0], [1.0, 2.0]]
    where, message = fault(road(12, {"region": small}))
    assert where == ("start", "region")
    assert re.search(facts("of 12 robots", "0.3 m", "20 m²", "min_gap", "fewer robots"), message)
    assert re.search(r'"r\d+"', message)


def test_a_record_holds_what_makes_the_run_again(tmp_path) -> None:
    world = road(4, {"region": REGION, "abreast": 2})
    with simulate(world, seed=9, path=tmp_path / "record.h5"):
        pass
    with Record.load(tmp_path / "record.h5") as record:
        inside = parse_world(record.world_text)
        assert (record.seed, inside.seed, inside.robots) == (9, 9, world.robots)
        with simulate(inside) as again:
            assert again.digest() == record.digest()


def test_places_fill_the_region_and_headings_the_circle() -> None:
    square = [[2.0, -3.0], [8.0, -3.0], [8.0, 3.0], [2.0, 3.0]]
    dot = {"name": "r1", "footprint": {"length": 0.02, "width": 0.02}, "path": {"offset": 0.0}}
    world = road(1, {"region": square}, robots=[{**dot, "limits": {"v": 0.1, "omega": 0.1}}])
    poses = np.array([build_scene(world, seed).start[0] for seed in range(300)])
    assert abs(poses[:, :2].mean(axis=0) - [5.0, 0.0]).max() < 0.35  # 3.5 standard errors
    assert abs(poses[:, :2].std(axis=0) - 6.0 / math.sqrt(12.0)).max() < 0.25
    assert abs(np.exp(1j * poses[:, 2]).mean()) < 0.15
