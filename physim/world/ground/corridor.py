"""Corridors: boundaries at a width from a centreline, and the width along a path (Fig. 4).

The width at a place of a path is the shortest distance to its left plus that to its right.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physim.geometry.path import SHARPEST_TURN
from physim.geometry.shapes import FloatArray
from physim.world.ground.polyline import Polyline

EVERY, LEAST_PLACES, MOST_PLACES = 0.1, 60, 100_000
"""[m] between places at which the width is taken; less on paths of fewer, more on paths of more"""
LEFT, RIGHT, EITHER = 1.0, -1.0, 0.0
"""Sides of a path"""
SIDES = ("left wall", "right wall")
"""Boundaries of a corridor; the caps that close its ends lie on neither side of a path."""


def offset_polyline(points: FloatArray, offset: FloatArray, first: int = 0) -> FloatArray:
    """Move a polyline (n, 2) sideways by ``offset`` (n,) [m], left positive, corners mitred.

    Raises ValueError where it is to be moved and turns back on itself, naming the waypoint as a
    world file counts it: from 0, or from ``first``.
    """
    direction = np.diff(points, axis=0)
    direction /= np.hypot(*direction.T)[:, None]
    normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    before = np.vstack([normal[:1], normal])
    after = np.vstack([normal, normal[-1:]])
    cosine = np.clip((before * after).sum(axis=1), -1.0, 1.0)
    stays = offset == 0.0
    sharp = np.flatnonzero((np.arccos(cosine) > SHARPEST_TURN) & ~stays)
    if sharp.size:
        x, y = points[sharp[0]]
        turn = np.degrees(np.arccos(cosine[sharp[0]]))
        raise ValueError(
            f"turns by {turn:.0f} degrees at waypoint [{sharp[0] + first}] ({x:g}, {y:g}); "
            f"at most {np.degrees(SHARPEST_TURN):.0f} degrees can be offset sideways"
        )
    mitre = (before + after) / np.where(stays, 1.0, 1.0 + cosine)[:, None]
    return np.asarray(points + offset[:, None] * mitre)


def corridor_boundaries(
    centreline: FloatArray, width: FloatArray, end_margin: float
) -> dict[str, FloatArray]:
    """Left and right wall and the two caps of a corridor, as polylines [m].

    ``centreline`` (n, 2), ``width`` (n,) from wall to wall at each of its points. The corridor is
    prolonged by ``end_margin`` straight on at both ends and closed there.
    Raises ValueError where the centreline turns too sharply to be offset.
    """
    first = centreline[0] - centreline[1]
    last = centreline[-1] - centreline[-2]
    line = np.vstack(
        [
            centreline[0] + end_margin * first / np.hypot(*first),
            centreline,
            centreline[-1] + end_margin * last / np.hypot(*last),
        ]
    )
    half = np.concatenate([width[:1], width, width[-1:]]) / 2.0
    left, right = offset_polyline(line, half, -1), offset_polyline(line, -half, -1)
    return {
        SIDES[0]: left,
        SIDES[1]: right,
        "start cap": np.array([left[0], right[0]]),
        "end cap": np.array([left[-1], right[-1]]),
    }


BLOCK = 200_000
"""Pairs of point and segment looked at in one go: bounds the memory."""
APART = -0.5
"""Cosine of the angle [120 degrees] by which the two sides of a path are apart at least."""


def feet(
    points: FloatArray, directions: FloatArray, segments: FloatArray, sides: tuple[float, ...]
) -> list[FloatArray]:
    """Nearest boundary points (K, 2) [m] to points of a path, for each of the ``sides`` (Fig. 4).

    ``points``, ``directions`` (K, 2) along the path, ``segments`` (S, 4) boundary segments
    ax, ay, bx, by. A side is 1, the half-plane left of the path's direction, -1, that to the right,
    or 0, everywhere; so a boundary on both sides of the path counts on each. Not finite where a
    side is open.
    """
    found = [np.full((len(points), 2), np.inf) for _ in sides]
    dx, dy = segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]  # (S,)
    square = dx * dx + dy * dy
    block = max(1, BLOCK // max(1, len(segments)))
    for first in range(0, len(points) if len(segments) else 0, block):
        at, ahead = points[first : first + block], directions[first : first + block]
        ax, ay = segments[:, 0] - at[:, :1], segments[:, 1] - at[:, 1:]  # (K, S)
        tx, ty = ahead[:, :1], ahead[:, 1:]
        across, span = tx * ay - ty * ax, tx * dy - ty * dx  # of a; from a to b
        foot = -(ax * dx + ay * dy) / np.where(square > 0.0, square, 1.0)
        crossing = np.divide(-across, span, out=np.zeros_like(span), where=span != 0.0)
        row = np.arange(len(at))
        for side, out in zip(sides, found, strict=True):
            starts, ends = side * across >= 0.0, side * (across + span) >= 0.0
            low, high = np.where(starts, 0.0, crossing), np.where(ends, 1.0, crossing)
            share = np.minimum(np.maximum(foot, low), high)
            x, y = ax + share * dx, ay + share * dy
            gap = np.where(starts | ends, x * x + y * y, np.inf)
            best = gap.argmin(axis=1)
            nearest = at + np.stack([x[row, best], y[row, best]], axis=1)
            is_there = np.isfinite(gap[row, best])
            out[first : first + block][is_there] = nearest[is_there]
    return found


def side_feet(
    points: FloatArray,
    directions: FloatArray,
    segments: FloatArray,
    walls: tuple[FloatArray, FloatArray] | None = None,
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Nearest points (K, 2) [m] on the left and on the right, and whether a width is between them.

    ``segments`` (S, 4) lie on the side of the path on which they are found, as in `feet`;
    ``walls`` are those of a corridor, of which it is known which is left and which is right: their
    points need only be 90 degrees or more apart, all others must be `opposite`. Where the road
    passes itself, so that both nearest points lie on one side, the farther one is of another
    stretch, behind the wall that the nearer one is on: that of its own side is taken instead.
    """
    left, right = feet(points, directions, segments, (LEFT, RIGHT))
    if walls is None:
        return left, right, opposite(points, directions, left, right)

    def gaps(at: FloatArray, some: FloatArray) -> FloatArray:
        return np.asarray(np.hypot(*(some - at).T))

    def nearer(at: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
        return np.where((gaps(at, first) < gaps(at, second))[:, None], first, second)

    own = left, right
    left, right = (
        nearer(points, side, feet(points, directions, wall, (EITHER,))[0])
        for side, wall in zip(own, walls, strict=True)
    )
    between = _apart(points, left, right, 0.0)
    rows = np.flatnonzero(~between)
    at, along = points[rows], directions[rows]
    sides = [
        nearer(at, seen[rows], feet(at, along, wall, (side,))[0])
        for seen, wall, side in zip(own, walls, (LEFT, RIGHT), strict=True)
    ]
    farther = gaps(at, left[rows]) > gaps(at, right[rows])
    seen_left = np.where(farther[:, None], sides[0], left[rows])
    seen_right = np.where(farther[:, None], right[rows], sides[1])
    found = opposite(at, along, seen_left, seen_right)
    left[rows[found]], right[rows[found]] = seen_left[found], seen_right[found]
    between[rows[found]] = True
    return left, right, between


def opposite(
    points: FloatArray, directions: FloatArray, left: FloatArray, right: FloatArray
) -> NDArray[np.bool_]:
    """Whether two nearest points (K, 2) lie on the two sides of a path, so that a width is between.

    ``points``, ``directions`` (K, 2) along the path. The two must be 120 degrees or more apart as
    seen from the path, and the line through them nearer to square than to along the path: near an
    end of a corridor one or both may lie on the wall that closes it, before or behind the path,
    and then the distances add up to no width that a robot must fit through. A wall square across
    the path never counts. False where a point is not finite.
    """
    across = np.where(np.isfinite(left) & np.isfinite(right), left - right, 0.0)
    ahead = np.abs((across * directions).sum(axis=1))
    aside = np.abs(across[:, 0] * directions[:, 1] - across[:, 1] * directions[:, 0])
    return np.asarray(_apart(points, left, right, APART) & (ahead <= aside))


def _apart(
    points: FloatArray, left: FloatArray, right: FloatArray, most: float
) -> NDArray[np.bool_]:
    """Whether the cosine between two points as seen from ``points`` is ``most`` or less."""
    known = np.isfinite(np.concatenate((left, right), axis=1)).all(axis=1)
    one, other = (np.where(np.isfinite(foot), foot - points, 0.0) for foot in (left, right))
    bound = most * np.hypot(*one.T) * np.hypot(*other.T)
    return np.asarray(known & ((one * other).sum(axis=1) <= bound))


EVEN = 1.0e-9
"""Share by which widths may differ and still count as equal."""
DIPS = 6
"""Narrow places that are looked at more closely."""
NEARER = 20
"""Stretches between two neighbours of a narrow place, cut twice."""


@dataclass(frozen=True)
class Widths:
    """Shortest distances to the left and to the right at K stations of a path."""

    station: FloatArray
    """(K,) [m] along the path"""
    point: FloatArray
    """(K, 2) [m] on the path"""
    left: FloatArray
    """(K,) [m]; inf where that side is open"""
    right: FloatArray
    """(K,) [m]; likewise"""
    left_foot: FloatArray
    """(K, 2) [m] the nearest point on the left; nan where that side is open"""
    right_foot: FloatArray
    """(K, 2) [m] likewise on the right"""
    between: NDArray[np.bool_]
    """(K,) whether there is a width between the two: `side_feet`"""

    @property
    def width(self) -> FloatArray:
        """(K,) [m] left plus right."""
        return self.left + self.right

    @property
    def narrowest(self) -> int | None:
        """Index of the narrowest place between two sides; None where there is none.

        Where a stretch is evenly narrow, the middle of the longest such stretch.
        """
        width = np.where(self.between, self.width, np.inf)
        if not np.isfinite(least := width.min(initial=np.inf)):
            return None
        even = np.concatenate(([False], width <= least * (1.0 + EVEN), [False]))
        first, end = np.flatnonzero(np.diff(even.astype(int))).reshape(-1, 2).T
        length = self.station[end - 1] - self.station[first]
        k = int(np.argmax(length))
        middle = self.station[first[k]] + length[k] / 2.0
        return int(first[k] + np.argmin(np.abs(self.station[first[k] : end[k]] - middle)))


def widths_at(
    path: FloatArray,
    stations: FloatArray,
    segments: FloatArray,
    walls: tuple[FloatArray, FloatArray] | None = None,
) -> Widths:
    """Widths at ``stations`` (K,) [m] of a path (n, 2) between segments (S, 4) ax, ay, bx, by.

    ``walls`` are segments of the left and of the right wall of a corridor, where there is one.

    *Left* is what lies in the half-plane left of the path's direction, which at a waypoint is the
    direction after it, so a wall on both sides of the path counts on each.
    """
    point, tangent = _line(path).at(stations)
    *found, between = side_feet(point, tangent, segments, walls)
    foot = [np.where(np.isfinite(one), one, np.nan) for one in found]
    gaps = [np.nan_to_num(np.hypot(*(one - point).T), nan=np.inf) for one in foot]
    return Widths(stations, point, gaps[0], gaps[1], foot[0], foot[1], between)


def _line(path: FloatArray) -> Polyline:
    """A path (n, 2) without points that are the ones before."""
    return Polyline(path[np.concatenate(([True], (np.diff(path, axis=0) != 0.0).any(axis=1)))])


def width_spacing(length: float) -> float:
    """[m] between places at which the width along a path of that length [m] is taken."""
    return max(min(EVERY, length / LEAST_PLACES), length / MOST_PLACES)


def sampled_widths(
    path: FloatArray,
    segments: FloatArray,
    places: int,
    walls: tuple[FloatArray, FloatArray] | None = None,
) -> Widths:
    """Widths at ``places`` evenly spaced stations, at every waypoint and round narrow places.

    Round each of the narrowest dips more are taken between its neighbours, 1/400 of their
    distance apart at last.
    """
    line = _line(path)
    even = np.linspace(0.0, line.length, places)
    widths = widths_at(path, np.unique(np.concatenate((even, line.station))), segments, walls)
    for _ in range(2):
        width = widths.width
        before, after = np.append(np.inf, width[:-1]), np.append(width[1:], np.inf)
        low = (width <= before) & (width <= after) & ((width < before) | (width < after))
        dips = np.flatnonzero(low & np.isfinite(width))
        dips = dips[np.argsort(width[dips], kind="stable")][:DIPS]
        near = [widths.station[max(k - 1, 0) : k + 2] for k in dips]
        closer = [np.linspace(part[0], part[-1], NEARER + 1)[1:-1] for part in near]
        if closer:
            more = widths_at(path, np.unique(np.concatenate(closer)), segments, walls)
            pairs = zip(vars(widths).values(), vars(more).values(), strict=True)
            columns = [np.concatenate(pair) for pair in pairs]
            order = np.unique(columns[0], return_index=True)[1]
            widths = Widths(*(column[order] for column in columns))
    return widths
