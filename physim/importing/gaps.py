"""Ends of drawn walls that nearly meet are joined; two walls beside each other get caps."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.importing.drawing import place

NEARLY = 0.01
"""[-] Ends nearer than this share of the drawing's extent are taken to meet."""


def faces_of(lines: list[FloatArray]) -> list[Any]:
    """Shapely polygons of all areas that lines enclose."""
    united = shapely.union_all([shapely.LineString(line) for line in lines])
    return list(shapely.get_parts(shapely.polygonize([united])))


def loose_ends(lines: list[FloatArray]) -> tuple[list[FloatArray], list[tuple[float, int, int]]]:
    """Both ends (2,) [m] of every line that is not closed, and how far any two are apart [m].

    The nearest two come first.
    """
    ends = [line[k] for line in lines if (line[0] != line[-1]).any() for k in (0, -1)]
    gaps = [(float(np.hypot(*(ends[i] - ends[j]))), i, j)
            for i, j in combinations(range(len(ends)), 2)]  # fmt: skip
    return ends, sorted(gaps)


def join_ends(lines: list[FloatArray]) -> list[str]:
    """Close a drawing whose lines enclose nothing; says what was done. Changes ``lines``.

    Lines that enclose an area already are left as they are.
    """
    if not lines or faces_of(lines):
        return []
    changes = _bridged(lines, NEARLY * float(np.ptp(np.vstack(lines), axis=0).max()))
    if len(lines) != 2 or faces_of(lines):
        return changes
    first, second = lines
    straight = np.hypot(*(first[0] - second[0])) + np.hypot(*(first[-1] - second[-1]))
    crossed = np.hypot(*(first[0] - second[-1])) + np.hypot(*(first[-1] - second[0]))
    if crossed < straight:
        second = second[::-1]
    for a, b in ((first[0], second[0]), (first[-1], second[-1])):
        lines.append(np.array([a, b]))
        changes.append(f"two open walls closed by a cap from {place(a)} to {place(b)}")
    return changes


def _bridged(lines: list[FloatArray], near: float) -> list[str]:
    """Bridge the gap from each loose end to the nearest other end within ``near`` [m]."""
    changes = []
    ends, gaps = loose_ends(lines)
    used: set[int] = set()
    for gap, i, j in gaps:
        if gap > near or used & {i, j}:
            continue
        used |= {i, j}
        if gap > 0.0:
            lines.append(np.array([ends[i], ends[j]]))
            changes.append(f"wall ends {gap:.3f} m apart at {place(ends[i])} joined")
    return changes
