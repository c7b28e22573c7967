"""Safe boundaries: a target in the danger area is replaced by the nearest safe point.

Safe is what lies at least L from every boundary. The border of the safe area is made of lines
parallel to wall edges at distance L and of circles of radius L about wall corners, so the safe
point nearest to a target is the nearest point of one such curve or a crossing of two. All of them
count: the answer is exact, and it needs only the walls near the target.

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

from math import hypot, sqrt
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.bodies import outline_distance, point_segment
from physim.geometry.shapes import FloatArray, IntArray, Part, Shapes
from physim.geometry.walls import Sight, all_seen, comes_near, parts_seen
from physim.tolerances import CONTACT, LENGTH

NEAR = 1.5
"""[-] The nearest walls, as multiples of L."""

CURVE_MARGIN = 1e-6
"""[m] Far above the rounding of a crossing's distance from its curves."""

SECTION_SAMPLES = 64
"""Samples a side of the cross-section that is searched for its greatest clearance."""

Point = tuple[float, float]


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
    target: Point,
    ahead: Point,
    outside: bool,
    position: Point,
    look_ahead: float,
    safe_distance: float,
) -> Point:
    """Target, or the safe point that replaces it [m].

    ``sight`` are the walls the robot sees, ``ahead`` is the unit direction of the path at the
    target, ``position`` the robot's.
    """
    (tx, ty), walls = target, sight.tree.walls
    if not outside and not comes_near(sight, tx, ty, safe_distance):
        return target
    eye = position if outside else target
    reach, back = 2.0 * look_ahead, look_ahead / 2.0
    if not outside:
        # Seldom more than the nearest walls count: what lies nearer than these is exact.
        near = NEAR * safe_distance
        parts = parts_seen(sight, tx, ty, near)
        place = Place(walls, parts, target, ahead, eye, safe_distance, back)
        found, x, y = nearest_safe_point(place, reach)
        if found and hypot(x - tx, y - ty) + safe_distance < near:
            return x, y
    wide = max(reach + 2.0 * safe_distance, hypot(eye[0] - tx, eye[1] - ty))
    parts = parts_seen(sight, tx, ty, wide)
    place = Place(walls, parts, target, ahead, eye, safe_distance, back)
    found, x, y = nearest_safe_point(place, reach)
    if found:
        return x, y
    return roomiest_point(walls, all_seen(sight), target, ahead, eye, reach)


class Place(NamedTuple):
    """What decides whether a point may take the place of a target."""

    walls: Shapes
    parts: IntArray
    """(P,) those of the walls that count"""
    target: Point
    ahead: Point
    """unit vector"""
    eye: Point
    """joined to the point by a straight way that crosses no wall"""
    safe_distance: float
    """[m] from every one of the parts, less 1e-9 m"""
    back: float
    """[m] behind the target along ``ahead`` at most"""


@compiled
def nearest_safe_point(place: Place, reach: float) -> tuple[bool, float, float]:
    """Safe point within ``reach`` [m] that is nearest to a target: found or not, x, y."""
    (tx, ty), eye, distance = place.target, place.eye, place.safe_distance
    edges = edges_near(place.walls, place.parts, tx, ty, reach + 2.0 * distance)
    way = max(reach, hypot(eye[0] - tx, eye[1] - ty))
    between = edges_near(place.walls, place.parts, tx, ty, way)
    gaps = np.empty(4 * len(edges))
    for c in range(len(gaps)):
        x, y = nearest_on(curve(edges, c, distance), distance, tx, ty)
        gaps[c] = hypot(x - tx, y - ty)
    # The nearest points of single curves, nearest first, until one serves. A crossing lies on both
    # its curves, so it is no nearer than either.
    best, bx, by, found = reach, tx, ty, False
    untried = gaps.copy()
    while len(gaps) and not found:
        c = int(untried.argmin())
        if untried[c] >= reach:
            break
        untried[c] = np.inf
        x, y = nearest_on(curve(edges, c, distance), distance, tx, ty)
        if serves(place, between, x, y):
            best, bx, by, found = gaps[c], x, y, True
    near = np.flatnonzero(gaps <= best + CURVE_MARGIN)
    for m in range(len(near)):
        one = curve(edges, near[m], distance)
        for n in range(m + 1, len(near)):
            for x, y in crossings(one, curve(edges, near[n], distance), distance):
                gap = hypot(x - tx, y - ty)
                if gap < best and serves(place, between, x, y):
                    best, bx, by, found = gap, x, y, True
    return found, bx, by


@compiled
def serves(place: Place, between: FloatArray, x: float, y: float) -> bool:
    """Whether a point is safe, in sight of the eye and not too far behind the target."""
    (tx, ty), (ux, uy), eye = place.target, place.ahead, place.eye
    if (x - tx) * ux + (y - ty) * uy < -place.back:
        return False
    if point_clearance(place.walls, place.parts, x, y) < place.safe_distance - CONTACT:
        return False
    return not crosses(between, eye[0], eye[1], x, y)


@compiled
def point_clearance(walls: Shapes, parts: IntArray, x: float, y: float) -> float:
    """Distance [m] of a point from the nearest of some wall parts; inf when there are none."""
    V, start = walls.vertices, walls.part_start
    best = np.inf
    for part in parts:
        best = min(best, outline_distance(Part(V, start[part], start[part + 1]), x, y))
    return best


