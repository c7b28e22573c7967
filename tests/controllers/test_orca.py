"""ORCA held against the one of its authors, and its tracking bound against the motion."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely

from tests.helpers import inside

arcs, facings, pack_parts = inside("physim.geometry", "arcs", "facings", "pack_parts")
build_wall_tree, nearest_walls = inside("physim.geometry", "build_wall_tree", "nearest_walls")
pack_polylines = inside("physim.geometry", "pack_polylines")
put_orca, OrcaRules, edges_of = inside("physim.controllers", "put_orca", "OrcaRules", "edges_of")
put_trackable_lines, tracking_command = inside(
    "physim.controllers", "put_trackable_lines", "tracking_command"
)
trackable_speed, OrcaSettings, Taken = inside(
    "physim.controllers", "trackable_speed", "OrcaSettings", "Taken"
)
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
    robots = robots or many
    shapes, solid = pack_parts([[ROUND]] * many), pack_parts([[one] for one in walls])
    tree, nobody = build_wall_tree(solid), np.zeros(0, np.int64)
    lines, limits = pack_polylines([[(0, 0), (1, 0)]]), (V_MAX, omega)
    team = Team(
        shapes, tree, nearest_walls(many), lines, np.zeros(many), np.zeros((many, 2)),
        np.zeros(many), np.tile(limits, (many, 1)), SpeedRule(False, 1.0, 0.0, 0.0, 1.0),
        np.zeros(many), nobody, 0, 0.0, 15.0, 2.0, PERIOD, 0.0, ahead, 0.0,
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
        np.array(near, dtype=np.int64).ravel(), np.arange(robots + 1) * (many - 1), robots,
    )  # fmt: skip
    given = {"horizon": HORIZON, "wall_horizon": HORIZON, "most": 10, "bounded": False,
             "turning_time": T, "error_min": 0.02, "error_max": 0.1}  # fmt: skip
    out = np.empty((robots, 2)), np.empty(robots, np.int64), np.empty((robots, 3))
    scene = SimpleNamespace(walls=solid, pieces=SimpleNamespace(joins=joins_of(walls)))
    put_orca(team, bodies, asked, OrcaRules(edges_of(scene), **(given | rules)), Taken(*out))
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


def drawn(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places, velocities and wishes (N, 2) of 2 to 7 discs in 4 m x 4 m."""
    many = int(rng.integers(2, 8))
    angle, speed = rng.uniform(-np.pi, np.pi, (2, many)), rng.uniform(0, V_MAX, (2, many))
    ways = np.stack((speed * np.cos(angle), speed * np.sin(angle)), axis=-1)
    return rng.uniform(-2, 2, (many, 2)), ways[0], ways[1]


def walls_of(rng: np.random.Generator) -> tuple[list[np.ndarray], list[np.ndarray], Any]:
    """Segments, a solid triangle or a room: as RVO2 takes them, our parts, and where discs are."""
    kind = rng.integers(0, 5)
    if kind < 3:
        segments = [rng.uniform(-2, 2, (2, 2)) for _ in range(kind)]
        return segments, segments, shapely.box(-2, -2, 2, 2)
    if kind == 3:
        middle, turn = rng.uniform(-1, 1, 2), rng.uniform(0, 7) + np.array([0.0, 1.9, 4.1])
        triangle = middle + np.stack((np.cos(turn), np.sin(turn)), axis=1)
        free = shapely.box(-2, -2, 2, 2) - shapely.Polygon(triangle)
        return [triangle], [triangle], free
    room = 2.2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) + rng.uniform(-0.2, 0.2, (4, 2))
    sides = [np.array(side) for side in zip(room, np.roll(room, -1, axis=0), strict=True)]
    return [room[::-1]], sides, shapely.Polygon(room)


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
    found = [simulator.get_agent_velocity(k) for k in range(len(place))]
    lines = [simulator.get_agent_num_orca_lines(k) for k in range(len(place))]
    return np.array([(one.x, one.y) for one in found]), np.array(lines)


@pytest.mark.parametrize("many", [300, pytest.param(3000, marks=pytest.mark.deep)])
def test_it_takes_the_velocity_that_its_authors_take(many: int) -> None:
    """As far as both have as many half-planes: RVO2 cuts walls at the lines of others."""
    rng = np.random.default_rng(1)
    feasible, fallen, asked = [], [], 0
    for _ in range(many):
        theirs, ours, free = walls_of(rng)
        scene = drawn(rng)
        expected, lines = by_its_authors(*scene, theirs)
        velocity, rule, report = chosen(*scene, ours)
        is_there = shapely.contains_xy(free, *scene[0].T)
        alike = is_there & (report[:, 0] == lines)
        off = np.hypot(*(velocity - expected).T)
        off[np.hypot(*expected.T) < 0.0011] = 0.0  # so slow that we stand
        feasible += off[alike & (rule < 2)].tolist()
        fallen += off[alike & (rule == 2)].tolist()
        asked += is_there.sum()
    assert len(feasible) + len(fallen) > 0.97 * asked
    assert len(fallen) > 0.1 * asked
    assert max(feasible) < 2e-5  # RVO2 counts in single precision
    assert np.quantile(fallen, 0.99) < 1e-3


