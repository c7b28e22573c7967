"""Robots that push each other: momentum, action and reaction, chains, hooks."""

from __future__ import annotations

import numpy as np
import pytest

from physim.contacts import Phase
from physim.tolerances import SETTLED_DEPTH
from tests.simulation.engine.hosts import ELL, box, drive, host


def first_touch(rows):
    return next(r for r in rows if len(r))


def test_dead_stop_at_a_wall_takes_all_momentum():
    physics = host([[0.0, 0.1, 0.0]], walls=[[[(2.0, -5.0), (2.0, 5.0)]]], mass=7.0)
    _, rows = drive(physics, [0.9, 0.0], 60)
    (row,) = first_touch(rows)
    assert row["phase"] == Phase.BEGAN
    assert (row["a"], row["b"]) == (0, 1)
    assert row["impulse"] == pytest.approx(7.0 * 0.9, rel=1e-9)
    assert (row["nx"], row["ny"]) == pytest.approx((1.0, 0.0), abs=1e-12)
    assert row["y"] == pytest.approx(0.1, abs=1e-9)
    assert 2.0 <= row["x"] <= 2.0 + 0.9 * 0.05
    # Held, it pushes with m v a step.
    assert rows[-1]["impulse"][0] == pytest.approx(7.0 * 0.9, rel=1e-6)


def test_elasticity_adds_to_the_impulse_alone():
    wall = [[[(2.0, -5.0), (2.0, 5.0)]]]
    for elasticity in (0.0, 0.5):
        physics = host([[0.0, 0.0, 0.0]], walls=wall, elasticity=elasticity)
        _, rows = drive(physics, [1.0, 0.0], 60)
        assert first_touch(rows)["impulse"][0] == pytest.approx(10.0 * (1 + elasticity), rel=1e-6)
        assert physics.pose[0, 0] == pytest.approx(1.5, abs=SETTLED_DEPTH)


def test_equal_robots_meet_and_stand_still():
    physics = host([[-1.0, 0.0, 0.0], [1.0, 0.0, np.pi]])
    poses, rows = drive(physics, [[1.0, 0.0], [1.0, 0.0]], 40)
    (row,) = first_touch(rows)
    assert (row["a"], row["b"]) == (0, 1)
    assert (row["nx"], row["ny"]) == pytest.approx((1.0, 0.0), abs=1e-9)
    assert (row["x"], row["y"]) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert row["impulse"] == pytest.approx(10.0, rel=1e-9)  # both stop: m v each
    assert poses[-1, 0, 0] == pytest.approx(-poses[-1, 1, 0], abs=1e-9)
    assert poses[-1, 1, 0] - poses[-1, 0, 0] == pytest.approx(1.0, abs=SETTLED_DEPTH)


def test_pushing_an_idle_robot_shares_the_momentum():
    # A commands 1 m/s, B stands and is commanded to stand: together they go at half the speed.
    physics = host([[0.0, 0.0, 0.0], [1.2, 0.0, 0.0]])
    poses, _ = drive(physics, [[1.0, 0.0], [0.0, 0.0]], 60)
    speed = (poses[-1] - poses[-21])[:, 0]
    assert speed == pytest.approx([0.5, 0.5], abs=2e-3)


def test_heavier_robot_wins_by_mass():
    physics = host([[0.0, 0.0, 0.0], [1.2, 0.0, np.pi]], mass=[30.0, 10.0])
    poses, _ = drive(physics, [[1.0, 0.0], [1.0, 0.0]], 60)
    assert (poses[-1] - poses[-21])[:, 0] == pytest.approx([0.5, 0.5], abs=2e-3)


def test_pushing_a_chain_to_a_wall():
    # Four idle robots in a row are pushed by a fifth until the first of them meets a wall.
    start = [[1.05 * k, 0.0, 0.0] for k in range(5)]
    wall = [[(5.2, -5.0), (5.2, 5.0)]]
    physics = host(start, walls=[wall])
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


@pytest.mark.parametrize(("count", "within"), [(3, 1e-9), (5, 1e-4), (6, 1e-2)])
def test_a_push_goes_through_a_row_undiminished(count: int, within: float) -> None:
    """Of a row of five the last pushed the wall by 9 % more than the first was pushed."""
    walls = [[[(count - 0.5, -5.0), (count - 0.5, 5.0)]]]
    physics = host([[float(k), 0.0, 0.0] for k in range(count)], walls=walls)
    command = np.zeros((count, 2))
    command[0, 0] = 1.0
    _, rows = drive(physics, command, 200)
    assert len(rows[-1]) == count
    assert rows[-1]["impulse"] == pytest.approx(10.0, rel=within)


@pytest.mark.parametrize(("heavier", "within"), [(3.0, 1e-9), (10.0, 1e-6)])
def test_a_light_robot_hands_a_heavy_push_on_to_the_wall(heavier: float, within: float) -> None:
    """9 % of it was lost by one a tenth as heavy."""
    wall = [[[(1.5, -5.0), (1.5, 5.0)]]]
    start = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    physics = host(start, walls=wall, mass=[10.0 * heavier, 10.0])
    _, rows = drive(physics, [[1.0, 0.0], [0.0, 0.0]], 200)
    assert [(r["a"], r["b"]) for r in rows[-1]] == [(0, 1), (1, 2)]
    assert rows[-1]["impulse"] == pytest.approx(10.0 * heavier, rel=within)


def test_friction_holds_back_a_sliding_robot():
    wall = [[[(-50.0, 0.0), (50.0, 0.0)]]]
    reached = []
    for friction in (0.0, 0.5):
        # Pressed to the wall by a robot above it.
        physics = host([[0.0, 0.301, 0.0], [0.0, 1.2, -np.pi / 2]], walls=wall, friction=friction)
        poses, _ = drive(physics, [[1.0, 0.0], [1.0, 0.0]], 20)
        reached.append(poses[-1, 0, 0])
    assert reached[1] < reached[0] - 0.05


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


def test_a_u_takes_a_pole_into_its_mouth_and_is_held():
    # The pole stands within the convex hull from the start: only the true shape is free there.
    u = [box(0.3, 1.0, x=-0.35), box(0.7, 0.2, x=0.15, y=0.4), box(0.7, 0.2, x=0.15, y=-0.4)]
    pole = [[(0.0, -0.1), (0.0, 0.1)]]
    physics = host([[0.0, 0.0, 0.0]], [u], walls=[pole])
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
    block = [box(0.4, 0.4, x=0.3, y=0.3)]
    physics = host([[0.0, 0.0, 0.0]], [ELL], walls=[block])
    _, rows = drive(physics, [1.0, 0.0], 40)
    assert all(len(r) <= 1 for r in rows)
    assert len(rows[-1]) == 1


@pytest.mark.parametrize("seed", range(4))
def test_a_crowd_in_the_open_has_the_momentum_of_its_commands(seed):
    """At every step, whoever touches whom, and however briefly: what one robot is given another
    lacks."""
    draw, dt = np.random.default_rng(seed), 0.01
    shapes = [
        box(1.0, 1.0),
        box(1.8, 1.0),
        box(0.8, 0.6),
        [(1.0, 0.0), (-0.7, 0.55), (-0.7, -0.55)],
    ]
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