@compiled
def edges_near(walls: Shapes, parts: IntArray, x: float, y: float, reach: float) -> FloatArray:
    """Edges (E, 4) of the parts that come within ``reach`` [m] of a point."""
    V, start, count, found = walls.vertices, walls.part_start, 0, 0
    for part in parts:
        count += start[part + 1] - start[part]
    edges = np.empty((count, 4))
    for part in parts:
        first, end = start[part], start[part + 1]
        for k in range(first, end - 1 if end - first == 2 else end):
            m = k + 1 if k + 1 < end else first
            ax, ay, bx, by = V[k, 0], V[k, 1], V[m, 0], V[m, 1]
            if point_segment(x, y, ax, ay, bx, by) <= reach:
                edges[found, 0], edges[found, 1] = ax, ay
                edges[found, 2], edges[found, 3] = bx, by
                found += 1
    return edges[:found]


@compiled
def crosses(edges: FloatArray, px: float, py: float, qx: float, qy: float) -> bool:
    """Whether the straight way from p to q properly crosses an edge."""
    for e in range(len(edges)):
        ax, ay, bx, by = edges[e, 0], edges[e, 1], edges[e, 2], edges[e, 3]
        side_a = (qx - px) * (ay - py) - (qy - py) * (ax - px)
        side_b = (qx - px) * (by - py) - (qy - py) * (bx - px)
        side_p = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
        side_q = (bx - ax) * (qy - ay) - (by - ay) * (qx - ax)
        if side_a * side_b <= 0.0 and side_p * side_q < 0.0:
            return True
    return False


class Curve(NamedTuple):
    """A line through (x, y) [m] along a unit vector, or a circle of radius L about (x, y)."""

    is_line: bool
    x: float
    y: float
    ux: float
    uy: float


@compiled
def curve(edges: FloatArray, c: int, distance: float) -> Curve:
    """Border of the safe area: of each edge the lines to its left and right, a circle at each end.

    Curve c is of edge c // 4; a point has circles only.
    """
    e, kind = c // 4, c % 4
    ax, ay, bx, by = edges[e, 0], edges[e, 1], edges[e, 2], edges[e, 3]
    length = hypot(bx - ax, by - ay)
    if kind < 2 and length > 0.0:
        ux, uy = (bx - ax) / length, (by - ay) / length
        if kind == 0:
            return Curve(True, ax - distance * uy, ay + distance * ux, ux, uy)
        return Curve(True, ax + distance * uy, ay - distance * ux, ux, uy)
    return Curve(False, bx, by, 0.0, 0.0) if kind == 3 else Curve(False, ax, ay, 0.0, 0.0)


@compiled
def nearest_on(c: Curve, distance: float, x: float, y: float) -> Point:
    """Point of a curve nearest to (x, y)."""
    if c.is_line:
        along = (x - c.x) * c.ux + (y - c.y) * c.uy
        return c.x + along * c.ux, c.y + along * c.uy
    dx, dy = x - c.x, y - c.y
    gap = hypot(dx, dy)
    if gap == 0.0:
        return c.x + distance, c.y
    return c.x + distance * dx / gap, c.y + distance * dy / gap


@compiled
def crossings(c: Curve, d: Curve, distance: float) -> tuple[Point, Point]:
    """Points in which two curves meet; nan where there is none."""
    none = (np.nan, np.nan)
    if c.is_line and d.is_line:
        cross = c.ux * d.uy - c.uy * d.ux
        if abs(cross) < 1e-12:
            return none, none
        along = ((d.x - c.x) * d.uy - (d.y - c.y) * d.ux) / cross
        return (c.x + along * c.ux, c.y + along * c.uy), none
    if not c.is_line and not d.is_line:
        mx, my = (d.x - c.x) / 2.0, (d.y - c.y) / 2.0
        half = hypot(mx, my)
        if half == 0.0 or half > distance:
            return none, none
        height = sqrt(distance * distance - half * half) / half
        x, y = c.x + mx, c.y + my
        return (x - height * my, y + height * mx), (x + height * my, y - height * mx)
    line, circle = (c, d) if c.is_line else (d, c)
    along = (circle.x - line.x) * line.ux + (circle.y - line.y) * line.uy
    x, y = line.x + along * line.ux, line.y + along * line.uy
    gap = hypot(circle.x - x, circle.y - y)
    if gap > distance:
        return none, none
    half = sqrt(distance * distance - gap * gap)
    return (x + half * line.ux, y + half * line.uy), (x - half * line.ux, y - half * line.uy)


@compiled
def roomiest_point(
    walls: Shapes, parts: IntArray, target: Point, ahead: Point, eye: Point, reach: float
) -> Point:
    """Point of greatest clearance on the cross-section through a target, seen from ``eye``.

    The cross-section is the line square to ``ahead``, ``reach`` to both sides, searched at
    2 x 64 + 1 points and then refined: within reach/64 of the best one for a smooth clearance, and
    at most that much beyond ``reach``. The target itself where none of it is seen.
    """
    away = hypot(eye[0] - target[0], eye[1] - target[1])
    step = reach / SECTION_SAMPLES
    edges = edges_near(walls, parts, target[0], target[1], max(reach + step, away))
    best, offset = -1.0, 0.0
    for k in range(-SECTION_SAMPLES, SECTION_SAMPLES + 1):
        x, y = target[0] - k * step * ahead[1], target[1] + k * step * ahead[0]
        clearance = point_clearance(walls, parts, x, y)
        if clearance > best + CONTACT and not crosses(edges, eye[0], eye[1], x, y):
            best, offset = clearance, k * step
    while step > CONTACT:
        step /= 2.0
        for side in (-1.0, 1.0):
            shift = offset + side * step
            x, y = target[0] - shift * ahead[1], target[1] + shift * ahead[0]
            clearance = point_clearance(walls, parts, x, y)
            if clearance > best and not crosses(edges, eye[0], eye[1], x, y):
                best, offset = clearance, shift
                break
    return target[0] - offset * ahead[1], target[1] + offset * ahead[0]
