"""Polytope velocity obstacles: held against hulls of vertex differences, rays, and marching."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import shapely
from shapely.affinity import translate

from physim import Simulation, build_scene, load_world
from physim.testing import check_controller
from physim.world.file import parse_world
from tests.helpers import inside

PolytopeVO, PolytopeVOSettings = inside("physim.controllers", "PolytopeVO", "PolytopeVOSettings")

L_SHAPES = """
name: two that are not convex, and a wall
time: {step: 0.02, duration: 20.0}
boundaries: [[[-9, -9], [21, -9], [21, 9], [-9, 9], [-9, -9]], [[2, -2], [7, -2.2]]]
reference_path: [[-5, -5], [15, -4]]
robots:
  - name: a
    footprint: &corner [[-0.6, -0.4], [0.6, -0.4], [0.6, 0.0], [0.0, 0.0], [0.0, 0.5], [-0.6, 0.5]]
    pose: [1, 0.2, 0]
    path: [[1, 0.2], [9, 0]]
    limits: &limits {v: 1.2, omega: 1.0}
    omegas: &turns [-1.0, 0.0, 1.0]
  - {name: b, footprint: *corner, pose: [9, 0, 3.1], path: [[9, 0], [1, 0]], limits: *limits,
     omegas: *turns}
"""


def inflated(points: np.ndarray, by: float) -> np.ndarray:
    """Each vertex moved out from the mean of all."""
    off = points - points.mean(axis=0)
    return np.asarray(points + by * off / np.hypot(*off.T)[:, None])


def parts_of(scene: Any, body: int, pose: np.ndarray) -> list[np.ndarray]:
    """Inflated parts of a robot in the world."""
    shapes, (c, s) = scene.shapes, (np.cos(pose[2]), np.sin(pose[2]))
    numbers = range(shapes.body_start[body], shapes.body_start[body + 1])
    cut = [shapes.vertices[shapes.part_start[p] : shapes.part_start[p + 1]] for p in numbers]
    return [inflated(one, 0.15) @ np.array([[c, s], [-s, c]]) + pose[:2] for one in cut]


class Watching(PolytopeVO):  # type: ignore[misc, valid-type]
    """Keeps all that it was asked, and what it chose."""

    kept: Any = ()

    def avoid(self, view: Any, team: Any, bodies: Any, asked: Any, memory: Any) -> Any:
        command, rule, chosen = super().avoid(view, team, bodies, asked, memory)
        each = zip(asked.robot, asked.preferred, rule, chosen, strict=True)
        twist = bodies.twist[:, :1] * bodies.facing  # unicycles
        self.kept = view.scene, bodies.pose.copy(), twist, [tuple(one) for one in each]
        return command, rule, chosen


def decisions(world: Any, seconds: float, **settings: Any) -> Iterator[Any]:
    """(scene, pose, velocity, chosen ones) of each decision of a run."""
    controller = Watching(PolytopeVOSettings(**settings))
    simulation = Simulation(build_scene(world), controller=controller)
    for _ in range(round(seconds / 0.1)):
        simulation.step()
        yield controller.kept
        simulation.step(steps=round(0.1 / simulation.scene.dt) - 1)


def walls_of(scene: Any) -> list[np.ndarray]:
    walls = scene.wall_tree.walls
    return [
        walls.vertices[a:b] for a, b in zip(walls.part_start, walls.part_start[1:], strict=False)
    ]


def hulls(scene: Any, i: int, pose: np.ndarray, velocity: np.ndarray) -> list[Any]:
    """What robot i's relative velocities must not point at, with each apex of a VO."""
    mine, found = parts_of(scene, i, pose[i]), []
    others = [
        (part, velocity[j])
        for j in range(len(pose))
        if j != i
        for part in parts_of(scene, j, pose[j])
    ]
    for line in walls_of(scene):
        piece = shapely.LineString(line) if len(line) == 2 else shapely.Polygon(line)
        if len(line) == 2:  # cut off at the range, as the controller sees it
            far = 5.0 + scene.shapes.radius[i] + 0.15
            piece = piece.intersection(shapely.Point(pose[i, :2]).buffer(far, 512))
        if not piece.is_empty:
            ends = np.array(piece.coords if len(line) == 2 else piece.exterior.coords[:-1])
            others.append((inflated(ends, 0.15), np.zeros(2)))
    for theirs, apex in others:
        for own in mine:
            if shapely.MultiPoint(own).convex_hull.distance(
                shapely.MultiPoint(theirs).convex_hull
            ) > 5.0:  # fmt: skip
                continue
            differences = (theirs[:, None] - own[None]).reshape(-1, 2)
            found.append((shapely.MultiPoint(differences).convex_hull, apex))
    return found


