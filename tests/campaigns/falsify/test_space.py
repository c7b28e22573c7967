"""Every world of a space lies within its bounds and can be run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from physim import Simulation, build_scene
from physim.world import World
from physim.world.file import load_world
from tests.campaigns.falsify.worlds import BOX, five_robots, robot
from tests.helpers import inside

KINDS, REACH, GAP = inside("physim.campaigns.falsify", "KINDS", "REACH", "GAP")
Space, pinned = inside("physim.campaigns.falsify", "Space", "pinned")
lay_out = inside("physim.world.layout", "lay_out")
placed_outline = inside("physim.world.ground", "placed_outline")


def in_region(**changes: Any) -> World:
    """Four robots in a region that the seed fills, along a narrow road."""
    values: dict[str, Any] = {
        "name": "in a region",
        "seed": 3,
        "time": {"step": 0.05, "duration": 2.0},
        "corridor": {"centreline": [[0.0, 0.0], [20.0, 0.0]], "width": 6.0},
        "start": {"region": [[0.0, -2.5], [9.0, -2.5], [9.0, 2.5], [0.0, 2.5]], "min_gap": 0.2},
        "robots": [{"count": 4, "footprint": BOX, "path": {"offset": 0.0}}],
    }
    return World(**{**values, **changes})


def outlines(world: World) -> list[Any]:
    laid = lay_out(world)
    return [
        placed_outline(outline, pose)
        for pose, outline in zip(laid.start, laid.footprints, strict=True)
    ]


def points(size: int) -> st.SearchStrategy[list[float]]:
    return st.lists(st.floats(0.0, 1.0), min_size=size, max_size=size)


FIVE, REGION = Space(five_robots(), KINDS), Space(in_region(), KINDS)


@settings(max_examples=20)
@given(points(len(FIVE.dimensions)))
def test_every_world_is_within_bounds_and_can_be_run(point: list[float]) -> None:
    world = FIVE.at(np.array(point)).world
    build_scene(world)
    base = FIVE.world.robots
    for one, was in zip(world.robots, base, strict=True):
        assert one.pose is not None
        assert was.pose is not None
        assert np.abs(np.subtract(one.pose[:2], was.pose[:2])).max() <= REACH + 1e-9
        assert abs(one.pose[2] - was.pose[2]) <= 0.5 + 1e-9
        for key in ("v", "omega"):
            share = getattr(one.limits, key) / getattr(was.limits, key)
            assert 0.5 - 1e-9 <= share <= 1.0
        assert one.footprint == was.footprint
    shapes = outlines(world)
    gaps = [a.distance(b) for k, a in enumerate(shapes) for b in shapes[:k]]
    assert min(gaps) >= GAP - 1e-6


@settings(max_examples=20)
@given(points(len(REGION.dimensions)))
def test_robots_start_anywhere_in_their_region_and_only_there(point: list[float]) -> None:
    world = REGION.at(np.array(point)).world
    region = shapely.Polygon([[0.0, -2.5], [9.0, -2.5], [9.0, 2.5], [0.0, 2.5]]).buffer(1e-9)
    shapes = outlines(world)
    assert all(region.covers(shape) for shape in shapes)
    least = float(REGION.starts.gap.min())
    assert least >= 0.2 - 1e-6
    assert min(a.distance(b) for k, a in enumerate(shapes) for b in shapes[:k]) >= least - 1e-6


def test_the_middle_is_the_world_itself() -> None:
    drawn = FIVE.at(FIVE.base)
    assert not drawn.repaired
    for one, was in zip(drawn.world.robots, FIVE.world.robots, strict=True):
        assert one.pose == pytest.approx(was.pose, abs=1e-12)


def test_starts_that_overlap_are_moved_apart_and_counted() -> None:
    world = five_robots(robots=[robot("a", 4.0, 0.0, 0.0), robot("b", 5.5, 0.0, 0.0)],
                        controller={"type": "path_following"})  # fmt: skip
    space = Space(world, ("pose",))
    together = np.array([1.0, 0.5, 0.0, 0.5])  # each a metre towards the other
    drawn = space.at(together)
    assert drawn.repaired
    build_scene(drawn.world)
    a, b = outlines(drawn.world)
    assert a.distance(b) >= float(space.starts.gap.max()) - 1e-6
    assert not space.at(np.array([0.0, 0.5, 1.0, 0.5])).repaired


def test_pinned_it_is_the_same_run() -> None:
    for world in (in_region(), load_world("three_robots"), load_world("hundred_robots")):
        fixed, laid = pinned(world, 7)
        assert np.array_equal(lay_out(fixed).start, laid.start)
        assert np.array_equal(lay_out(world, 7).start, laid.start)
        assert fixed.start is None


def slow(controller: str, **limits: Any) -> World:
    own = {} if "omegas" not in limits else {"omegas": limits.pop("omegas")}
    robots = [{**robot("a", 2.0, 0.0, 0.0), "limits": {"v": 1.5, "omega": 1.6, **limits}, **own}]
    time = {"step": 0.02, "duration": 1.0}
    return five_robots(robots=robots, controller={"type": controller}, time=time)


@pytest.mark.parametrize(
    ("controller", "limits", "least"),
    [
        ("constant", {}, {"v": 0.75, "omega": 0.8}),
        ("path_following", {"omegas": [-1.2, 0.0, 1.3]}, {"v": 0.75, "omega": 1.3}),
        ("mode_switching", {}, {"v": 0.75, "omega": np.pi / 2}),  # the fastest turn it chooses from
        ("mode_switching", {"omega": 4.0}, {"v": 0.75, "omega": 2.0}),
        ("mode_switching", {"omega": 1.6, "omegas": [-0.9, 0.9]}, {"v": 0.75, "omega": 0.9}),
        ("path_following", {"omegas": [-1.6, 1.6]}, {"v": 0.75}),
    ],
)
def test_limits_go_down_to_what_the_controller_takes(
    controller: str, limits: dict[str, Any], least: dict[str, float]
) -> None:
    space = Space(slow(controller, **limits), ("speed",))
    assert {one.key: one.low for one in space.dimensions} == pytest.approx(least, abs=1e-5)
    Simulation(space.at(np.zeros(len(space.dimensions))).world)
