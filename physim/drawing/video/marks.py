"""What moves in the view: robots, filled by mode, with a heading mark; trails, targets, the
closest pair, contacts.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from physim.drawing import palette
from physim.drawing.palette import Colour
from physim.drawing.scene_model import Shape
from physim.drawing.video.canvas import ONE, SHIFT, Image, Lens, draw_disc, draw_lines, fixed
from physim.geometry.shapes import FloatArray

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
