"""CBF-QP: its lines against differences of the exact distance, its command against enumeration, and
no contact in the physics as long as all barriers can be kept."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely

from physim import Simulation, build_scene, load_world
from physim.testing import check_controller
from physim.world import World
from tests.helpers import inside

Approached, CbfQp, CbfQpSettings = inside(
    "physim.controllers", "Approached", "CbfQp", "CbfQpSettings"
)
put_barriers, project_and_turn = inside("physim.controllers", "put_barriers", "project_and_turn")
body_distance, relative_frame = inside("physim.geometry", "body_distance", "relative_frame")
arcs, pack_parts, Part = inside("physim.geometry", "arcs", "pack_parts", "Part")
build_wall_tree, body_parts = inside("physim.geometry", "build_wall_tree", "body_parts")

LIMITS = np.array([1.2, 1.5])
ELL = np.array([[-0.5, -0.3], [0.5, -0.3], [0.5, 0.0], [0.0, 0.0], [0.0, 0.4], [-0.5, 0.4]])


def convex(rng: np.random.Generator) -> np.ndarray:
    """A convex polygon about a point near the origin."""
    many = int(rng.integers(3, 7))
    turn = np.sort((np.arange(many) + rng.uniform(0.1, 0.9, many)) * 2.0 * np.pi / many)
    size = rng.uniform(0.3, 0.6) * np.array([1.0, rng.uniform(0.4, 1.0)])
    return rng.uniform(-0.2, 0.2, 2) + size * np.stack((np.cos(turn), np.sin(turn)), axis=1)


def placed(shape: np.ndarray, pose: np.ndarray) -> np.ndarray:
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return np.asarray(shape @ np.array([[c, s], [-s, c]]) + pose[:2])


def test_a_line_is_where_the_exact_distance_falls_as_fast_as_it_may() -> None:
    rng, rate, margin, step, looked_at = np.random.default_rng(1), 1.3, 0.05, 1e-6, 0
    while looked_at < 150:
        a, b, at, there = convex(rng), convex(rng), *rng.uniform(-1.2, 1.2, (2, 3))
        twist, turn, shapes = rng.uniform(-1.0, 1.0, 2), there[2] - at[2], pack_parts([[a], [b]])
        other = Approached(
            relative_frame(at, there), twist[0] * np.cos(turn), twist[0] * np.sin(turn), twist[1],
            1.0, rate, 0.1, margin, *LIMITS,
        )  # fmt: skip
        lines = np.empty((len(a) + len(b), 4))
        count, gap = put_barriers(other, Part(a, 0, len(a)), Part(b, 0, len(b)), lines, 0)
        if gap < 0.01:
            continue
        p, d = lines[:count, :2], lines[:count, 2:]
        commands = rng.uniform(-1.0, 1.0, (20, 2))
        on = (p[:, None] + np.array([[-0.3], [0.0], [0.4]]) * d[:, None]).reshape(-1, 2)
        slack = []
        for command in np.vstack((commands, on)) * LIMITS:
            before, after = (
                body_distance(
                    shapes, 0, arcs(at[None], command[None], t)[0],
                    shapes, 1, arcs(there[None], twist[None], t)[0],
                )
                for t in (-step, step)
            )  # fmt: skip
            slack.append((after - before) / (2.0 * step) + rate * (gap - margin))
        off = p[:, None] - commands
        deep = d[:, None, 0] * off[..., 1] - d[:, None, 1] * off[..., 0]
        forbidden = np.array(slack[:20]) < -1e-6
        assert not np.any(forbidden & (deep.max(axis=0, initial=-1.0) <= 0.0))
        if forbidden.any():
            looked_at += 1
            assert np.abs(np.reshape(slack[20:], (-1, 3))).max(axis=1).min() < 1e-6


def room(seed: int, gap: float = 0.055, side: float = 6.0, robots: int = 6) -> World:
    """Polygons anywhere in a room with two walls more, each to go anywhere else."""
    rng = np.random.default_rng(seed)
    walls = [np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]) * side]
    walls.append((0.5 * side + rng.uniform(-1.0, 1.0, (3, 2))).round(3))
    solid: list[Any] = [shapely.LineString(wall) for wall in walls]
    rows: list[dict[str, Any]] = []
    while len(rows) < robots:
        shape = ELL if rng.random() < 0.3 else convex(rng).round(3)
        pose, goal = rng.uniform((0, 0, -3), (side, side, 3)), rng.uniform(0.4, side - 0.4, 2)
        body = shapely.Polygon(placed(shape, pose))
        inner = shapely.box(0, 0, side, side).contains(body)
        if not inner or min(map(body.distance, solid)) < gap or math.dist(goal, pose[:2]) < 1.0:
            continue
        solid.append(body)
        rows.append({
            "name": f"r{len(rows)}", "footprint": shape.tolist(), "pose": pose.tolist(),
            "path": [pose[:2].tolist(), goal.tolist()], "limits": {"v": 1.0, "omega": 1.5},
        })  # fmt: skip
    return World(
        name="room", time={"step": 0.0125, "duration": 60.0}, robots=rows,
        boundaries=[wall.tolist() for wall in walls], reference_path=[[0, 0], [side, side]],
    )  # fmt: skip


class Watched(CbfQp):  # type: ignore[misc]
    """Keeps what was asked and decided; may be blind to walls."""

    blind = False

    def avoid(self, view: Any, team: Any, bodies: Any, asked: Any, memory: Any) -> Any:
        if self.blind:
            team = team._replace(walls=build_wall_tree(pack_parts([])))
        self.last = team, bodies, asked, super().avoid(view, team, bodies, asked, memory)
        self.stuck = np.any(self.last[3].rule == 2)
        return self.last[3]


def permitted(me: int, watched: Watched) -> np.ndarray:
    """(n, 3) g_v, g_omega, c of all barriers g . (v, omega) >= c, by the formula and shapely."""
    (team, bodies, _, _), rows, own = watched.last, [], watched.settings
    x, e = bodies.pose[me, :2], bodies.facing[me]
    mine = [placed(part, bodies.pose[me]) for part in body_parts(team.shapes, bodies.number[me])]
    walls, still = team.walls.walls, np.zeros(2)
    others = [
        (1.0, part, still, still, 0.0)
        for k in range(len(walls.body_start) - 1)
        for part in body_parts(walls, k)
    ]
    for j in set(range(bodies.size)) - {me}:
        share, twist = 0.5, (0.0, 0.0)
        if own.priority == "ahead":
            share = float(bodies.station[j] > bodies.station[me])
            twist = bodies.twist[j, :2]
        for part in body_parts(team.shapes, bodies.number[j]) if share else ():
            there = bodies.pose[j]
            move = twist[0] * bodies.facing[j]
            others.append((share, placed(part, there), there[:2], move, twist[1]))
    for share, b, middle, move, turn in others:
        for a in mine:
            outline_a, outline_b = shapely.LinearRing(a), shapely.LineString([*b, b[0]])
            pairs = [shapely.shortest_line(shapely.Point(p), outline_b) for p in a]
            pairs += [shapely.shortest_line(outline_a, shapely.Point(p)) for p in b]
            gap = min(pair.length for pair in pairs)
            for at, there in (np.array(pair.coords) for pair in pairs):
                d = math.dist(at, there)
                fall = own.rate * (gap - own.margin) + (d - gap) / own.update_period
                n, (lx, ly) = (at - there) / d, at - x
                (rx, ry), arm = there - middle, n @ (-ly, lx)
                nears = n @ (move + turn * np.array([-ry, rx]))
                rows.append((n @ e, arm, nears - share * fall))
    return np.array(rows)


def by_enumeration(wish: np.ndarray, lines: np.ndarray, limits: np.ndarray) -> np.ndarray:
    """The best of the wish, its feet on all lines, and all crossings, in shares of the limits."""
    box = np.array([[1, 0, -1], [-1, 0, -1], [0, 1, -1], [0, -1, -1]], dtype=float)
    lines = np.vstack((lines * [*limits, 1.0], box))
    lines = lines[np.hypot(*lines.T[:2]) > 1e-9]
    lines /= np.hypot(*lines.T[:2])[:, None]
    g, c = lines[:, :2], lines[:, 2]
    feet = wish + (c - g @ wish)[:, None] * g
    i, j = np.triu_indices(len(g), 1)
    across = g[i, 0] * g[j, 1] - g[i, 1] * g[j, 0]
    i, j, across = i[abs(across) > 1e-9], j[abs(across) > 1e-9], across[abs(across) > 1e-9]
    x, y = (c[i] * g[j, 1] - c[j] * g[i, 1]) / across, (g[i, 0] * c[j] - g[j, 0] * c[i]) / across
    found = np.vstack((wish, feet, np.stack((x, y), axis=1)))
    found = found[(found @ g.T - c).min(axis=1) >= -1e-9]
    return np.asarray(found[np.hypot(*(found - wish).T).argmin()])


@pytest.mark.parametrize("rooms", [4, pytest.param(20, marks=pytest.mark.deep)])
def test_the_command_is_the_nearest_that_all_barriers_permit(rooms: int) -> None:
    moved = 0
    for seed in range(rooms):
        priority = ("shared", "ahead")[seed % 2]
        watched = Watched(CbfQpSettings(rate=2.0, priority=priority))
        simulation = Simulation(build_scene(room(seed)), controller=watched)
        for _ in range(4):
            simulation.step(steps=8)
            team, _, asked, out = watched.last
            for k in range(asked.size):
                if out.rule[k] == 2:
                    continue
                i, me = asked.robot[k], asked.row[k]
                pose, limits = watched.last[1].pose[me], team.limits[i]
                wish = np.array(project_and_turn(*asked.preferred[k], pose[2], *limits, 0.5))
                best = by_enumeration(wish / limits, permitted(me, watched), limits)
                assert out.command[k] / limits == pytest.approx(best, abs=1e-6)
                moved += out.rule[k] == 1
    assert moved > 4 * rooms


def contacts(rooms: int, controller: Watched) -> tuple[int, int]:
    """In how many rooms robots touch, and how many were left where barriers could not be kept."""
    touched, stuck = 0, 0
    for seed in range(rooms):
        simulation = Simulation(build_scene(room(seed)), controller=controller)
        for _ in range(400):
            simulation.step()
            if controller.stuck or len(simulation.contacts):
                break
        stuck += bool(controller.stuck)
        touched += bool(len(simulation.contacts)) and not controller.stuck
    return touched, stuck


@pytest.mark.parametrize("rooms", [8, pytest.param(100, marks=pytest.mark.deep)])
def test_none_touches_where_all_keep_their_barriers(rooms: int) -> None:
    for rate in (1.0, 5.0):
        assert contacts(rooms, Watched(CbfQpSettings(rate=rate))) == (0, 0)
    too_fast = CbfQpSettings.model_construct(**CbfQpSettings().model_dump() | {"rate": 100.0})
    assert contacts(8, Watched(too_fast))[0] >= 2
    blind = Watched(CbfQpSettings())
    blind.blind = True
    assert contacts(8, blind)[0] >= 6


def test_it_keeps_to_the_rules_and_refuses_a_rate_that_closes_gaps_in_a_period() -> None:
    assert check_controller(CbfQp(), worlds=["three_robots"], seconds=0.5) == []
    with pytest.raises(ValueError, match=r"rate is 11 1/s.* at most 10 1/s"):
        CbfQpSettings(rate=11.0)
    CbfQpSettings(rate=20.0, update_period=0.05)


def test_it_clears_what_following_the_path_alone_does_not() -> None:
    least = {}
    for controller in ("cbf_qp", "path_following"):
        simulation = Simulation(load_world("doorway"), controller=controller)
        least[controller] = math.inf
        for _ in range(400):
            simulation.step(steps=10)
            gaps = np.minimum(simulation.clearance, simulation.boundary_clearance)
            least[controller] = min(least[controller], float(gaps.min()))
        if controller == "cbf_qp":
            assert simulation.arrived.all()
    assert least["path_following"] <= 0.0 < 0.05 < least["cbf_qp"]
