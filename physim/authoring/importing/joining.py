"""Ends of drawn lines: joined where they nearly meet, and named where nothing is enclosed."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import dist
from typing import Any

import numpy as np
import shapely
from scipy.spatial import cKDTree

from physim.authoring.importing.drawing import Drawing, listed, place, rounded
from physim.geometry.shapes import FloatArray, IntArray

MOST_ENDS = 600
"""Ends of open lines that are compared with each other."""
NEARLY = 0.01
"""[-] Ends nearer than this share of the drawing's extent are taken to meet."""


def faces_of(lines: list[FloatArray]) -> list[Any]:
    """Shapely polygons of all areas that lines enclose."""
    return faces_and_loose(lines)[0]


def faces_and_loose(lines: list[FloatArray]) -> tuple[list[Any], list[Any]]:
    """Shapely polygons of all areas that lines enclose, and the lines that enclose nothing."""
    united = shapely.union_all([shapely.LineString(line) for line in lines])
    faces, cuts, dangles, _ = shapely.polygonize_full([united])
    loose = [*shapely.get_parts(cuts), *shapely.get_parts(dangles)]
    return list(shapely.get_parts(faces)), loose


def loose_ends(lines: list[FloatArray]) -> tuple[list[FloatArray], list[tuple[float, int, int]]]:
    """Both ends (2,) [m] of every line that is not closed, and how far any two are apart [m].

    The nearest two come first.
    """
    ends = [line[k] for line in lines if (line[0] != line[-1]).any() for k in (0, -1)]
    if len(ends) > MOST_ENDS:
        return ends, []
    gaps = [(float(np.hypot(*(ends[i] - ends[j]))), i, j)
            for i, j in combinations(range(len(ends)), 2)]  # fmt: skip
    return ends, sorted(gaps)


def join_ends(lines: list[FloatArray]) -> list[str]:
    """Close walls that enclose nothing; says what was done. Changes ``lines``.

    Open lines that enclose an area already are left as they are, and so are those in or at a closed
    one: they may leave a passage.
    """
    closed = [line for line in lines if (line[0] == line[-1]).all()]
    within = shapely.union_all([shapely.Polygon(face.exterior) for face in faces_of(closed)])
    walls = [line for line in lines if (line[0] != line[-1]).any() and _is_outside(line, within)]
    if not walls or faces_of(walls):
        return []
    near = NEARLY * float(np.ptp(np.vstack(lines), axis=0).max())
    joints, changes = _bridged(walls, near)
    if len(walls) == 2 and not joints:
        joints, changes = _caps(*walls)
    lines += joints
    return changes


def _is_outside(line: FloatArray, area: Any) -> bool:
    return not shapely.LineString(line).intersects(area)


def _caps(first: FloatArray, second: FloatArray) -> tuple[list[FloatArray], list[str]]:
    """Caps that close two open walls at their ends, and what is said of them."""
    straight = np.hypot(*(first[0] - second[0])) + np.hypot(*(first[-1] - second[-1]))
    crossed = np.hypot(*(first[0] - second[-1])) + np.hypot(*(first[-1] - second[0]))
    if crossed < straight:
        second = second[::-1]
    caps = ((first[0], second[0]), (first[-1], second[-1]))
    if any((a == b).all() for a, b in caps):
        return [], []  # one wall in two pieces, and a gap
    return [np.array(cap) for cap in caps], [
        f"two open walls closed by a cap from {place(a)} to {place(b)}" for a, b in caps
    ]


def _bridged(lines: list[FloatArray], near: float) -> tuple[list[FloatArray], list[str]]:
    """Bridges over the gap from each loose end to the nearest other end within ``near`` [m].

    And what is said of them; ends that meet need none.
    """
    bridges, changes = [], []
    ends, gaps = loose_ends(lines)
    used: set[int] = set()
    for gap, i, j in gaps:
        if gap > near or used & {i, j}:
            continue
        used |= {i, j}
        if gap > 0.0:
            bridges.append(np.array([ends[i], ends[j]]))
            changes.append(f"wall ends {gap:.3f} m apart at {place(ends[i])} joined")
    return bridges, changes


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


def open_ends(drawing: Drawing) -> tuple[str, FloatArray]:
    """Say where lines that enclose nothing are open, and a point (2,) [m] of the one to mend.

    That is at the nearest two ends that touch no line; where an end lies nearer to the course of
    another line, that is said instead.
    """
    boundaries, somewhere = drawing.boundaries, drawing.boundaries[0][0]
    if len(boundaries) > MOST_ENDS // 2:
        return "draw them closed", somewhere
    shapes = [shapely.LineString(line) for line in boundaries]
    ends = [
        (k, shapely.Point(end))
        for k, line in enumerate(boundaries)
        if (line[0] != line[-1]).any()
        for end in line[[0, -1]]
    ]
    others = {k: shapely.union_all(shapes[:k] + shapes[k + 1 :]) for k, _ in ends}
    loose = [(k, end) for k, end in ends if others[k].is_empty or end.distance(others[k]) > 0.0]
    pairs = [(a.distance(b), a, b) for (_, a), (_, b) in combinations(loose, 2)]
    if not pairs:
        return "draw them closed", somewhere
    gap, a, b = min(pairs, key=lambda pair: pair[0])
    walls = [(end.distance(others[k]), end, others[k]) for k, end in loose if others[k]]
    near, end, wall = min(walls, key=lambda one: one[0], default=(gap, a, b))
    if near < gap:
        at = shapely.get_coordinates(shapely.shortest_line(end, wall))[1]
        which = drawing.named(at, "boundary")
        said = f"the end at {place(_xy(end))} stops {near:.3g} m short of the line at {place(at)}"
        return said + which, _xy(end)
    which = drawing.named(_xy(b), "boundary")
    said = f"the nearest ends, {place(_xy(a))} and {place(_xy(b))}{which}, are {gap:.3g} m apart"
    return said, _xy(a)


def _xy(point: Any) -> FloatArray:
    return np.array([point.x, point.y])