def nearest(place: np.ndarray, velocity: np.ndarray) -> float:
    """Least distance [m] of two discs' middles within the horizon, at constant velocities."""
    times = np.linspace(0.0, HORIZON, 2001)[:, None]
    return float(np.hypot(*(np.diff(place, axis=0) + times * np.diff(velocity, axis=0)).T).min())


def test_two_share_and_what_gives_no_way_is_avoided_whole() -> None:
    rng, halves = np.random.default_rng(4), 0
    for _ in range(200):
        place = np.array([[0.0, 0.0], [rng.uniform(1, 4), rng.uniform(-0.5, 0.5)]])
        velocity = np.array([[0.8, 0.0], [-0.8, 0.0]]) + rng.uniform(-0.2, 0.2, (2, 2))
        both, rule, _ = chosen(place, velocity, velocity, [])
        if rule.max() == 2 or nearest(place, velocity) > 2 * RADIUS:
            continue
        assert nearest(place, both) > 2 * RADIUS - 1e-6
        halves += nearest(place, np.stack((both[0], velocity[1]))) < 2 * RADIUS - 1e-3
        whole, rule, _ = chosen(place, velocity, velocity, [], robots=1)
        if rule[0] < 2:
            assert nearest(place, np.stack((whole[0], velocity[1]))) > 2 * RADIUS - 1e-6
    assert halves > 50


def test_a_robot_stays_within_its_error_of_the_velocity_that_it_follows() -> None:
    rng = np.random.default_rng(5)
    for _ in range(300):
        turn, error, omega = rng.uniform(-np.pi, np.pi), rng.uniform(0.01, 0.3), rng.uniform(1, 9)
        speed = trackable_speed(turn, error, T, V_MAX, omega)
        v, w = tracking_command(speed, turn, T, omega)
        until = turn / w
        at = np.append(np.linspace(0.0, until, 200), [until + 0.3, until + 2.0])
        off = []
        for t in at:
            pose = arcs(np.zeros((1, 3)), np.array([[v, w]]), min(t, until))[0]
            straight = max(0.0, t - until) * speed * np.array([np.cos(turn), np.sin(turn)])
            off.append(pose[:2] + straight - t * speed * np.array([np.cos(turn), np.sin(turn)]))
        strayed = np.hypot(*np.array(off).T)
        assert abs(w) <= omega
        assert abs(v) <= V_MAX + 1e-12
        assert strayed.max() <= error + 1e-9
        if speed < V_MAX:  # the bound is met when it has turned
            assert strayed[199] == pytest.approx(error)
    assert tracking_command(0.5, 0.0, T, 1.5) == (0.5, 0.0)


def test_a_large_error_leaves_all_velocities_and_a_small_one_those_ahead() -> None:
    lines, limits, angle = np.empty((20, 4)), np.array([V_MAX, 2.0]), np.linspace(-np.pi, np.pi, 61)
    assert put_trackable_lines(0.3, 2.0, T, limits, lines) == 0
    count = put_trackable_lines(0.3, 0.05, T, limits, lines)
    permitted = []
    for speed in (0.01, 0.2, 0.99):
        u = speed * np.stack((np.cos(angle + 0.3), np.sin(angle + 0.3)), axis=1)
        out = lines[:count, :2] - u[:, None]
        deep = lines[:count, 2] * out[..., 1] - lines[:count, 3] * out[..., 0]
        permitted.append(np.abs(angle[deep.max(axis=1) <= 1e-9]))
    assert len(permitted[0]) == 61
    assert 0.3 < permitted[1].max() < 1.6
    assert 0.0 in permitted[2]
    assert permitted[2].max() < 0.2


def test_a_bounded_robot_goes_no_faster_than_it_can_follow() -> None:
    rng, omega = np.random.default_rng(6), 1.6
    for _ in range(100):
        scene = drawn(rng)
        _, _, report = chosen(*scene, [], omega=omega, bounded=True)
        assert np.all((report[:, 2] >= 0.02) & (report[:, 2] <= 0.1))
    far = np.array([[0.0, 0.0], [50.0, 0.0]])
    _, rule, report = chosen(far, 0.1 * far, np.array([[0.0, 1.0], [0.0, 1.0]]), [], bounded=True)
    assert report[:, 2].tolist() == [0.1, 0.1]
    assert rule.tolist() == [0, 0]
    with pytest.raises(ValueError, match="below error_min"):
        OrcaSettings(error_min=0.2)
