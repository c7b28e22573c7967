"""Distances of points from parts, witnesses of pairs, a turning body: by shapely and by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from tests.helpers import inside

pack_parts, Part = inside("physim.geometry", "pack_parts", "Part")
point_gap, outline_distance = inside("physim.geometry", "point_gap", "outline_distance")
collision_time_pair, describe_pairs = inside(
    "physim.geometry", "collision_time_pair", "describe_pairs"
)
BOX = [(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)]


@pytest.mark.parametrize("seed", range(20))
def test_distance_of_a_point_from_a_convex_part(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, 5))
    part = np.column_stack((np.cos(angles), np.sin(angles))) + rng.uniform(-1.0, 1.0, 2)
    solid = shapely.Polygon(part)
    for x, y in rng.uniform(-2.0, 2.0, (20, 2)):
        point = shapely.Point(x, y)
        assert outline_distance(Part(part, 0, 5), x, y) == pytest.approx(solid.distance(point))
        bound = point_gap(Part(part, 0, 5), x, y)
        if solid.contains(point):
            assert bound == pytest.approx(-solid.exterior.distance(point))
        else:
            assert 0.0 <= bound <= solid.distance(point) + 1e-12


def test_a_pair_is_described_midway_between_its_nearest_points() -> None:
    shapes = pack_parts([[BOX], [BOX]])
    pose = np.array([(0.0, 0.0, 0.0), (1.4, 2.0, math.pi / 2)])
    found = np.empty(5)
    describe_pairs(shapes, pose, np.array([[0, 1]]), 1, found.reshape(1, 5))
    x, y, nx, ny, gap = found
    corners = np.array([(0.5, 0.3), (1.1, 1.5)])  # of either box
    assert (x, y) == pytest.approx(tuple(corners.mean(axis=0)))
    assert (nx, ny) == pytest.approx(tuple((corners[1] - corners[0]) / gap))
    assert gap == pytest.approx(math.hypot(0.6, 1.2))


def test_a_bar_that_turns_in_place_meets_the_corner_of_a_box() -> None:
    """The corner (0.1, 0.9) lies on the bar's edge, 0.1 m from its axis, after that angle."""
    bar = [(-1.0, -0.1), (1.0, -0.1), (1.0, 0.1), (-1.0, 0.1)]
    box = [(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)]
    shapes = pack_parts([[bar], [box]])
    turning = shapes, 0, np.zeros(3), np.array([0.0, 1.0, 0.0])
    other = shapes, 1, np.array([0.0, 1.0, 0.0]), np.zeros(3)
    time = collision_time_pair(*turning, *other, 5.0)
    touch = math.atan2(0.9, 0.1) - math.asin(0.1 / math.hypot(0.9, 0.1))
    assert time == pytest.approx(touch, abs=1e-4)
