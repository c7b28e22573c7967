"""Robots as they are: outline of the union of all parts, filled by mode, with a heading mark."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from physim import palette
from physim.geometry.shapes import FloatArray
from physim.palette import Colour
from physim.scene_model import largest, rings_of, union
from physim.video.layout import SHIFT, Image

FAR = 0.2
"""Distance of the reference point from the centroid, over the reach, from which it is shown."""


@dataclass(frozen=True)
class Figure:
    """A robot's footprint made ready to draw, robot's frame [m]."""

    rings: tuple[FloatArray, ...]
    """outline and holes of the union of its parts"""
    mark: FloatArray
    """(3, 2) heading mark, a triangle pointing along x at the widest place of the footprint"""
    eccentric: bool
    """whether the reference point is far from the centroid, so that it must be shown"""


def figure(parts: Sequence[FloatArray]) -> Figure:
    """Prepare a footprint given as convex parts (n, 2)."""
    whole = union(parts)
    middle, size = _widest(largest(whole))
    mark = middle + 0.72 * size * np.array([[0.95, 0.0], [-0.6, 0.72], [-0.6, -0.72]])
    reach = np.hypot(*np.concatenate(parts).T).max()
    eccentric = float(np.hypot(whole.centroid.x, whole.centroid.y)) > FAR * reach
    return Figure(tuple(rings_of(whole)), mark, eccentric)


def _widest(shape: shapely.Geometry) -> tuple[FloatArray, float]:
    """Return middle [m] and radius [m] of a disc about as large as any within ``shape``.

    The centroid where that serves, since a long shape has many such discs.
    """
    middle, edge = shapely.get_coordinates(shapely.maximum_inscribed_circle(shape))
    radius = float(np.hypot(*(edge - middle)))
    room = float(shapely.distance(shape.centroid, shape.boundary))
    if shape.contains(shape.centroid) and room > 0.85 * radius:
        return shapely.get_coordinates(shape.centroid)[0], room
    return middle, radius


class Outline(NamedTuple):
    """A robot at one time, in OpenCV's fixed-point pixels."""

    rings: list[NDArray[np.int32]]
    mark: NDArray[np.int32]


class Fleet:
    """All robots: their vertices are placed together, in one go a frame."""

    def __init__(self, footprints: Sequence[Sequence[FloatArray]]) -> None:
        self.figures = [figure(parts) for parts in footprints]
        pieces = [[*s.rings, s.mark] for s in self.figures]
        flat = [piece for body in pieces for piece in body]
        self._points = np.concatenate(flat)
        self._owner = np.repeat(
            np.arange(len(pieces)), [sum(len(piece) for piece in body) for body in pieces]
        )
        self._ends = np.cumsum([len(piece) for piece in flat])[:-1]

    def placed(self, pose: FloatArray) -> FloatArray:
        """Return all vertices (V, 2) [m] in the world frame for poses (N, 3)."""
        c, s = np.cos(pose[:, 2])[self._owner], np.sin(pose[:, 2])[self._owner]
        x, y = self._points.T
        turned = np.stack((c * x - s * y, s * x + c * y), axis=1)
        return turned + pose[self._owner, :2]

    def split(self, vertices: NDArray[np.int32]) -> list[Outline]:
        """Divide vertices (V, 2) into the outlines of each robot."""
        pieces = iter(np.split(vertices, self._ends))
        return [
            Outline([next(pieces) for _ in shape.rings], next(pieces)) for shape in self.figures
        ]


def draw_robot(view: Image, outline: Outline, colour: Colour, touching: bool) -> None:
    """Draw one robot in the colour of its mode, given in OpenCV's fixed-point pixels.

    A robot that touches something has a firm outline in the contact colour.
    """
    rings = outline.rings
    cv2.fillPoly(view, rings, colour, cv2.LINE_AA, SHIFT)
    edge, width = (palette.CONTACT, 3) if touching else (palette.mix(colour, (0, 0, 0), 0.6), 1)
    cv2.polylines(view, rings, True, edge, width, cv2.LINE_AA, SHIFT)
    cv2.fillPoly(view, [outline.mark], palette.WHITE, cv2.LINE_AA, SHIFT)
