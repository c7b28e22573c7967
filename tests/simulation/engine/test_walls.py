"""Walls hold robots, let them go at once, and let them slide.

Walls that touch act as the one solid that they are: no seam holds what slides along it.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from physim.tolerances import CONTACT, DEEP, SETTLED_DEPTH
from tests.helpers import inside
from tests.simulation.engine.hosts import (
    box,
    deepest,
    distances,
    drive,
    host,
    pairs_in,
    segments,
)

pack_parts = inside("physim.geometry", "pack_parts")

WALL = [[(2.0, -50.0), (2.0, 50.0)]]
REACH = np.hypot(0.5, 0.3)


@pytest.mark.parametrize("dt", [0.01, 0.05, 0.1])
@pytest.mark.parametrize("heading", [0.0, 0.2, -0.7, 1.2])
@pytest.mark.parametrize(("v", "omega"), [(1.0, 0.0), (0.4, 0.0), (1.0, -0.8)])
def test_held_at_rest_and_in_transit(dt, heading, v, omega):
    physics = host([[1.3011, 0.0, heading]], walls=[WALL], dt=dt)
    steps = round(8 / dt)
    _, rows = drive(physics, [v, omega], steps)
    assert deepest(rows) > 0.0
    assert deepest(rows) <= (v + REACH * abs(omega)) * dt + SETTLED_DEPTH
    if omega == 0.0:
        assert deepest(rows[-round(1 / dt) :]) <= SETTLED_DEPTH
    assert physics.pose[0, 0] < 2.0


@pytest.mark.parametrize("dt", [0.01, 0.05])
def test_reversing_after_pushing_moves_at_once(dt):
    physics = host([[1.3, 0.0, 0.0]], walls=[WALL], dt=dt)
    drive(physics, [1.0, 0.0], round(1.2 / dt))
    held = physics.pose[0, 0]
    assert held == pytest.approx(1.5, abs=SETTLED_DEPTH)
    drive(physics, [-1.0, 0.0], round(1 / dt))
    assert held - physics.pose[0, 0] == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("speed", [3.0, 2.0, 1.1])
@pytest.mark.parametrize("heading", [0.0, 0.4, np.pi / 2])
def test_head_on_wall_is_never_passed(speed, heading):
    # Up to a quarter of the width (0.6 m) a step, from 8 offsets within one step, to a wall of
    # a single thin segment; the robot comes with its front, a corner, or its broad side.
    dt = 0.05
    gap = speed * dt
    for offset in np.linspace(0.0, gap, 8, endpoint=False):
        physics = host([[0.3 + offset, 0.0, 0.0]], [[turned(heading)]], walls=[WALL], dt=dt)
        poses, rows = drive(physics, [speed, 0.0], 60)
        assert poses[:, 0, 0].max() < 2.0
        assert deepest(rows) <= speed * dt + SETTLED_DEPTH
        assert len(rows[-1]) == 1 or abs(poses[-1, 0, 1]) > 1.0


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array(box()) @ np.array([[c, s], [-s, c]])


@pytest.mark.parametrize("dt", [0.01, 0.05])
def test_a_nose_driven_into_a_corner_is_held(dt):
    # The tip gets past the corner before a side touches: each wall leans on the other.
    corner = segments([(-4.0, 0.0), (0.0, 0.0), (0.0, 4.0)])
    nose = [[(0.5, 0.0), (-0.3, 0.2), (-0.3, -0.2)]]
    for offset in (0.0, 1e-3, -0.02):
        start = [[-1.0 + offset, 1.0, -np.pi / 4]]
        physics = host(start, [nose], walls=[corner], dt=dt)
        _, rows = drive(physics, [1.0, 0.0], round(4 / dt))
        assert deepest(rows) <= dt + SETTLED_DEPTH
        assert deepest(rows[-10:]) <= SETTLED_DEPTH
        assert len(rows[-1]) == 1


ROOM = [(0.0, 0.0), (6.0, 0.0), (6.0, 5.0), (0.0, 5.0), (0.0, 0.0)]
CIRCLE = np.linspace(0.0, 2 * np.pi, 40, endpoint=False)
DRUM = np.column_stack((3.0 + 3.0 * np.cos(CIRCLE), 2.5 + 3.0 * np.sin(CIRCLE))).tolist()
ARROW, NEEDLE = [(0.9, 0.0), (-0.7, 0.5), (-0.7, -0.5)], [(1.2, 0.0), (-0.3, 0.1), (-0.3, -0.1)]
REVERSED = [ROOM[0:2], ROOM[1:3][::-1], ROOM[2:4], ROOM[3:5][::-1]]
ROOMS = {
    "one line": [segments(ROOM)],
    "walls and caps": [segments(side) for side in REVERSED],
    "drum": [segments([*DRUM, DRUM[0]])],
}


@pytest.mark.parametrize("room", ROOMS)
@pytest.mark.parametrize("robot", [ARROW, NEEDLE], ids=["arrow", "needle"])
def test_a_corner_never_lets_a_robot_through(room, robot):
    # Full speed against the walls of a closed room, turning all the while: in a corner the shortest
    # way out of one wall leads through the next.
    dt, v = 0.01, 1.0
    for omega in (-0.8, -0.3, 0.0, 0.3):
        physics = host([[3.4, 2.8, 1.1]], [[robot]], walls=ROOMS[room], dt=dt)
        drive(physics, [v, 0.0], 150)
        _, rows = drive(physics, [v, omega], 600)
        depths = [deepest([r]) for r in rows if len(r)]
        assert max(depths) <= DEEP
        assert np.median(depths) <= 3.0 * SETTLED_DEPTH  # held, not wedged between the walls


@pytest.mark.parametrize("dt", [0.01, 0.05])
def test_a_bend_of_many_segments_guides_a_robot_without_snagging(dt):
    angle = np.linspace(-np.pi / 2, 0.0, 60)
    bend = np.column_stack((4.0 * np.cos(angle), 4.0 * np.sin(angle)))
    physics = host([[0.0, -3.6, -0.1]], walls=[segments(bend.tolist())], dt=dt)
    poses, rows = drive(physics, [1.0, 0.0], round(5 / dt))
    travelled = np.unwrap(np.arctan2(poses[:, 0, 1], poses[:, 0, 0]))
    assert np.diff(travelled[round(1 / dt) :]).min() > 0.2 * dt
    assert deepest(rows) <= 2 * dt + SETTLED_DEPTH


def test_wall_end_and_obstacle_stop_a_robot():
    pole = [[(2.0, 0.0), (4.0, 0.0)]]
    block = [box(1.0, 1.0, x=2.5)]
    for wall in (pole, block):
        physics = host([[0.0, 0.0, 0.0]], walls=[wall])
        _, rows = drive(physics, [1.0, 0.0], 60)
        assert physics.pose[0, 0] == pytest.approx(1.5, abs=SETTLED_DEPTH)
        (row,) = rows[-1]
        assert (row["a"], row["b"]) == (0, 1)
        assert (row["nx"], row["ny"]) == pytest.approx((1.0, 0.0), abs=1e-6)
        assert row["x"] == pytest.approx(2.0, abs=SETTLED_DEPTH)
        assert row["y"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("pieces", [1, 2, 126])
def test_a_tip_is_held_by_a_straight_wall_however_many_pieces_it_has(pieces):
    """Next to a joint the shortest way out of one piece leads into the next: a tip sank 6 cm in,
    and stayed there."""
    dart = [(0.4, 0.0), (-0.4, 0.15), (-0.4, -0.15)]
    wall = [(float(x), 0.0) for x in np.linspace(5.0, -5.0, pieces + 1)]
    rng = np.random.default_rng(2)
    for _ in range(8):
        x, heading, v = rng.uniform(-1.0, 1.0), rng.uniform(1.2, 1.9), rng.choice([0.5, 1.0])
        found = []
        for some in (wall, [wall[0], wall[-1]]):
            physics = host([[x, -0.6, heading]], [[dart]], walls=[segments(some)], dt=0.01)
            poses, _ = drive(physics, [v, 0.0], 300)
            c, s = np.cos(poses[:, 0, 2]), np.sin(poses[:, 0, 2])
            beyond = [poses[:, 0, 1] + s * px + c * py for px, py in dart]
            assert np.max(beyond) <= 0.01 * v + SETTLED_DEPTH
            found.append(poses)
        # as the same wall in one piece, but for which of two pushes comes first
        assert np.abs(found[0][-1] - found[1][-1]).max() <= 0.02


@pytest.mark.parametrize("steps", [40, 60, 80])
def test_a_robot_that_has_come_round_a_corner_goes_no_farther_than_it_is_driven(steps):
    # What is past the corner lies on the second wall alone, although its beginning is the end of
    # the first: that pushed a robot 152 mm aside in a step, as if it were through the wall.
    dt, v, bend = 0.02, 1.0, -1.0
    corner = segments([(-9.0, 0.0), (0.0, 0.0), (9.0 * np.cos(bend), 9.0 * np.sin(bend))])
    for heading in (-0.4, -0.7, -1.0):
        for omega in (0.0, -0.3, -0.6, -1.0):
            physics = host([[-1.0, 0.55, heading]], [[ARROW]], walls=[corner], dt=dt)
            drive(physics, [v, 0.0], steps)
            poses, rows = drive(physics, [v, omega], 80)
            moved = np.hypot(*np.diff(poses[:, 0, :2], axis=0).T)
            assert sum(len(r) for r in rows) > 0
            assert moved.max() <= (v + 0.9 * abs(omega)) * dt + SETTLED_DEPTH


def test_a_flank_on_the_tip_of_a_tooth_with_the_nose_in_the_next_gap():
    """The wall behind the tip, left to the tooth's front, was taken for one that it had crossed by
    45 cm: a turn of 80 mrad in 5 ms."""
    arrow = [[(0.6, 0.0), (-0.5, 0.4), (-0.2, 0.0)], [(0.6, 0.0), (-0.2, 0.0), (-0.5, -0.4)]]
    teeth = [(0.529, -2.051), (1.058, -2.539), (1.587, -2.064), (2.116, -2.539), (2.645, -2.103)]
    for shift in np.linspace(0.0, 6e-3, 13):
        pose = [1.806822 + shift, -1.987827 - 0.895 * shift, -1.08232]
        physics = host([pose], [arrow], walls=[segments(teeth)], dt=0.005, mass=7.2)
        poses, _ = drive(physics, [1.672, -1.62], 40)
        assert np.abs(np.diff(poses[:, 0, 2])).max() < 0.03
        assert np.hypot(*np.diff(poses[:, 0, :2], axis=0).T).max() < 1.672 * 0.005 * 1.01


# Seams

SAME = 1e-9
"""[m] A solid has the corners that are drawn, and between them may be off the walls by roundings:
as these are far below the tolerance of contact, so are the motions."""
ROBOT = [box(1.8, 1.0)]
DT = 0.01


def shelf(left, right, depth=0.5):
    return [(left, -depth), (right, -depth), (right, 0.0), (left, 0.0)]


def ends(pieces, step):
    return [step * k for k in range(pieces + 1)]


SHELVES = ends(15, 1.2)
PIECES = ends(400, 0.045)
WALLS = {
    "a shelf": [[shelf(0.0, SHELVES[-1])]],
    "shelves": [[shelf(*pair)] for pair in zip(SHELVES, SHELVES[1:], strict=False)],
    "uneven shelves": [
        [shelf(*pair, 0.3 + 0.1 * (k % 3))]
        for k, pair in enumerate(zip(SHELVES, SHELVES[1:], strict=False))
    ],
    "overlapping shelves": [[shelf(left, left + 1.5)] for left in SHELVES[:-1]],
    "a line": [segments([(0.0, 0.0), (PIECES[-1], 0.0)])],
    "lines": [[part] for part in segments([(x, 0.0) for x in PIECES])],
}
WHOLE = {"shelves": "a shelf", "uneven shelves": "a shelf", "overlapping shelves": "a shelf"}
TURNS = {"flush": (0.0, (0.0, 0.0)), "turned": (0.7345, (0.123, -4.7))}


def slide(wall, degrees, left, turn):
    """Poses, with the wall along x, and rows of a robot driven into a wall and along it."""
    angle, away = TURNS[turn]
    c, s = math.cos(angle), math.sin(angle)
    rotation, heading = np.array([[c, s], [-s, c]]), -math.radians(degrees)
    walls = [[np.array(part) @ rotation + away for part in body] for body in WALLS[wall]]
    height = 0.5 * math.cos(heading) + 0.9 * abs(math.sin(heading)) + 0.1
    start = *(np.array((left, height)) @ rotation + away), heading + angle
    poses, rows = drive(
        host([start], [ROBOT], walls=walls, dt=DT, mass=100.0), [1.0, 0.0], round(5 / DT)
    )
    rows = np.concatenate(rows)
    places = (poses[:, 0, :2] - away) @ rotation.T
    normals = np.column_stack((rows["nx"], rows["ny"])) @ rotation.T
    return places, normals, rows


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("wall", WALLS)
def test_nothing_is_caught_at_a_seam(wall, turn):
    for k, degrees in enumerate((10.0, 25.0, 40.0)):
        tilt = math.radians(degrees)
        # The nose meets the wall at 2 to 10 cm before the seam at 4.8 m.
        nose = 0.9 * math.cos(tilt) - 0.5 * math.sin(tilt) + 0.1 / math.tan(tilt)
        left = 4.78 - 0.02 * k - nose
        places, normals, rows = slide(wall, degrees, left, turn)
        # Without friction a wall takes what leads into it, and never any speed along it.
        speed = np.diff(places[:, 0]) / DT
        assert speed.min() > math.cos(tilt) - 1e-3
        assert speed[-1] == pytest.approx(1.0, abs=1e-3)
        assert np.abs(normals[:, 0]).max() < 1e-6
        assert rows["depth"].max() <= 0.7 * DT + SETTLED_DEPTH
        whole = slide(WHOLE.get(wall, "a line"), degrees, left, turn)
        assert np.abs(places - whole[0]).max() <= SAME
        assert rows["impulse"].sum() == pytest.approx(whole[2]["impulse"].sum(), rel=1e-6)


def test_an_inner_corner_of_two_obstacles_stops_a_robot():
    floor, block = [shelf(0.0, 6.0)], [[(6.0, -0.5), (7.0, -0.5), (7.0, 2.0), (6.0, 2.0)]]
    start = [[2.0, 0.499, 0.0]]
    physics = host(start, [ROBOT], walls=[floor, block], dt=DT)
    poses, rows = drive(physics, [1.0, 0.0], round(5 / DT))
    assert poses[-1, 0, 0] == pytest.approx(6.0 - 0.9, abs=SETTLED_DEPTH)
    below, ahead = rows[-1]
    assert (below["b"], ahead["b"]) == (1, 2)
    assert (below["nx"], below["ny"]) == pytest.approx((0.0, -1.0), abs=1e-9)
    assert (ahead["nx"], ahead["ny"]) == pytest.approx((1.0, 0.0), abs=1e-9)
    assert ahead["impulse"] == pytest.approx(10.0 * 1.0, rel=1e-3)  # all the push
    assert below["impulse"] < 0.1


SOLIDS = [
    *([shelf(*pair, depth)] for pair, depth in (((-2.0, -0.7), 0.5), ((-0.7, 0.4), 0.3))),
    [[(0.4, -0.6), (0.9, -0.6), (0.9, 0.7), (0.4, 0.7)]],
    [[(-1.9, -0.1), (-1.5, -0.1), (-1.5, 0.2), (-1.9, 0.2)]],  # stands in another
    *([part] for part in segments([(-2.0, 1.5), (-0.5, 1.5), (1.0, 1.5), (1.0, 0.9)])),
]


def test_contacts_name_all_walls_of_a_solid_that_a_robot_touches():
    rng, robots = np.random.default_rng(0), [[box()], [[(-0.3, -0.3), (0.6, 0.0), (-0.3, 0.3)]]]
    shapes, walls = pack_parts(robots), pack_parts(SOLIDS)
    several = 0
    for _ in range(150):
        start = np.column_stack(
            (rng.uniform(-2.2, 1.2, 2), rng.uniform(0.1, 1.6, 2), rng.random(2))
        )
        physics = host(start, robots, walls=SOLIDS)
        for _ in range(4):
            touching = {
                p for p, d in distances(shapes, walls, physics.pose).items() if d <= CONTACT
            }
            assert pairs_in(physics.contacts) == touching
            several += len(touching) > 2
            physics.step(np.array([[0.8, 0.3], [0.5, -0.4]]))
    assert several > 50
