"""Bodies that touch between two samples only, where geometry alone says when and where."""

from __future__ import annotations

import math

import numpy as np
import pytest

from physim.geometry.swept_contacts import wear_off
from tests.geometry.cases import BOX
from tests.helpers import inside

FloatArray, pack_parts = inside("physim.geometry", "FloatArray", "pack_parts")
find_swept_contacts = inside("physim.geometry", "find_swept_contacts")

DT = 0.1
SHAPES = pack_parts([[BOX], [BOX]])
RADIUS = math.hypot(0.9, 0.5)
TURN = math.atan2(0.9, 0.5)
"""[rad] heading at which a corner of the box is farthest to the left"""


def found(poses: FloatArray, walls: list[FloatArray]) -> tuple[list[list[int]], FloatArray]:
    """Step, bodies and values of what is found in the steps between samples (B, 2, 3)."""
    packed = pack_parts([[wall] for wall in walls])
    steps, all_values = [], []
    for k in range(1, len(poses)):
        reach, room = np.empty((2, 2)), np.full((2, 2), -np.inf)
        assert wear_off(poses[k - 1], poses[k], SHAPES.radius, reach, room)
        near = np.ones((2, 2), dtype=np.bool_)
        who, values = np.empty((8, 2), dtype=np.int64), np.empty((8, 5))
        count = find_swept_contacts(
            poses[k - 1], poses[k], reach, near, SHAPES, packed, DT, who, values
        )
        steps += [[k, *pair] for pair in who[:count].tolist()]
        all_values.append(values[:count])
    return steps, np.concatenate(all_values)


FAR = np.array([[-50.0, -50.0], [50.0, -50.0]])


@pytest.mark.parametrize(("gap", "touches"), [(-1e-3, True), (1e-3, False)])
def test_a_corner_that_swings_past_a_wall(gap: float, touches: bool) -> None:
    """On the spot, through the heading at which the corner is nearest: the place moves nowhere."""
    wall = np.array([[-5.0, RADIUS + gap], [5.0, RADIUS + gap]])
    poses = np.zeros((2, 2, 3))
    poses[:, 0, 2] = TURN - 0.2, TURN + 0.2
    poses[:, 1, 0] = 20.0
    who, values = found(poses, [FAR, wall])
    assert who == ([[1, 0, 3]] if touches else [])
    for x, y, nx, ny, distance in values:
        assert (x, y) == pytest.approx((0.0, RADIUS + gap), abs=1e-3)
        assert (nx, ny) == pytest.approx((0.0, 1.0), abs=1e-6)
        assert distance == pytest.approx(gap, abs=1e-9)


@pytest.mark.parametrize(("depth", "touches"), [(1e-3, True), (-1e-3, False)])
def test_corners_that_pass(depth: float, touches: bool) -> None:
    """Two boxes, corner to corner: in one step one goes by the other, ``depth`` [m] inside it."""
    along = np.array([-1.0, -0.02, 0.02])  # away, just before the corner, just behind it
    out, aside = np.array([1.0, 1.0]) / math.sqrt(2.0), np.array([1.0, -1.0]) / math.sqrt(2.0)
    poses = np.zeros((3, 2, 3))
    poses[:, 1, 2] = 0.25 * math.pi - math.atan2(0.5, 0.9)  # its rear right corner goes ahead
    poses[:, 1, :2] = BOX[2] + (RADIUS - depth) * out + along[:, None] * aside
    who, values = found(poses, [FAR])
    assert who == ([[2, 0, 1]] if touches else [])
    for x, y, nx, ny, distance in values:
        assert (x, y) == pytest.approx((0.9, 0.5), abs=2e-3)
        assert nx * out[0] + ny * out[1] > 0.5
        assert 0.0 < -distance < depth
