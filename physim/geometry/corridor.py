"""Corridors: boundaries at a width from a centreline, and the width along a path (Fig. 4).

The width at a place of a path is the shortest distance to its left plus that to its right.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physim.geometry.path import SHARPEST_TURN
from physim.geometry.shapes import FloatArray

EVERY, LEAST_PLACES, MOST_PLACES = 0.1, 60, 100_000
"""[m] between places at which the width is taken; less on paths of fewer, more on paths of more"""
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


def width_feet(
    points: FloatArray, directions: FloatArray, segments: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Nearest boundary points (K, 2) [m] on the left and on the right of a path (Fig. 4).

    ``points``, ``directions`` (K, 2) along the path, ``segments`` (S, 4) boundary segments
    ax, ay, bx, by. *Left* is what lies in the half-plane left of the path's direction, so a
    boundary on both sides of the path counts on each. Not finite where a side is open.
    """
    left, right = np.full((len(points), 2), np.inf), np.full((len(points), 2), np.inf)
    if not len(segments):
        return left, right
    block = max(1, BLOCK // len(segments))
    for first in range(0, len(points), block):
        part = slice(first, first + block)
        _feet(points[part], directions[part], segments, left[part], right[part])
    return left, right


def nearest_feet(points: FloatArray, segments: FloatArray) -> FloatArray:
    """Nearest points (K, 2) [m] of segments (S, 4) to points (K, 2); not finite without any."""
    feet = np.full((len(points), 2), np.inf)
    block = max(1, BLOCK // max(1, len(segments)))
    for first in range(0, len(points) if len(segments) else 0, block):
        part = points[first : first + block]
        ax, ay = segments[:, 0] - part[:, :1], segments[:, 1] - part[:, 1:]
        dx, dy = segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]
        square = dx * dx + dy * dy
        along = -(ax * dx + ay * dy) / np.where(square > 0.0, square, 1.0)
        at = np.minimum(np.maximum(along, 0.0), 1.0)
        x, y = ax + at * dx, ay + at * dy
        best = (x * x + y * y).argmin(axis=1)
        row = np.arange(len(part))
        feet[first : first + block] = part + np.stack([x[row, best], y[row, best]], axis=1)
    return feet


def side_feet(
    points: FloatArray,
    directions: FloatArray,
    segments: FloatArray,
    walls: tuple[FloatArray, FloatArray] | None = None,
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Nearest points (K, 2) [m] on the left and on the right, and whether a width is between them.

    ``segments`` (S, 4) lie on the side of the path on which they are found, as in `width_feet`;
    ``walls`` are those of a corridor, of which it is known which is left and which is right: their
    points need only be 90 degrees or more apart, all others must be `opposite`. Where the road
    passes itself, so that both nearest points lie on one side, the farther one is of another
    stretch, behind the wall that the nearer one is on: that of its own side is taken instead.
    """
    left, right = width_feet(points, directions, segments)
    if walls is None:
        return left, right, opposite(points, directions, left, right)
    own = left, right
    left = _nearer(points, left, nearest_feet(points, walls[0]))
    right = _nearer(points, right, nearest_feet(points, walls[1]))
    between = _apart(points, left, right, 0.0)
    rows = np.flatnonzero(~between)
    at, along = points[rows], directions[rows]
    halves = (width_feet(at, along, wall)[k] for k, wall in enumerate(walls))
    sides = [_nearer(at, side[rows], half) for side, half in zip(own, halves, strict=True)]
    farther = _gaps(at, left[rows]) > _gaps(at, right[rows])
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


def _nearer(points: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    return np.where((_gaps(points, first) < _gaps(points, second))[:, None], first, second)


def _gaps(points: FloatArray, feet: FloatArray) -> FloatArray:
    return np.asarray(np.hypot(*(feet - points).T))


def _feet(
    points: FloatArray,
    directions: FloatArray,
    segments: FloatArray,
    left: FloatArray,
    right: FloatArray,
) -> None:
    """Write the nearest points of some points, in place."""
    ax, ay = segments[:, 0] - points[:, :1], segments[:, 1] - points[:, 1:]  # (K, S)
    dx, dy = segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]  # (S,)
    tx, ty = directions[:, :1], directions[:, 1:]
    side, span = tx * ay - ty * ax, tx * dy - ty * dx  # of a; from a to b
    square = dx * dx + dy * dy
    foot = -(ax * dx + ay * dy) / np.where(square > 0.0, square, 1.0)
    crossing = np.divide(-side, span, out=np.zeros_like(span), where=span != 0.0)
    for sign, out in ((1.0, left), (-1.0, right)):
        starts, ends = sign * side >= 0.0, sign * (side + span) >= 0.0
        low, high = np.where(starts, 0.0, crossing), np.where(ends, 1.0, crossing)
        at = np.minimum(np.maximum(foot, low), high)
        x, y = ax + at * dx, ay + at * dy
        gap = np.where(starts | ends, x * x + y * y, np.inf)
        best = gap.argmin(axis=1)
        row = np.arange(len(points))
        found = np.isfinite(gap[row, best])
        nearest = points + np.stack([x[row, best], y[row, best]], axis=1)
        out[found] = nearest[found]


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
    """(K,) whether there is a width between the two: `physim.geometry.corridor.side_feet`"""

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
    path, length, along = _legs(path)
    leg = np.clip(np.searchsorted(along, stations, side="right") - 1, 0, len(length) - 1)
    direction = np.diff(path, axis=0) / length[:, None]
    tangent = direction[leg]
    point = path[leg] + (stations - along[leg])[:, None] * tangent
    *found, between = side_feet(point, tangent, segments, walls)
    feet = [np.where(np.isfinite(foot), foot, np.nan) for foot in found]
    gaps = [np.nan_to_num(np.hypot(*(foot - point).T), nan=np.inf) for foot in feet]
    return Widths(stations, point, gaps[0], gaps[1], feet[0], feet[1], between)


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
    along = _legs(path)[2]
    even = np.linspace(0.0, along[-1], places)
    widths = widths_at(path, np.unique(np.concatenate((even, along))), segments, walls)
    for _ in range(2):
        near = [widths.station[max(k - 1, 0) : k + 2] for k in _dips(widths.width)]
        closer = [np.linspace(part[0], part[-1], NEARER + 1)[1:-1] for part in near]
        if closer:
            more = widths_at(path, np.unique(np.concatenate(closer)), segments, walls)
            widths = _joined(widths, more)
    return widths


def _dips(width: FloatArray) -> list[int]:
    """Indices of the lowest local minima, DIPS at most; stretches that are even have none."""
    before, after = np.append(np.inf, width[:-1]), np.append(width[1:], np.inf)
    low = (width <= before) & (width <= after) & ((width < before) | (width < after))
    places = np.flatnonzero(low & np.isfinite(width))
    return [int(k) for k in places[np.argsort(width[places], kind="stable")][:DIPS]]


def _joined(one: Widths, other: Widths) -> Widths:
    """The places of both, by station."""
    pairs = [
        np.concatenate(pair) for pair in zip(vars(one).values(), vars(other).values(), strict=True)
    ]
    order = np.unique(pairs[0], return_index=True)[1]
    return Widths(*(column[order] for column in pairs))


def _legs(path: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Path without repeated points, the lengths of its legs, and the stations of its points."""
    steps = np.hypot(*np.diff(path, axis=0).T)
    path = path[np.concatenate(([True], steps > 0.0))]
    length = np.hypot(*np.diff(path, axis=0).T)
    return path, length, np.concatenate(([0.0], np.cumsum(length)))
