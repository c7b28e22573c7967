"""Robots that push each other: momentum, action and reaction, chains, hooks, friction, energy."""

from __future__ import annotations

import numpy as np
import pytest

from physim.contacts import Phase
from physim.tolerances import SETTLED_DEPTH
from tests.simulation.engine.hosts import ELL, box, drive, host

WALL = [[[(2.0, -5.0), (2.0, 5.0)]]]


@pytest.mark.parametrize("elasticity", [0.0, 0.5])
@pytest.mark.parametrize("robot", [[box()], [box(1.0, 0.3, y=0.15), box(1.0, 0.3, y=-0.15)]])
def test_dead_stop_at_a_wall_takes_all_momentum(robot, elasticity):
    """However many parts touch it; elasticity adds to the impulse, and nothing bounces."""
    physics = host([[0.0, 0.1, 0.0]], [robot], walls=WALL, mass=7.0, elasticity=elasticity)
    _, rows = drive(physics, [0.9, 0.0], 60)
    assert max(map(len, rows)) == 1
    (row,) = next(r for r in rows if len(r))
    assert (row["phase"], row["a"], row["b"]) == (Phase.BEGAN, 0, 1)
    assert row["impulse"] == pytest.approx(7.0 * 0.9 * (1.0 + elasticity), rel=1e-6)
    assert (row["nx"], row["ny"]) == pytest.approx((1.0, 0.0), abs=1e-12)
    assert abs(row["y"] - 0.1) <= (1e-9 if len(robot) == 1 else 0.3)
    assert 2.0 <= row["x"] <= 2.0 + 0.9 * 0.05
    assert physics.pose[0, 0] == pytest.approx(1.5, abs=SETTLED_DEPTH)
    # Held, it pushes with m v a step.
    assert elasticity or rows[-1]["impulse"][0] == pytest.approx(7.0 * 0.9, rel=1e-6)


def test_equal_robots_meet_and_stand_still():
    physics = host([[-1.0, 0.0, 0.0], [1.0, 0.0, np.pi]])
    poses, rows = drive(physics, [[1.0, 0.0], [1.0, 0.0]], 40)
    (row,) = next(r for r in rows if len(r))
    assert (row["a"], row["b"]) == (0, 1)
    assert (row["nx"], row["ny"]) == pytest.approx((1.0, 0.0), abs=1e-9)
    assert (row["x"], row["y"]) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert row["impulse"] == pytest.approx(10.0, rel=1e-9)  # both stop: m v each
    assert poses[-1, 0, 0] == pytest.approx(-poses[-1, 1, 0], abs=1e-9)
    assert poses[-1, 1, 0] - poses[-1, 0, 0] == pytest.approx(1.0, abs=SETTLED_DEPTH)


@pytest.mark.parametrize(
    ("heading", "speed", "mass"), [(0.0, 0.0, 10.0), (np.pi, 1.0, [30.0, 10.0])]
)
def test_one_that_is_pushed_shares_the_momentum(heading, speed, mass):
    """One that is to stand, or a lighter one that comes against: together they go at half."""
    physics = host([[0.0, 0.0, 0.0], [1.2, 0.0, heading]], mass=mass)
    poses, _ = drive(physics, [[1.0, 0.0], [speed, 0.0]], 60)
    assert (poses[-1] - poses[-21])[:, 0] == pytest.approx([0.5, 0.5], abs=2e-3)


def test_pushing_a_chain_to_a_wall():
    # Four idle robots in a row are pushed by a fifth until the first of them meets a wall.
    physics = host([[1.05 * k, 0.0, 0.0] for k in range(5)], walls=[[[(5.2, -5.0), (5.2, 5.0)]]])
    command = np.zeros((5, 2))
    command[0, 0] = 1.0
    poses, rows = drive(physics, command, 400)
    pairs = {(int(r["a"]), int(r["b"])) for r in rows[-1]}
    assert pairs == {(0, 1), (1, 2), (2, 3), (3, 4), (4, 5)}
    # A pushed row is about to buckle, so it is not straight for ever.
    assert np.abs(poses[-1, :, 1]).max() < 0.05
    assert poses[-1, 4, 0] == pytest.approx(4.7, abs=SETTLED_DEPTH)
    assert np.abs(poses[-1] - poses[-21])[:, 0].max() < 5e-3
    # At rest the push of the first goes through the whole row.
    assert rows[-1]["impulse"] == pytest.approx(10.0, rel=0.2)


