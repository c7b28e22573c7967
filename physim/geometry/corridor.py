"""Boundaries of a corridor given by its centreline and width."""

from __future__ import annotations

import numpy as np

from physim.geometry.shapes import FloatArray

SIDES = ("left wall", "right wall")
"""Boundaries of a corridor; the caps that close its ends lie on neither side of a path."""

SHARPEST_TURN = 2.6
"""[rad] Beyond this (150 degrees) a mitred corner would reach four half-widths out."""


def offset_polyline(points: FloatArray, offset: FloatArray, first: int = 0) -> FloatArray:
    """Move a polyline (n, 2) sideways by ``offset`` (n,) [m], left positive, corners mitred.

    Raises ValueError where the polyline turns back on itself, naming the waypoint as a world file
    counts it: from 0, or from ``first``.
    """
    direction = np.diff(points, axis=0)
    direction /= np.hypot(*direction.T)[:, None]
    normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    before = np.vstack([normal[:1], normal])
    after = np.vstack([normal, normal[-1:]])
    cosine = np.clip((before * after).sum(axis=1), -1.0, 1.0)
    sharp = np.flatnonzero(np.arccos(cosine) > SHARPEST_TURN)
    if sharp.size:
        x, y = points[sharp[0]]
        turn = np.degrees(np.arccos(cosine[sharp[0]]))
        raise ValueError(
            f"turns by {turn:.0f} degrees at waypoint [{sharp[0] + first}] ({x:g}, {y:g}); "
            f"at most {np.degrees(SHARPEST_TURN):.0f} degrees can be offset sideways"
        )
    mitre = (before + after) / (1.0 + cosine)[:, None]
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
