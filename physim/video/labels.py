"""Names beside the robots, moved away from robots and from each other.

Each label may stand in twelve directions from its robot, touching it or farther off; it takes the
place that covers least, is on no wall, and is nearer to its robot than to any other or its target.
It prefers to be near and to stay where it is, and glides to a new place.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.geometry.shapes import FloatArray, IntArray

ANGLES = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
GAPS = (2.0, 12.0, 28.0, 48.0)
"""[px] between a robot and its label"""
PRICES = (0.0, 0.3, 0.9, 1.6)
"""What these gaps cost; covering a whole label costs 10."""
CLEARER = 8.0
"""[px] by which a label should be nearer to its own robot than to others"""
GLIDE = 0.3
"""Share of the way that a label moves in a frame."""
EVERY = 6
"""Frames between two choices of places."""


class Tag(NamedTuple):
    """A label to place: what it belongs to, and its size, all [px]."""

    key: int
    at: tuple[float, float]
    reach: float
    size: tuple[float, float]
    shape: FloatArray | None = None
    """(n, 2) outline round ``at``; a disc of radius ``reach`` where it is not given"""


class Labels:
    """Places labels frame by frame; it remembers where they were, and nothing else."""

    def __init__(self) -> None:
        self._chosen: dict[int, int] = {}
        self._wanted: dict[int, FloatArray] = {}
        self._offset: dict[int, FloatArray] = {}
        self._frame = 0

    def place(
        self,
        tags: list[Tag],
        boxes: FloatArray,
        area: tuple[int, int],
        owners: IntArray | None = None,
        walls: FloatArray | None = None,
    ) -> FloatArray:
        """Return the middles (n, 2) [px] of labels.

        ``boxes`` (m, 4) are left, top, right, bottom of what should not be covered, ``owners``
        (m,) the keys of the labels that they belong to (first the body, then its target), and
        ``walls`` (s, 2, 2) segments; ``area`` is the width and height of the view.
        """
        owners = np.arange(len(boxes)) if owners is None else owners
        walls = np.zeros((0, 2, 2)) if walls is None else walls
        choose = self._frame % EVERY == 0 or any(tag.key not in self._chosen for tag in tags)
        self._frame += 1
        middles = np.zeros((len(tags), 2))
        taken = boxes
        for row, tag in enumerate(tags):
            if choose:
                places = _places(tag)
                cost = _price(tag, places, boxes, owners, walls)
                self._chosen[tag.key] = self._best(tag, places, cost, taken, area)
                self._wanted[tag.key] = places[self._chosen[tag.key]]
            offset = self._wanted[tag.key]
            before = self._offset.get(tag.key, offset)
            offset = before + (offset - before) * GLIDE
            self._offset[tag.key] = offset
            middles[row] = offset + tag.at
            if choose:
                taken = np.concatenate((taken, [_box(self._wanted[tag.key], tag)]))
        return middles

    def _best(
        self,
        tag: Tag,
        places: FloatArray,
        cost: FloatArray,
        taken: FloatArray,
        area: tuple[int, int],
    ) -> int:
        half = np.array(tag.size) / 2.0
        middle = places + tag.at
        low, high = middle - half, middle + half
        room = half[None] * 2.0 + 4.0
        if tag.shape is not None:
            taken = np.delete(taken, tag.key, axis=0)  # its places clear its own body anyway
        near = (np.abs((taken[:, :2] + taken[:, 2:]) / 2.0 - tag.at) < 300.0).all(axis=1)
        taken = taken[near]
        lapped = np.minimum(high[:, None] + 2.0, taken[None, :, 2:])
        lapped = lapped - np.maximum(low[:, None] - 2.0, taken[None, :, :2])
        covered = np.prod(np.maximum(lapped, 0.0), axis=2).sum(axis=1) / np.prod(room)
        outside = np.maximum(-low, 0.0) + np.maximum(high - area, 0.0)
        cost = cost + 10.0 * covered
        cost = cost + 2.0 * (outside > 0.0).any(axis=1) + 0.02 * outside.sum(axis=1)
        if tag.key in self._chosen:
            cost[self._chosen[tag.key]] -= 0.6
        return int(np.argmin(cost))


def _price(
    tag: Tag, places: FloatArray, boxes: FloatArray, owners: IntArray, walls: FloatArray
) -> FloatArray:
    """Return what each place (n, 2) costs for itself: gap, direction, walls, others nearby."""
    cost = np.repeat(PRICES, len(ANGLES)) - 0.1 * np.sin(np.tile(ANGLES, len(GAPS)))
    half = np.array(tag.size) / 2.0
    low, high = places + tag.at - half, places + tag.at + half
    cost = cost + 2.0 * _crossed(low, high, walls)
    others = boxes[owners != tag.key]
    if tag.key < 0 or not len(others):
        return cost
    apart = np.maximum(others[None, :, :2] - high[:, None], low[:, None] - others[None, :, 2:])
    distance = np.hypot(*np.maximum(apart, 0.0).transpose(2, 0, 1)).min(axis=1)
    wanted = np.repeat(GAPS, len(ANGLES)) + CLEARER
    price: FloatArray = cost + 1.5 * np.clip(1.0 - distance / wanted, 0.0, 1.0)
    return price


def _crossed(low: FloatArray, high: FloatArray, walls: FloatArray) -> FloatArray:
    """Return 1 for each box (n, 2) low to high that a segment (s, 2, 2) enters, else 0."""
    least, most = low.min(axis=0), high.max(axis=0)
    seen = (walls.max(axis=1) >= least) & (walls.min(axis=1) <= most)
    start, end = walls[seen.all(axis=1)].transpose(1, 0, 2)
    way = end - start
    way = np.where(np.abs(way) < 1e-9, 1e-9, way)
    at = (low[:, None] - start) / way, (high[:, None] - start) / way
    enter = np.minimum(*at).max(axis=2)
    leave = np.maximum(*at).min(axis=2)
    inside = np.maximum(enter, 0.0) <= np.minimum(leave, 1.0)
    crossed: FloatArray = inside.any(axis=1).astype(np.float64)
    return crossed


def _places(tag: Tag) -> FloatArray:
    """Return the offsets (48, 2) at which the label clears its robot by each gap."""
    direction = np.column_stack((np.cos(ANGLES), -np.sin(ANGLES)))
    half = np.array(tag.size) / 2.0
    if tag.shape is None:
        way = tag.reach + np.min(half / np.maximum(np.abs(direction), 1e-9), axis=1)
    else:
        way = way_out(direction, tag.shape, half)
    return np.concatenate([direction * (way + gap)[:, None] for gap in GAPS])


def way_out(direction: FloatArray, shape: FloatArray, half: FloatArray) -> FloatArray:
    """Return how far a box of half sizes (2,) must go in directions (d, 2) to clear a shape.

    Exact for a convex ``shape`` (n, 2) round the origin; of others the hull is cleared.
    """
    edges = np.roll(shape, -1, axis=0) - shape
    normals = np.column_stack((edges[:, 1], -edges[:, 0]))
    axes = np.concatenate((normals, -normals, np.eye(2), -np.eye(2)))
    support = (shape @ axes.T).max(axis=0) + np.abs(axes) @ half
    along = direction @ axes.T
    way = np.where(along > 1e-9, support / np.maximum(along, 1e-9), np.inf)
    out: FloatArray = np.maximum(way.min(axis=1), 0.0)
    return out


def leader(tag: Tag, middle: FloatArray) -> FloatArray | None:
    """Return the line (2, 2) [px] from a robot to a label farther off than its length, or None."""
    if tag.shape is None:
        return None
    half = np.array(tag.size) / 2.0
    offset = middle - tag.at
    near = np.clip(0.0, offset - half, offset + half)
    distance = float(np.hypot(*near))
    if distance <= 2.0 * float(np.hypot(*tag.shape.T).max()):
        return None
    way = near / distance
    start = way * way_out(way[None], tag.shape, np.zeros(2))
    return np.stack((start, near)) + tag.at


def _box(offset: FloatArray, tag: Tag) -> FloatArray:
    middle, half = offset + tag.at, np.array(tag.size) / 2.0
    return np.concatenate((middle - half, middle + half))
