"""Lanes beside a reference path: as far beside it as there is room, drawn in where there is not.

A sideways line crosses itself in a tight bend; that loop is cut off. Where the path goes round
itself, as a lap does, so does the lane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from physim.authoring.importing.drawing import rounded
from physim.authoring.importing.lines import (
    CrossingError,
    Outline,
    crossings,
    directions_at,
    distances_to,
    is_closed,
    length_of,
    points_at,
    samples,
    stations,
    stretch,
    without_loops,
)
from physim.authoring.importing.way import Way
from physim.geometry.corridor import offset_polyline
from physim.geometry.shapes import FloatArray, IntArray

SLOPE = 0.2
"""[-] How fast a lane may draw in, across over along."""
MOST_SAMPLES, FEWEST_SAMPLES = 8_000, 200
"""Places along a path at which offsets are tried, of all lanes, and of one"""
OVERHANG = 4.0
"""[-] of its offset by which a lane goes on beyond the corner at most, where a lap begins: what it
does at one of 30 degrees"""
BEND = 8.0
"""[-] times the offset that the path goes on at most where a bend folds its lane"""
ABREAST = 0.7
"""[-] sine of the angle at which one leg crosses another, below which it goes beside it"""
SHARPEST = np.radians(150.0)
"""[rad] up to which a corner makes a lane within it shorter"""
LOST = 4.0
"""[m] at size 1 by which it is longer or shorter, beside what its bends make, and half of it by
which it is farther from a place of its path, if it leaves none out"""
CLEARLY = 0.6
"""[-] of the way to the middle between two legs of a hairpin that a lane in it goes"""
AFTER, BEFORE = 0.01, 0.1
"""[m] from where a lane of a lap meets itself, at size 1, to its beginning and its end"""
FRACTIONS = 41
"""Steps in which a lane's offset is tried, from nothing to all of it."""


@dataclass(frozen=True)
class Lane:
    """Path of a lane (n, 2) [m]; ``offset`` [m], left positive, where it holds throughout."""

    line: FloatArray
    offset: float
    is_plain: bool
    narrowest: float
    """[m] least offset along it on its own side; negative: that far over on the other"""

    @property
    def plain_offset(self) -> float | None:
        """Offset [m] by which a world can name it; None where its points are needed."""
        return self.offset if self.is_plain else None

    def narrowing(self) -> str:
        """Say how far it is drawn in; empty where it is not, to the centimetre."""
        if f"{self.narrowest:.2f}" == f"{abs(self.offset):.2f}":
            return ""
        where = "where the corridor is narrow, bends tightly or comes back beside itself"
        if self.narrowest < 0.0:
            return f"is drawn over to {-self.narrowest:.2f} m on its other side {where}"
        return f"is drawn in to {self.narrowest:.2f} m {where}"


