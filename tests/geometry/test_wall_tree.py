"""What a robot sees of the walls, against a look at every part: equal to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from physim.geometry import Shapes
from tests.controllers.random_scenes import footprint, random_road, random_walls
from tests.helpers import inside

walls_time, arc_course = inside("physim.geometry", "walls_time", "arc_course")
point_clearance, wall_distance = inside("physim.geometry", "point_clearance", "wall_distance")
IntArray, pack_parts = inside("physim.geometry", "IntArray", "pack_parts")
parts_in_range, Sight, all_seen = inside("physim.geometry", "parts_in_range", "Sight", "all_seen")
build_wall_tree, comes_near = inside("physim.geometry", "build_wall_tree", "comes_near")
parts_seen, put_in_order = inside("physim.geometry", "parts_seen", "put_in_order")
seen_distance, seen_time = inside("physim.geometry", "seen_distance", "seen_time")

CASES = 400


def road_with_obstacles(rng: np.random.Generator) -> Shapes:
    """Boundaries of short and long segments, and solid parts."""
    road, outline = random_road(rng)
    walls = random_walls(rng, road, outline)
    ends = rng.uniform(-12.0, 12.0, (int(rng.integers(0, 20)), 2))
    walls += [[np.array([end, end + rng.normal(0.0, 0.3, 2)])] for end in ends]
    return pack_parts(walls)


def robot_among(rng: np.random.Generator, walls: Shapes) -> tuple[Shapes, np.ndarray, Sight]:
    """A robot near a wall, or in it, or far from all, and what it sees."""
    shapes = pack_parts([footprint(rng)])
    corner = walls.vertices[rng.integers(len(walls.vertices))]
    spread = rng.choice([0.3, 2.0, 30.0])
    pose = np.array([*(corner + rng.normal(0.0, spread, 2)), rng.uniform(-9.0, 9.0)])
    reach = float(rng.choice([0.7, 3.0, 10.0, np.inf]))
    return shapes, pose, Sight(build_wall_tree(walls), pose[0], pose[1], reach, np.array([-1]))


def every(walls: Shapes) -> IntArray:
    return np.arange(len(walls.part_start) - 1)


def seen_by_all(walls: Shapes, sight: Sight) -> IntArray:
    return parts_in_range(walls, every(walls), sight.x, sight.y, sight.reach)


def test_distance_is_that_of_a_look_at_every_part_in_sight() -> None:
    none = overlapping = 0
    for k in range(CASES):
        rng = np.random.default_rng([70, k])
        walls = road_with_obstacles(rng)
        shapes, pose, sight = robot_among(rng, walls)
        plain = wall_distance(shapes, 0, pose, walls, seen_by_all(walls, sight))
        assert seen_distance(shapes, 0, pose, sight) == plain
        for _ in range(3):  # what it remembers of the nearest part changes nothing
            pose = pose + rng.normal(0.0, 0.4, 3)
            moved = sight._replace(x=pose[0], y=pose[1])
            plain = wall_distance(shapes, 0, pose, walls, seen_by_all(walls, moved))
            assert seen_distance(shapes, 0, pose, moved) == plain
            none += np.isinf(plain)
            overlapping += plain < 0.0
    assert min(none, overlapping) >= 50


def test_time_is_that_of_a_look_at_every_part_in_sight() -> None:
    straight = turning = 0
    for k in range(CASES):
        rng = np.random.default_rng([71, k])
        walls = road_with_obstacles(rng)
        shapes, pose, sight = robot_among(rng, walls)
        for _ in range(8):
            v, omega = rng.choice([-1.0, 0.0, 0.6]), rng.choice([0.0, 0.0, 1e-9, 0.3, -1.2])
            a = arc_course(pose, float(v), float(omega), shapes.radius[0])
            horizon = float(rng.choice([0.5, 10.0]))
            plain = walls_time(shapes, 0, a, walls, seen_by_all(walls, sight), horizon)
            assert seen_time(shapes, 0, a, sight, horizon) == plain
            met = 0.0 < plain < np.inf
            straight += met and omega == 0.0
            turning += met and omega != 0.0
    assert min(straight, turning) >= 20


def test_parts_in_sight_are_all_of_them_in_order() -> None:
    for k in range(CASES):
        rng = np.random.default_rng([72, k])
        walls = road_with_obstacles(rng)
        _, pose, sight = robot_among(rng, walls)
        seen = seen_by_all(walls, sight)
        assert np.array_equal(all_seen(sight), seen)
        x, y = pose[:2] + rng.normal(0.0, 2.0, 2)
        within = float(rng.uniform(0.1, 5.0))
        near = parts_seen(sight, x, y, within)
        assert np.isin(parts_in_range(walls, seen, x, y, within), near).all()
        assert np.isin(near, parts_in_range(walls, seen, x, y, within + 1e-5)).all()
        clearance = point_clearance(walls, seen, x, y)
        assert comes_near(sight, x, y, within) == (clearance < within)


def test_numbers_are_put_in_order() -> None:
    rng = np.random.default_rng(74)
    for count in (0, 1, 2, 3, 7, 40, 41, 1000, 5000):
        for values in (rng.permutation(count), np.arange(count)[::-1], rng.integers(0, 9, count)):
            found = values.copy()
            put_in_order(found)
            assert np.array_equal(found, np.sort(values))


@pytest.mark.parametrize("count", [0, 1, 4, 5, 9])
def test_few_walls_or_none(count: int) -> None:
    rng = np.random.default_rng([73, count])
    walls = pack_parts([[rng.normal(0.0, 1.0, (2, 2))] for _ in range(count)])
    tree = build_wall_tree(walls)
    assert sorted(tree.part.tolist()) == list(range(count))
    shapes, pose = pack_parts([footprint(rng)]), np.array([0.5, 0.0, 1.0])
    sight = Sight(tree, 0.5, 0.0, np.inf, np.array([-1]))
    a = arc_course(pose, 1.0, 0.0, shapes.radius[0])
    assert seen_distance(shapes, 0, pose, sight) == wall_distance(
        shapes, 0, pose, walls, every(walls)
    )
    assert seen_time(shapes, 0, a, sight, 9.0) == walls_time(shapes, 0, a, walls, every(walls), 9.0)


def test_every_box_holds_what_is_below_it() -> None:
    for k in range(40):
        walls = road_with_obstacles(np.random.default_rng([74, k]))
        tree = build_wall_tree(walls)
        for node in range(1, 2 * tree.leaves):
            low, high = tree.box[node, :2], tree.box[node, 2:]
            if node < tree.leaves:
                below = tree.box[2 * node : 2 * node + 2]
            else:
                first = 4 * (node - tree.leaves)
                parts = tree.part[first : first + 4]
                corners = [
                    walls.vertices[walls.part_start[p] : walls.part_start[p + 1]] for p in parts
                ]
                below = np.array([[*c.min(axis=0), *c.max(axis=0)] for c in corners]).reshape(-1, 4)
            assert (below[:, :2] >= low).all()
            assert (below[:, 2:] <= high).all()
