"""The engine's contacts are those of the exact distance: none missed, none invented."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from physim.tolerances import CONTACT
from tests.helpers import examples, inside
from tests.simulation.engine.hosts import ELL, box, distances, drive, host, pairs_in, segments

joined_shapes, pack_parts = inside("physim.geometry", "joined_shapes", "pack_parts")
ACTS, APART, classify = inside("physim.simulation.engine", "ACTS", "APART", "classify")
LEFT, segment_links, SIDE = inside("physim.simulation.engine", "LEFT", "segment_links", "SIDE")
deepest_point = inside("physim.simulation.engine", "deepest_point")

ROBOTS = [[box()], ELL, [box(0.4, 0.4)], [[(-0.3, -0.3), (0.6, 0.0), (-0.3, 0.3)]], [box()], ELL]
RING = [(-1.5, -1.5), (0.0, -1.5), (1.5, -1.5), (1.5, 1.5), (0.2, 1.2), (-1.5, 1.5), (-1.5, -1.5)]
WALLS = [segments(RING), [box(0.3, 0.3, x=0.5)], [box(0.4, 0.2, x=-0.8), box(0.2, 0.5, x=-0.8)]]
SHAPES, SOLID = pack_parts(ROBOTS), pack_parts(WALLS)


def touching(pose):
    return {pair for pair, d in distances(SHAPES, SOLID, pose).items() if d <= CONTACT}


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
    assert pairs_in(physics.contacts) == touching(np.array(start))
    for _ in range(3):
        physics.step(np.tile([speed, 0.3], (6, 1)))
        assert pairs_in(physics.contacts) == touching(physics.pose)


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
    start = np.array([[away, away, heading], [away + x, away + y, heading + turn]])
    physics = host(start)
    exact = distances(pack_parts([[box()]] * 2), pack_parts([]), physics.pose)
    assert pairs_in(physics.contacts) == {p for p, d in exact.items() if d <= CONTACT}


@pytest.mark.parametrize("dt", [0.05, 0.02])
def test_first_contact_is_at_the_sample_that_the_collision_time_says(dt):
    rng = np.random.default_rng(3)
    for _ in range(30):
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


def test_a_robot_beside_a_corner_is_pushed_away_from_it():
    # A box on the left of one of two walls of which the second turns away to the right: whatever
    # pushes it does so along the normal of a wall, to the left, or along one between the two.
    rng, met = np.random.default_rng(0), []
    for _ in range(1000):
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
    assert met.count(ACTS) > 600
    assert met.count(LEFT) > 5


def test_many_contacts_at_once_are_all_told():
    """More than the engine's arrays hold at first."""
    rng = np.random.default_rng(0)
    robots = [[[(-0.5, -0.3), (0.5, -0.3), (0.0, 0.5)]]] * 60
    physics = host(np.column_stack((rng.uniform(0, 3, (60, 2)), rng.uniform(-3, 3, 60))), robots)
    assert len(physics.contacts) > 200
    for _ in range(2):
        exact = distances(pack_parts(robots), pack_parts([]), physics.pose)
        assert pairs_in(physics.contacts) == {p for p, d in exact.items() if d <= CONTACT}
        physics.step(np.ones((60, 2)))


def test_the_deepest_point_is_that_of_the_part_between_the_ends_of_the_segment():
    """By shapely: the part clipped to the ends, but not at one where the next bends to its side."""
    rng = np.random.default_rng(0)
    some = 0
    for _ in range(100):
        ends = rng.uniform(-1.0, 1.0, (4, 2)).round(2)
        walls = [ends[k : k + 2].tolist() for k in range(3)]
        corners = 0.7 * np.exp(1j * np.sort(rng.uniform(0.0, 2.0 * np.pi, rng.integers(3, 7))))
        robot = np.column_stack((corners.real, corners.imag))
        shapes = joined_shapes(pack_parts([[robot]]), pack_parts([walls]))
        pose = np.array([*rng.uniform(-1.0, 1.0, 2), rng.uniform(-4.0, 4.0)])
        turned = corners * np.exp(1j * pose[2]) + complex(*pose[:2])
        for k in range(3):
            way = ends[k + 1] - ends[k]
            length = np.hypot(*way)
            along = way / length
            out = rng.choice([-1.0, 1.0]) * np.array([-along[1], along[0]])
            found = deepest_point(shapes, segment_links(shapes), 0, pose, k + 1, *out)
            frame = np.column_stack((turned.real, turned.imag)) - ends[k]
            frame = np.column_stack((frame @ along, frame @ out))
            low = -9.0 if k > 0 and (ends[k - 1] - ends[k]) @ out > 0.0 else 0.0
            high = 9.0 if k < 2 and (ends[k + 2] - ends[k + 1]) @ out > 0.0 else length
            part = shapely.clip_by_rect(shapely.Polygon(frame), low, -9.0, high, 9.0)
            assert found[0] == (not part.is_empty)
            if found[0]:
                some += 1
                assert np.subtract(found[1:3], found[3:5]) @ out == pytest.approx(part.bounds[1])
                at = (found[3:5] - ends[k]) @ along
                assert part.distance(shapely.Point(at, part.bounds[1])) < 1e-9
    assert 100 < some < 280