def candidates(velocity: np.ndarray) -> np.ndarray:
    """The grid about a velocity, limits of 1.2 m/s."""
    axes = [np.arange(max(one - 0.5, -1.2), min(one + 0.5, 1.2) - 5e-5, 0.05) for one in velocity]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)


@pytest.mark.parametrize("world", ["league/circle_of_eight", L_SHAPES])
def test_the_best_candidate_whose_ray_misses_all_hulls_is_taken(world: str) -> None:
    seen = set()
    read = parse_world(world) if "\n" in world else load_world(world)
    for scene, pose, velocity, chosen in decisions(read, 4.0, kind="vo", speed=1.2):
        for i, preferred, rule, taken in chosen[::3]:
            obstacles = hulls(scene, i, pose, velocity)
            if any(hull.distance(shapely.Point(0, 0)) < 1e-6 for hull, _ in obstacles):
                continue  # they overlap: half-planes
            grid = candidates(velocity[i])
            off = np.hypot(*(grid - preferred).T)
            ray = [
                any(
                    hull.intersects(shapely.LineString([(0, 0), 1e3 * (u - apex)]))
                    for hull, apex in obstacles
                )
                for u in grid[np.argsort(off, kind="stable")]
            ]
            seen.add(int(rule))
            if rule == 2:
                assert all(ray)
                continue
            best = off[np.argsort(off, kind="stable")[ray.index(False)]]
            assert np.hypot(*(taken - preferred)) == pytest.approx(best, abs=1e-6)
            assert (rule == 0) == (ray.index(False) == 0)
    assert seen >= {0, 1}


def test_what_is_chosen_never_leads_moving_polygons_into_a_touch() -> None:
    looked_at = 0
    world = load_world("league/circle_of_eight")
    for scene, pose, velocity, chosen in decisions(world, 4.0, kind="vo", speed=1.2):
        bodies = [shapely.Polygon(parts_of(scene, j, one)[0]) for j, one in enumerate(pose)]
        for i, _, rule, taken in chosen:
            if rule == 2:
                continue
            for j in set(range(len(pose))) - {i}:
                if bodies[i].distance(bodies[j]) > 5.0 or bodies[i].intersects(bodies[j]):
                    continue
                looked_at += 1
                way = 20.0 * (taken - velocity[j])  # all that it ever sweeps, seen from the other
                swept = shapely.MultiPoint(
                    [*bodies[i].exterior.coords, *translate(bodies[i], *way).exterior.coords]
                ).convex_hull
                assert swept.intersection(bodies[j]).area < 1e-6
    assert looked_at > 1000


@pytest.mark.parametrize("kind", ["rvo", "hrvo"])
def test_where_all_avoid_two_that_meet_pass(kind: str) -> None:
    simulation = Simulation(
        build_scene(parse_world(L_SHAPES)), controller=PolytopeVO(PolytopeVOSettings(kind=kind))
    )
    simulation.step(steps=1000)
    assert simulation.finished
    assert not len(simulation.contacts)


def test_it_keeps_to_the_rules_with_polygons_and_with_discs() -> None:
    assert check_controller(PolytopeVO(), worlds=["three_robots", "nonconvex"], seconds=0.5) == []
    given = {"shape": "circle", "priority": "ahead", "horizon": 4.0}
    discs = PolytopeVO(PolytopeVOSettings(**given, rounding=0.4))  # 1.6 m/s is beyond the limit
    assert check_controller(discs, worlds=["three_robots"], seconds=0.5) == []


def test_a_horizon_lets_a_robot_stop_before_a_wall() -> None:
    text = """
name: a wall behind the stop
time: {step: 0.02, duration: 20.0}
boundaries: [[[-9, -5], [20, -5], [20, 5], [-9, 5], [-9, -5]]]
reference_path: [[0, -4], [12, -4]]
robots:
  - {name: a, footprint: {length: 0.8, width: 0.5}, pose: [2, 0, 0], path: [[2, 0], [9, 0]]}
obstacles: [[[10.5, -3], [11, -3], [11, 3], [10.5, 3]]]
"""
    ends = []
    for horizon in (None, 1.0):
        controller = PolytopeVO(PolytopeVOSettings(horizon=horizon))
        simulation = Simulation(build_scene(parse_world(text)), controller=controller)
        simulation.step(steps=1000)
        ends.append(float(simulation.pose[0, 0]))
    assert ends[0] < 8.5
    assert ends[1] == pytest.approx(9.0, abs=0.1)


def test_defaults_are_those_of_the_source() -> None:
    s = PolytopeVOSettings()
    given = s.margin, s.neighbour_range, s.window, s.grid, s.penalty, s.turn_time, s.horizon
    assert given == (0.15, 5.0, 0.5, 0.05, 10.0, 0.2, None)
