"""Contacts are those of the exact distance, told row by row: none missed, none invented."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim.contacts import Kind, Phase
from physim.tolerances import CONTACT
from tests.helpers import examples, inside
from tests.simulation.engine.crowds import crowd, digest, go_on
from tests.simulation.engine.hosts import (
    ELL,
    FALSE_CONTACTS,
    box,
    distances,
    drive,
    host,
    pairs_in,
    segments,
    side_by_side,
)

describe_pairs, joined_shapes = inside("physim.geometry", "describe_pairs", "joined_shapes")
pack_parts = inside("physim.geometry", "pack_parts")

ROBOTS = [[box()], ELL, [box(0.4, 0.4)], [[(-0.3, -0.3), (0.6, 0.0), (-0.3, 0.3)]], [box()], ELL]
RING = [(-1.5, -1.5), (0.0, -1.5), (1.5, -1.5), (1.5, 1.5), (0.2, 1.2), (-1.5, 1.5), (-1.5, -1.5)]
WALLS = [segments(RING), [box(0.3, 0.3, x=0.5)], [box(0.4, 0.2, x=-0.8), box(0.2, 0.5, x=-0.8)]]


def exact(robots, walls, pose):
    """Pairs that touch, by distances."""
    found = distances(pack_parts(robots), pack_parts(walls), pose)
    return {pair for pair, d in found.items() if d <= CONTACT}


@examples(25, deep=150)
@given(
    st.lists(
        st.tuples(
            st.floats(-1.6, 1.6),
            st.floats(-1.6, 1.6),
            st.one_of(st.floats(-4, 4), st.sampled_from([0.0, math.pi / 2, -math.pi, 0.5])),
        ),
        min_size=6,
        max_size=6,
    ),
    st.floats(-1.0, 1.0),
)
def test_contacts_agree_with_distances(start, speed):
    physics = host(start, ROBOTS, walls=WALLS)
    for _ in range(4):
        assert pairs_in(physics.contacts) == exact(ROBOTS, WALLS, physics.pose)
        physics.step(np.tile([speed, 0.3], (6, 1)))


@examples(25, deep=150)
@given(
    st.sampled_from([-1e-6, -1e-9, -1e-12, 0.0, 1e-12, 0.9e-9, 1.1e-9, 1e-8, 1e-6]),
    st.floats(-math.pi, math.pi),
    st.floats(-50, 50),
    st.floats(-0.9, 0.9),
    st.sampled_from([0.0, 0.3, math.pi / 2]),
)
def test_at_the_very_edge_of_contact(gap, heading, away, shift, turn):
    # A box beside a box, turned against it or aligned: touching within 1e-9 m is contact.
    reach = 0.3 + 0.5 * math.sin(turn) + 0.3 * math.cos(turn)
    c, s = math.cos(heading), math.sin(heading)
    x, y = shift * c - (reach + gap) * s, shift * s + (reach + gap) * c
    physics = host([[away, away, heading], [away + x, away + y, heading + turn]])
    assert pairs_in(physics.contacts) == exact([[box()]] * 2, [], physics.pose)


@pytest.mark.parametrize("dt", [0.05, 0.02])
def test_first_contact_is_at_the_sample_that_the_collision_time_says(dt):
    rng = np.random.default_rng(3)
    for _ in range(30):
        gap, v, u = rng.uniform(0.01, 2.0), rng.uniform(0.1, 1.0), rng.uniform(0.1, 1.0)
        physics = host([[0.0, 0.0, 0.0], [1.0 + gap, rng.uniform(-0.5, 0.5), np.pi]], dt=dt)
        expected = math.ceil((gap / (v + u) - CONTACT) / dt)
        _, rows = drive(physics, [[v, 0.0], [u, 0.0]], expected)
        assert [len(r) for r in rows] == [0] * expected + [1]
        assert rows[-1]["step"][0] == expected


def test_many_contacts_at_once_are_all_told():
    """More than the engine's arrays hold at first."""
    rng = np.random.default_rng(0)
    robots = [[[(-0.5, -0.3), (0.5, -0.3), (0.0, 0.5)]]] * 60
    physics = host(np.column_stack((rng.uniform(0, 3, (60, 2)), rng.uniform(-3, 3, 60))), robots)
    assert len(physics.contacts) > 200
    for _ in range(2):
        assert pairs_in(physics.contacts) == exact(robots, [], physics.pose)
        physics.step(np.ones((60, 2)))


# Rows


@pytest.mark.parametrize("kind", ["compound", "wall_ends", "jam"])
def test_rows_are_those_of_sets_and_of_the_exact_geometry(kind):
    scene = crowd(kind, 1)
    physics = scene.physics()
    shapes = joined_shapes(pack_parts(scene.robots), pack_parts(scene.walls))
    pose, last, before, told = np.zeros((len(shapes.radius), 3)), physics.pose, set(), 0
    for step in range(150):
        now = exact(scene.robots, scene.walls, physics.pose)
        pairs = np.array(sorted(before | now), dtype=np.int64).reshape(-1, 2)
        pose[: len(scene.robots)] = physics.pose
        found, rows = np.empty((len(pairs), 5)), physics.contacts
        describe_pairs(shapes, pose, pairs, len(pairs), found)
        phases = [
            (Phase.STAYS if pair in before else Phase.BEGAN) if pair in now else Phase.ENDED
            for pair in map(tuple, pairs.tolist())
        ]
        assert np.stack((rows["a"], rows["b"]), axis=1).tolist() == pairs.tolist()
        assert rows["phase"].tolist() == phases
        assert set(rows["step"]) | set(rows["kind"]) <= {step, Kind.PHYSICAL}
        for k, name in enumerate(("x", "y", "nx", "ny")):
            assert rows[name].tobytes() == found[:, k].tobytes()
        depth = [
            -gap if phase == Phase.ENDED else max(-gap, 0.0)
            for gap, phase in zip(found[:, 4], phases, strict=True)
        ]
        assert np.array_equal(rows["depth"], depth)
        # Commanded 0.05 m a step; easing of overlaps and turning add a little.
        assert np.hypot(*(physics.pose - last)[:, :2].T).max() < 0.1
        last, before, told = physics.pose, now, told + len(rows)
        physics.step(scene.command(step, last))
    assert told > 150


