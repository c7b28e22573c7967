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

from math import sqrt
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.bodies import outline_distance, point_segment
from physim.geometry.shapes import Part, Rows2, Rows4, Shapes
from physim.geometry.walls import Parts, Sight, all_seen, comes_near, parts_seen
from physim.tolerances import CONTACT, LENGTH

NEAR = 1.5
"""[-] The nearest walls, as multiples of L."""

CURVE_MARGIN = 1e-6
"""[m] Far above the rounding of a crossing's distance from its curves."""

SECTION_SAMPLES = 64
"""Samples a side of the cross-section that is searched for its greatest clearance."""


class Point(NamedTuple):
    """[m], world frame; or a direction."""

    x: float
    y: float


@compiled
def is_outside(stretches: Rows2, first: int, end: int, station: float) -> bool:
    """Whether a station lies in one of the stretches ``first`` to ``end`` outside the area.

    Their ends count, too: a path may end outside.
    """
    for k in range(first, end):
        if stretches[k, 0] < station <= stretches[k, 1] + LENGTH:
            return True
    return False


class Target(NamedTuple):
    """Where a path leads."""

    at: Point
    ahead: Point
    """unit direction of the path there"""
    outside: bool
    """whether it lies outside the area"""


@compiled
def safe_target(
    sight: Sight, target: Target, position: Point, look_ahead: float, safe_distance: float
) -> Point:
    """Target, or the safe point that replaces it [m].

    ``sight`` are the walls the robot sees, ``position`` is the robot's.
    """
    at, walls = target.at, sight.tree.walls
    if not target.outside and not comes_near(sight, at.x, at.y, safe_distance):
        return at
    eye = position if target.outside else at
    reach, back = 2.0 * look_ahead, look_ahead / 2.0
    if not target.outside:
        # Seldom more than the nearest walls count: what lies nearer than these is exact.
        near = NEAR * safe_distance
        parts = parts_seen(sight, at.x, at.y, near)
        found = nearest_safe_point(
            Place(walls, parts, at, target.ahead, eye, safe_distance, back), reach
        )
        if found.is_found and np.hypot(found.at.x - at.x, found.at.y - at.y) + safe_distance < near:
            return found.at
    wide = max(reach + 2.0 * safe_distance, np.hypot(eye.x - at.x, eye.y - at.y))
    parts = parts_seen(sight, at.x, at.y, wide)
    place = Place(walls, parts, at, target.ahead, eye, safe_distance, back)
    found = nearest_safe_point(place, reach)
    if found.is_found:
        return found.at
    return roomiest_point(place, all_seen(sight), reach)


class Place(NamedTuple):
    """What decides whether a point may take the place of a target."""

    walls: Shapes
    parts: Parts
    """those of the walls that count"""
    target: Point
    ahead: Point
    """unit vector"""
    eye: Point
    """joined to the point by a straight way that crosses no wall"""
    safe_distance: float
    """[m] from every one of the parts, less 1e-9 m"""
    back: float
    """[m] behind the target along ``ahead`` at most"""


class SafePoint(NamedTuple):
    """A safe point, where one is found."""

    is_found: bool
    at: Point


