"""Swept checks against marching and dense sampling with shapely, and cases with known answers."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from physim.tolerances import CONTACT
from tests.geometry.cases import (
    BOX,
    corridor_walls,
    depth_of,
    placed,
    random_convex,
    random_scene,
)
from tests.helpers import examples, inside
from tests.oracles.collision_time import distance_at, marched_time

body_distance = inside("physim.geometry", "body_distance")
least_gap = inside("physim.geometry.swept", "least_gap")
pack_parts, swept_time = inside("physim.geometry", "pack_parts", "swept_time")

DT, SLACK = 0.1, 0.25 * CONTACT
STILL = np.zeros(3)
seeds = st.integers(0, 2**32 - 1)


def random_step(rng, start):
    """A pose after the step: up to 1 m and 1.2 rad further on."""
    return start + np.array([*rng.uniform(-0.7, 0.7, 2), rng.choice([0.0, rng.uniform(-1.2, 1.2)])])


def random_pair(seed):
    """Two bodies, their shapes, and the poses at both samples."""
    rng = np.random.default_rng(seed)
    bodies, shapes, start = random_scene(rng, 2, spread=2.0)
    end = np.array([random_step(rng, pose) for pose in start])
    return bodies, shapes, start, end


def as_oracle(parts, start, end):
    """The same motion for the oracle: parts, pose, twist (vx, vy, omega)."""
    return parts, start, tuple((end - start) / DT)


def pair(shapes, start, end, i=0, j=1):
    return shapes, i, start[i], end[i], shapes, j, start[j], end[j], DT


@examples(25, deep=150)
@given(seeds)
def test_earliest_contact_against_marching(seed):
    bodies, shapes, start, end = random_pair(seed)
    t = swept_time(*pair(shapes, start, end))
    bodies = [as_oracle(bodies[k], start[k], end[k]) for k in (0, 1)]
    marched = marched_time(*bodies[0], *bodies[1], DT)
    if marched is None:
        return
    least, _, _ = least_gap(*pair(shapes, start, end))
    if abs(least - CONTACT) > 2.0 * SLACK:
        assert math.isinf(t) == math.isinf(marched) == (least > CONTACT)
    if t < math.inf:
        assert distance_at(*bodies[0], *bodies[1], t) <= CONTACT + SLACK + 1e-12
    if 0.0 < t < math.inf:
        for u in t * np.linspace(0.0, 1.0, 40, endpoint=False):
            assert distance_at(*bodies[0], *bodies[1], u) > CONTACT - 1e-12


def signed(a, b, start, end, t):
    """Signed distance of two convex parts at t: shapely apart, Minkowski difference inside."""
    d = distance_at(*as_oracle([a], start[0], end[0]), *as_oracle([b], start[1], end[1]), t)
    if d > 0.0:
        return d
    poses = start + (end - start) * t / DT
    return -depth_of(placed(a, poses[0]), placed(b, poses[1]))


@examples(25, deep=150)
@given(seeds)
@example(3)
def test_least_distance_against_dense_sampling(seed):
    """Apart or overlapping: attained where it says, and nowhere below its bound."""
    rng = np.random.default_rng(seed)
    a, b = random_convex(rng), random_convex(rng)
    start = np.c_[rng.uniform(-1.2, 1.2, (2, 2)), rng.uniform(-4, 4, 2)]
    end = np.array([random_step(rng, pose) for pose in start])
    least, bound, at = least_gap(*pair(pack_parts([[a], [b]]), start, end))
    assert 0.0 <= at <= DT
    assert least == pytest.approx(signed(a, b, start, end, at), abs=1e-11)
    assert least - CONTACT <= bound + 1e-15
    for t in np.linspace(0.0, DT, 120):
        assert signed(a, b, start, end, t) >= bound - 1e-11


@examples(25, deep=150)
@given(seeds)
def test_walls_are_the_best_of_their_parts(seed):
    rng = np.random.default_rng(seed)
    bodies, shapes, _ = random_scene(rng, 1)
    start = np.array([rng.uniform(5, 35), rng.uniform(-3, 3), rng.uniform(-4, 4)])
    end = random_step(rng, start)
    robot, mine = as_oracle(bodies[0], start, end), (shapes, 0, start, end, DT)
    for wall in bodies_of(corridor_walls()):
        one, still = pack_parts([wall]), (wall, STILL, (0.0, 0.0, 0.0))
        t, least = swept_time(one, 0, STILL, STILL, *mine), least_gap(one, 0, STILL, STILL, *mine)
        marched = marched_time(*robot, *still, DT)
        if marched is not None and abs(least.distance - CONTACT) > 2.0 * SLACK:
            assert math.isinf(t) == math.isinf(marched)
        if t < math.inf:
            assert distance_at(*robot, *still, t) <= 2.0 * CONTACT

        def distance(share, one=one):
            now = start + (end - start) * share
            return body_distance(one, 0, STILL, shapes, 0, now)

        assert distance(least.time / DT) == pytest.approx(least.distance, abs=1e-12)
        assert min(map(distance, np.linspace(0.0, 1.0, 60))) >= least.bound - 1e-12
        assert least.distance - CONTACT <= least.bound + 1e-15


def bodies_of(shapes):
    """Parts of every body."""
    parts = np.split(shapes.vertices, shapes.part_start[1:-1])
    return [parts[a:b] for a, b in itertools.pairwise(shapes.body_start)]


def bar_and_wall(gap):
    """A wall, and a bar that turns through upright in mid-step, its corner then ``gap`` below."""
    bar = np.array([[-1.0, 0.0], [1.0, 0.0], [0.0, 0.01]])
    wall = pack_parts([[np.array([[-5.0, 1.0 + gap], [5.0, 1.0 + gap]])]])
    start, end = (np.array([0.0, 0.0, math.pi / 2 + turn]) for turn in (-0.2, 0.2))
    return wall, 0, STILL, STILL, pack_parts([[bar]]), 0, start, end, DT


def test_graze_between_samples():
    """Both samples are 2 cm apart; in mid-step the corner comes to the wall."""
    for gap, touches in ((-1e-6, True), (0.0, True), (0.9e-9, True), (2e-9, False), (1e-6, False)):
        case = bar_and_wall(gap)
        t, least = swept_time(*case), least_gap(*case)
        assert (t < math.inf) == touches
        assert gap - 1e-11 <= least.distance <= gap + CONTACT
        assert least.distance - CONTACT <= least.bound + 1e-15 <= gap + 1e-15
        assert least.time == pytest.approx(DT / 2, abs=1e-4)
        if touches:
            # At turn u from upright the corner is at height cos u.
            assert t == pytest.approx(DT / 2, abs=DT / 0.4 * math.sqrt(2.01 * (CONTACT + 1e-6)))


def test_touching_at_either_sample_counts():
    shapes = pack_parts([[BOX], [BOX]])
    away, beside = np.array([2.5, 0.0, 0.0]), np.array([1.8 + 0.9e-9, 0.0, 0.0])
    assert swept_time(shapes, 0, STILL, STILL, shapes, 1, beside, away, DT) == 0.0
    assert swept_time(shapes, 0, STILL, STILL, shapes, 1, away, beside, DT) == pytest.approx(
        DT, abs=1e-9
    )
    near = np.array([1.8 + 2e-9, 0.0, 0.0])
    assert swept_time(shapes, 0, STILL, STILL, shapes, 1, away, near, DT) == math.inf
    assert swept_time(shapes, 0, STILL, STILL, shapes, 1, near, near, DT) == math.inf


def test_head_on_at_a_known_time():
    shapes = pack_parts([[BOX], [BOX]])
    for turn in (0.0, 0.3, 2.0):
        start = np.c_[placed([(0.0, 0.0), (1.9, 0.1)], (0, 0, turn)), [turn, turn]]
        end = np.c_[placed([(0.2, 0.0), (1.8, 0.1)], (0, 0, turn)), [turn, turn]]
        # 0.1 m apart, closing at 3 m/s
        t = swept_time(shapes, 0, start[0], end[0], shapes, 1, start[1], end[1], DT)
        assert t == pytest.approx(0.1 / 3.0, abs=1e-9)
        least, _, at = least_gap(shapes, 0, start[0], end[0], shapes, 1, start[1], end[1], DT)
        assert least == pytest.approx(-0.2, abs=1e-12)
        assert at == DT


def test_bodies_too_fast_for_their_times_end_the_search():
    """At 9e9 m/s, as in a damaged record, 1e-9 m further is no later time."""
    shapes = pack_parts([(BOX,), (BOX,)])
    start = np.array([0.023643249400513433, 9e7, 0.9009273926518706])
    end = np.array([-0.047524828055559826, 0.8972988942744877, 0.9009273926518706])
    still = np.array([-0.4600413061645461, 0.0, 1.9662155629226508])
    assert body_distance(shapes, 0, end, shapes, 1, still) < -CONTACT
    assert 0.0 < swept_time(shapes, 0, start, end, shapes, 1, still, still, 0.01) <= 0.01