def test_a_visit_to_a_wall_is_one_episode():
    physics = host([[1.3, 0.0, 0.0]], walls=[[[(2.0, -5.0), (2.0, 5.0)]]])
    _, first = drive(physics, [1.0, 0.0], 10)
    _, then = drive(physics, [-1.0, 0.0], 5)
    rows = np.concatenate(first + then[1:])
    assert rows["phase"].tolist() == [Phase.BEGAN] + [Phase.STAYS] * 6 + [Phase.ENDED]
    assert rows["step"].tolist() == list(range(4, 12))
    last = rows[-1]
    assert (last["depth"], last["nx"], last["ny"]) == pytest.approx((-0.05, 1.0, 0.0), abs=1e-3)
    assert last["x"] == pytest.approx(1.975, abs=1e-3)  # midway in the gap
    assert not physics.touching.any()


@pytest.mark.parametrize(
    ("start", "row"),
    [
        ([[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [3.0, 0.0, 0.0]], (0.5, 0.05, 1.0, 0.0, 0.0)),
        # aligned and deep: out sideways, by the whole width
        ([[0.0, 0.0, math.pi / 2], [0.0, 0.2, math.pi / 2]], (..., ..., ..., ..., 0.6)),
    ],
)
def test_contact_at_the_start_is_found(start, row):
    physics = host(start)
    (found,) = physics.contacts.tolist()
    assert found[:5] == (0, 0, 1, Phase.BEGAN, Kind.PHYSICAL)
    for one, wanted in zip(found[5:], row, strict=False):
        assert wanted is ... or one == pytest.approx(wanted, abs=1e-12)
    assert physics.touching.tolist() == [True, True, False][: len(start)]
    assert physics.pose.tolist() == start


# False contacts


def test_robots_side_by_side_never_touch_and_each_false_contact_is_told():
    """Without the guard the engine's false contacts come through: so this test can fail."""
    disturbed, told = {True: 0, False: 0}, 0
    for guarded in disturbed:
        for seed in (*range(10), *FALSE_CONTACTS):
            physics = side_by_side(seed, guarded)
            gap, touched = physics.pose[1, :2] - physics.pose[0, :2], False
            for step in range(1, 401):
                physics.step(np.array([[1.0, 0.0], [1.0, 0.0]]))
                touched |= len(physics.contacts) > 0
                for row in physics.false_contacts.tolist():
                    assert row == (step, 0, 1, pytest.approx(0.2))
                    told += 1
            strayed = np.abs(physics.pose[1, :2] - physics.pose[0, :2] - gap).max() > 1e-9
            disturbed[guarded] += touched or strayed
    assert disturbed == {True: 0, False: len(FALSE_CONTACTS)}
    assert told >= len(FALSE_CONTACTS)


def test_pressed_side_by_side_they_stay_in_step():
    for seed in range(20):
        rng = np.random.default_rng(seed)
        heading, gap = rng.uniform(-3, 3), rng.uniform(-1e-3, 1e-3)
        left = np.array([-np.sin(heading), np.cos(heading)])
        start = [[0.0, 0.0, heading], [*((0.6 + gap) * left), heading]]
        poses, _ = drive(host(start), [[1.0, 0.0], [1.0, 0.0]], 50)
        moved = np.hypot(*np.diff(poses, axis=0)[:, :, :2].reshape(-1, 2).T)
        assert moved == pytest.approx(0.05, abs=1e-5)


def test_parts_of_one_robot_do_not_collide():
    poses, rows = drive(host([[0.0, 0.0, 0.0]], [[box(), box(x=0.4)]]), [1.0, 0.0], 40)
    assert not any(len(r) for r in rows)
    assert poses[-1, 0, 0] == pytest.approx(2.0, abs=1e-12)


PLAIN = """
from tests.simulation.engine.crowds import crowd, digest, go_on
for kind, steps in (("abreast", 30), ("wall_ends", 16)):
    scene = crowd(kind, 1)
    print(digest(go_on(scene, scene.physics(), steps)))
"""


@pytest.mark.deep
def test_compiled_callbacks_do_what_they_do_as_plain_python():
    done = subprocess.run(
        [sys.executable, "-c", PLAIN], cwd=Path(__file__).parents[3], capture_output=True,
        text=True, env={**os.environ, "PHYSIM_KERNELS": "plain"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    runs = ((crowd(kind, 1), steps) for kind, steps in (("abreast", 30), ("wall_ends", 16)))
    assert done.stdout.split() == [digest(go_on(s, s.physics(), n)) for s, n in runs]
