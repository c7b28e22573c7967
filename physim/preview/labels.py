"""Labels on a map that never overlap: each takes the first free place round its anchor, or none."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.geometry.shapes import FloatArray

ANGLES = np.radians([90, 45, 135, 0, 180, 270, 315, 225, 67, 112, 22, 157, 247, 292, 202, 337])
"""Directions tried, the best first: above, then beside, then below."""
GAPS = (2.0, 7.0, 14.0, 24.0)
"""[pt] between what is labelled and its label"""


class Label(NamedTuple):
    """A text to place, all in points."""

    at: tuple[float, float]
    reach: float
    """radius to keep free round ``at``"""
    size: tuple[float, float]


def placed(labels: list[Label], taken: FloatArray, room: FloatArray) -> list[FloatArray | None]:
    """Middle (2,) of every label, or None for those that find no place; the first go first.

    ``taken`` (M, 4) are boxes left, bottom, right, top that no label may cover, and ``room`` (4,)
    the box that all must lie in. Labels do not cover each other.
    """
    middles: list[FloatArray | None] = []
    boxes = np.asarray(taken, dtype=np.float64).reshape(-1, 4)
    for label in labels:
        box = _first_free(label, boxes, room)
        if box is None:
            middles.append(None)
            continue
        middles.append((box[:2] + box[2:]) / 2.0)
        boxes = np.concatenate((boxes, box[None]))
    return middles


def _first_free(label: Label, taken: FloatArray, room: FloatArray) -> FloatArray | None:
    """Box of a label in its first free place."""
    half = np.array(label.size) / 2.0
    way = np.column_stack((np.cos(ANGLES), np.sin(ANGLES)))
    out = np.min(half / np.maximum(np.abs(way), 1e-9), axis=1) + label.reach
    middles = np.concatenate([label.at + way * (out + gap)[:, None] for gap in GAPS])
    places = np.concatenate((middles - half, middles + half), axis=1)
    inside = ((places[:, :2] >= room[:2]) & (places[:, 2:] <= room[2:])).all(axis=1)
    low, high = places[:, None, :2], places[:, None, 2:]
    lapped = ((low < taken[None, :, 2:]) & (high > taken[None, :, :2])).all(axis=2)
    free = np.flatnonzero(inside & ~lapped.any(axis=1))
    return places[free[0]] if free.size else None
