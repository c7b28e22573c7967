"""Bounds from a face that turns along hold at every time, sampled; and they keep grazes cheap."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from physim.tolerances import CONTACT
from tests.geometry.cases import random_convex
from tests.helpers import inside

fall_time, look_at, above, bend = inside("physim.geometry", "fall_time", "look_at", "above", "bend")
face_step, lasting, turned = inside("physim.geometry", "face_step", "lasting", "turned")
along_course, arc_course = inside("physim.geometry", "along_course", "arc_course")
still_course, straight_course = inside("physim.geometry", "still_course", "straight_course")

seeds = st.integers(0, 2**32 - 1)


def random_course(rng, radius):
    pose = np.array([*rng.uniform(-2, 2, 2), rng.uniform(-4, 4)])
    spin = float(rng.choice([0.0, *rng.uniform(-3, 3, 2)]))
    if rng.random() < 0.5:
        return arc_course(pose, float(rng.uniform(-1, 1)), spin, radius)
    return straight_course(pose, *(float(v) for v in rng.uniform(-1, 1, 2)), spin, radius)


def in_frame(course, t, other, q):
    """Point q of the other body, seen from a body at time t."""
    x, y, c, s, _, _ = along_course(other, t)
    px, py = x + c * q[0] - s * q[1], y + s * q[0] + c * q[1]
    x, y, c, s, _, _ = along_course(course, t)
    return np.array([c * (px - x) + s * (py - y), c * (py - y) - s * (px - x)])


@settings(max_examples=80)
@given(seeds)
def test_height_and_its_bound_hold(seed):
    rng = np.random.default_rng(seed)
    P, Q = random_convex(rng), random_convex(rng)
    a, b = (random_course(rng, float(np.hypot(*part.T).max())) for part in (P, Q))
    start = float(rng.uniform(0, 2))
    seen = look_at(P, 0, len(P), a, Q, 0, len(Q), b, start).seen
    back = look_at(Q, 0, len(Q), b, P, 0, len(P), a, start).seen
    assert turned(seen, a.radius) == pytest.approx(back, abs=1e-12)
    n = rng.normal(size=2)
    n /= np.hypot(*n)
    h, rate, reach = above(P, 0, n[0], n[1], Q, 0, seen)
    for t in np.linspace(0.0, 2.0, 40):
        true = n @ (in_frame(a, start + t, b, Q[0]) - P[0])
        assert abs(true - (h + rate * t)) <= 0.5 * bend(seen, reach, t) * t * t + 1e-12


@settings(max_examples=80)
@given(seeds)
def test_bound_holds_for_a_wall_far_from_the_origin_of_the_world(seed):
    rng = np.random.default_rng(seed)
    P = random_convex(rng)
    wall = rng.uniform(-30, 30, (2, 2))
    a = random_course(rng, float(np.hypot(*P.T).max()))
    seen = look_at(P, 0, len(P), a, wall, 0, 2, still_course(), 0.0).seen
    n = rng.normal(size=2)
    n /= np.hypot(*n)
    h, rate, reach = above(P, 0, n[0], n[1], wall, 0, seen)
    for t in np.linspace(0.0, 2.0, 40):
        true = n @ (in_frame(a, t, still_course(), wall[0]) - P[0])
        assert abs(true - (h + rate * t)) <= 0.5 * bend(seen, reach, t) * t * t + 1e-12


@settings(max_examples=80)
@given(seeds)
def test_the_gap_lasts_as_long_as_promised(seed):
    rng = np.random.default_rng(seed)
    P, Q = random_convex(rng), random_convex(rng)
    a, b = (random_course(rng, float(np.hypot(*part.T).max())) for part in (P, Q))
    look = look_at(P, 0, len(P), a, Q, 0, len(Q), b, 0.0)
    if a.spin == 0.0:
        return
    spare = float(rng.uniform(1e-3, 0.5))
    m = int(rng.integers(len(P)))
    long = face_step(P, 0, len(P), m, Q, 0, len(Q), look.seen, spare)
    assert long > 0.0
    edge = P[m] - P[m - 1]
    n = np.array([edge[1], -edge[0]]) / np.hypot(*edge)

    def gap(t):
        return min(n @ (in_frame(a, t, b, q) - P[m]) for q in Q)

    for t in np.linspace(0.0, long, 40):
        assert gap(t) >= gap(0.0) - spare - 1e-12


def test_lasting_is_the_root():
    for room, rate, curve in ((1.0, 0.0, 2.0), (0.3, -0.7, 1.5), (0.3, 0.7, 1.5), (2.0, -1.0, 0.0)):
        t = lasting(room, rate, curve)
        assert room + rate * t - curve * t * t / 2.0 == pytest.approx(0.0, abs=1e-15)
    assert lasting(1.0, 0.5, 0.0) == math.inf


@pytest.mark.parametrize("gap", [1e-4, 1e-6, 1e-8])
def test_an_edge_that_turns_past_a_point(gap):
    """At t = 1 the point rests on the turning edge but for ``gap``; before and after it is off."""
    bar = np.array([[-2.0, -0.1], [2.0, -0.1], [2.0, 0.1], [-2.0, 0.1]])
    turn, at = 0.5, np.array([0.4, 0.1 + gap])
    velocity = turn * np.array([-at[1], at[0]])  # of the edge there
    a = straight_course(np.array([0.0, 0.0, -turn]), 0.0, 0.0, turn, 2.1)
    b = straight_course(np.array([*(at - velocity), 0.0]), *velocity, 0.0, 0.0)
    t, d, steps = fall_time(bar, 0, 4, a, np.zeros((1, 2)), 0, 1, b, 0.0, CONTACT, 0.0, 1.5)
    assert t == math.inf
    assert steps < 100
    t, d, _ = fall_time(bar, 0, 4, a, np.zeros((1, 2)), 0, 1, b, 2.0 * gap, CONTACT, 0.0, 1.5)
    # The edge comes down on the point, in its frame with turn^2 0.1 m/s^2.
    assert t == pytest.approx(1.0 - math.sqrt(2.0 * gap / (turn * turn * at[1])), rel=2e-2)
    assert d == pytest.approx(2.0 * gap, abs=2e-9)
