"""The picture of 1280 x 720 pixels: its parts, the map from the world to it, lines, text and marks.

Lengths are pixels of that picture. Text is in any script, by OpenCV's embedded outline fonts.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from physim.drawing import palette
from physim.drawing.labels import number, shortened
from physim.drawing.palette import Colour
from physim.drawing.scene_model import Shape
from physim.geometry.shapes import FloatArray

Image = NDArray[np.uint8]
Sprite = tuple[NDArray[np.float32], NDArray[np.float32]]
"""Colour times opacity (h, w, 3) from 0 to 255, and transparency (h, w, 3) from 0 to 1."""

WIDTH, HEIGHT = 1280, 720
PANEL_WIDTH, STRIP_HEIGHT = 272, 184
TEXT, SMALL, TITLE = 14, 13, 17
"""[px] font sizes; the second is the least used anywhere"""
NORMAL, BOLD = 420, 600
"""Weights of fonts."""

TRAIL, SHORT_TRAIL = 10.0, 2.0
"""[s] simulated length of a trail, and of one in a crowd, where robots follow close behind"""
FLASH = 0.5
"""[s of video] length of the flash at a contact"""
MARK = 1.0
"""[s] least simulated time that the mark of a contact stays, and at least FLASH of video"""

SHIFT = 4
"""Fractional bits of the pixel coordinates given to OpenCV (1/16 px)."""
ONE = 1 << SHIFT
LONGEST = 150
"""[px] a scale bar is at most so long"""


class Box(NamedTuple):
    """A rectangle of pixels."""

    left: int
    top: int
    width: int
    height: int

    @property
    def size(self) -> FloatArray:
        """Width and height (2,)."""
        return np.array([self.width, self.height], dtype=np.float64)

    def of(self, image: Image) -> Image:
        """Return the part of ``image`` in this box, as a view: drawing there is clipped to it."""
        return image[self.top : self.top + self.height, self.left : self.left + self.width]


VIEW = Box(0, 0, WIDTH - PANEL_WIDTH, HEIGHT - STRIP_HEIGHT)
PANEL = Box(VIEW.width, 0, PANEL_WIDTH, HEIGHT)
STRIP = Box(0, VIEW.height, VIEW.width, STRIP_HEIGHT)


class Lens(NamedTuple):
    """World to pixels: scale [px/m], and the world's origin in pixels of the view (y down)."""

    scale: float
    x: float
    y: float

    @classmethod
    def whole(cls, extent: tuple[FloatArray, FloatArray], size: FloatArray, margin: float) -> Lens:
        """Return the map that shows all of an extent [m] in the middle of a size (2,) [px]."""
        low, high = extent
        scale = float(((size - 2.0 * margin) / np.maximum(high - low, 1e-6)).min())
        x, y = size / 2.0 + np.array([-0.5, 0.5]) * (low + high) * scale
        return cls(scale, float(round(x)), float(round(y)))

    def pixels(self, points: FloatArray) -> FloatArray:
        """Return points (…, 2) [m] as pixels (…, 2)."""
        return np.asarray(points) * (self.scale, -self.scale) + (self.x, self.y)

    def fixed(self, points: FloatArray) -> NDArray[np.int32]:
        """Return points (…, 2) [m] as OpenCV's fixed-point pixels (…, 2)."""
        return fixed(self.pixels(points))


def fixed(pixels: FloatArray) -> NDArray[np.int32]:
    """Return pixels as OpenCV's fixed-point numbers; far outside the picture they saturate."""
    return np.rint(np.clip(pixels, -1e6, 1e6) * ONE).astype(np.int32)


# Lines


def draw_lines(
    image: Image, lines: NDArray[np.int32], colour: Colour, width: int, closed: bool = False
) -> None:
    """Draw lines (k, n, 2) of fixed-point pixels."""
    cv2.polylines(image, list(lines), closed, colour, width, cv2.LINE_AA, SHIFT)


