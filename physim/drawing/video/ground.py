"""What does not move: areas, walls, obstacles and paths, drawn once and cut to the view.

The view's ground is drawn in tiles when they are first seen; the overview shows all of it,
small, with the place of the view and of every robot.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import chain
from typing import NamedTuple

import cv2
import numpy as np

from physim.drawing import palette
from physim.drawing.crowd import NAMED
from physim.drawing.items import Item, Level, items
from physim.drawing.scene_model import pieces_of
from physim.drawing.timeline import Moment, Timeline
from physim.drawing.video.layout import ONE, SHIFT, Box, Image, Lens, fixed
from physim.geometry.shapes import FloatArray
from physim.parts.declarations import Mode


class Ground(NamedTuple):
    """What does not move, in the order of drawing; world frame [m]."""

    items: Sequence[Item]
    extent: tuple[FloatArray, FloatArray]
    """lowest and highest x, y [m] of all of it, and of every place a robot went"""


def ground(timeline: Timeline) -> Ground:
    """Collect what does not move in a run."""
    still = [item for item in items(timeline.scene) if item.level <= Level.WALL]
    return Ground(still, _extent(timeline))


def plain(timeline: Timeline, whole: Ground) -> Ground:
    """Keep what can be distinguished when small: the accessible area, walls, the reference path."""
    scene = timeline.scene
    key = scene.areas[-1].key if scene.areas else "floor"
    thin = [
        item._replace(width=min(item.width, 1.0))
        for item in whole.items
        if item.level not in (Level.AREA, Level.PATH)
    ]
    return Ground([Item("", scene.accessible, key, 0.0, Level.AREA), *thin], whole.extent)


def _extent(timeline: Timeline) -> tuple[FloatArray, FloatArray]:
    """Of the scene, and of every place that a robot went to."""
    places, reach = timeline.record.pose[:, :, :2].reshape(-1, 2), timeline.scene.reach.max()
    low, high = timeline.scene.extent
    return np.minimum(low, places.min(axis=0) - reach), np.maximum(high, places.max(axis=0) + reach)


TILE = 512
"""[px] edge of a tile"""
EDGE = 16
"""[px] drawn round a tile and cut off: lines that end at an edge are drawn blunt there"""
KEPT = 64
"""Tiles kept (48 MB): memory stays flat however large the world."""


def draw_ground(image: Image, ground: Ground, lens: Lens) -> None:
    """Draw the static content as seen through ``lens``."""
    image[:] = palette.OUTSIDE
    for item in ground.items:
        if item.width:
            _draw_lines(image, item, lens)
        elif item.lines:
            rings = [lens.fixed(ring) for ring in item.lines]
            cv2.fillPoly(image, rings, item.colour, cv2.LINE_AA, SHIFT)


def _draw_lines(image: Image, item: Item, lens: Lens) -> None:
    every, width = lens.pixels(pieces_of(item.lines)), round(item.width)
    low, high = every.min(axis=1), every.max(axis=1)
    edge = np.array([image.shape[1], image.shape[0]]) + width + 2
    seen = ((high >= -width - 2) & (low <= edge)).all(axis=1)
    pieces = every[seen]
    if item.dash is not None:
        pieces = _dashes(pieces, _stations(every)[seen], *item.dash, edge)
    cv2.polylines(image, list(fixed(pieces)), False, item.colour, width, cv2.LINE_AA, SHIFT)


def _stations(pieces: FloatArray) -> FloatArray:
    """Return the length drawn before each piece, so that dashes go on round corners."""
    length = np.hypot(*(pieces[:, 1] - pieces[:, 0]).T)
    return np.concatenate(([0.0], np.cumsum(length)[:-1]))


def _dashes(
    pieces: FloatArray, offset: FloatArray, dash: float, gap: float, edge: FloatArray
) -> FloatArray:
    """Cut pieces (M, 2, 2) [px] into dashes (D, 2, 2), those that a picture from 0 to ``edge`` (2,)
    [px] may show: a piece may be long beyond any bound."""
    centre, far = edge / 2.0, float(np.hypot(*edge)) + dash + gap
    cut = []
    for (start, end), before in zip(pieces, offset, strict=True):
        length = float(np.hypot(*(end - start)))
        if length < 1e-9:
            continue
        along = (end - start) / length
        middle, period = float((centre - start) @ along), dash + gap
        whole = max(0.0, (middle - far) // period) * period
        until = min(length, middle + far)
        first = np.arange(whole - before % period, until, period)
        span = np.clip(np.stack((first, first + dash), axis=1), 0.0, length)
        span = span[span[:, 1] > span[:, 0]]
        cut.append(start + span[:, :, None] * along)
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


class Overview:
    """Fits a ground into a box, which is drawn once."""

    def __init__(self, ground: Ground, box: Box, modes: Sequence[Mode]) -> None:
        self._dangerous = np.array([*(mode.danger for mode in modes), False])
        low, high = ground.extent
        size = np.maximum(high - low, 1e-6)
        room = box.size
        scale = float(((room - 10.0) / size).min())
        corner = room / 2.0 + np.array([-0.5, 0.5]) * (low + high) * scale
        self._lens = Lens(scale, float(corner[0]), float(corner[1]))
        self._ground = np.empty((box.height, box.width, 3), np.uint8)
        draw_ground(self._ground, ground, self._lens)

    def paint(self, image: Image, corners: FloatArray, now: Moment) -> None:
        """Draw the ground, the view's rectangle (two ``corners`` (2, 2) [m]) and the robots."""
        image[:] = self._ground
        if len(now.pose) > NAMED:
            self._draw_dots(image, now)
        else:
            radius = int(2.6 * ONE)
            for place, colour in zip(self._lens.fixed(now.pose[:, :2]), now.colours, strict=True):
                cv2.circle(image, place.tolist(), radius, colour, cv2.FILLED, cv2.LINE_AA, SHIFT)
        (x0, y0), (x1, y1) = np.rint(self._lens.pixels(corners)).astype(int).tolist()
        cv2.rectangle(image, (x0, y0), (x1, y1), palette.INK, 1)
        cv2.rectangle(image, (0, 0), (image.shape[1] - 1, image.shape[0] - 1), palette.RULE, 1)

    def _draw_dots(self, image: Image, now: Moment) -> None:
        """A dot of 2 x 2 px for each robot of a crowd, over all others those in danger."""
        order = np.argsort(self._dangerous[now.modes], kind="stable")
        places = np.rint(self._lens.pixels(now.pose[order, :2])).astype(int) - 1
        colours = np.frombuffer(bytes(chain.from_iterable(now.colours)), np.uint8)
        colours = colours.reshape(-1, 3)[order]
        for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
            x, y = (places + (dx, dy)).T
            seen = (x >= 0) & (y >= 0) & (x < image.shape[1]) & (y < image.shape[0])
            image[y[seen], x[seen]] = colours[seen]
