"""Pieces of a drawn path: joined where their ends meet, each path given to its robot."""

from __future__ import annotations

from collections.abc import Sequence
from math import dist

import numpy as np
from scipy.spatial import cKDTree

from physim.authoring.importing.drawing import Drawing, listed, place, rounded
from physim.authoring.importing.joining import NEARLY
from physim.geometry.shapes import FloatArray, IntArray


def take_paths(drawing: Drawing, named: Sequence[tuple[str, FloatArray]]) -> None:
    """Give a drawing its paths: names of their own and points, once all robots are known.

    A path with a robot's name is that robot's, the first of the others is the reference. Without
    that the first of the former is.
    """
    robots = {robot.name for robot in drawing.robots}
    pieces: dict[str, list[FloatArray]] = {}
    for name, points in named:
        pieces.setdefault(name, []).append(points)
    unused: list[tuple[FloatArray, str]] = []
    for name, lines in pieces.items():
        if name not in robots and drawing.reference is not None:
            unused += [(line, "belongs to no robot") for line in lines]
            continue
        path, left, changes = _join_pieces(lines)
        drawing.changes += listed(changes)
        unused += [(line, "its ends do not meet those of the first piece") for line in left]
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
        drawing.reference = next(iter(drawing.paths.values()))


def _join_pieces(pieces: list[FloatArray]) -> tuple[FloatArray, list[FloatArray], list[str]]:
    """A path drawn in pieces (n, 2) [m]: the first with those whose ends meet its own, in turn.

    In the direction of the first. Returns it, the pieces that are left, and what was done. Two
    ends meet where they are the same, or else nearer than a share of the extent of all pieces, as
    those of walls; not where there is a third.
    """
    ends = np.vstack([piece[[0, -1]] for piece in pieces])
    other = _met(ends, NEARLY * float(np.ptp(np.vstack(pieces), axis=0).max()))
    used, told = {0}, []
    joined = pieces[0]
    for at_end in (True, False):
        end = int(at_end)  # of the ends, that at which the path goes on
        while (met := int(other[end])) >= 0 and met // 2 not in used:
            used.add(met // 2)
            piece = pieces[met // 2]
            piece = piece[::-1] if (met % 2 == 1) == at_end else piece  # on in the same direction
            if gap := dist(ends[end], ends[met]):
                told.append(f"path ends {gap:.3f} m apart at {place(ends[end])} joined")
            joint = (ends[[end]] + ends[[met]]) / 2.0
            first, second = (joined, piece) if at_end else (piece, joined)
            joined = np.vstack([first[:-1], joint, second[1:]])
            end = met ^ 1
    if len(used) > 1:
        begin, final = place(joined[0]), place(joined[-1])
        told.insert(0, f"path of {len(used)} pieces joined: it goes from {begin} to {final}")
    left = [piece for k, piece in enumerate(pieces) if k not in used]
    return rounded(joined), left, told


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
