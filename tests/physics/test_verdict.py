"""The engine's contacts are those of the exact distance: none missed, none invented."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hosts import ELL, box, distances, drive, host, pairs_in, segments
from hypothesis import given, settings
from hypothesis import strategies as st

from physim.tolerances import CONTACT
from tests.helpers import inside

joined_shapes, pack_parts = inside("physim.geometry", "joined_shapes", "pack_parts")
ACTS, APART, LEFT, SIDE = inside("physim.simulation.engine", "ACTS", "APART", "LEFT", "SIDE")
classify, segment_links = inside("physim.simulation.engine", "classify", "segment_links")

ROBOTS = [[box()], ELL, [box(0.4, 0.4)], [[(-0.3, -0.3), (0.6, 0.0), (-0.3, 0.3)]], [box()], ELL]
RING = [(-1.5, -1.5), (0.0, -1.5), (1.5, -1.5), (1.5, 1.5), (0.2, 1.2), (-1.5, 1.5), (-1.5, -1.5)]
WALLS = [segments(RING), [box(0.3, 0.3, x=0.5)], [box(0.4, 0.2, x=-0.8), box(0.2, 0.5, x=-0.8)]]
SHAPES, SOLID = pack_parts(ROBOTS), pack_parts(WALLS)


def touching(pose):
    return {pair for pair, d in distances(SHAPES, SOLID, pose).items() if d <= CONTACT}


@settings(max_examples=150, deadline=None)
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
    assert pairs_in(physics.contacts) == touching(np.array(start))
    for _ in range(3):
        physics.step(np.tile([speed, 0.3], (6, 1)))
        assert pairs_in(physics.contacts) == touching(physics.pose)


@settings(max_examples=150, deadline=None)
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
    start = np.array([[away, away, heading], [away + x, away + y, heading + turn]])
    physics = host(start)
    exact = distances(pack_parts([[box()]] * 2), pack_parts([]), physics.pose)
    assert pairs_in(physics.contacts) == {p for p, d in exact.items() if d <= CONTACT}


@pytest.mark.parametrize("dt", [0.05, 0.02])
def test_first_contact_is_at_the_sample_that_the_collision_time_says(dt):
    rng = np.random.default_rng(3)
    for _ in range(100):
        gap, v, u = rng.uniform(0.01, 2.0), rng.uniform(0.1, 1.0), rng.uniform(0.1, 1.0)
        shift = rng.uniform(-0.5, 0.5)
        xi = gap / (v + u)
        physics = host([[0.0, 0.0, 0.0], [1.0 + gap, shift, np.pi]], dt=dt)
        expected = math.ceil((xi - CONTACT) / dt)
        _, rows = drive(physics, [[v, 0.0], [u, 0.0]], expected)
        assert [len(r) for r in rows] == [0] * expected + [1]
        assert rows[-1]["step"][0] == expected


def test_depth_of_aligned_deep_overlap_is_exact():
    physics = host([[0.0, 0.0, 0.7], [0.2 * math.cos(0.7), 0.2 * math.sin(0.7), 0.7]])
    (row,) = physics.contacts
    assert row["depth"] == pytest.approx(0.6, abs=1e-12)  # out sideways: the whole width


def judged(robot, points, pose):
    """Verdict of each segment of a chain on a robot of one part."""
    shapes = joined_shapes(pack_parts([[robot]]), pack_parts([segments(points)]))
    links, still = segment_links(shapes), np.zeros(3)
    parts = range(1, len(points))
    return [classify(shapes, links, 0, np.array(pose), q, still) for q in parts]


def test_links_of_open_and_closed_chains():
    lines = pack_parts([segments([(0, 0), (1, 0), (2, 0)]), segments(RING), [box()]])
    links = segment_links(lines)
    assert links.part[:2].tolist() == [[-1, 1], [0, -1]]
    assert links.part[2:8].tolist() == [[7, 3], [2, 4], [3, 5], [4, 6], [5, 7], [6, 2]]
    assert links.part[8].tolist() == [-1, -1]
    assert links.end[2:8].tolist() == [[1, 0]] * 6


def test_links_go_straight_on_and_take_either_direction():
    wall, cap = [(0, 0), (1, 0), (2, 0)], [(2, 3), (2, 0)]
    links = segment_links(pack_parts([segments(wall), segments(cap), segments([(1, 5), (1, 0)])]))
    assert links.part.tolist() == [[-1, 1], [0, 2], [-1, 1], [-1, 0]]
    assert links.end[1].tolist() == [1, 1]


FLOOR = [(-2.0, 0.0), (-0.1, 0.0), (0.4998, 0.0), (1.5, 0.0), (2.0, 0.0)]


def test_a_flat_robot_is_held_by_the_segments_below_not_by_the_end_ahead():
    # Pressed 1 mm into the floor, its front 0.2 mm beyond the start of the third segment.
    told = judged(box(), FLOOR, (0.0, 0.299, 0.0))
    assert [verdict for verdict, _, _ in told] == [ACTS, ACTS, LEFT, APART]
    for _, nx, ny in told[:2]:
        assert (nx, ny) == pytest.approx((0.0, 1.0), abs=1e-12)


def test_an_end_that_stops_a_robot_acts():
    # The same floor without what comes before: its end is a true obstacle.
    ((verdict, nx, ny),) = judged(box(), FLOOR[2:4], (0.0, 0.299, 0.0))
    assert verdict == ACTS
    assert (nx, ny) == pytest.approx((-1.0, 0.0), abs=1e-12)


def test_a_tip_across_a_joint_is_pushed_straight_out_by_both():
    tip = [(0.0, -0.5), (0.4, 0.0), (-0.4, 0.0)]
    told = judged(tip, [(-2.0, 0.0), (0.0, 0.0), (2.0, 0.0)], (0.0001, 0.499, 0.0))
    assert [verdict for verdict, _, _ in told] == [SIDE, SIDE]
    for _, nx, ny in told:
        assert (nx, ny) == pytest.approx((0.0, 1.0), abs=1e-12)


@pytest.mark.parametrize(("bend", "wanted"), [(0.0, SIDE), (0.5, SIDE), (-0.5, SIDE), (-1.5, ACTS)])
def test_a_tip_beside_a_joint_is_not_pushed_past_it_into_the_next_segment(bend, wanted):
    # 2 cm beyond the wall, 1 mm beside where the next one goes on: 3 mm sideways it is out of this
    # one, and in that, unless that turns away by more than the tip's own flank.
    tip = [(0.0, -0.5), (0.05, 0.0), (-0.05, 0.0)]
    far = (-2.0 * np.cos(bend), 2.0 * np.sin(bend))
    told = judged(tip, [far, (0.0, 0.0), (2.0, 0.0)], (0.003, 0.48, 0.0))
    verdict, nx, ny = told[1]
    assert verdict == wanted
    if wanted == SIDE:
        assert (nx, ny) == pytest.approx((0.0, 1.0), abs=1e-12)
    else:
        assert nx < -0.9


def test_a_face_on_two_segments_up_to_the_end_wall_is_held_by_both():
    # A flank flat on the wall, its front 0.6 mm into the end wall, to which the short last segment
    # would push it: left to that one, it sank 21 mm into the wall where forty robots pushed.
    robot = [(0.5, 0.0), (-0.35, 0.4), (-0.35, -0.4)]
    pose = (15.014146237497053, -2.2879175406857692, -2.7023988920553763)
    told = judged(robot, [(0.0, -2.5), (15.0, -2.5), (15.5, -2.5), (15.5, 2.5)], pose)
    assert [verdict for verdict, _, _ in told[:2]] == [SIDE, SIDE]
    for _, nx, ny in told[:2]:
        assert (nx, ny) == pytest.approx((0.0, 1.0), abs=1e-12)


def test_a_robot_beside_a_corner_is_pushed_away_from_it():
    # A box on the left of one of two walls of which the second turns away to the right: whatever
    # pushes it does so along the normal of a wall, to the left, or along one between the two.
    rng, met = np.random.default_rng(0), []
    for _ in range(3000):
        bend, heading, at = rng.uniform(-1.4, 0.0), rng.uniform(-3.2, 3.2), rng.uniform(-0.7, 0.7)
        robot, depth = box(0.5, rng.uniform(0.1, 0.5)), rng.uniform(0.0, 0.01)
        walls = np.array(((1.0, 0.0), (math.cos(bend), math.sin(bend))))
        along = walls[int(at > 0.0)]
        out = np.array((-along[1], along[0]))
        c, s = math.cos(heading), math.sin(heading)
        height = -(np.array(robot) @ np.array([[c, s], [-s, c]]) @ out).min() - depth
        x, y = at * along + height * out
        told = judged(robot, [(-3.0, 0.0), (0.0, 0.0), tuple(3.0 * walls[1])], (x, y, heading))
        for verdict, *normal in told:
            met.append(verdict)
            if verdict in (ACTS, SIDE):
                assert np.dot(walls[0], normal) >= -1e-9
                assert np.dot(walls[1], normal) <= 1e-9
    assert met.count(ACTS) > 2000
    assert met.count(LEFT) > 20