def lane(
    reference: FloatArray,
    offset: float,
    outline: Outline,
    room: float,
    size: float,
    lanes: int,
    is_ring: bool = False,
) -> Lane:
    """Lane ``offset`` [m] beside the reference path with clearance ``room`` [m] where there is.

    Where there is not, it is drawn in towards the reference path, and, where that has not the room
    either, over to its other side. It is one of so many ``lanes``, which share the work; of a lap
    that robots begin anywhere on it goes round the joint as round any corner (``is_ring``).
    """
    if offset == 0.0:
        return Lane(reference, 0.0, True, 0.0)
    plain = _plain(reference, offset, outline, room, is_ring)
    if plain is not None:
        return Lane(plain, offset, True, abs(offset))
    length = length_of(reference)
    at = samples(length, max(0.5 * size, length / max(MOST_SAMPLES // lanes, FEWEST_SAMPLES)))
    base = points_at(reference, at)
    is_lap = is_closed(reference)
    direction = directions_at(reference, at, 2.0 * abs(offset))
    normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    courses = np.unwrap(np.arctan2(direction[:, 1], direction[:, 0]))
    share = _shares(base, offset * normal, outline, room)
    share = _on_its_leg(share, base, offset * normal, reference)
    share = _gentle(share, at, SLOPE / abs(offset), is_lap)
    line = base + (share * offset)[:, None] * normal
    if is_lap:
        line[-1] = line[0]  # but for rounding
    try:
        line = without_loops(line, float("inf"), courses)[0]
    except CrossingError:  # too many loops: no lane of its own
        return Lane(reference, offset, False, 0.0)
    line = _lap(line, abs(offset), size)
    simple = shapely.simplify(shapely.LineString(line), 0.02 * size)
    return Lane(
        rounded(shapely.get_coordinates(simple)), offset, False, abs(offset) * float(share.min())
    )


def leaves_out(reference: FloatArray, line: FloatArray, size: float) -> bool:
    """Whether a lane leaves out a part of its path: is far from some of it, or far shorter.

    Than one beside it may be: within bends it is shorter, and farther from their corners.
    """
    whole = np.vstack([reference, reference[1:2]]) if is_closed(reference) else reference
    ahead = np.arctan2(*np.diff(whole, axis=0).T[::-1])
    turns = np.abs((np.diff(ahead) + np.pi) % (2.0 * np.pi) - np.pi)
    half = 0.5 * np.minimum(turns, SHARPEST)
    beside, length = float(distances_to(reference, line).max()), length_of(reference)
    if abs(length - length_of(line)) > beside * float(2.0 * np.tan(half).sum()) + LOST * size:
        return True
    at = samples(length, max(0.5 * size, length / MOST_SAMPLES))
    allowed = np.full(len(at), beside)
    for corner, turn in zip(stations(whole)[1:-1], half, strict=True):
        for place in (corner, corner - length) if is_closed(reference) else (corner,):
            reach = beside * np.tan(turn) + size
            near = slice(*np.searchsorted(at, [place - reach, place + reach]))
            allowed[near] = np.maximum(allowed[near], beside / np.cos(turn))
    far = distances_to(line, points_at(reference, at))
    return bool((far > allowed + 0.5 * LOST * size).any())


def _lap(line: FloatArray, offset: float, size: float) -> FloatArray:
    """A lane (n, 2) of a lap, from where its end crosses its beginning to just before that.

    As it does ``offset`` [m] within a corner at which the lap begins; no place of it is two then.
    """
    whole = stations(line)
    for i, j, point in crossings(line):
        first, last = (whole[k] + float(np.hypot(*(point - line[k]))) for k in (i, j))
        if max(first, whole[-1] - last) < OVERHANG * offset:
            return stretch(line, first + AFTER * size, last - BEFORE * size)
    return line


def _shares(base: FloatArray, across: FloatArray, outline: Outline, room: float) -> FloatArray:
    """(k,) [-] share of ``across`` (k, 2) [m] at which each of the points ``base`` has the room.

    The largest that the reference path reaches without coming nearer to a wall than it is itself;
    negative where only its other side has room. Where neither has, the share with the most.
    """
    share, best = _outward(base, across, outline, room)
    tight = np.flatnonzero(best < room)
    if tight.size:
        back = -across[tight] * (room / np.hypot(*across[tight].T))[:, None]
        other, gained = _outward(base[tight], back, outline, room, farthest=False)
        wider = gained > best[tight]
        moved = -other * room / np.hypot(*across[tight].T)
        share[tight] = np.where(wider, moved, share[tight])
    return share


def _on_its_leg(
    share: FloatArray, base: FloatArray, across: FloatArray, path: FloatArray
) -> FloatArray:
    """Shares at which a lane stays beside its own leg of the path, where another goes beside it.

    As in a hairpin whose legs are nearer to each other than twice the offset: a run would take
    robots for being on the other leg, and the lane would lose the hairpin. Where a path crosses
    itself the lanes go straight on.
    """
    at, offset = stations(base), float(np.hypot(*across[0]))
    way, length = Way(path), length_of(path)
    directions, drawn = directions_at(path, at, offset), share.copy()

    def is_beside_another(some: IntArray, fraction: float) -> NDArray[np.bool_]:
        points = base[some] + fraction * share[some, None] * across[some]
        found = way.nearest(points)
        away = np.abs(found - at[some])
        away = np.minimum(away, length - away) if is_closed(path) else away
        there, here = directions_at(path, found, offset), directions[some]
        turned = np.abs(there[:, 0] * here[:, 1] - there[:, 1] * here[:, 0])
        return np.asarray((away > 0.5 * BEND * offset) & (turned < ABREAST))

    beside = doubted = np.flatnonzero(is_beside_another(np.arange(len(base)), 1.0))
    for fraction in np.linspace(1.0, 0.0, FRACTIONS)[1:]:
        drawn[doubted] = CLEARLY * fraction * share[doubted]
        doubted = doubted[is_beside_another(doubted, float(fraction))]
    for a, b in zip(beside[:-1], beside[1:], strict=True):  # and round the end of the hairpin
        if b - a > 1 and at[b] - at[a] <= 1.5 * BEND * offset:
            drawn[a : b + 1] = np.interp(at[a : b + 1], at[[a, b]], drawn[[a, b]])
    return drawn


def _outward(
    base: FloatArray, across: FloatArray, outline: Outline, room: float, farthest: bool = True
) -> tuple[FloatArray, FloatArray]:
    """Share of ``across`` and the clearance there [m], capped at ``room``.

    The farthest share with the room, or the first.
    """
    share = np.zeros(len(base))
    best = np.minimum(outline.clearances(base), room)
    reached, need = share.copy(), best.copy()
    for fraction in np.linspace(0.0, 1.0, FRACTIONS)[1:]:
        gap = np.minimum(outline.clearances(base + fraction * across), room)
        held = (reached >= fraction - 1.5 / FRACTIONS) & (gap >= need)
        reached = np.where(held, fraction, reached)
        better = held & ((gap > best) | (farthest & (gap >= room)))
        share, best = np.where(better, fraction, share), np.where(better, gap, best)
    return share, best


def _plain(
    reference: FloatArray, offset: float, outline: Outline, room: float, is_ring: bool
) -> FloatArray | None:
    """The mitred offset line, where it neither folds nor comes too near a wall; None otherwise."""
    more = [reference[-2:-1], reference, reference[1:2]] if is_ring else [reference]
    whole = np.vstack(more)
    try:
        line = offset_polyline(whole, np.full(len(whole), offset))
    except ValueError:
        return None
    if is_ring:
        line = np.vstack([line[1:-2], line[1]])  # closed, but for rounding
    along = (np.diff(line, axis=0) * np.diff(reference, axis=0)).sum(axis=1)
    if (along <= 0.0).any() or not shapely.LineString(line).is_simple:
        return None
    at = samples(length_of(line), 0.25 * room)
    return line if (outline.clearances(points_at(line, at)) >= room - 1e-6).all() else None


def _gentle(share: FloatArray, at: FloatArray, slope: float, is_lap: bool) -> FloatArray:
    """Largest function below ``share`` that changes by at most ``slope`` [1/m], also on from the
    end of a lap to its beginning."""
    low = share.copy()
    for _ in range(2 if is_lap else 1):
        if is_lap:
            low[0] = low[-1] = min(low[0], low[-1])
        for k in range(1, len(low)):
            low[k] = min(low[k], low[k - 1] + slope * (at[k] - at[k - 1]))
        for k in range(len(low) - 2, -1, -1):
            low[k] = min(low[k], low[k + 1] + slope * (at[k + 1] - at[k]))
    return low
