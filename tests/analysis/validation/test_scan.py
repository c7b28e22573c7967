"""What the scan for contacts sees: robots and every part of every wall."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely import affinity

from tests.helpers import inside

Room = inside("physim.analysis.validation", "Room")
near_rows, scan_walls = inside("physim.analysis.validation", "near_rows", "scan_walls")
pack_parts = inside("physim.geometry", "pack_parts")

BOX = np.array([[0.9, 0.5], [-0.9, 0.5], [-0.9, -0.5], [0.9, -0.5]])
CORNER = [[(0.0, -5.0), (0.0, 5.0)], [(0.0, 5.0), (8.0, 5.0)], [(8.0, 5.0), (8.0, -5.0)]]
"""One boundary of three segments round a dead end."""


@pytest.mark.parametrize(
    "pose", [(1.2, 0.0, 0.0), (4.0, 4.3, 0.0), (6.9, 0.0, 0.0), (1.5, 4.0, 0.4), (6.2, 3.6, 2.0)]
)
def test_the_distance_to_a_boundary_is_that_to_its_nearest_segment(pose):
    shapes = pack_parts([[BOX]])
    walls = pack_parts([[np.array(segment) for segment in CORNER]])
    who, values = np.zeros((4, 3), dtype=np.int64), np.zeros((4, 2))
    count = scan_walls(
        np.array([pose]), 1, 1, 0, shapes, walls, 1, 3.0, 0.01, len(who), who, values
    )
    body = affinity.rotate(shapely.Polygon(BOX), pose[2], origin=(0, 0), use_radians=True)
    body = affinity.translate(body, *pose[:2])
    assert (count, who[0].tolist()) == (1, [0, 0, 1])
    nearest = min(body.distance(shapely.LineString(segment)) for segment in CORNER)
    assert values[0, 0] == pytest.approx(nearest, abs=1e-12)
    assert np.isnan(values[0, 1])


LEAPS = [((-100.0, 0.0), True), ((0.0, 300.0), True), ((-100.0, 9.0), False)]
"""where a robot that stood at (100, 0) leaps to within a step, and whether it crosses the middle"""


@pytest.mark.parametrize(("to", "crosses"), LEAPS)
@pytest.mark.parametrize("middle", ["robot", "wall"])
def test_what_a_leap_crosses_is_found_however_far_away_it_begins_and_ends(to, crosses, middle):
    poses = np.zeros((4, 2, 3))
    poses[:, 0] = (100.0, 0.0, 0.0) if to[1] != 300.0 else (0.0, -300.0, 0.0)
    poses[2:, 0] = (*to, 0.0)
    poses[:, 1] = (0.0, 0.0 if middle == "robot" else -900.0, 0.3)
    walls = pack_parts([[BOX + (0.0 if middle == "wall" else 900.0)]])
    rows = near_rows(poses, 0, pack_parts([[BOX], [BOX]]), walls, 1.1, 0.01, Room())
    assert rows[["step", "a", "b"]].tolist() == (
        [(2, 0, 1 if middle == "robot" else 2)] if crosses else []
    )
    path = shapely.LineString([poses[1, 0, :2], poses[2, 0, :2]])
    body = affinity.rotate(
        shapely.Polygon(BOX), 0.3 if middle == "robot" else 0.0, use_radians=True
    )
    apart = path.length
    for share in np.linspace(0.0, 1.0, 4001):
        at = path.interpolate(share, normalized=True)
        apart = min(apart, affinity.translate(shapely.Polygon(BOX), at.x, at.y).distance(body))
    assert crosses == (apart == 0.0)
