"""Obstacles of a road that the seed draws: anywhere on it, beside the way that stays clear.

The stream is (seed, "road clutter", attempt). Obstacles spread evenly along the road: it is cut
into as many stretches, and each has one, unless there is no room for it there.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.randomness import stream
from physim.world.ground.corridor import SIDES
from physim.world.layout.road_line import DECIMALS, Course

GAP = 0.3
"""[m] least distance of an obstacle to another and to a wall"""
SPARE = 2.0 * 10.0**-DECIMALS
"""[m] added to distances, for the rounding of corners"""
TRIES = (24, 72, 144)
"""Places drawn for one obstacle, first on its own stretch, then anywhere, before it is given up"""


def draw_clutter(course: Course, way: shapely.LineString) -> list[FloatArray] | None:
    """Outlines (n, 2) [m] of the obstacles beside a way; None where there is no room for all."""
    road, walls = course.road, course.walls
    draw = stream(course.seed, "road clutter", course.attempt)
    first, last = road.ends, course.line.length - road.ends
    count = round(road.clutter * (last - first) / 100.0)
    left, right = (course.lines[side] for side in SIDES)
    inside = shapely.Polygon(np.vstack([left, right[::-1]]))
    ends = _ends(course)
    shapely.prepare(inside)
    shapely.prepare(way)
    found: list[FloatArray] = []
    solids: list[shapely.Geometry] = []
    for k in range(count):
        own = first + np.array([k, k + 1]) * (last - first) / count
        for tries in TRIES:
            low, high = own if tries == TRIES[0] else (first, last)
            outlines, sizes, at = _candidates(course, draw, low, high, tries)
            shapes = np.array([shapely.Polygon(outline) for outline in outlines])
            fits = (at - 0.5 * sizes >= first) & (at + 0.5 * sizes <= last)
            fits &= shapely.contains_properly(inside, shapes) & ~shapely.intersects(ends, shapes)
            fits &= shapely.distance(way, shapes) >= 0.5 * course.passage + SPARE
            fits &= shapely.distance(walls, shapes) >= GAP + SPARE
            if solids:
                fits &= shapely.distance(shapely.union_all(solids), shapes) >= GAP + SPARE
            if fits.any():
                chosen = int(np.argmax(fits))
                found.append(outlines[chosen])
                solids.append(shapes[chosen])
                break
        else:
            return None
    return found


def _ends(course: Course) -> shapely.Geometry:
    """The first and the last stretch of a road, which are straight.

    What is placed by its station beside a bend may reach back into them.
    """
    centreline, widths, length = course.centreline, course.widths, course.road.ends
    parts = []
    for (here, there), width in ((centreline[:2], widths[0]), (centreline[:-3:-1], widths[-1])):
        along = (there - here) / np.hypot(*(there - here))
        line = shapely.LineString([here, here + length * along])
        parts.append(line.buffer(0.5 * width, cap_style="flat"))
    return shapely.union_all(parts)


def _candidates(
    course: Course, draw: np.random.Generator, low: float, high: float, count: int
) -> tuple[list[FloatArray], FloatArray, FloatArray]:
    """Outlines of obstacles anywhere on a stretch of the road, their sizes and stations [m]."""
    road, centreline, station = course.road, course.centreline, course.line.station
    at, aside = draw.uniform(low, high, count), draw.uniform(-0.5, 0.5, count)
    sizes, angles = draw.uniform(*road.sizes, count), draw.uniform(0.0, 2.0 * pi, count)
    kinds, shares = draw.integers(len(road.shapes), size=count), draw.uniform(0.0, 1.0, count)
    step = np.diff(centreline, axis=0) / np.diff(station)[:, None]
    leg = np.clip(np.searchsorted(station, at, side="right") - 1, 0, len(step) - 1)
    normal = np.stack([-step[leg, 1], step[leg, 0]], axis=1)
    place = centreline[leg] + (at - station[leg])[:, None] * step[leg]
    place = place + (aside * np.interp(at, station, course.widths))[:, None] * normal
    outlines = []
    for k in range(count):
        corners = SHAPES[road.shapes[kinds[k]]](shares[k])
        turn = angles[k] + corners
        outline = place[k] + 0.5 * sizes[k] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        outlines.append(outline.round(DECIMALS))
    return outlines, sizes, at


def _rectangle(half: float) -> FloatArray:
    """Angles (4,) [rad] at which the corners lie on the circle round a rectangle."""
    return np.array([-half, half, pi - half, pi + half])


def _triangle(share: float) -> FloatArray:
    """One of equal sides, or a more slender one."""
    half = pi / 3.0 - 0.4 * share
    return np.array([0.0, pi - half, pi + half])


SHAPES: dict[str, Callable[[float], FloatArray]] = {
    "box": lambda share: _rectangle(pi / 4.0 - share * 0.32),  # up to twice as long as wide
    "bar": lambda share: _rectangle(0.2 - share * 0.09),  # five to nine times
    "round": lambda _: np.linspace(0.0, 2.0 * pi, 8, endpoint=False),
    "triangle": _triangle,
}
"""Angles [rad] of the corners on the circle round an obstacle, counter-clockwise, by its shape;
each of a number from 0 to 1 that the seed draws."""
