"""Collision times against marching with shapely, closed cases, and published ones.

The guarantee is checked as it is stated: at every earlier instant the shapes are apart, at the
time returned they are within CONTACT, and times agree to TIME where they close fast enough.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim.errors import PhysimError
from physim.geometry import collision_time, collision_time_certified
from physim.tolerances import CLOSING_SPEED, CONTACT, TIME
from tests.geometry.cases import BOX, corridor_walls, placed, published, random_convex, random_scene
from tests.helpers import examples, inside
from tests.oracles.collision_time import distance_at, marched_time

advancement_time, arc_course = inside("physim.geometry", "advancement_time", "arc_course")
collision_time_pair, Part = inside("physim.geometry", "collision_time_pair", "Part")
pack_parts, part_time = inside("physim.geometry", "pack_parts", "part_time")

HORIZON = 10.0
OMEGAS = (0.0, 0.0, -1.57, -0.785, 0.785, 1.57, 0.3, -1e-3)


def disc(radius=0.1, corners=256):
    angles = 2.0 * np.pi * np.arange(corners) / corners
    return radius * np.c_[np.cos(angles), np.sin(angles)]


def random_twist(rng):
    v = float(rng.choice([-1.0, 0.0, 1.0, rng.uniform(-1.5, 1.5)]))
    if rng.random() < 0.3:
        angle = rng.uniform(-np.pi, np.pi)
        return (v * math.cos(angle), v * math.sin(angle), float(rng.choice(OMEGAS)))
    return (v, float(rng.choice(OMEGAS)))


def check_time(xi, a, b, horizon=HORIZON):
    """The guarantee for a time ``xi`` of bodies a and b, each (parts, pose, twist)."""
    marched = marched_time(*a, *b, horizon)
    if marched is None:
        return

    def distance(t):
        return distance_at(*a, *b, t)

    if math.isinf(xi):
        # A contact missed may only be a graze, or one at the very horizon.
        assert math.isinf(marched) or marched > horizon - TIME or is_graze(distance, marched)
        return
    assert distance(xi) <= CONTACT * (1.0 + 1e-5)
    if xi > 0.0:
        for t in xi * np.linspace(0.0, 1.0, 50, endpoint=False):
            assert distance(t) > 0.0
    closing = distance(max(0.0, xi - TIME)) / TIME
    if closing >= 2.0 * CLOSING_SPEED and xi > TIME:
        assert xi == pytest.approx(marched, abs=TIME)


def is_graze(distance, t):
    """Whether the shapes only come within CONTACT after t, without overlap."""
    return all(distance(t + k * 1e-6) > 0.0 for k in range(50))


@examples(25, deep=150)
@given(st.integers(0, 2**32 - 1))
def test_random_bodies_against_marching(seed):
    rng = np.random.default_rng(seed)
    bodies, _, poses = random_scene(rng, 2, spread=3.0)
    a, b = ((bodies[k], poses[k], random_twist(rng)) for k in (0, 1))
    xi = collision_time(*a, *b, HORIZON)
    check_time(xi, a, b)
    other = collision_time(*b, *a, HORIZON)
    if math.isinf(xi) or math.isinf(other):
        assert xi == other or distance_at(*a, *b, min(xi, other)) > 0.0
    else:
        assert distance_at(*a, *b, other) <= CONTACT * (1.0 + 1e-5)


@examples(25, deep=150)
@given(st.integers(0, 2**32 - 1))
def test_walls_against_marching(seed):
    rng = np.random.default_rng(seed)
    bodies, shapes, _ = random_scene(rng, 1)
    walls = corridor_walls()
    starts = walls.part_start
    parts = [walls.vertices[starts[k] : starts[k + 1]] for k in range(len(starts) - 1)]
    pose = np.array([rng.uniform(5, 35), rng.uniform(-2, 2), rng.uniform(-4, 4)])
    twist = np.array([rng.uniform(-1.5, 1.5), rng.choice(OMEGAS), 0.0])

    def time(some):
        still = np.zeros(3), np.zeros(3)
        return min(
            collision_time_pair(some, w, *still, shapes, 0, pose, twist, HORIZON)
            for w in range(len(some.body_start) - 1)
        )

    xi = time(walls)
    check_time(xi, (bodies[0], pose, twist[:2]), (parts, np.zeros(3), (0.0, 0.0)))
    # The order of the parts, and what was found before, change nothing.
    assert xi == time(pack_parts([[part] for part in parts]))
    assert xi == time(pack_parts([parts[::-1]]))


def test_discs_whose_present_relative_speed_misleads():
    """Parallel discs that turn towards each other: the relative speed now is 0, and grows."""
    a, b = disc(), disc()
    found = [
        collision_time(a, (0, 0, 0), (1, 1), b, (0, 0.5, 0), (1, -1), 20.0),
        collision_time(b, (0, 0.5, 0), (1, -1), a, (0, 0, 0), (1, 1), 20.0),
    ]
    exact = math.acos(1.0 - 0.15)  # 2 (1 - cos t) = 0.5 - 0.2 for true discs
    assert exact == pytest.approx(0.555, abs=1e-3)
    assert found == pytest.approx([exact, exact], abs=1e-4)


def test_turning_on_the_spot_hits_a_wall():
    bar = [[-1.0, -0.1], [1.0, -0.1], [1.0, 0.1], [-1.0, 0.1]]
    wall = [[-5.0, 0.8], [5.0, 0.8]]
    reach, at = math.hypot(1.0, 0.1), math.atan2(0.1, 1.0)
    exact = (math.asin(0.8 / reach) - at) / 0.5
    xi = collision_time(bar, (0, 0, 0), (0, 0.5), wall, (0, 0, 0), (0, 0))
    assert xi == pytest.approx(exact, abs=TIME)
    # Beyond the reach it turns for ever.
    assert collision_time(bar, (0, -0.3, 0), (0, 0.5), wall, (0, 0, 0), (0, 0), 1e4) == math.inf


def test_straight_head_on_is_exact():
    for turn in (0.0, 0.7, 2.0):
        a = placed([(0.0, 0.0)], (0, 0, turn))[0]
        b = placed([(5.0, 0.1)], (0, 0, turn))[0]
        pose_a, pose_b = (*a, turn), (*b, turn + math.pi)
        xi = collision_time(BOX, pose_a, (1.0, 0.0), BOX, pose_b, (0.6, 0.0))
        assert xi == pytest.approx((5.0 - 1.8) / 1.6, abs=1e-14)
        # The same through the advancement: a rotation far too slow to matter.
        xi = collision_time(BOX, pose_a, (1.0, 1e-13), BOX, pose_b, (0.6, 0.0))
        assert xi == pytest.approx((5.0 - 1.8) / 1.6, abs=1e-8)


@pytest.mark.parametrize("omega", [0.0, 0.5])
@pytest.mark.parametrize("offset", [0.0, 10_000.0])
def test_touching_and_overlapping_now_is_zero(omega, offset):
    pose = (offset, 0.0, 0.0)
    for x in (0.5, 1.8, 1.8 + 0.5 * CONTACT):
        xi = collision_time(BOX, pose, (-1.0, omega), BOX, (offset + x, 0.0, 0.0), (1.0, 0.0))
        assert xi == (0.0 if offset == 0.0 or x < 1.8 or omega == 0.0 else pytest.approx(0.0))


def test_sliding_flush_counts_as_touching():
    """Boxes whose sides lie on one line, one sliding along: they touch when the ends meet."""
    for turn in (0.0, 0.4, 1.3):
        start = placed([(0.0, 0.0), (5.0, 1.0)], (0, 0, turn))
        xi = collision_time(BOX, (*start[0], turn), (1, 0), BOX, (*start[1], turn), (0, 0))
        assert xi == pytest.approx(3.2, abs=1e-9) or xi == math.inf  # a graze may count either way
        # Clearly apart, clearly overlapping by a hair more than the tolerance.
        for gap, expected in ((1e-8, math.inf), (-1e-8, 3.2)):
            at = placed([(5.0, 1.0 + gap)], (0, 0, turn))[0]
            xi = collision_time(BOX, (*start[0], turn), (1, 0), BOX, (*at, turn), (0, 0))
            assert xi == pytest.approx(expected, abs=1e-9)


def test_horizon_only_cuts():
    a, b = (BOX, (0, 0, 0), (1, 0.4)), (BOX, (4, 2, 0), (0, 0.7))
    xi = collision_time(*a, *b, 50.0)
    assert 0.5 < xi < 10.0
    assert collision_time(*a, *b, xi + 1e-9) == xi
    assert collision_time(*a, *b, xi - 1e-6) == math.inf


@examples(25, deep=150)
@given(st.integers(0, 2**32 - 1))
def test_an_omnidirectional_twist_is_that_of_a_body_that_faces_its_way(seed):
    """The same motion told twice: of a frame in which the body goes straight ahead."""
    rng = np.random.default_rng(seed)
    bodies, _, pose = random_scene(rng, 2)
    twist = rng.uniform(-1.5, 1.5, (2, 3))
    one, other = ([bodies[k], pose[k], twist[k]] for k in (0, 1))
    xi = collision_time(*one, *other, HORIZON, frame="body")
    v, omega, lateral = twist[0]
    way = math.atan2(lateral, v)
    c, s = math.cos(way), math.sin(way)
    facing = [part @ np.array([[c, -s], [s, c]]) for part in bodies[0]]
    told = collision_time(
        facing, pose[0] + (0.0, 0.0, way), (math.hypot(v, lateral), omega, 0.0), *other, HORIZON,
        frame="body",
    )  # fmt: skip
    assert xi == pytest.approx(told, abs=1e-5)


@examples(25, deep=150)
@given(st.integers(0, 2**32 - 1))
def test_two_derivations_agree_in_translation(seed):
    """Closed form against the advancement, which knows nothing of it."""
    rng = np.random.default_rng(seed)
    P, Q = random_convex(rng), random_convex(rng)
    pose_a, pose_b = (np.array([*rng.uniform(-3, 3, 2), rng.uniform(-4, 4)]) for _ in range(2))
    a = arc_course(*pose_a, rng.uniform(-1, 1), 0.0, rng.uniform(-1, 1), 3.0)
    b = arc_course(*pose_b, rng.uniform(-1, 1), 0.0, 0.0, 3.0)
    parts = Part(P, 0, len(P)), a, Part(Q, 0, len(Q)), b
    closed = part_time(*parts, HORIZON)
    marched, d, _ = advancement_time(*parts, HORIZON)
    if math.isinf(closed) or math.isinf(marched):
        assert closed == marched
    else:
        assert d <= CONTACT
        assert abs(closed - marched) * math.hypot(b.vx - a.vx, b.vy - a.vy) < 1e-6


def test_segments_and_points_on_one_line():
    """Their normals alone would say that they touch all the time."""
    still, line = (0.0, 0.0, 0.0), np.array([[0.0, 0.0], [0.3, 0.1]])
    for other in (line, line[:1]):
        for sign, expected in ((-1.0, 8.0), (1.0, math.inf)):
            move = (sign * 0.3, sign * 0.1, 0.0)
            xi = collision_time(line, still, still, other, (2.7, 0.9, 0.0), move)
            assert xi == pytest.approx(expected, abs=1e-12)
    xi = collision_time([[1.0, 2.0]], still, (1.0, 0.0, 0.0), [[4.0, 2.0]], still, still)
    assert xi == pytest.approx(3.0, abs=1e-12)
    xi = collision_time([[1.0, 2.0]], still, (1.0, 0.0, 0.0), [[4.0, 2.1]], still, still)
    assert xi == math.inf


@pytest.mark.parametrize("omega", [5e-324, -1e-310, 1e-99, -1e-17, 1e-16, -1e-12, 1e-10, -1e-8])
def test_a_hit_straight_ahead_is_never_missed_by_who_hardly_turns(omega):
    """Divided by the slowest of these, bounds overflowed; circles of 1e8 m and more are rough."""
    rng, still = np.random.default_rng(4), ((0, 0, 0), (0, 0))
    for _ in range(15):
        pose = (*rng.uniform(-500.0, 500.0, 2), rng.uniform(-math.pi, math.pi))
        ahead = np.array((math.cos(pose[2]), math.sin(pose[2])))
        place = np.array(pose[:2]) + rng.uniform(2.0, 9.0) * ahead
        aside, v = 2.0 * np.array((-ahead[1], ahead[0])), rng.uniform(0.5, 2.0)
        wall, other = [place - aside, place + aside], (*place, rng.uniform(-math.pi, math.pi))
        near = 1e-6 + 30.0**2 * abs(omega)
        for motion in ((wall, *still), (BOX, other, (-0.1, 0.0))):
            straight = collision_time(BOX, pose, (v, 0.0), *motion, 30.0)
            assert straight < 30.0
            turning = collision_time(BOX, pose, (v, omega), *motion, 30.0)
            assert turning == pytest.approx(straight, abs=near)


@pytest.mark.parametrize("gap", [1e-4, 1e-6, 1e-8, -1e-4])
def test_an_edge_that_turns_past_a_point(gap):
    """At t = 1 the point rests on the turning edge but for ``gap``; before and after it is off."""
    bar = np.array([[-2.0, -0.1], [2.0, -0.1], [2.0, 0.1], [-2.0, 0.1]])
    turn, at = 0.5, np.array([0.4, 0.1 + gap])
    velocity = turn * np.array([-at[1], at[0]])  # of the edge there
    motion = (bar, (0, 0, -turn), (0, 0, turn), [[0, 0]], (*(at - velocity), 0), (*velocity, 0))
    t = collision_time(*motion, 1.5)
    # The edge comes down on the point, in its frame with turn^2 0.1 m/s^2.
    down = 1.0 - math.sqrt(2.0 * abs(gap) / (turn * turn * at[1]))
    assert t == (math.inf if gap > 0.0 else pytest.approx(down, rel=2e-2))


# Published cases


def engine_shape(shape):
    if "circle" in shape:
        x, y, r = shape["circle"]
        return disc(r, 2048) + [x, y], 1e-5
    return shape.get("polygon") or shape["segment"], 0.0


def test_engine_times_of_impact():
    cases = [c for c in published("engine_unit_tests.json")["time_of_impact"] if c.get("usable", 1)]
    assert len(cases) >= 12
    for case in cases:
        (a, near_a), (b, near_b) = engine_shape(case["a"]), engine_shape(case["b"])
        still = (0.0, 0.0, 0.0)
        motion = (a, still, (*case["va"], 0.0), b, still, (*case["vb"], 0.0))
        horizon = case.get("horizon", 100.0)
        xi = collision_time(*motion, horizon)
        if case["toi"] is None:
            assert xi == math.inf, case["id"]
            continue
        found = collision_time_certified(*motion, horizon)
        speed = math.hypot(*np.subtract(case["va"], case["vb"]))
        tolerance = case["tol"] + (near_a + near_b) / max(speed, 1e-3)
        assert xi == pytest.approx(case["toi"], abs=tolerance), case["id"]
        assert found.lower - tolerance <= case["toi"] <= found.upper + tolerance, case["id"]
        assert xi == found.time, case["id"]


def test_published_point_and_segment():
    cases = published("ccd_planar_point_segment.json")["cases"]
    cases = [case for case in cases if case["robust"] and case["rigid_translation"]]
    assert len(cases) > 50
    for case in cases:
        point, segment = np.array(case["point_t0"]), np.array(case["seg_t0"])
        move_point = np.array(case["point_t1"]) - point
        move_segment = (np.array(case["seg_t1"]) - segment)[0]
        motion = (
            point[None], (0, 0, 0), (*move_point, 0.0), segment, (0, 0, 0), (*move_segment, 0.0),
        )  # fmt: skip
        xi = collision_time(*motion, 1.0)
        assert (xi < math.inf) == case["hit"], case["id"]
        if case["hit"]:
            exact = case["first_contact_fraction"]
            found = collision_time_certified(*motion, 1.0)
            assert found.lower <= exact + 1e-12 <= found.upper + 1e-12, case["id"]
            assert xi == pytest.approx(exact, abs=1e-9), case["id"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"pose_a": (0, 0)}, "pose_a.*x, y, heading"),
        ({"pose_b": (0, 0, math.nan)}, "pose_b.*finite"),
        ({"twist_a": (1, 0, 0, 0)}, "twist_a.*v, omega or .*vx, vy, omega"),
        ({"twist_b": "fast"}, "twist_b"),
        ({"horizon": -1.0}, "horizon"),
        ({"horizon": math.nan}, "horizon"),
        ({"footprint_b": [[0, 0], [1, 1], [1, 0], [0, 1]]}, "footprint_b.*crosses"),
        ({"footprint_b": [[9, 0], [-8, 6], [3, -9], [3, 9], [-8, -6]]}, "footprint_b.*crosses"),
    ],
)
def test_bad_input_is_refused(change, words):
    good = {
        "footprint_a": BOX,
        "pose_a": (0, 0, 0),
        "twist_a": (1, 0),
        "footprint_b": BOX,
        "pose_b": (5, 0, 0),
        "twist_b": (0, 0),
    }
    for function in (collision_time, collision_time_certified):
        with pytest.raises(PhysimError, match=words):
            function(**{**good, **change})
