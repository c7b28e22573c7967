"""The line of a road that the seed draws: where it goes, how wide it is, and the way through it.

Each part draws from a stream of its own, (seed, what is drawn, attempt): another width or other
clutter leaves the bends as they are. Coordinates are rounded to `DECIMALS`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, pi

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.randomness import stream
from physim.world.ground.corridor import SIDES, corridor_boundaries, offset_polyline
from physim.world.ground.polyline import Polyline
from physim.world.road import RandomRoad

DECIMALS = 3
"""of coordinates and widths [m]"""
PIECE = 3.0
"""[m] longest piece of the centreline where it is straight"""
TURN = pi / 15.0
"""[rad] largest turn between two pieces of a bend"""
APART = 1.0
"""[m] least distance between the walls of two parts of a road that pass each other"""
ASTRAY = (2.2, 1.3)
"""[rad] how far a road may turn away from its first direction: at first, and once half of all
attempts crossed themselves"""
SWING = 15.0
"""[m] about, from one place where width and way are drawn to the next"""
WEAVE = 1.5
"""[m] farthest that the way swings out from the middle of the road"""


def draw_centreline(road: RandomRoad, seed: int, attempt: int, astray: float) -> FloatArray:
    """Points (n, 2) [m] of a road as long as asked for, from (0, 0) along the x axis.

    Bends go to either side, but to the other one where the road would turn away from its first
    direction by more than ``astray`` [rad]. Where they are longer than the road has room for, all
    are taken nearer to the smallest.
    """
    draw = stream(seed, "road line", attempt)
    bends = int(draw.integers(road.least_bends, road.most_bends + 1))
    turns, radii = draw.uniform(*road.turns, bends), draw.uniform(*road.bend_radii, bends)
    sides, shares = draw.choice([-1.0, 1.0], bends), draw.dirichlet(np.ones(bends + 1))
    room = road.length - 2.0 * road.ends
    for share in (1.0, 0.75, 0.5, 0.25, 0.0):
        sizes = road.turns[0] + share * (turns - road.turns[0])
        wide = road.bend_radii[0] + share * (radii - road.bend_radii[0])
        pieces = np.maximum(np.ceil(sizes / TURN), 1.0)
        chords = 2.0 * wide * np.sin(0.5 * sizes / pieces)
        if (rest := room - float(pieces @ chords)) >= 0.0:
            break
    straights = shares * max(rest, 0.0)
    heading, steps = 0.0, _straight(road.ends) + _straight(straights[0])
    headings = [heading] * len(steps)
    for k in range(bends):
        turn = sides[k] * sizes[k]
        if abs(heading + turn) > astray and abs(heading - turn) < abs(heading + turn):
            turn = -turn
        count = int(pieces[k])
        headings += [heading + (m + 0.5) * turn / count for m in range(count)]
        steps += [float(chords[k])] * count
        heading += turn
        more = _straight(straights[k + 1])
        steps, headings = steps + more, headings + [heading] * len(more)
    last = _straight(road.ends)
    steps, headings = steps + last, headings + [heading] * len(last)
    way = np.array(steps)[:, None] * np.stack([np.cos(headings), np.sin(headings)], axis=1)
    return np.vstack([[0.0, 0.0], np.cumsum(way, axis=0)]).round(DECIMALS)


def _straight(length: float) -> list[float]:
    """Steps [m] of a straight piece; a very short one is left out."""
    count = ceil(length / PIECE) if length > 10.0**-DECIMALS else 0
    return [length / count] * count if count else []


@dataclass(frozen=True)
class Course:
    """A road on its way to be drawn: what is asked for, and what is drawn already."""

    road: RandomRoad
    passage: float
    """[m]"""
    seed: int
    attempt: int
    centreline: FloatArray
    """(n, 2) [m]"""
    widths: FloatArray
    """(n,) [m]"""
    lines: dict[str, FloatArray]
    """walls and caps"""

    @cached_property
    def walls(self) -> shapely.Geometry:
        """The same as one geometry."""
        walls = shapely.MultiLineString(list(self.lines.values()))
        shapely.prepare(walls)
        return walls

    @cached_property
    def line(self) -> Polyline:
        """The centreline by arc length."""
        return Polyline(self.centreline)


def draw_widths(road: RandomRoad, centreline: FloatArray, seed: int, attempt: int) -> FloatArray:
    """Width (n,) [m] at each point of a centreline: the greatest one at the ends."""
    low, high = road.widths
    station = Polyline(centreline).station
    knots = _knots(road, float(station[-1]))
    drawn = stream(seed, "road width", attempt).uniform(low, high, len(knots))
    drawn[:1], drawn[-1:] = high, high
    return np.clip(_smooth(station, knots, drawn).round(DECIMALS), low, high)


def draw_way(course: Course) -> FloatArray:
    """Way (n, 2) [m] through a road that keeps half the passage from its walls.

    It swings from the middle of the road to its sides, as far as there is room.
    """
    centreline, station = course.centreline, course.line.station
    knots = _knots(course.road, course.line.length)
    drawn = stream(course.seed, "road way", course.attempt).uniform(-1.0, 1.0, len(knots))
    drawn[:1], drawn[-1:] = 0.0, 0.0
    room, least = np.minimum(0.5 * (course.widths - course.passage), WEAVE), 0.5 * course.passage
    swing = _smooth(station, knots, drawn) * np.maximum(room, 0.0)
    for share in (1.0, 0.5, 0.25):
        way = offset_polyline(centreline, share * swing).round(DECIMALS)
        away = shapely.LineString(way).distance(course.walls)
        if _advances(way, centreline) and away >= least:
            return way
    return centreline


def are_apart(centreline: FloatArray, widths: FloatArray, end_margin: float) -> bool:
    """Whether a road neither crosses itself nor passes itself nearer than `APART`.

    It does not where the outline of a road wider by that is simple.
    """
    walls = corridor_boundaries(centreline, widths + APART, end_margin + 0.5 * APART)
    left, right = (walls[side] for side in SIDES)
    return bool(shapely.LinearRing(np.vstack([left, right[::-1]])).is_simple)


def lanes_advance(way: FloatArray, offsets: list[float]) -> bool:
    """Whether paths beside a way go on in its sense everywhere, in its bends too."""
    for offset in offsets:
        try:
            if not _advances(offset_polyline(way, np.full(len(way), offset)), way):
                return False
        except ValueError:
            return False
    return True


def walls_advance(lines: dict[str, FloatArray], centreline: FloatArray) -> bool:
    """Whether the walls of a corridor go on in the sense of its centreline everywhere."""
    return all(_advances(lines[side][1:-1], centreline) for side in SIDES)


def _advances(line: FloatArray, beside: FloatArray) -> bool:
    return bool(((np.diff(line, axis=0) * np.diff(beside, axis=0)).sum(axis=1) > 0.0).all())


def _knots(road: RandomRoad, length: float) -> FloatArray:
    """Stations [m], `SWING` apart or a little less, from the end of the first end to the other."""
    first, last = road.ends, length - road.ends
    return np.linspace(first, last, 2 + int(max(last - first, 0.0) / SWING))


def _smooth(station: FloatArray, knots: FloatArray, values: FloatArray) -> FloatArray:
    """Values at stations, between those at knots along half a wave of a cosine."""
    place = np.interp(station, knots, np.arange(len(knots)))
    before = np.minimum(place.astype(np.int64), len(knots) - 2)
    share = 0.5 - 0.5 * np.cos(pi * (place - before))
    return np.asarray(values[before] + share * (values[before + 1] - values[before]))
