"""Stops at which two robots cannot both stand: their footprints there overlap or touch."""

from __future__ import annotations

import numpy as np
import shapely
from shapely.affinity import translate

from physim.errors import place_text, plural
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world.checks.findings import Diagnostics
from physim.world.checks.standing import Stop
from physim.world.faults import describe
from physim.world.scene import Layout

MOST_PAIRS = 5_000
"""Pairs that are counted: of a crowd that stops in one place, these."""
LEAST = 1e-3
"""[m] of an overlap from which on its measure is told"""


def check_shared_stops(laid: Layout, at: list[Stop], found: Diagnostics) -> None:
    """Warn of robots whose stops overlap, unless the run is not to finish.

    One warning for all of them, at the pair that overlaps most.
    """
    expect = laid.world.expect
    if expect is not None and expect.finished is False:
        return
    if any(fault.location[:1] == ("formation",) for fault in found.errors):
        return  # those overlap all the way
    if any(fault.location[-1:] == ("footprint",) for fault in found.warnings):
        return  # what is out of scale is told first
    pairs = _overlapping(at)
    if not pairs:
        return
    back, stop, other = _earlier(*_deepest(pairs))
    heading = np.array([np.cos(stop.pose[2]), np.sin(stop.pose[2])])
    between: FloatArray = stop.pose[:2] - other.pose[:2]
    now, needed = np.hypot(*between), np.hypot(*(between - back * heading))
    x, y = stop.pose[:2]
    count = "more than " * (len(pairs) > MOST_PAIRS) + plural(len(pairs) - 1, "more pair")
    more = f" (so {'does' if len(pairs) == 2 else 'do'} {count})" if len(pairs) > 1 else ""
    by = (
        f"more than {back:.4g} m earlier ({needed:.4g} m apart)"
        if back > LEAST
        else "a bit earlier"
    )
    found.warn(
        laid.path_key(stop.number),
        f"{describe(laid.names[stop.number])} stops at station {stop.station:.2f} m of its path, "
        f"{place_text(x, y, 4)}, where {describe(laid.names[other.number])} stops too{more}: both "
        f"cannot stand there, and one will not arrive; their stops are {round(now, 9):.4g} m "
        f"apart: end one path {by}, or keep them apart by formation.spacing",
    )


def _overlapping(at: list[Stop]) -> list[tuple[Stop, Stop]]:
    """Pairs of stops that overlap or touch, the lower number first; not all of very many."""
    outlines = [stop.outline for stop in at]
    tree, pairs = shapely.STRtree(outlines), []
    for i, outline in enumerate(outlines):
        near = sorted(tree.query(outline, predicate="intersects").tolist())
        pairs += [(at[i], at[k]) for k in near if k > i]
        if len(pairs) > MOST_PAIRS:
            break
    return pairs


def _deepest(pairs: list[tuple[Stop, Stop]]) -> tuple[Stop, Stop]:
    """The pair with most area in common, the first of equal ones."""
    first, second = ([pair[k].outline for pair in pairs] for k in (0, 1))
    return pairs[int(np.argmax(np.round(shapely.area(shapely.intersection(first, second)), 6)))]


def _earlier(a: Stop, b: Stop) -> tuple[float, Stop, Stop]:
    """How much earlier [m] one of two must stop, that one, and the other: the smaller of both.

    Of equal ones the second stops earlier.
    """
    back = _back(b, a), _back(a, b)
    return (back[0], b, a) if back[0] <= back[1] + LENGTH else (back[1], a, b)


def _back(stop: Stop, other: Stop) -> float:
    """How far [m] a robot must go straight back to be clear of another's convex hull."""
    hull, fixed = stop.outline.convex_hull, other.outline.convex_hull
    c, s = np.cos(stop.pose[2]), np.sin(stop.pose[2])
    points = np.vstack([shapely.get_coordinates(one) for one in (hull, fixed)])
    low, high = 0.0, float(np.hypot(*np.ptp(points, axis=0)))
    while high - low > LENGTH:
        middle = (low + high) / 2.0
        if translate(hull, -middle * c, -middle * s).intersects(fixed):
            low = middle
        else:
            high = middle
    return high
