"""Width of a corridor along a path, with the nearest points on both sides (Fig. 4).

Stations and narrow places of a path; the nearest points are those of `physim.geometry.width`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray
from physim.geometry.width import side_feet

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
    """(K,) whether there is a width between the two: `physim.geometry.width.side_feet`"""

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
