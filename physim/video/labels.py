"""Names beside the robots, moved away from robots and from each other.

Each label may stand at twelve places round its robot, near or a little farther; it takes the one
that covers least, prefers to stay where it is, and glides to a new place.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.geometry.shapes import FloatArray

ANGLES = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
GAPS = (3.0, 16.0)
"""[px] between a robot's disc and its label"""
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


class Labels:
    """Places labels frame by frame; it remembers where they were, and nothing else."""

    def __init__(self) -> None:
        self._chosen: dict[int, int] = {}
        self._wanted: dict[int, FloatArray] = {}
        self._offset: dict[int, FloatArray] = {}
        self._frame = 0

    def place(self, tags: list[Tag], boxes: FloatArray, area: tuple[int, int]) -> FloatArray:
        """Return the middles (n, 2) [px] of labels.

        ``boxes`` (m, 4) are left, top, right, bottom of what should not be covered, ``area`` the
        width and height of the view.
        """
        choose = self._frame % EVERY == 0 or any(tag.key not in self._chosen for tag in tags)
        self._frame += 1
        middles = np.zeros((len(tags), 2))
        taken = boxes
        for row, tag in enumerate(tags):
            if choose:
                places = _places(tag)
                self._chosen[tag.key] = self._best(tag, places, taken, area)
                self._wanted[tag.key] = places[self._chosen[tag.key]]
            offset = self._wanted[tag.key]
            before = self._offset.get(tag.key, offset)
            offset = before + (offset - before) * GLIDE
            self._offset[tag.key] = offset
            middles[row] = offset + tag.at
            if choose:
                taken = np.concatenate((taken, [_box(self._wanted[tag.key], tag)]))
        return middles

    def _best(self, tag: Tag, places: FloatArray, taken: FloatArray, area: tuple[int, int]) -> int:
        half = np.array(tag.size) / 2.0
        middle = places + tag.at
        low, high = middle - half, middle + half
        room = half[None] * 2.0 + 4.0
        near = (np.abs((taken[:, :2] + taken[:, 2:]) / 2.0 - tag.at) < 300.0).all(axis=1)
        taken = taken[near]
        lapped = np.minimum(high[:, None] + 2.0, taken[None, :, 2:])
        lapped = lapped - np.maximum(low[:, None] - 2.0, taken[None, :, :2])
        covered = np.prod(np.maximum(lapped, 0.0), axis=2).sum(axis=1) / np.prod(room)
        outside = np.maximum(-low, 0.0) + np.maximum(high - area, 0.0)
        cost = 10.0 * covered + 2.0 * (outside > 0.0).any(axis=1) + 0.02 * outside.sum(axis=1)
        cost = cost + 0.5 * (np.arange(len(places)) >= len(ANGLES))
        cost = cost - 0.1 * np.sin(np.tile(ANGLES, len(GAPS)))
        if tag.key in self._chosen:
            cost[self._chosen[tag.key]] -= 0.8
        return int(np.argmin(cost))


def _places(tag: Tag) -> FloatArray:
    """Return the offsets (24, 2) at which the label just clears its robot's disc."""
    direction = np.column_stack((np.cos(ANGLES), -np.sin(ANGLES)))
    half = np.array(tag.size) / 2.0
    clear = np.min(half / np.maximum(np.abs(direction), 1e-9), axis=1)
    return np.concatenate([direction * (tag.reach + gap + clear)[:, None] for gap in GAPS])


def _box(offset: FloatArray, tag: Tag) -> FloatArray:
    middle, half = offset + tag.at, np.array(tag.size) / 2.0
    return np.concatenate((middle - half, middle + half))
