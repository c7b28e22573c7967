"""Names beside robots, away from robots and from each other.

Each takes the place that covers least, is on no wall, and is nearer to its robot than to any other
or its target. It prefers to be near and to stay where it is, and glides to a new place.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from physim.drawing.labels import ANGLES, Label, around, covered, grown, overlaps, places
from physim.geometry.shapes import FloatArray, IntArray

GAPS = (2.0, 12.0, 28.0, 48.0)
"""[px] between a robot and its label"""
PRICES = (0.0, 0.3, 0.9, 1.6)
"""What these gaps cost; covering a whole label costs 10."""
TURN = 0.2
"""What it costs to stand below rather than above: a label that glides must not cross its robot."""
COVERED, ON_WALL, ASTRAY, OUTSIDE = 10.0, 2.0, 1.5, 12.0
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
        owners: IntArray,
        walls: FloatArray,
    ) -> list[FloatArray]:
        """Return the middles (2,) [px] of labels, which are named by any number.

        ``boxes`` (m, 4) are left, top, right, bottom of what should not be covered, ``owners``
        (m,) the numbers of the labels that they belong to (first the body, then its target), and
        ``walls`` (s, 2, 2) segments; ``area`` is the width and height of the view.
        """
        due = self._frame % EVERY == 0
        chosen = {key: label for key, label in labels.items() if due or key not in self._chosen}
        if chosen:
            stay = [
                around(label.at + self._wanted[key], label.size)
                for key, label in labels.items()
                if key not in chosen
            ]
            taken = np.array(stay).reshape(-1, 4)
            self._choose(chosen, np.concatenate((boxes, taken)), area, owners, walls)
        self._frame += 1
        middles = []
        for key, label in labels.items():
            before = self._offset.get(key, self._wanted[key])
            self._offset[key] = before + (self._wanted[key] - before) * GLIDE
            middles.append(self._offset[key] + label.at)
        return middles

    def _choose(
        self,
        labels: Mapping[int, Label],
        boxes: FloatArray,
        area: tuple[int, int],
        owners: IntArray,
        walls: FloatArray,
    ) -> None:
        """Choose the place of each label, one after the other: none covers one before it.

        ``boxes`` without an owner are of labels that stay where they are.
        """
        found = np.stack([places(label, GAPS, up=-1.0) for label in labels.values()])
        size = np.array([label.size for label in labels.values()])[:, None]
        room = np.concatenate((found - size / 2.0, found + size / 2.0), axis=2)
        air = grown(room, AIR)
        price = COVERED / np.prod(size + 2.0 * AIR, axis=2)
        lapped = overlaps(air.reshape(-1, 4), boxes).reshape(*room.shape[:2], -1)
        for k, (key, label) in enumerate(labels.items()):
            if label.shape is not None:  # its places clear its own body anyway
                lapped[k, :, np.flatnonzero(owners == key)[:1]] = 0.0
        keys = np.array(list(labels))
        cost = _costs(keys, room, boxes[: len(owners)], owners, walls, area)
        cost += price * lapped.sum(axis=2)
        for k, (key, label) in enumerate(labels.items()):
            if key in self._chosen:
                cost[k, self._chosen[key]] -= STAYS
            best = self._chosen[key] = int(np.argmin(cost[k]))
            self._wanted[key] = found[k, best] - label.at
            later = air[k + 1 :]
            taken = overlaps(later.reshape(-1, 4), room[k, best][None])
            cost[k + 1 :] += price[k + 1 :] * taken.reshape(later.shape[:2])


def _costs(
    keys: IntArray,
    room: FloatArray,
    boxes: FloatArray,
    owners: IntArray,
    walls: FloatArray,
    area: tuple[int, int],
) -> FloatArray:
    """Return what each place (k, n, 4) costs for itself: gap, direction, walls, other robots."""
    alone = np.add.outer(PRICES, TURN * (1.0 - np.sin(ANGLES)) / 2.0).ravel()
    on_wall = covered(room.reshape(-1, 4), walls) > 0.0
    cost = alone + ON_WALL * on_wall.reshape(room.shape[:2])
    low, high = room[..., :2], room[..., 2:]
    over = (np.maximum(-low, 0.0) + np.maximum(high - area, 0.0)).sum(axis=2)
    cost += OUTSIDE * (over > 0.0) + 0.01 * OUTSIDE * over
    wanted = np.repeat(GAPS, len(ANGLES)) + CLEARER
    for k in np.flatnonzero(keys >= 0).tolist():
        others = boxes[owners != keys[k]]
        if len(others):  # how near the nearest of them is
            x = np.maximum(others[:, 0] - high[k, :, :1], low[k, :, :1] - others[:, 2])
            y = np.maximum(others[:, 1] - high[k, :, 1:], low[k, :, 1:] - others[:, 3])
            x, y = np.maximum(x, 0.0), np.maximum(y, 0.0)
            distance = np.sqrt((x * x + y * y).min(axis=1))
            cost[k] += ASTRAY * np.clip(1.0 - distance / wanted, 0.0, 1.0)
    return np.asarray(cost)
