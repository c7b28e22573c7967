"""ORCA held against the one of its authors, and its tracking bound against the motion."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from physim.geometry.motion import arcs, facings
from physim.geometry.shapes import pack_parts
from physim.geometry.walls import build_wall_tree, nearest_walls
from tests.helpers import inside

put_orca, OrcaRules, edges_of = inside("physim.controllers", "put_orca", "OrcaRules", "edges_of")
put_trackable_lines, tracking_command = inside(
    "physim.controllers", "put_trackable_lines", "tracking_command"
)
trackable_speed, OrcaSettings = inside("physim.controllers", "trackable_speed", "OrcaSettings")
Team, Asked, Bodies = inside("physim.controllers", "Team", "Asked", "Bodies")
SpeedRule = inside("physim.controllers", "SpeedRule")
pieces_of = inside("physim.world", "pieces_of")

RADIUS, V_MAX, T, PERIOD, HORIZON = 0.3, 1.0, 0.4, 0.1, 5.0
ROUND = RADIUS * np.stack((np.cos(np.arange(8) * np.pi / 4), np.sin(np.arange(8) * np.pi / 4)), 1)
AT_ONCE = 1e4
"""[rad/s] so fast that every velocity is one of an arc, and can be told from its command"""


def chosen(
    place: np.ndarray, velocity: np.ndarray, wish: np.ndarray, walls: list[np.ndarray],
    omega: float = AT_ONCE, robots: int | None = None, ahead: bool = False, **rules: Any,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    """Velocities (N, 2) that discs take, numbers of their rules (N,), and their reports (N, 3).

    Beyond ``robots`` of them the others are movers. Headings are those of the velocities.
    """
    many = len(place)
    robots = many if robots is None else robots
    shapes, solid = pack_parts([[ROUND]] * many), pack_parts([[one] for one in walls])
    tree, nobody = build_wall_tree(solid), np.zeros(0, np.int64)
    lines, limits = inside("physim.geometry", "pack_polylines")([[(0, 0), (1, 0)]]), (V_MAX, omega)
    team = Team(
        shapes, tree, nearest_walls(many), lines, np.zeros(many), np.tile(limits, (many, 1)),
        SpeedRule(False, 1.0, 0.0, 0.0, 1.0), np.zeros(many), nobody, 0, 0.0, 15.0, 2.0, PERIOD,
        0.0, ahead, 0.0,
    )  # fmt: skip
    heading = np.arctan2(velocity[:, 1], velocity[:, 0])
    pose, speed = np.column_stack((place, heading)), np.hypot(*velocity.T)
    station = np.where(np.arange(many) < robots, -place[:, 0], np.inf)
    bodies = Bodies(
        shapes, np.arange(many), pose, np.column_stack((speed, 0 * speed, 0 * speed)), station,
        facings(pose), many,
    )  # fmt: skip
    near = [[j for j in range(many) if j != i] for i in range(robots)]
    asked = Asked(
        np.arange(robots), np.arange(robots), wish[:robots].copy(), wish[:robots].copy(),
        np.array(sum(near, []), dtype=np.int64), np.arange(robots + 1) * (many - 1), robots,
    )  # fmt: skip
    given = {"horizon": HORIZON, "wall_horizon": HORIZON, "most": 10, "bounded": False,
             "turning_time": T, "error_min": 0.02, "error_max": 0.1}  # fmt: skip
    out = np.empty((robots, 2)), np.empty(robots, np.int64), np.empty((robots, 3))
    scene = SimpleNamespace(walls=solid, pieces=SimpleNamespace(joins=joins_of(walls)))
    put_orca(team, bodies, asked, edges_of(scene), OrcaRules(**(given | rules)), *out)
    (v, turn), heading = out[0].T * ((1.0,), (T,)), heading[:robots]
    half = np.where(turn == 0.0, 1e-9, 0.5 * turn)
    u = v / (half / np.tan(half))
    return np.stack((u * np.cos(heading + turn), u * np.sin(heading + turn)), 1), out[1], out[2]


def joins_of(walls: list[np.ndarray]) -> np.ndarray:
    """Segments whose ends meet join there."""
    found = np.full((len(walls), 2), -1)
    for p, one in enumerate(walls):
        for q, other in enumerate(walls):
            for end in range(2):
                if p != q and len(one) == len(other) == 2 and (other == one[end]).all(1).any():
                    found[p, end] = q
    return found


def drawn(rng: np.random.Generator, walls: int) -> tuple[Any, ...]:
    """Places, velocities and wishes (N, 2) of 2 to 7 discs in 4 m x 4 m, and walls among them."""
    many = int(rng.integers(2, 8))
    place = rng.uniform(-2, 2, (many, 2))
    velocity, wish = (
        rng.uniform(0, V_MAX, (many, 1))
        * (lambda a: np.column_stack((np.cos(a), np.sin(a))))(rng.uniform(-np.pi, np.pi, many))
        for _ in range(2)
    )
    return place, velocity, wish, [rng.uniform(-2, 2, (2, 2)) for _ in range(walls)]


def by_its_authors(place: Any, velocity: Any, wish: Any, walls: Any) -> tuple[Any, Any]:
    """Velocities (N, 2), and numbers of half-planes (N,), of RVO2."""
    pyrvo = pytest.importorskip("pyrvo")
    simulator = pyrvo.RVOSimulator(PERIOD, 15.0, 10, HORIZON, HORIZON, RADIUS, V_MAX)
    for wall in walls:
        simulator.add_obstacle([tuple(point) for point in wall.tolist()])
    simulator.process_obstacles()
    for k, (p, u, w) in enumerate(zip(place, velocity, wish, strict=True)):
        simulator.add_agent(tuple(p))
        simulator.set_agent_velocity(k, tuple(u))
        simulator.set_agent_pref_velocity(k, tuple(w))
    simulator.do_step()
    count = range(len(place))
    found = [simulator.get_agent_velocity(k) for k in count]
    lines = [simulator.get_agent_num_orca_lines(k) for k in count]
    return np.array([(one.x, one.y) for one in found]), np.array(lines)


@pytest.mark.parametrize("many", [300, pytest.param(3000, marks=pytest.mark.deep)])
def test_it_takes_the_velocity_that_its_authors_take(many: int) -> None:
    rng, apart, fallen = np.random.default_rng(1), [], []
    compared = 0
    for _ in range(many):
        scene = drawn(rng, int(rng.integers(0, 3)))
        theirs, lines = by_its_authors(*scene)
        ours, rule, report = chosen(*scene)
        alike = report[:, 0] == lines
        off = np.hypot(*(ours - theirs).T)
        off[np.hypot(*theirs.T) < 0.0011] = 0.0  # below it is standing
        apart += off[alike & (rule < 2)].tolist()
        fallen += off[alike & (rule == 2)].tolist()
        compared += len(off)
    print(compared, len(apart), max(apart), len(fallen), sorted(fallen)[-3:])
    assert len(apart) + len(fallen) > 0.97 * compared
    assert max(apart) < 2e-5
    assert np.quantile(fallen, 0.995) < 1e-3
