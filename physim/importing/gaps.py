"""Ends of drawn walls that nearly meet are joined; two walls beside each other get caps."""

from __future__ import annotations

import numpy as np
import shapely
from shapely.ops import polygonize, unary_union

from physim.geometry.shapes import FloatArray
from physim.importing.drawing import place

NEARLY = 0.01
"""[-] Ends nearer than this share of the drawing's extent are taken to meet."""


def join_ends(lines: list[FloatArray]) -> list[str]:
    """Close a drawing whose lines enclose nothing; says what was done. Changes ``lines``.

    Lines that enclose an area already are left as they are.
    """
    if not lines or list(polygonize(unary_union([shapely.LineString(line) for line in lines]))):
        return []
    corners = np.vstack(lines)
    near = NEARLY * float(np.ptp(corners, axis=0).max())
    told = _joined(lines, near)
    if list(polygonize(unary_union([shapely.LineString(line) for line in lines]))):
        return told
    if len(lines) != 2:
        return told
    first, second = lines
    straight = np.hypot(*(first[0] - second[0])) + np.hypot(*(first[-1] - second[-1]))
    crossed = np.hypot(*(first[0] - second[-1])) + np.hypot(*(first[-1] - second[0]))
    if crossed < straight:
        second = second[::-1]
    for a, b in ((first[0], second[0]), (first[-1], second[-1])):
        lines.append(np.array([a, b]))
        told.append(f"two open walls closed by a cap from {place(a)} to {place(b)}")
    return told


def _joined(lines: list[FloatArray], near: float) -> list[str]:
    """Bridge the gap from each loose end to the nearest other end within ``near`` [m]."""
    told = []
    ends = [
        (k, side) for k, line in enumerate(lines) if (line[0] != line[-1]).any() for side in (0, -1)
    ]
    used: set[tuple[int, int]] = set()
    pairs = sorted(
        (float(np.hypot(*(lines[a[0]][a[1]] - lines[b[0]][b[1]]))), a, b)
        for i, a in enumerate(ends)
        for b in ends[i + 1 :]
    )
    for gap, a, b in pairs:
        if gap > near:
            break
        if a in used or b in used:
            continue
        used |= {a, b}
        p, q = lines[a[0]][a[1]], lines[b[0]][b[1]]
        if gap > 0.0:
            lines.append(np.array([p, q]))
            told.append(f"wall ends {gap:.3f} m apart at {place(p)} joined")
    return told
