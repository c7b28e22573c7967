"""The roads of the templates: walls and reference path, with a straight stretch to start on.

Each is made for a straight stretch [m] of at most `LONGEST` metres, which holds the robots.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import atan2, ceil, cos, pi, sin, tan

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray

TURN = pi / 12.0
"""[rad] largest turn between two pieces of an arc"""


def arc(x: float, y: float, radius: float, first: float, last: float) -> FloatArray:
    """Points of an arc around (x, y) from angle ``first`` to ``last`` [rad], both included."""
    angles = np.linspace(first, last, 1 + max(1, ceil(abs(last - first) / TURN)))
    return np.stack([x + radius * np.cos(angles), y + radius * np.sin(angles)], axis=1)


def rounded(points: Sequence[Sequence[float]], radius: float) -> FloatArray:
    """Polyline whose inner corners are arcs of a radius; its pieces must be long enough."""
    line = [np.array(points[0], dtype=np.float64)]
    for a, corner, b in zip(points, points[1:], points[2:], strict=False):
        into = atan2(corner[1] - a[1], corner[0] - a[0])
        out = atan2(b[1] - corner[1], b[0] - corner[0])
        turn = (out - into + pi) % (2.0 * pi) - pi
        side = 1.0 if turn > 0.0 else -1.0
        back = radius * tan(0.5 * abs(turn))
        x = corner[0] - back * cos(into) - side * radius * sin(into)
        y = corner[1] - back * sin(into) + side * radius * cos(into)
        start = into - side * 0.5 * pi
        line.extend(arc(x, y, radius, start, start + turn))
    line.append(np.array(points[-1], dtype=np.float64))
    return np.array(line, dtype=np.float64).round(2)


def rectangle(x0: float, y0: float, x1: float, y1: float) -> FloatArray:
    """Corners (4, 2) of a rectangle, counter-clockwise."""
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def tangent_join(ring: float, fillet: float) -> tuple[float, float]:
    """Where an arc joins a straight line through a ring's centre to the ring, from outside.

    Returns how far from the centre along the line the arc leaves the line [m], and the angle [rad]
    between the line and the point at which it meets the ring.
    """
    along = ((ring + fillet) ** 2 - fillet**2) ** 0.5
    return along, atan2(fillet, along)


LONGEST = 34.0
"""[m] longest straight stretch to start on"""


@dataclass(frozen=True)
class Road:
    """What a template draws. Lengths [m], world frame.

    Every reference path begins at the origin, straight along x, where the robots stand.
    """

    what: str
    """what the world shows, in a sentence"""
    reference: FloatArray
    """(n, 2)"""
    narrowest: float
    """least width: as many lanes as fit into it"""
    start_width: float
    """width where the robots start"""
    width: float | None = None
    """of a corridor along the reference path; None: boundaries are drawn"""
    boundaries: tuple[FloatArray, ...] = ()
    obstacles: tuple[FloatArray, ...] = ()
    notes: dict[str, str] = field(default_factory=dict)
    """comments on ``boundaries`` and ``obstacles``"""
    drawn: tuple[tuple[str, str, str], ...] = ()
    """key, value and comment of each key of `RandomRoad`, for a road that the seed draws; its
    ``reference`` is as long as that"""


def corridor(straight: float) -> Road:
    """Straight and 8 m wide."""
    line = np.array([[0.0, 0.0], [straight + 30.0, 0.0]])
    return Road("Robots drive abreast along a straight corridor.", line, 8.0, 8.0, 8.0)


def bend(straight: float) -> Road:
    """A quarter turn to the left."""
    line = rounded([[0.0, 0.0], [straight + 10.0, 0.0], [straight + 10.0, 32.0]], 9.0)
    return Road("Robots drive abreast round a bend.", line, 8.0, 8.0, 8.0)


def s_bend(straight: float) -> Road:
    """A turn to the left and one to the right."""
    x = straight + 10.0
    line = rounded([[0.0, 0.0], [x, 0.0], [x, 24.0], [x + 26.0, 24.0]], 9.0)
    return Road("Robots drive abreast through an S-bend.", line, 7.0, 7.0, 7.0)


def doorway(straight: float) -> Road:
    """A corridor with a wall across it, and a door in that."""
    line = np.array([[0.0, 0.0], [straight + 34.0, 0.0]])
    x = straight + 6.0
    wall = (rectangle(x, 1.1, x + 0.6, 4.0), rectangle(x, -4.0, x + 0.6, -1.1))
    notes = {"obstacles": "the wall on either side of the door, which is 2.2 m wide"}
    what = "Robots drive one by one through a door that is one robot wide."
    return Road(what, line, 2.2, 8.0, 8.0, obstacles=wall, notes=notes)


def roundabout(straight: float) -> Road:
    """A ring with three arms: in from the west, three quarters round, out to the north."""
    ring, fillet, half, arm = 10.0, 5.0, 3.5, 34.0
    along, angle = tangent_join(ring, fillet)
    centre = along + straight
    turn = angle + 1.5 * pi - 2.0 * angle
    into = arc(-along, -fillet, fillet, 0.5 * pi, angle)[:-1]
    round_ = arc(0.0, 0.0, ring, pi + angle, pi + turn)
    out = arc(fillet, along, fillet, 1.5 * pi - angle, pi)[1:]
    line = np.vstack([[[-centre, 0.0]], into, round_, out, [[0.0, arm - 3.0]]])
    disc = shapely.Polygon(arc(0.0, 0.0, ring + half, 0.0, 2.0 * pi)[:-1])
    arms = [
        shapely.box(-centre - 3.0, -half, 0.0, half),
        shapely.box(0.0, -half, arm, half),
        shapely.box(-half, 0.0, half, arm),
    ]
    outer = np.array(shapely.union_all([disc, *arms]).exterior.coords)
    island = arc(0.0, 0.0, ring - half, 0.0, 2.0 * pi)[:-1]
    shift = np.array([centre, 0.0])
    notes = {
        "boundaries": "the outer edge of the ring and its three arms",
        "obstacles": "the island",
    }
    return Road(
        "Robots enter a roundabout from the west, go three quarters round and leave to the north.",
        np.round(line + shift, 2),
        2.0 * half - 1.0,  # so that two lanes drive round with room to spare, not three without
        2.0 * half,
        boundaries=(np.round(outer + shift, 2),),
        obstacles=(np.round(island + shift, 2),),
        notes=notes,
    )


def warehouse(straight: float) -> Road:
    """A hall with shelves; the path winds through three aisles, the robots start in the first."""
    aisle, shelf, long = 6.0, 2.0, 46.0
    pitch = aisle + shelf
    line = rounded(
        [[0.0, 0.0], [long, 0.0], [long, pitch], [0.0, pitch], [0.0, 2 * pitch], [long, 2 * pitch]],
        3.5,
    )
    hall = rectangle(-3.0, -3.0, long + 3.0, 2 * pitch + 3.0)
    shelves = [
        rectangle(x, 0.5 * aisle + k * pitch, x + 18.5, 0.5 * aisle + k * pitch + shelf)
        for k in (0, 1)
        for x in (3.5, 24.0)
    ]
    return Road(
        "Robots wind through the aisles of a warehouse.",
        line,
        aisle,
        aisle,
        boundaries=(np.vstack([hall, hall[:1]]),),
        obstacles=tuple(shelves),
        notes={"boundaries": "the walls of the hall", "obstacles": "shelves"},
    )


def random(straight: float) -> Road:
    """Bends and obstacles that the seed draws, beside a passage for two lanes."""
    ends, passage, widths = round(straight + 4.0, 2), 4.6, (6.0, 9.0)
    length = round(2.0 * ends + 60.0, 2)
    drawn = (
        ("length", f"{length}", "[m] of the middle line, from (0, 0) along the x axis"),
        ("bends", "[2, 3]", "least and greatest number"),
        ("turns", "[0.35, 1.2]", "[rad] of one bend, to either side"),
        (
            "width",
            f"[{widths[0]}, {widths[1]}]",
            "[m] from wall to wall; the greatest at both ends",
        ),
        ("clutter", "8.0", "obstacles per 100 m between the ends"),
        ("sizes", "[0.6, 1.6]", "[m] diameter of the circle round an obstacle"),
        ("passage", f"{passage}", "[m] stays clear along the whole way, about its middle"),
        ("ends", f"{ends}", "[m] straight, without obstacles: where robots start and stop"),
    )
    return Road(
        "Robots drive along a road that the seed draws.",
        np.array([[0.0, 0.0], [length, 0.0]]),
        passage,
        widths[1],
        drawn=drawn,
    )


ROADS: dict[str, Callable[[float], Road]] = {
    "corridor": corridor,
    "bend": bend,
    "doorway": doorway,
    "s_bend": s_bend,
    "roundabout": roundabout,
    "warehouse": warehouse,
    "random": random,
}
"""Templates by name; the first is the default."""