def draw_disc(
    image: Image, at: NDArray[np.int32], radius: float, colour: Colour, width: int = cv2.FILLED
) -> None:
    """Draw a disc, or a ring of some ``width``, of ``radius`` [px] round fixed-point pixels."""
    cv2.circle(image, at.tolist(), round(radius * ONE), colour, width, cv2.LINE_AA, SHIFT)


def draw_progress(image: Image, left: int, right: int, y: int, share: float) -> None:
    """Draw a bar of which a share is done."""
    cv2.line(image, (left, y), (right, y), palette.FAINT, 5)
    cv2.line(image, (left, y), (left + round((right - left) * share), y), palette.QUIET, 5)


def draw_scale(image: Image, left: int, y: int, scale: float) -> None:
    """Draw a bar at ``left``, ``y`` [px] for a scale [px/m], and its length beside it.

    The length is the greatest of 1, 2, 5 × a power of ten [m] with room for it.
    """
    most = LONGEST / scale
    decade = 10.0 ** math.floor(math.log10(most))
    length = next(factor * decade for factor in (5.0, 2.0, 1.0, 0.5) if factor * decade <= most)
    end = left + round(length * scale)
    cv2.line(image, (left, y), (end, y), palette.INK, 2)
    for x in (left, end):
        cv2.line(image, (x, y - 5), (x, y + 5), palette.INK, 2)
    write(image, f"{number(length, length)} m", (end + 10, y + 5), TEXT)


# Text


@functools.cache
def _face() -> Any:
    return cv2.FontFace("sans")


@functools.lru_cache(maxsize=4096)
def width(text: str, size: int, weight: int = NORMAL) -> int:
    """Return the width of ``text`` [px] at font size ``size`` [px]."""
    return int(cv2.getTextSize((8, 8), text, (0, 0), _face(), size, weight)[2])


@functools.lru_cache(maxsize=4096)
def shorten(text: str, size: int, room: int, weight: int = NORMAL) -> str:
    """Return ``text`` cleaned and, where wider than ``room`` px, cut and ended with an ellipsis."""
    return shortened(text, lambda cut: width(cut, size, weight) <= room)


def wrapped(text: str, size: int, room: int, most: int) -> list[str]:
    """Return ``text`` in at most ``most`` lines of ``room`` px, ended at commas, the last cut."""
    lines: list[str] = []
    for part in text.split(", ") if text else ():
        longer = f"{lines[-1]}, {part}" if lines else part
        if lines and (len(lines) == most or width(f"{longer},", size) <= room):
            lines[-1] = longer
        else:
            lines.append(part)
    ends = ["," for _ in lines[1:]] + [""]
    return [shorten(line + end, size, room) for line, end in zip(lines, ends, strict=False)]


def write(
    image: Image,
    text: str,
    at: tuple[float, float],
    size: int,
    *,
    colour: Colour = palette.INK,
    weight: int = NORMAL,
    anchor: str = "left",
) -> None:
    """Write a text with its baseline at (x, y) [px]; ``anchor``: left, middle, right."""
    x = at[0]
    if anchor != "left":
        x -= width(text, size, weight) * (0.5 if anchor == "middle" else 1.0)
    cv2.putText(image, text, (round(x), round(at[1])), colour, _face(), size, weight)


@functools.lru_cache(maxsize=2048)
def sprite(text: str, size: int, colour: Colour, weight: int = BOLD) -> Sprite:
    """Return a text with a white halo, made ready to be blended into a picture."""
    wide, high = width(text, size, weight) + 8, size + 10
    ink = np.zeros((high, wide, 3), np.uint8)
    write(ink, text, (4, high - 8), size, colour=palette.WHITE, weight=weight)
    cover = ink[:, :, :1].astype(np.float32) / 255.0
    halo = cv2.GaussianBlur(cv2.dilate(ink[:, :, 0], np.ones((3, 3), np.uint8)), (5, 5), 0)
    opacity = np.maximum(cover, np.minimum(halo[:, :, None] / 255.0 * 1.2, 0.9))
    tint = np.floor(cover * np.array(colour, np.float32) + (1.0 - cover) * 255.0)
    return (tint * opacity).astype(np.float32), np.repeat(1.0 - opacity, 3, 2).astype(np.float32)