@pytest.mark.parametrize(
    ("count", "first", "within"),
    [(3, 10.0, 1e-9), (5, 10.0, 1e-4), (6, 10.0, 1e-2), (2, 30.0, 1e-9), (2, 100.0, 1e-6)],
)
def test_a_push_goes_through_a_row_undiminished(count, first, within):
    """Of a row of five the last pushed the wall by 9 % more than the first was pushed; and 9 % of
    a push was lost by one a tenth as heavy as who pushed."""
    walls = [[[(count - 0.5, -5.0), (count - 0.5, 5.0)]]]
    mass = [first] + [10.0] * (count - 1)
    physics = host([[float(k), 0.0, 0.0] for k in range(count)], walls=walls, mass=mass)
    command = np.zeros((count, 2))
    command[0, 0] = 1.0
    _, rows = drive(physics, command, 200)
    assert [(r["a"], r["b"]) for r in rows[-1]] == [(k, k + 1) for k in range(count)]
    assert rows[-1]["impulse"] == pytest.approx(first, rel=within)


def test_a_u_takes_a_pole_into_its_mouth_and_is_held():
    # The pole stands within the convex hull from the start: only the true shape is free there.
    u = [box(0.3, 1.0, x=-0.35), box(0.7, 0.2, x=0.15, y=0.4), box(0.7, 0.2, x=0.15, y=-0.4)]
    physics = host([[0.0, 0.0, 0.0]], [u], walls=[[[(0.0, -0.1), (0.0, 0.1)]]])
    assert len(physics.contacts) == 0
    _, rows = drive(physics, [1.0, 0.0], 40)
    (row,) = rows[-1]
    assert physics.pose[0] == pytest.approx([0.2, 0.0, 0.0], abs=SETTLED_DEPTH)
    assert row["depth"] <= SETTLED_DEPTH
    assert (row["nx"], row["ny"]) == pytest.approx((1.0, 0.0), abs=1e-6)
    assert row["x"] == pytest.approx(0.0, abs=SETTLED_DEPTH)
    assert abs(row["y"]) <= 0.1 + 1e-9


def test_both_parts_of_an_l_touch_but_one_row_tells():
    # The corner of a block is driven into the inner corner of the L, touching both its parts.
    physics = host([[0.0, 0.0, 0.0]], [ELL], walls=[[box(0.4, 0.4, x=0.3, y=0.3)]])
    _, rows = drive(physics, [1.0, 0.0], 40)
    assert max(map(len, rows)) == len(rows[-1]) == 1


# Friction and energy


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.25, 0.5])
def test_friction_is_that_of_coulomb(friction):
    """A flat box flush with a wall, driven at it aslant: 3 m/s into it for every 4 along it."""
    heading = -np.arctan2(3.0, 4.0)
    c, s = np.cos(heading), np.sin(heading)
    flat = np.array(box(4.0, 0.2)) @ np.array([[c, -s], [s, c]])  # along the wall at that heading
    wall = [[[(-50.0, 0.0), (50.0, 0.0)]]]
    physics = host([[0.0, 0.1, heading]], robots=[[flat]], walls=wall, dt=0.01, friction=friction)
    poses, _ = drive(physics, [[1.0, 0.0]], 100)
    slid = poses[:, 0, 0]
    assert (slid[-1] - slid[-51]) / 0.5 == pytest.approx(0.8 - 0.6 * friction, abs=0.01)
    assert poses[-1, 0, 2] == pytest.approx(heading, abs=1e-3)


