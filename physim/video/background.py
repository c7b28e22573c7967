"""The ground in pixels: drawn once, in tiles, and cut to the view of each frame."""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np

from physim import palette
from physim.geometry.shapes import FloatArray
from physim.video.ground import Ground, Stroke
from physim.video.layout import SHIFT, Image, Lens, fixed

TILE = 512
"""[px] edge of a tile"""
EDGE = 16
"""[px] drawn round a tile and cut off: lines that end at an edge are drawn blunt there"""
KEPT = 64
"""Tiles kept (48 MB): memory stays flat however large the world."""


def draw_ground(image: Image, ground: Ground, lens: Lens) -> None:
    """Draw the static content as seen through ``lens``."""
    image[:] = palette.OUTSIDE
    for rings, colour in ground.fills:
        if rings:
            contours = [lens.fixed(ring) for ring in rings]
            cv2.fillPoly(image, contours, colour, cv2.LINE_AA, SHIFT)
    for stroke in ground.strokes:
        _draw_stroke(image, stroke, lens)


def _draw_stroke(image: Image, stroke: Stroke, lens: Lens) -> None:
    pieces = lens.pixels(stroke.pieces)
    low, high = pieces.min(axis=1), pieces.max(axis=1)
    edge = np.array([image.shape[1], image.shape[0]]) + stroke.width + 2
    seen = ((high >= -stroke.width - 2) & (low <= edge)).all(axis=1)
    pieces = pieces[seen]
    if stroke.dash is not None:
        offset = _stations(lens.pixels(stroke.pieces))[seen]
        pieces = _dashes(pieces, offset, *stroke.dash)
    lines = fixed(pieces)
    cv2.polylines(image, list(lines), False, stroke.colour, stroke.width, cv2.LINE_AA, SHIFT)


def _stations(pieces: FloatArray) -> FloatArray:
    """Return the length drawn before each piece, so that dashes go on round corners."""
    length = np.hypot(*(pieces[:, 1] - pieces[:, 0]).T)
    return np.concatenate(([0.0], np.cumsum(length)[:-1]))


def _dashes(pieces: FloatArray, offset: FloatArray, dash: float, gap: float) -> FloatArray:
    """Cut pieces (M, 2, 2) [px] into dashes (D, 2, 2)."""
    cut = []
    for (start, end), before in zip(pieces, offset, strict=True):
        length = float(np.hypot(*(end - start)))
        if length < 1e-9:
            continue
        first = np.arange(-(before % (dash + gap)), length, dash + gap)
        span = np.clip(np.stack((first, first + dash), axis=1), 0.0, length)
        span = span[span[:, 1] > span[:, 0]]
        cut.append(start + span[:, :, None] * ((end - start) / length))
    return np.concatenate(cut) if cut else np.zeros((0, 2, 2))


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