@compiled
def nearest_safe_point(place: Place, reach: float) -> SafePoint:
    """Safe point within ``reach`` [m] that is nearest to a target."""
    at, eye, distance = place.target, place.eye, place.safe_distance
    edges = edges_near(place.walls, place.parts, at.x, at.y, reach + 2.0 * distance)
    way = max(reach, np.hypot(eye.x - at.x, eye.y - at.y))
    between = edges_near(place.walls, place.parts, at.x, at.y, way)
    curves = 4 * edges.size
    gaps, untried, near = np.empty(curves), np.empty(curves), np.empty(curves, np.int64)
    for c in range(curves):
        one = nearest_on(curve(edges, c, distance), distance, at)
        gaps[c] = np.hypot(one.x - at.x, one.y - at.y)
        untried[c] = gaps[c]
    # The nearest points of single curves, nearest first, until one serves. A crossing lies on both
    # its curves, so it is no nearer than either.
    best, point, found = reach, at, False
    while curves > 0 and not found:
        c = 0
        for k in range(1, curves):
            if untried[k] < untried[c]:
                c = k
        if untried[c] >= reach:
            break
        untried[c] = np.inf
        one = nearest_on(curve(edges, c, distance), distance, at)
        if serves(place, between, one):
            best, point, found = gaps[c], one, True
    count = 0
    for c in range(curves):
        if gaps[c] <= best + CURVE_MARGIN:
            near[count] = c
            count += 1
    for m in range(count):
        for n in range(m + 1, count):
            met = crossings(
                curve(edges, near[m], distance), curve(edges, near[n], distance), distance
            )
            for k in range(2):
                one = met.second if k else met.first
                gap = np.hypot(one.x - at.x, one.y - at.y)
                if gap < best and serves(place, between, one):
                    best, point, found = gap, one, True
    return SafePoint(found, point)


@compiled
def serves(place: Place, between: Edges, p: Point) -> bool:
    """Whether a point is safe, in sight of the eye and not too far behind the target."""
    at, ahead = place.target, place.ahead
    if (p.x - at.x) * ahead.x + (p.y - at.y) * ahead.y < -place.back:
        return False
    if point_clearance(place.walls, place.parts, p.x, p.y) < place.safe_distance - CONTACT:
        return False
    return not crosses(between, place.eye.x, place.eye.y, p.x, p.y)


@compiled
def point_clearance(walls: Shapes, parts: Parts, x: float, y: float) -> float:
    """Distance [m] of a point from the nearest of some wall parts; inf when there are none."""
    V, start = walls.vertices, walls.part_start
    best = np.inf
    for k in range(parts.size):
        part = parts.number[k]
        best = min(best, outline_distance(Part(V, start[part], start[part + 1]), x, y))
    return best


class Edges(NamedTuple):
    """Edges of walls."""

    ends: Rows4
    """(E, 4) x, y [m] of either end"""
    size: int


@compiled
def edges_near(walls: Shapes, parts: Parts, x: float, y: float, reach: float) -> Edges:
    """Edges of the parts that come within ``reach`` [m] of a point."""
    V, start, count, found = walls.vertices, walls.part_start, 0, 0
    for n in range(parts.size):
        count += start[parts.number[n] + 1] - start[parts.number[n]]
    edges = np.empty((count, 4))
    for n in range(parts.size):
        first, end = start[parts.number[n]], start[parts.number[n] + 1]
        for k in range(first, end - 1 if end - first == 2 else end):
            m = k + 1 if k + 1 < end else first
            ax, ay, bx, by = V[k, 0], V[k, 1], V[m, 0], V[m, 1]
            if point_segment(x, y, ax, ay, bx, by) <= reach:
                edges[found, 0], edges[found, 1] = ax, ay
                edges[found, 2], edges[found, 3] = bx, by
                found += 1
    return Edges(edges, found)


@compiled
def crosses(edges: Edges, px: float, py: float, qx: float, qy: float) -> bool:
    """Whether the straight way from p to q properly crosses an edge."""
    for e in range(edges.size):
        ax, ay, bx, by = edges.ends[e, 0], edges.ends[e, 1], edges.ends[e, 2], edges.ends[e, 3]
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
def curve(edges: Edges, c: int, distance: float) -> Curve:
    """Border of the safe area: of each edge the lines to its left and right, a circle at each end.

    Curve c is of edge c // 4; a point has circles only.
    """
    e, kind = c // 4, c % 4
    ax, ay, bx, by = edges.ends[e, 0], edges.ends[e, 1], edges.ends[e, 2], edges.ends[e, 3]
    length = np.hypot(bx - ax, by - ay)
    if kind < 2 and length > 0.0:
        ux, uy = (bx - ax) / length, (by - ay) / length
        if kind == 0:
            return Curve(True, ax - distance * uy, ay + distance * ux, ux, uy)
        return Curve(True, ax + distance * uy, ay - distance * ux, ux, uy)
    return Curve(False, bx, by, 0.0, 0.0) if kind == 3 else Curve(False, ax, ay, 0.0, 0.0)


