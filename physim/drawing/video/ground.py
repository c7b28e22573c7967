"""What does not move: areas, walls, obstacles, paths; drawn once in tiles, and cut to the view."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np

from physim.drawing import palette
from physim.drawing.items import Item, Level, items
from physim.drawing.scene_model import pieces_of
from physim.drawing.timeline import Timeline
from physim.drawing.video.canvas import SHIFT, Image, Lens, draw_lines, fixed
from physim.geometry.shapes import FloatArray

TILE = 512
"""[px] edge of a tile"""
EDGE = 16
"""[px] drawn round a tile and cut off: lines that end at an edge are drawn blunt there"""
KEPT = 64
"""Tiles kept (48 MB): memory stays flat however large the world."""


class Ground(NamedTuple):
    """What does not move, in the order of drawing; world frame [m]."""

    items: Sequence[Item]
    extent: tuple[FloatArray, FloatArray]
    """lowest and highest x, y [m] of all of it, and of every place a robot went"""


def ground(timeline: Timeline) -> Ground:
    """Collect what does not move in a run."""
    scene = timeline.scene
    places, reach = timeline.record.pose[:, :, :2].reshape(-1, 2), scene.reach.max()
    low = np.minimum(scene.extent[0], places.min(axis=0) - reach)
    high = np.maximum(scene.extent[1], places.max(axis=0) + reach)
    return Ground([item for item in items(scene) if item.level <= Level.WALL], (low, high))


def draw_ground(image: Image, ground: Ground, lens: Lens, small: bool = False) -> None:
    """Draw what does not move as seen through ``lens``.

    ``small``: what can be distinguished then, thin, without paths, and one area.
    """
    image[:] = palette.OUTSIDE
    area = [item.colour for item in ground.items if item.level == Level.AREA][-1:]
    for item in ground.items:
        if item.width == 0.0:
            colour = area[0] if small and item.level == Level.AREA else item.colour
            rings = [lens.fixed(ring) for ring in item.lines]
            cv2.fillPoly(image, rings, colour, cv2.LINE_AA, SHIFT)
        elif not (small and item.level == Level.PATH):
            _draw_lines(image, item, lens, 1 if small else round(item.width))


def _draw_lines(image: Image, item: Item, lens: Lens, width: int) -> None:
    every = lens.pixels(pieces_of(item.lines))
    edge = np.array([image.shape[1], image.shape[0]]) + width + 2
    seen = ((every.max(axis=1) >= -width - 2) & (every.min(axis=1) <= edge)).all(axis=1)
    pieces = every[seen]
    if item.dash is not None:
        length = np.hypot(*(every[:, 1] - every[:, 0]).T)
        before = np.concatenate(([0.0], np.cumsum(length)[:-1]))  # dashes go on round corners
        pieces = _dashes(pieces, before[seen], item.dash, edge)
    draw_lines(image, fixed(pieces), item.colour, width)


def _dashes(
    pieces: FloatArray, before: FloatArray, dash: tuple[float, float], edge: FloatArray
) -> FloatArray:
    """Cut pieces (M, 2, 2) [px] into dashes (D, 2, 2), those that a picture from 0 to ``edge`` (2,)
    [px] may show: a piece may be long beyond any bound."""
    period, cut = sum(dash), [np.zeros((0, 2, 2))]
    centre, far = edge / 2.0, float(np.hypot(*edge)) + period
    for (start, end), offset in zip(pieces, before, strict=True):
        length = float(np.hypot(*(end - start)))
        along = (end - start) / max(length, 1e-9)
        middle = float((centre - start) @ along)
        whole = max(0.0, (middle - far) // period) * period
        first = np.arange(whole - offset % period, min(length, middle + far), period)
        span = np.clip(np.stack((first, first + dash[0]), axis=1), 0.0, length)
        cut.append(start + span[span[:, 1] > span[:, 0]][:, :, None] * along)
    return np.concatenate(cut)


class Background:
    """Cuts the ground at one scale to any view; tiles are drawn when first seen."""

    def __init__(self, ground: Ground, scale: float) -> None:
        self._ground = ground
        self._scale = scale
        self._tile = lru_cache(KEPT)(self._drawn)

    def paint(self, view: Image, lens: Lens) -> None:
        """Fill ``view`` with the ground; ``lens`` has this background's scale."""
        left, top = -round(lens.x), -round(lens.y)
        high, wide = view.shape[:2]
        for row in range(top // TILE, (top + high - 1) // TILE + 1):
            for column in range(left // TILE, (left + wide - 1) // TILE + 1):
                tile = self._tile(column, row)
                x, y = column * TILE - left, row * TILE - top
                x0, x1 = max(x, 0), min(x + TILE, wide)
                y0, y1 = max(y, 0), min(y + TILE, high)
                view[y0:y1, x0:x1] = tile[y0 - y : y1 - y, x0 - x : x1 - x]

    def _drawn(self, column: int, row: int) -> Image:
        drawn = np.empty((TILE + 2 * EDGE, TILE + 2 * EDGE, 3), np.uint8)
        lens = Lens(self._scale, EDGE - column * TILE, EDGE - row * TILE)
        draw_ground(drawn, self._ground, lens)
        return drawn[EDGE:-EDGE, EDGE:-EDGE].copy()
