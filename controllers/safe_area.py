"""Safe boundaries: a target in the danger area is replaced by the nearest safe point.

Safe is what lies at least L from every boundary.

Departures from the paper: the safe point is sought within two look-ahead distances of the target
and at most half a look-ahead behind it, so that a narrow stretch does not hold the robot before
it; where there is none (a doorway), the roomiest point of the cross-section serves. A target
inside the area must be joined to its safe point by a straight way that crosses no wall; for a
target outside the area the robot itself must be. Looked at are the points where the border of the
safe area comes nearest to the target and its corners: where those nearest are out of sight, a
point at the very edge of sight is not sought. A target of whose cross-section the robot sees
nothing stays where it is.
"""

from __future__ import annotations

from math import hypot

from physim.compiled import compiled
from physim.geometry.safe_point import nearest_safe_point, roomiest_point
from physim.geometry.shapes import FloatArray
from physim.geometry.walls import Sight, all_seen, comes_near, parts_seen
from physim.tolerances import LENGTH

NEAR = 1.5
"""[-] The nearest walls, as multiples of L."""


@compiled
def is_outside(stretches: FloatArray, station: float) -> bool:
    """Whether a station lies in one of the stretches (M, 2) outside the area.

    Their ends count, too: a path may end outside.
    """
    for k in range(len(stretches)):
        if stretches[k, 0] < station <= stretches[k, 1] + LENGTH:
            return True
    return False


@compiled
def safe_target(
    sight: Sight,
    target: tuple[float, float],
    ahead: tuple[float, float],
    outside: bool,
    position: tuple[float, float],
    look_ahead: float,
    safe_distance: float,
) -> tuple[float, float]:
    """Target, or the safe point that replaces it [m].

    ``sight`` are the walls the robot sees, ``ahead`` is the unit direction of the path at the
    target, ``position`` the robot's.
    """
    if not outside and not comes_near(sight, target[0], target[1], safe_distance):
        return target
    return moved_target(sight, target, ahead, outside, position, look_ahead, safe_distance)


@compiled
def moved_target(
    sight: Sight,
    target: tuple[float, float],
    ahead: tuple[float, float],
    outside: bool,
    position: tuple[float, float],
    look_ahead: float,
    safe_distance: float,
) -> tuple[float, float]:
    """Safe point that replaces a target [m]; arguments of `safe_target`."""
    eye = position if outside else target
    reach = 2.0 * look_ahead
    back = look_ahead / 2.0
    (tx, ty), walls = target, sight.tree.walls
    if not outside:
        # Seldom more than the nearest walls count: what lies nearer than these is exact.
        near = NEAR * safe_distance
        found, x, y = nearest_safe_point(
            walls, parts_seen(sight, tx, ty, near), target, ahead, eye, safe_distance, reach, back
        )
        if found and hypot(x - tx, y - ty) + safe_distance < near:
            return x, y
    wide = max(reach + 2.0 * safe_distance, hypot(eye[0] - tx, eye[1] - ty))
    parts = parts_seen(sight, tx, ty, wide)
    found, x, y = nearest_safe_point(walls, parts, target, ahead, eye, safe_distance, reach, back)
    if found:
        return x, y
    return roomiest_point(walls, all_seen(sight), target, ahead, eye, reach)