@compiled
def nearest_on(c: Curve, distance: float, p: Point) -> Point:
    """Point of a curve nearest to another."""
    if c.is_line:
        along = (p.x - c.x) * c.ux + (p.y - c.y) * c.uy
        return Point(c.x + along * c.ux, c.y + along * c.uy)
    dx, dy = p.x - c.x, p.y - c.y
    gap = np.hypot(dx, dy)
    if gap == 0.0:
        return Point(c.x + distance, c.y)
    return Point(c.x + distance * dx / gap, c.y + distance * dy / gap)


class Crossings(NamedTuple):
    """Points in which two curves meet; nan where there is none."""

    first: Point
    second: Point


@compiled
def crossings(c: Curve, d: Curve, distance: float) -> Crossings:
    """Points in which two curves meet."""
    none = Point(np.nan, np.nan)
    if c.is_line and d.is_line:
        cross = c.ux * d.uy - c.uy * d.ux
        if abs(cross) < 1e-12:
            return Crossings(none, none)
        along = ((d.x - c.x) * d.uy - (d.y - c.y) * d.ux) / cross
        return Crossings(Point(c.x + along * c.ux, c.y + along * c.uy), none)
    if not c.is_line and not d.is_line:
        mx, my = (d.x - c.x) / 2.0, (d.y - c.y) / 2.0
        half = np.hypot(mx, my)
        if half == 0.0 or half > distance:
            return Crossings(none, none)
        height = sqrt(distance * distance - half * half) / half
        x, y = c.x + mx, c.y + my
        first = Point(x - height * my, y + height * mx)
        return Crossings(first, Point(x + height * my, y - height * mx))
    line, circle = d, c
    if c.is_line:
        line, circle = c, d
    along = (circle.x - line.x) * line.ux + (circle.y - line.y) * line.uy
    x, y = line.x + along * line.ux, line.y + along * line.uy
    gap = np.hypot(circle.x - x, circle.y - y)
    if gap > distance:
        return Crossings(none, none)
    half = sqrt(distance * distance - gap * gap)
    first = Point(x + half * line.ux, y + half * line.uy)
    return Crossings(first, Point(x - half * line.ux, y - half * line.uy))


@compiled
def roomiest_point(place: Place, parts: Parts, reach: float) -> Point:
    """Point of greatest clearance on the cross-section through a target, seen from the eye.

    The cross-section is the line square to ``ahead``, ``reach`` to both sides, searched at
    2 x 64 + 1 points and then refined: within reach/64 of the best one for a smooth clearance, and
    at most that much beyond ``reach``. The target itself where none of it is seen. ``parts`` are
    those that count.
    """
    walls, target, ahead, eye = place.walls, place.target, place.ahead, place.eye
    away = np.hypot(eye.x - target.x, eye.y - target.y)
    step = reach / SECTION_SAMPLES
    edges = edges_near(walls, parts, target.x, target.y, max(reach + step, away))
    best, offset = -1.0, 0.0
    for k in range(-SECTION_SAMPLES, SECTION_SAMPLES + 1):
        x, y = target.x - k * step * ahead.y, target.y + k * step * ahead.x
        clearance = point_clearance(walls, parts, x, y)
        if clearance > best + CONTACT and not crosses(edges, eye.x, eye.y, x, y):
            best, offset = clearance, k * step
    while step > CONTACT:
        step /= 2.0
        for side in (-1.0, 1.0):
            shift = offset + side * step
            x, y = target.x - shift * ahead.y, target.y + shift * ahead.x
            clearance = point_clearance(walls, parts, x, y)
            if clearance > best and not crosses(edges, eye.x, eye.y, x, y):
                best, offset = clearance, shift
                break
    return Point(target.x - offset * ahead.y, target.y + offset * ahead.x)
