"""Names beside robots, away from robots and from each other.

Each takes the place that covers least, is on no wall, and is nearer to its robot than to any other
or its target. It prefers to be near and to stay where it is, and glides to a new place.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from physim.drawing.labels import ANGLES, Label, covered, grown, overlaps, places
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
        due = self._frame % EVERY == 0
        chosen = {key: label for key, label in labels.items() if due or key not in self._chosen}
        if chosen:
            stay = [self._box(key, labels[key]) for key in labels.keys() - chosen.keys()]
            self._choose(chosen, boxes, area, owners, walls, np.array(stay).reshape(-1, 4))
        self._frame += 1
        middles = []
        for key, label in labels.items():
            before = self._offset.get(key, self._wanted[key])
            self._offset[key] = before + (self._wanted[key] - before) * GLIDE
            middles.append(self._offset[key] + label.at)
        return middles

    def _box(self, key: int, label: Label) -> FloatArray:
        """Box (4,) of a label where it is going."""
        middle, half = label.at + self._wanted[key], np.array(label.size) / 2.0
        return np.concatenate((middle - half, middle + half))

    def _choose(
        self,
        labels: Mapping[int, Label],
        boxes: FloatArray,
        area: tuple[int, int],
        owners: IntArray,
        walls: FloatArray,
        stay: FloatArray,
    ) -> None:
        """Choose the place of each label, one after the other: none covers one before it.

        ``stay`` (l, 4) are boxes of labels that stay where they are.
        """
        keys = np.array(list(labels))
        found = np.stack([places(label, GAPS, up=-1.0) for label in labels.values()])
        size = np.array([label.size for label in labels.values()])[:, None]
        room = np.concatenate((found - size / 2.0, found + size / 2.0), axis=2)
        cost = _costs(keys, room, boxes, owners, walls, area)
        around_it = grown(room, AIR)
        price = COVERED / np.prod(size + 2.0 * AIR, axis=2)
        lapped = overlaps(around_it.reshape(-1, 4), boxes).reshape(*room.shape[:2], -1)
        for k, label in enumerate(labels.values()):
            if label.shape is not None:  # its places clear its own body anyway
                lapped[k, :, np.flatnonzero(owners == keys[k])[:1]] = 0.0
        cost += price * lapped.sum(axis=2)
        if len(stay):
            taken = overlaps(around_it.reshape(-1, 4), stay).sum(axis=1)
            cost += price * taken.reshape(room.shape[:2])
        for k, (key, label) in enumerate(labels.items()):
            if key in self._chosen:
                cost[k, self._chosen[key]] -= STAYS
            best = self._chosen[key] = int(np.argmin(cost[k]))
            self._wanted[key] = found[k, best] - label.at
            later = around_it[k + 1 :]
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
    over = np.maximum(-low, 0.0) + np.maximum(high - area, 0.0)
    outside = over[..., 0] + over[..., 1]
    cost += OUTSIDE * (outside > 0.0) + 0.01 * OUTSIDE * outside
    wanted = np.repeat(GAPS, len(ANGLES)) + CLEARER
    for k in np.flatnonzero(keys >= 0).tolist():
        others = boxes[owners != keys[k]]
        if len(others):
            distance = _nearest(low[k], high[k], others)
            cost[k] += ASTRAY * np.clip(1.0 - distance / wanted, 0.0, 1.0)
    return np.asarray(cost)


def _nearest(low: FloatArray, high: FloatArray, others: FloatArray) -> FloatArray:
    """Return the distance (n,) of boxes, ``low`` to ``high`` (n, 2), to the nearest of others."""
    x = np.maximum(others[:, 0] - high[:, :1], low[:, :1] - others[:, 2])
    y = np.maximum(others[:, 1] - high[:, 1:], low[:, 1:] - others[:, 3])
    x, y = np.maximum(x, 0.0), np.maximum(y, 0.0)
    return np.asarray(np.sqrt((x * x + y * y).min(axis=1)))
