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

from physim.compiled import compiled
from physim.geometry.safe_point import nearest_safe_point, point_clearance, roomiest_point
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.tolerances import LENGTH


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
    walls: Shapes,
    parts: IntArray,
    target: tuple[float, float],
    ahead: tuple[float, float],
    outside: bool,
    position: tuple[float, float],
    look_ahead: float,
    safe_distance: float,
) -> tuple[float, float]:
    """Target, or the safe point that replaces it [m].

    ``parts`` are the wall parts the robot sees, ``ahead`` is the unit direction of the path at the
    target, ``position`` the robot's.
    """
    if not outside and point_clearance(walls, parts, target[0], target[1]) >= safe_distance:
        return target
    eye = position if outside else target
    reach = 2.0 * look_ahead
    found, x, y = nearest_safe_point(
        walls, parts, target, ahead, eye, safe_distance, reach, look_ahead / 2.0
    )
    if found:
        return x, y
    return roomiest_point(walls, parts, target, ahead, eye, reach)
