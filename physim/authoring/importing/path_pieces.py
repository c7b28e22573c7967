"""Pieces of a drawn path: joined where their ends meet, each path given to its robot."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, degrees, dist

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from physim.authoring.importing.drawing import Drawing, listed, place, rounded
from physim.authoring.importing.joining import NEARLY
from physim.errors import nearest
from physim.geometry.shapes import FloatArray, IntArray

MOST_TURN = 149.0
"""[deg] by which a path may turn where lanes beside it are to be"""

CLOSED = 0.01
"""[m] A path whose ends are nearer than this is closed: they were rounded, or drawn so by hand."""
FORK = "it meets others where they fork or turn back"
APART = "its ends do not meet those of the first piece"


def take_paths(drawing: Drawing, named: Sequence[tuple[str, FloatArray]]) -> None:
    """Give a drawing its paths: names of their own and points, once all robots are known.

    A path with a robot's name is that robot's. Of the others that without a name is the reference,
    else the first; without these the first of the former is.
    """
    robots = {robot.name for robot in drawing.robots}
    pieces: dict[str, list[FloatArray]] = {}
    for name, points in named:
        pieces.setdefault(name, []).append(points)
    unused: list[tuple[FloatArray, str]] = []  # and why
    for name, lines in sorted(pieces.items(), key=lambda one: one[0] != ""):
        if name not in robots and drawing.reference is not None:
            close = nearest(name[:80], sorted(robots))
            unused += [(line, f'there is no robot "{name}"{close}') for line in lines]
            continue
        path, left, changes = _join_pieces(lines)
        drawing.changes += listed(changes)
        unused += left
        if name in robots:
            drawing.paths[name] = path
        else:
            drawing.reference = path
    drawing.changes += listed(
        [
            f"path from {place(line[0])} to {place(line[-1])}: {why}, left out"
            for line, why in unused
        ]
    )
    if drawing.reference is None and drawing.paths:
        drawing.reference = _most_behind(drawing)
    drawing.are_paths_named = "" not in pieces


def _most_behind(drawing: Drawing) -> FloatArray:
    """Of the robots' paths that before whose beginning the fewest of them stand; or the longest.

    In a queue that is the path of the last: on the others a formation could not measure it.
    """
    centres = shapely.centroid([shapely.Polygon(one.outline) for one in drawing.robots])
    half = max(float(np.ptp(one.outline, axis=0).max()) for one in drawing.robots) / 2.0

    def rank(points: FloatArray) -> tuple[int, float]:
        line = shapely.LineString(points)
        before = shapely.line_locate_point(line, centres) <= 0.0
        is_at_it = shapely.distance(shapely.Point(points[0]), centres) <= half
        return int((before & ~is_at_it).sum()), -line.length

    return min(drawing.paths.values(), key=rank)


def _join_pieces(
    pieces: list[FloatArray],
) -> tuple[FloatArray, list[tuple[FloatArray, str]], list[str]]:
    """A path drawn in pieces (n, 2) [m]: the first with those whose ends meet its own, in turn.

    In the direction of the first. Returns it, the pieces that are left, each with why, and what was
    done. Two ends meet where they are the same, or else nearer than a share of the extent of all
    pieces, as those of walls; not where there is a third, and not where the path would turn back.
    """
    pieces, twice = _each_once(pieces)
    ends = np.vstack([piece[[0, -1]] for piece in pieces])
    near = NEARLY * float(np.ptp(np.vstack(pieces), axis=0).max())
    other = _met(ends, near)
    used, told = {0}, []
    joined = pieces[0]
    for at_end in (True, False):
        end = int(at_end)  # of the ends, that at which the path goes on
        while (met := int(other[end])) >= 0 and met // 2 not in used:
            piece = pieces[met // 2]
            piece = piece[::-1] if (met % 2 == 1) == at_end else piece  # on in the same direction
            first, second = (joined, piece) if at_end else (piece, joined)
            if _turn(first, second) > MOST_TURN:
                break
            used.add(met // 2)
            gap, joint = dist(ends[end], ends[met]), (ends[[end]] + ends[[met]]) / 2.0
            if gap:
                told.append(f"path ends {gap:.3f} m apart at {place(ends[end])} joined")
                first, second = _cut(first[::-1], joint, gap)[::-1], _cut(second, joint, gap)
            joined = np.vstack([first[:-1], joint, second[1:]])
            end = met ^ 1
    gap = dist(joined[0], joined[-1])
    if 0.0 < gap < CLOSED:
        told.append(f"path ends {gap:.3f} m apart at {place(joined[0])} joined: it is closed")
        joined = np.vstack([joined[:-1], joined[:1]])
    if len(used) > 1:
        begin, final = place(joined[0]), place(joined[-1])
        told.insert(0, f"path of {len(used)} pieces joined: it goes from {begin} to {final}")
    is_fork = _meets_others(ends, near)
    left = [
        (piece, FORK if is_fork[[2 * k, 2 * k + 1]].any() else APART)
        for k, piece in enumerate(pieces)
        if k not in used
    ]
    return rounded(joined), twice + left, told


def _each_once(
    pieces: list[FloatArray],
) -> tuple[list[FloatArray], list[tuple[FloatArray, str]]]:
    """Pieces without those that lie on an earlier one, in either direction, and these."""
    known: set[bytes] = set()
    once, twice = [], []
    for piece in pieces:
        if piece.tobytes() in known:
            twice.append((piece, "drawn twice"))
            continue
        known |= {piece.tobytes(), piece[::-1].tobytes()}
        once.append(piece)
    return once, twice


def _cut(piece: FloatArray, joint: FloatArray, gap: float) -> FloatArray:
    """A piece (n, 2) without the points after its first that a joint lies as near to as the gap.

    Where two pieces lie over one another they would go to and fro; the last point stays.
    """
    is_far = np.hypot(*(piece - joint).T) > gap
    k = int(np.argmax(is_far[1:-1])) + 1 if is_far[1:-1].any() else len(piece) - 1
    return np.vstack([piece[:1], piece[k:]])


def _turn(first: FloatArray, second: FloatArray) -> float:
    """[deg] by which a path turns from the end of one piece to the beginning of another."""
    (ax, ay), (bx, by) = first[-1] - first[-2], second[1] - second[0]
    return abs(degrees(atan2(ax * by - ay * bx, ax * bx + ay * by)))


def _meets_others(ends: FloatArray, near: float) -> NDArray[np.bool_]:
    """(n,) whether one of another piece is within ``near`` [m] of each end (n, 2) [m]."""
    away, found = cKDTree(ends).query(ends, k=min(4, len(ends)))
    own = np.arange(len(ends))[:, None]
    return np.asarray(((away <= near) & (found != own) & (found != own ^ 1)).any(axis=1))


def _met(ends: FloatArray, near: float) -> IntArray:
    """(n,) for each of the ends (n, 2) [m] of pieces, two a piece, the one it meets; else -1."""
    other = np.full(len(ends), -1)
    for reach in (0.0, near):
        free = np.flatnonzero(other < 0)
        if len(free) < 2:
            break
        away, found = cKDTree(ends[free]).query(ends[free], k=min(4, len(free)))
        is_other = (away <= reach) & (found != np.arange(len(free))[:, None])
        is_other &= (free[found] ^ 1) != free[:, None]  # the other end of its own piece
        alone = is_other.sum(axis=1) == 1
        partner = np.where(alone, found[np.arange(len(free)), is_other.argmax(axis=1)], -1)
        mutual = alone & (partner[partner] == np.arange(len(free)))
        other[free[mutual]] = free[partner[mutual]]
    return other
