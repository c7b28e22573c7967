"""Names beside the robots, moved away from robots and from each other.

Each label takes the place that covers least, is on no wall, and is nearer to its robot than to any
other or its target. It prefers to be near and to stay where it is, and glides to a new place.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from physim.geometry.shapes import FloatArray, IntArray
from physim.labels import ANGLES, Label, around, covered, grown, overlaps, places

GAPS = (2.0, 12.0, 28.0, 48.0)
"""[px] between a robot and its label"""
PRICES = (0.0, 0.3, 0.9, 1.6)
"""What these gaps cost; covering a whole label costs 10."""
TURN = 0.2
"""What it costs to stand below rather than above: a label that glides must not cross its robot."""
COVERED, ON_WALL, ASTRAY, OUTSIDE = 10.0, 2.0, 1.5, 2.0
"""What it costs to cover a whole label, to cross a wall, to touch another robot than the own, and
to reach out of the view (a hundredth of it more for every px)."""
STAYS = 0.6
"""What a label saves where it stays in its direction."""
CLEARER = 8.0
"""[px] by which a label should be nearer to its own robot than to others"""
AIR = 2.0
"""[px] round a label that is counted as covered, too"""
GLIDE = 0.3
"""Share of the way that a label moves in a frame."""
EVERY = 6
"""Frames between two choices of places."""


class Labels:
    """Places labels frame by frame; it remembers where they were, and nothing else."""

    def __init__(self) -> None:
        self._chosen: dict[int, int] = {}
        self._wanted: dict[int, FloatArray] = {}
        self._offset: dict[int, FloatArray] = {}
        self._frame = 0

    def place(
        self,
        labels: Mapping[int, Label],
        boxes: FloatArray,
        area: tuple[int, int],
        owners: IntArray | None = None,
        walls: FloatArray | None = None,
    ) -> list[FloatArray]:
        """Return the middles (2,) [px] of labels, which are named by any number.

        ``boxes`` (m, 4) are left, top, right, bottom of what should not be covered, ``owners``
        (m,) the numbers of the labels that they belong to (first the body, then its target), and
        ``walls`` (s, 2, 2) segments; ``area`` is the width and height of the view.
        """
        owners = np.arange(len(boxes)) if owners is None else owners
        walls = np.zeros((0, 2, 2)) if walls is None else walls
        choose = self._frame % EVERY == 0 or not labels.keys() <= self._chosen.keys()
        self._frame += 1
        middles, taken = [], boxes
        for key, label in labels.items():
            if choose:
                found = places(label, GAPS, up=-1.0)
                room = around(found, label.size)
                cost = _cost(key, room, boxes, owners, walls, area)
                # where a shape is given, its places clear its own body anyway
                others = taken if label.shape is None else np.delete(taken, key, axis=0)
                lapped = overlaps(grown(room, AIR), others).sum(axis=1)
                cost += COVERED * lapped / np.prod(np.array(label.size) + 2.0 * AIR)
                if key in self._chosen:
                    cost[self._chosen[key]] -= STAYS
                best = self._chosen[key] = int(np.argmin(cost))
                self._wanted[key] = found[best] - label.at
                taken = np.concatenate((taken, room[best : best + 1]))
            before = self._offset.get(key, self._wanted[key])
            self._offset[key] = before + (self._wanted[key] - before) * GLIDE
            middles.append(self._offset[key] + label.at)
        return middles


def _cost(
    key: int,
    found: FloatArray,
    boxes: FloatArray,
    owners: IntArray,
    walls: FloatArray,
    area: tuple[int, int],
) -> FloatArray:
    """Return what each place (n, 4) costs for itself: gap, direction, walls, others nearby."""
    cost = np.add.outer(PRICES, TURN * (1.0 - np.sin(ANGLES)) / 2.0).ravel()
    cost += ON_WALL * (covered(found, walls) > 0.0)
    low, high = found[:, None, :2], found[:, None, 2:]
    outside = np.maximum(-low, 0.0) + np.maximum(high - area, 0.0)
    cost += OUTSIDE * (outside > 0.0).any(axis=(1, 2)) + 0.01 * OUTSIDE * outside.sum(axis=(1, 2))
    others = boxes[owners != key]
    if key >= 0 and len(others):
        apart = np.maximum(np.maximum(others[:, :2] - high, low - others[:, 2:]), 0.0)
        wanted = np.repeat(GAPS, len(ANGLES)) + CLEARER
        distance = np.hypot(apart[..., 0], apart[..., 1]).min(axis=1)
        cost += ASTRAY * np.clip(1.0 - distance / wanted, 0.0, 1.0)
    return np.asarray(cost)