@pytest.mark.parametrize("seed", range(4))
def test_a_crowd_in_the_open_has_the_momentum_of_its_commands(seed):
    """At every step, whoever touches whom, and however briefly: what one robot is given another
    lacks."""
    draw, dt = np.random.default_rng(seed), 0.01
    dart = [(1.0, 0.0), (-0.7, 0.55), (-0.7, -0.55)]
    shapes = [box(1.0, 1.0), box(1.8, 1.0), box(0.8, 0.6), dart]
    place = np.linspace(0.0, 2 * np.pi, 5, endpoint=False) + draw.uniform(-0.3, 0.3, 5)
    away = draw.uniform(2.2, 4.0, 5)
    start = np.column_stack((away * np.cos(place), away * np.sin(place), place + np.pi))
    start[:, 2] += draw.uniform(-0.5, 0.5, 5)
    mass = 10.0 ** draw.uniform(1.8, 2.8, 5)
    command = np.column_stack((draw.uniform(0.1, 0.9, 5), draw.uniform(-0.3, 0.3, 5)))
    parts = [[shapes[k]] for k in draw.integers(4, size=5)]
    poses, rows = drive(host(start, parts, dt=dt, mass=mass), command, 900)
    moved = np.diff(poses, axis=0)[..., :2] / dt
    half = 0.5 * command[:, 1] * dt
    ahead = poses[:-1, :, 2] + half
    wanted = (command[:, 0] * np.sinc(half / np.pi))[:, None] * np.stack(
        (np.cos(ahead), np.sin(ahead)), axis=2
    )
    assert sum(map(len, rows)) > 200
    lost = np.einsum("j,kjc->kc", mass, moved - wanted)
    assert np.abs(lost).max() < 1e-6 * (mass * command[:, 0]).sum()


U = [
    [(0.516, 0.452), (-0.387, 0.452), (-0.129, 0.258), (0.516, 0.258)],
    [(-0.129, 0.258), (-0.387, 0.452), (-0.387, -0.452), (-0.129, -0.258)],
    [(-0.129, -0.258), (-0.387, -0.452), (0.516, -0.452), (0.516, -0.258)],
]
FLOOR = [[(-6.0, -6.0), (6.0, -6.0)]]
BACKWARDS = [-1.8023765795840256, -5.509782593090083, 1.3173745607214675]
TWICE = [[(-2.816, -0.183), (-0.827, -0.396)], [(-0.827, -0.396), (-2.816, -0.183)]]
INTO = [-2.646, -1.484, 0.630157570029585]


@pytest.mark.parametrize(
    ("start", "robot", "wall", "v", "dt", "friction", "steps"),
    [
        # a corner dragged along a floor turned by 49,200 rad in a step
        *((BACKWARDS, U, FLOOR, -2.0, 0.02, friction, 60) for friction in (0.0, 1.0, 100.0)),
        # a wall drawn there and back gave a robot 1e76 m/s
        (INTO, [box(1.608, 0.804)], TWICE, 2.0, 0.01, 5.0, 500),
    ],
)
def test_contacts_add_no_energy(start, robot, wall, v, dt, friction, steps):
    """No step is longer than its command, but for what eases overlaps."""
    physics = host([start], [robot], walls=[wall], dt=dt, friction=friction)
    poses, rows = drive(physics, [v, 0.0], steps)
    assert any(len(r) for r in rows)
    moved = np.abs(np.diff(poses[:, 0], axis=0))
    depth = np.array([r["depth"].max(initial=0.0) for r in rows])[:-1]
    way = abs(v) * dt + 2.0 * depth
    assert (np.hypot(*moved[:, :2].T) <= way + 1e-4 * abs(v) * dt).all()
    assert (moved[:, 2] <= 4.0 * way + 1e-9).all()
    assert all((r["impulse"] <= 100.0 * abs(v)).all() for r in rows)
