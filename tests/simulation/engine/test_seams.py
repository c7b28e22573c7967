"""Walls that touch act as the one solid that they are: no seam holds what slides along it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from physim.tolerances import CONTACT, SETTLED_DEPTH
from tests.helpers import inside
from tests.simulation.engine.hosts import box, distances, drive, host, pairs_in, segments

pack_parts = inside("physim.geometry", "pack_parts")

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
