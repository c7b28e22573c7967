"""Equation (1): arcs against fine integration, and the chord against the arc."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.helpers import examples, inside

along_course, arc, arc_course = inside("physim.geometry", "along_course", "arc", "arc_course")
arcs, chord_velocities = inside("physim.geometry", "arcs", "chord_velocities")
chord_velocity = inside("physim.geometry", "chord_velocity")

SPEEDS = st.floats(-2.0, 2.0)
ANGLES = st.floats(-10.0, 10.0)


def turned(pose, v, omega, t):
    """The textbook form of the arc, by its centre; loses digits as omega goes to 0."""
    x, y, heading = pose
    end = heading + omega * t
    return (
        x + v / omega * (math.sin(end) - math.sin(heading)),
        y - v / omega * (math.cos(end) - math.cos(heading)),
        end,
    )


@examples(25, deep=100)
@given(SPEEDS, st.floats(0.05, 3.0), ANGLES, st.floats(0.0, 20.0))
def test_arc_is_the_circle_about_its_centre(v, omega, heading, t):
    pose = np.array([1.0, -2.0, heading])
    for w in (omega, -omega):
        assert arc(*pose, v, w, 0.0, t) == pytest.approx(turned(pose, v, w, t), abs=1e-12)


def test_arc_solves_equation_1():
    pose, twist, h = np.array([0.3, 0.4, 0.5]), (1.3, -0.7, 0.4), 1e-5
    for t in (0.0, 0.4, 3.0):
        before, after = (np.array(arc(*pose, *twist, t + k * h)) for k in (-1, 1))
        heading = arc(*pose, *twist, t)[2]
        rate = (after - before) / (2 * h)
        assert rate == pytest.approx(rate_of(twist, heading), abs=1e-9)


def rate_of(twist, heading):
    """Equation (1) with a lateral speed, left positive."""
    v, omega, lateral = twist
    c, s = math.cos(heading), math.sin(heading)
    return np.array([v * c - lateral * s, v * s + lateral * c, omega])


def test_a_lateral_arc_is_what_many_small_steps_add_up_to():
    pose, twist, n = np.array([1.0, -2.0, 0.4]), (0.6, 1.1, -0.8), 4000
    marched = pose.copy()
    for _ in range(n):  # the middle of each small step, whose error is of third order
        half = marched[2] + 0.5 * twist[1] * 2.5 / n
        marched += rate_of(twist, half) * 2.5 / n
    assert arc(*pose, *twist, 2.5) == pytest.approx(tuple(marched), abs=1e-6)
    assert np.hypot(*(marched - pose)[:2]) > 1.0


@pytest.mark.parametrize("omega", [0.0, 1e-300, 1e-16, 1e-12, 1e-9, -1e-8, 1e-6, 1e-4])
def test_arc_near_straight(omega):
    t, v = 10.0, 1.5
    x, y, heading = arc(0.0, 0.0, 0.0, v, omega, 0.0, t)
    angle = omega * t  # series of sin(angle) / omega and (1 - cos(angle)) / omega
    assert x == pytest.approx(v * t * (1 - angle**2 / 6), rel=1e-15)
    assert y == pytest.approx(v * t * (angle / 2 - angle**3 / 24), rel=1e-15)
    assert heading == angle


@examples(25, deep=100)
@given(
    st.tuples(SPEEDS, st.floats(-2.0, 2.0), SPEEDS), ANGLES, st.floats(0.01, 5.0),
    st.floats(0.01, 5.0),
)  # fmt: skip
def test_two_arcs_in_a_row_are_one(twist, heading, t1, t2):
    pose = np.array([3.0, 1.0, heading])
    middle = arc(*pose, *twist, t1)
    twice = arc(*middle, *twist, t2)
    assert twice == pytest.approx(arc(*pose, *twist, t1 + t2), abs=1e-12)
    assert arc(*twice, *twist, -t1 - t2) == pytest.approx(tuple(pose), abs=1e-12)


def test_chords_follow_the_arc_for_100_s():
    v, omega, lateral, dt = 1.1, 0.6, -0.3, 0.05
    pose = np.array([0.0, 0.0, 0.2])
    for _ in range(2000):
        vx, vy = chord_velocity(pose[2], v, omega, lateral, dt)
        pose += [vx * dt, vy * dt, omega * dt]
    assert tuple(pose) == pytest.approx(arc(0.0, 0.0, 0.2, v, omega, lateral, 100.0), abs=1e-11)


def test_array_forms_equal_single_ones():
    rng = np.random.default_rng(1)
    pose, twist = rng.uniform(-3, 3, (7, 3)), rng.uniform(-1, 1, (7, 3))
    out = np.empty((7, 3))
    chord_velocities(pose, twist, 7, 0.1, out)
    after, without = arcs(pose, twist, 0.7), arcs(pose, twist[:, :2], 0.7)
    for i in range(7):
        v, omega, lateral = twist[i]
        assert tuple(out[i]) == (*chord_velocity(pose[i, 2], v, omega, lateral, 0.1), omega)
        assert tuple(after[i]) == arc(*pose[i], *twist[i], 0.7)
        assert tuple(without[i]) == arc(*pose[i], v, omega, 0.0, 0.7)


@examples(25, deep=100)
@given(SPEEDS, st.floats(-2.0, 2.0), SPEEDS, ANGLES, st.floats(0.0, 10.0))
def test_course_is_the_arc(v, omega, lateral, heading, t):
    pose = np.array([1.0, 2.0, heading])
    course = arc_course(*pose, v, omega, lateral, 1.0)
    assert course.speed == pytest.approx(math.hypot(v, lateral))
    x, y, c, s, vx, vy = along_course(course, t)
    px, py, end = arc(*pose, v, omega, lateral, t)
    expected = (px, py, math.cos(end), math.sin(end), *rate_of((v, omega, lateral), end)[:2])
    assert (x, y, c, s, vx, vy) == pytest.approx(expected, abs=1e-13)