def size_of(picture: Sprite) -> tuple[int, int]:
    """Return the width and height of a sprite [px]."""
    return picture[0].shape[1], picture[0].shape[0]


def stamp(image: Image, picture: Sprite, left: int, top: int) -> None:
    """Blend a sprite into ``image`` with its corner at (left, top), clipped at the edges."""
    colour, transparency = picture
    high, wide = transparency.shape[:2]
    y0, y1 = max(top, 0), min(top + high, image.shape[0])
    x0, x1 = max(left, 0), min(left + wide, image.shape[1])
    if y0 >= y1 or x0 >= x1:
        return
    part = (slice(y0 - top, y1 - top), slice(x0 - left, x1 - left))
    blended = image[y0:y1, x0:x1] * transparency[part]
    blended += colour[part]
    image[y0:y1, x0:x1] = blended


# Marks

CORNERS = np.array([[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])
"""of the diamond of a swept contact"""
ARMS = np.array([[[-1.0, -1.0], [1.0, 1.0]], [[-1.0, 1.0], [1.0, -1.0]]])
"""of the cross of a contact"""


class Outline(NamedTuple):
    """A robot at one time, in OpenCV's fixed-point pixels."""

    rings: list[NDArray[np.int32]]
    mark: NDArray[np.int32]


class Fleet:
    """All robots: their vertices are placed together, in one go a frame."""

    def __init__(self, shapes: Sequence[Shape]) -> None:
        self.shapes = shapes
        pieces = [[*one.rings, one.mark] for one in shapes]
        flat = [piece for body in pieces for piece in body]
        self._points = np.concatenate(flat)
        self._owner = np.repeat(
            np.arange(len(pieces)), [sum(len(piece) for piece in body) for body in pieces]
        )
        self._start = np.searchsorted(self._owner, np.arange(len(pieces)))
        spans = iter(pairwise(np.cumsum([0, *map(len, flat)]).tolist()))
        self._spans = [[next(spans) for _ in body] for body in pieces]

    def placed(self, pose: FloatArray) -> FloatArray:
        """Return all vertices (V, 2) [m] in the world frame for poses (N, 3)."""
        c, s = np.cos(pose[:, 2])[self._owner], np.sin(pose[:, 2])[self._owner]
        x, y = self._points.T
        turned = np.stack((c * x - s * y, s * x + c * y), axis=1)
        return turned + pose[self._owner, :2]

    def split(
        self, vertices: NDArray[np.int32], robots: Iterable[int] | None = None
    ) -> list[Outline]:
        """Divide vertices (V, 2) into the outlines of all robots, or of some."""
        outlines = []
        for robot in range(len(self.shapes)) if robots is None else robots:
            pieces = [vertices[a:b] for a, b in self._spans[robot]]
            outlines.append(Outline(pieces[:-1], pieces[-1]))
        return outlines

    def boxes(self, vertices: NDArray[np.int32]) -> FloatArray:
        """Return left, top, right, bottom (N, 4) [px] of robots, of vertices (V, 2)."""
        low = np.minimum.reduceat(vertices, self._start, axis=0)
        high = np.maximum.reduceat(vertices, self._start, axis=0)
        return np.concatenate((low, high), axis=1) / ONE


def draw_robots(
    view: Image, outlines: Sequence[Outline], colours: Sequence[Colour], touching: Sequence[bool]
) -> None:
    """Draw robots in the colours of their modes, given in OpenCV's fixed-point pixels.

    A robot that touches something has a firm outline in the contact colour. Lines of one colour
    are drawn together: calls cost more than pixels.
    """
    edges: dict[tuple[Colour, int], list[NDArray[np.int32]]] = {}
    dark = {colour: palette.mix(colour, (0, 0, 0), 0.6) for colour in set(colours)}
    for outline, colour, touches in zip(outlines, colours, touching, strict=True):
        cv2.fillPoly(view, outline.rings, colour, cv2.LINE_AA, SHIFT)
        edge = (palette.CONTACT, 3) if touches else (dark[colour], 1)
        edges.setdefault(edge, []).extend(outline.rings)
    for (colour, width), rings in sorted(edges.items(), key=lambda edge: edge[0][1]):
        cv2.polylines(view, rings, True, colour, width, cv2.LINE_AA, SHIFT)
    for outline in outlines:
        cv2.fillConvexPoly(view, outline.mark, palette.WHITE, cv2.LINE_AA, SHIFT)


def draw_trails(
    view: Image, pixels: NDArray[np.int32], colour: Colour, bands: int, width: int = 2
) -> None:
    """Draw where robots went, (N, T, 2) fixed-point pixels, old to new, fading in steps."""
    count = pixels.shape[1] - 1
    for band in range(bands):
        first, last = band * count // bands, (band + 1) * count // bands
        if last > first:
            shade = palette.mix(colour, palette.SAFE_AREA, 0.85 * (1.0 - (band + 1) / bands))
            draw_lines(view, pixels[:, first : last + 1], shade, width)


def draw_targets(view: Image, lens: Lens, robots: FloatArray, targets: FloatArray) -> None:
    """Draw targets (N, 2) [m] as small rings, joined to their robots by thin lines."""
    known = np.isfinite(targets).all(axis=1)
    ends = lens.fixed(np.stack((robots[known], targets[known]), axis=1))
    draw_lines(view, ends, palette.QUIET, 1)
    for end in ends[:, 1]:
        draw_disc(view, end, 3.0, palette.WHITE)
        draw_disc(view, end, 3.0, palette.INK, 1)


def draw_closest(view: Image, lens: Lens, points: FloatArray) -> None:
    """Join the closest points (2, 2) [m] of two bodies."""
    ends = lens.fixed(points)
    draw_lines(view, ends[None], palette.WHITE, 5)
    draw_lines(view, ends[None], palette.INK, 2)
    for end in ends:
        draw_disc(view, end, 3.0, palette.INK)


def draw_ring(image: Image, centre: FloatArray, radius: float, width: int) -> None:
    """Draw a ring in the contact colour round ``centre`` (2,), all [px]."""
    draw_disc(image, fixed(centre), radius, palette.WHITE, width + 3)
    draw_disc(image, fixed(centre), radius, palette.CONTACT, width)


def draw_contacts(
    image: Image, centres: FloatArray, swept: bool, small: bool = False, deep: bool = False
) -> None:
    """Draw crosses of contacts, or open diamonds of swept ones, at ``centres`` (C, 2) [px].

    Of those that are too ``deep`` to be physical the cross is white on a disc.
    """
    centres = centres[np.isfinite(centres).all(axis=1)]
    if deep:
        for centre in fixed(centres):
            draw_disc(image, centre, 13.0, palette.WHITE)
            draw_disc(image, centre, 11.0, palette.CONTACT)
        lines = fixed((centres[:, None, None] + 5.0 * ARMS).reshape(-1, 2, 2))
        draw_lines(image, lines, palette.WHITE, 3)
        return
    shape = CORNERS[None] if swept else ARMS
    arm, width = ((5.0, 2) if swept else (4.0, 2)) if small else ((9.0, 3) if swept else (7.0, 4))
    lines = fixed((centres[:, None, None] + arm * shape).reshape(-1, *shape.shape[1:]))
    draw_lines(image, lines, palette.WHITE, width + 3, swept)
    draw_lines(image, lines, palette.CONTACT, width, swept)
