"""What does not move: areas, walls, obstacles and paths, drawn once and cut to the view.

The view's ground is drawn in tiles when they are first seen; the overview shows all of it,
small, with the place of the view and of every robot.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain

import cv2
import numpy as np

from physim.drawing import palette
from physim.drawing.crowd import NAMED
from physim.drawing.palette import Colour
from physim.drawing.scene_model import SceneModel, closed, pieces_of
from physim.drawing.timeline import Moment, Timeline
from physim.drawing.video.layout import ONE, SHIFT, Box, Image, Lens, fixed
from physim.geometry.shapes import FloatArray
from physim.parts.declarations import Mode

PATH_TINT = 0.42
"""Share of white in the colour of a robot's own path."""


@dataclass(frozen=True)
class Stroke:
    """Straight pieces (M, 2, 2) [m] of one colour; dashed over dash and gap [px] when given."""

    pieces: FloatArray
    colour: Colour
    width: int
    dash: tuple[float, float] | None = None


@dataclass(frozen=True)
class Ground:
    """What does not move, in the order of drawing; world frame [m]."""

    fills: Sequence[tuple[Sequence[FloatArray], Colour]]
    """rings (n, 2), filled by the even-odd rule, and their colour"""
    strokes: Sequence[Stroke]
    extent: tuple[FloatArray, FloatArray]
    """lowest and highest x, y [m] of all of it, and of every place a robot went"""


def ground(timeline: Timeline) -> Ground:
    """Collect what does not move in a run."""
    scene = timeline.scene
    strokes = _paths(scene)
    if scene.solid_rings:
        strokes.append(Stroke(pieces_of(map(closed, scene.solid_rings)), palette.WALL, 1))
    strokes.append(Stroke(pieces_of(scene.boundaries), palette.WALL, 3))
    fills = [(area.rings, area.colour) for area in scene.areas]
    return Ground([*fills, (scene.solid_rings, palette.OBSTACLE)], strokes, _extent(timeline))


def plain(timeline: Timeline, whole: Ground) -> Ground:
    """Keep what can be distinguished when small: the accessible area, walls, the reference path."""
    scene = timeline.scene
    strokes = [
        Stroke(stroke.pieces, stroke.colour, 1)
        for stroke in whole.strokes
        if stroke.colour in (palette.WALL, palette.REFERENCE)
    ]
    floor = scene.areas[-1].colour if scene.areas else palette.FLOOR
    fills = ((scene.accessible, floor), (scene.solid_rings, palette.OBSTACLE))
    return Ground(fills, strokes, whole.extent)


def _paths(scene: SceneModel) -> list[Stroke]:
    """The reference path, and over it the robots' own, dashed outside of the safe area.

    In a crowd all have one colour, and a path that robots share is there once.
    """
    strokes = [Stroke(pieces_of([scene.reference]), palette.REFERENCE, 2)]
    for own, (safe, danger) in _own_paths(scene):
        colour = palette.mix(own, palette.WHITE, PATH_TINT)
        for lines, dash in ((safe, None), (danger, (5.0, 5.0))):
            if lines:
                strokes.append(Stroke(pieces_of(lines), colour, 1, dash))
    return strokes


def _own_paths(scene: SceneModel) -> Iterable[tuple[Colour, tuple[list[FloatArray], ...]]]:
    """Colour of each path, and its pieces in the safe area and elsewhere."""
    if scene.robots <= NAMED:
        return zip(scene.colours, scene.path_pieces, strict=True)
    paths = zip(scene.paths, scene.path_pieces, strict=True)
    each = {path.tobytes(): pieces for path, pieces in paths}.values()
    together = tuple([line for pieces in each for line in pieces[k]] for k in (0, 1))
    return [(palette.BAND, together)]


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
        pieces = _dashes(pieces, offset, *stroke.dash, edge)
    lines = fixed(pieces)
    cv2.polylines(image, list(lines), False, stroke.colour, stroke.width, cv2.LINE_AA, SHIFT)


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
