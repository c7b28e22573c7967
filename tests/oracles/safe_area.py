"""Safe area: which point replaces a target in the danger area.

The border of the safe area runs at distance L along the walls: straight beside their edges, round
about their ends. Where it comes nearest to the target, and where it has corners, are the points
that may replace the target, if they are near enough, not too far behind, and in sight.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from tests.oracles.tolerances import ROUNDING, TOUCH
from tests.oracles.view import shape

SMOOTH = 1e-9
"""[-] Pieces of the border that meet at a smaller (squared) sine touch without a corner."""
KINDS = ("as it is", "moved", "narrow", "unseen")


@dataclass(frozen=True)
class Place:
    """Where a target lies."""

    walls: tuple[np.ndarray, ...]
    """wall parts in sight"""
    target: np.ndarray
    ahead: np.ndarray
    """direction of the path at the target"""
    eye: np.ndarray
    """the replacing point must be seen from here: the target, or the robot where that is outside"""
    outside: bool
    look_ahead: float
    safe_distance: float

    @property
    def reach(self) -> float:
        """The replacing point is at most this far from the target."""
        return 2.0 * self.look_ahead

    @cached_property
    def solid(self) -> Any:
        """All walls as one geometry."""
        return shapely.GeometryCollection([shape(part) for part in self.walls])

    @cached_property
    def edges(self) -> np.ndarray:
        """Edges (E, 2, 2) of all walls."""
        rings = [shapely.get_coordinates(shape(part)) for part in self.walls]
        pairs = [edge for ring in rings for edge in zip(ring, ring[1:], strict=False)]
        return np.array(pairs).reshape(-1, 2, 2)

    def clearances(self, points: np.ndarray) -> np.ndarray:
        """Distances (K,) [m] from the nearest wall; inf without any."""
        if not self.walls:
            return np.full(len(points), np.inf)
        return np.asarray(shapely.distance(self.solid, shapely.points(points)))

    def seen(self, points: np.ndarray, margin: float = ROUNDING) -> np.ndarray:
        """Whether the straight ways (K,) from the eye cross no wall by more than ``margin``."""
        a, b = self.edges[None, :, 0], self.edges[None, :, 1]
        p = points[:, None]
        eye = np.broadcast_to(self.eye, p.shape)
        way, wall = p - eye, b - a
        sides = [_left(way, a - eye), _left(way, b - eye), _left(wall, eye - a), _left(wall, p - a)]
        crossed = (np.minimum(sides[0], sides[1]) < -margin) & (
            np.maximum(sides[0], sides[1]) > margin
        )
        crossed &= (np.minimum(sides[2], sides[3]) < -margin) & (
            np.maximum(sides[2], sides[3]) > margin
        )
        return ~crossed.any(axis=1)


def place(walls, path_target, ahead, outside, position, look_ahead, safe_distance):
    """Place of a target; the eye is the target, or the robot when the target is outside."""
    eye = np.asarray(position[:2]) if outside else path_target
    return Place(walls, path_target, ahead, eye, outside, look_ahead, safe_distance)


def is_outside(stretches, station):
    """Whether a station lies in one of the stretches outside the area, their ends included.

    The ends count because a path may end outside; elsewhere they lie on a wall, which is not safe.
    """
    return any(begin < station <= end + TOUCH for begin, end in stretches)


def judge(where, point):
    """How a point replaces the target, one of KINDS, or what is wrong with it."""
    point = np.asarray(point)
    moved = math.dist(point, where.target)
    room = where.clearances(where.target[None])[0]
    if not where.outside and room >= where.safe_distance - ROUNDING:
        if moved <= ROUNDING:
            return "as it is"
        if room >= where.safe_distance + ROUNDING:
            return f"a safe target moved by {moved} m"
    candidates = border_points(where)
    nearest = smallest_step(where, candidates, -ROUNDING)
    if may_replace(where, point[None], ROUNDING)[0]:
        return "moved" if moved <= nearest + ROUNDING else f"{moved} m away, not {nearest} m"
    if nearest < math.inf:
        return f"not allowed, though there is a point {nearest} m away"
    return _judge_narrow(where, point)


def smallest_step(where, candidates, slack):
    """How far [m] the nearest point is that may replace the target; inf when there is none."""
    allowed = candidates[may_replace(where, candidates, slack)]
    return min((math.dist(p, where.target) for p in allowed), default=math.inf)


def may_replace(where, points, slack):
    """Whether points (K, 2) are safe, near enough, not too far behind, and in sight.

    ``slack`` [m] is what each of these may lack; negative: by how much reach, place and sight must
    hold, while the clearance must only be L.
    """
    step = points - where.target
    return (
        (where.clearances(points) >= where.safe_distance - TOUCH - max(slack, 0.0))
        & (np.hypot(*step.T) <= where.reach + slack)
        & (step @ where.ahead >= -0.5 * where.look_ahead - slack)
        & where.seen(points, slack)
    )


def border_points(where):
    """Points (K, 2) where the border comes nearest to the target, and where it has a corner.

    Where a straight piece goes over into a round one smoothly there is no corner.
    """
    edges, distance, target = where.edges, where.safe_distance, where.target
    if not len(edges):
        return np.zeros((0, 2))
    wall = edges[:, 1] - edges[:, 0]
    length = np.hypot(*wall.T)
    along = wall / length[:, None]
    aside = distance * np.stack([-along[:, 1], along[:, 0]], axis=1)
    starts = np.vstack([edges[:, 0] + aside, edges[:, 0] - aside])
    lines = starts, np.vstack([along, along]), np.concatenate([length, length])
    corners = np.unique(edges.reshape(-1, 2), axis=0)
    way = target - corners
    found = [
        _feet(lines, target),
        corners + distance * way / np.maximum(np.hypot(*way.T), 1e-300)[:, None],
        _line_line(lines),
        _line_circle(lines, corners, distance),
        _circle_circle(corners, distance),
    ]
    points = np.vstack(found)
    return points[np.abs(where.clearances(points) - distance) <= TOUCH]


# Straight pieces of the border: starts, directions, and lengths


def _feet(lines, target):
    starts, along, length = lines
    t = ((target - starts) * along).sum(axis=1)
    return (starts + t[:, None] * along)[(t >= 0.0) & (t <= length)]


def _line_line(lines):
    starts, along, length = lines
    i, j = np.triu_indices(len(starts), 1)
    cross = _left(along[i], along[j], unit=False)
    ok = np.abs(cross) > SMOOTH
    i, j, cross = i[ok], j[ok], cross[ok]
    t = _left(starts[j] - starts[i], along[j], unit=False) / cross
    u = _left(starts[j] - starts[i], along[i], unit=False) / cross
    both = (t >= 0.0) & (t <= length[i]) & (u >= 0.0) & (u <= length[j])
    return (starts[i] + t[:, None] * along[i])[both]


def _line_circle(lines, centres, radius):
    starts, along, length = (array[:, None] for array in lines)
    t = ((centres[None] - starts) * along).sum(axis=2)
    rest = radius**2 - ((starts + t[..., None] * along - centres[None]) ** 2).sum(axis=2)
    half = np.sqrt(np.maximum(rest, 0.0))
    points = []
    for at in (t + half, t - half):
        ok = (rest > SMOOTH * radius**2) & (at >= 0.0) & (at <= length)
        points.append((starts + at[..., None] * along)[ok])
    return np.vstack(points)


def _circle_circle(centres, radius):
    i, j = np.triu_indices(len(centres), 1)
    middle, half = (centres[i] + centres[j]) / 2.0, (centres[j] - centres[i]) / 2.0
    square = (half**2).sum(axis=1)
    ok = square < (1.0 - SMOOTH) * radius**2
    middle, half, square = middle[ok], half[ok], square[ok]
    height = np.sqrt(radius**2 / square - 1.0)[:, None] * np.stack(
        [-half[:, 1], half[:, 0]], axis=1
    )
    return np.vstack([middle + height, middle - height])


def _judge_narrow(where, point):
    """Greatest clearance on the cross-section: as good as 129 points across and refining find it.

    Where the robot sees none of it, the target stays.
    """
    step = point - where.target
    across = np.array([-where.ahead[1], where.ahead[0]])
    spacing = where.reach / 64.0
    if abs(step @ where.ahead) > ROUNDING or abs(step @ across) > where.reach + spacing:
        return "not on the cross-section"
    points = where.target + np.linspace(-where.reach, where.reach, 513)[:, None] * across
    room = np.where(where.seen(points, -ROUNDING), where.clearances(points), -np.inf)
    if not where.seen(point[None])[0]:
        return "unseen" if room[::4].max() == -np.inf and not step.any() else "not seen"
    if where.clearances(point[None])[0] < room.max() - spacing:
        return f"{where.clearances(point[None])[0]} m of room, not {room.max()} m"
    return "narrow"


def _left(way, point, unit=True):
    """How far [m] a point lies to the left of a way; without ``unit`` times the way's length."""
    cross = way[..., 0] * point[..., 1] - way[..., 1] * point[..., 0]
    return cross / np.maximum(np.hypot(way[..., 0], way[..., 1]), 1e-300) if unit else cross
