"""Where a target in the danger area moves to, against border points and against cut polygons."""

from __future__ import annotations

import math

import numpy as np
import shapely

from tests.controllers.random_scenes import random_road, random_walls, stretches_outside
from tests.helpers import inside
from tests.oracles import paths, safe_area
from tests.oracles.safe_area import Place
from tests.oracles.tolerances import ROUNDING
from tests.oracles.view import shape

Point, Target, safe_target = inside("physim.controllers", "Point", "Target", "safe_target")
build_wall_tree, nearest_walls, pack_parts = inside(
    "physim.geometry", "build_wall_tree", "nearest_walls", "pack_parts"
)
Sight = inside("physim.geometry", "Sight")

QUARTER = 32
"""edges in place of a quarter of a circle about a corner"""
CHORD = 2.0 * (1.0 - math.cos(math.pi / (4 * QUARTER)))
"""[-] how far, as a share of L, the border lies off such polygons, doubled; asserted is twenty
times that, for corners at which two pieces of it cross aslant"""


def random_place(rng: np.random.Generator) -> tuple[Place, np.ndarray]:
    """A target on a path through a corridor with obstacles, and the robot."""
    road, outline = random_road(rng)
    area = shapely.Polygon(outline)
    walls = tuple(part for body in random_walls(rng, road, outline) for part in body)
    path = road + rng.normal(0.0, rng.choice([0.3, 2.0]), road.shape)
    station = rng.uniform(0.0, paths.lengths(path)[-1])
    target, ahead = paths.point_at(path, station)
    outside = safe_area.is_outside(stretches_outside(path, area), station)
    here = paths.point_at(road, station - rng.uniform(0.5, 4.0))[0]
    look_ahead, width = float(rng.uniform(0.4, 3.0)), float(rng.uniform(0.2, 1.5))
    return safe_area.place(walls, target, ahead, outside, here, look_ahead, width), here


def moved(where: Place, robot: np.ndarray) -> np.ndarray:
    tree = build_wall_tree(pack_parts([[part] for part in where.walls]))
    sight = Sight(tree, robot[0], robot[1], np.inf, nearest_walls(1))
    target = Target(Point(*where.target), Point(*where.ahead), where.outside)
    return np.array(
        safe_target(sight, target, Point(*robot), where.look_ahead, where.safe_distance)
    )


def test_targets_agree_with_the_oracle() -> None:
    kinds = []
    for k in range(200):
        where, robot = random_place(np.random.default_rng([80, k]))
        kind = safe_area.judge(where, moved(where, robot))
        kinds.append(kind + " from outside" * where.outside)
        assert kind in safe_area.KINDS, k
    met = ("as it is", "moved", "narrow", "moved from outside", "narrow from outside")
    assert min(map(kinds.count, met)) >= 3


def test_nearest_point_of_the_safe_area_where_nothing_hides_it() -> None:
    """The area by shapely: all within reach less rounded strips about the walls."""
    compared = 0
    for k in range(150):
        where, robot = random_place(np.random.default_rng([81, k]))
        if where.outside or where.clearances(where.target[None])[0] >= where.safe_distance:
            continue
        point = moved(where, robot)
        strips = [shape(p).buffer(where.safe_distance, quad_segs=QUARTER) for p in where.walls]
        near = shapely.Point(where.target).buffer(where.reach)
        safe = near.difference(shapely.union_all(strips))
        if safe.is_empty:
            continue
        nearest = shapely.shortest_line(safe, shapely.Point(where.target))
        if safe_area.may_replace(where, shapely.get_coordinates(nearest)[:1], -0.05)[0]:
            gap = math.dist(point, where.target)
            assert abs(gap - nearest.length) <= 20.0 * CHORD * where.safe_distance
            compared += 1
    assert compared >= 10


def test_what_stands_between_robot_and_a_far_target_is_a_wall() -> None:
    """The wall is further from the target than any safe point may be, and hides all of them."""
    wall = np.array([[0.0, -50.0], [0.0, 50.0]])
    where = Place(
        walls=(wall, np.array([[20.3, -50.0], [20.3, 50.0]])),
        target=np.array([20.0, 0.0]),
        ahead=np.array([1.0, 0.0]),
        eye=np.array([-1.0, 0.0]),
        outside=True,
        look_ahead=1.0,
        safe_distance=0.5,
    )
    assert moved(where, where.eye).tolist() == [20.0, 0.0]
    assert abs(moved(where, np.array([1.0, 0.0])) - [19.8, 0.0]).max() <= ROUNDING
