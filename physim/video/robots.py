"""Robots as they are: outline of the union of all parts, filled by mode, with a heading mark."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.video import theme
from physim.video.camera import Lens
from physim.video.text import Image
from physim.video.theme import SHIFT

SEAM = 1e-6
"""[m] Parts closer than this are drawn as one: their shared edges agree only to rounding."""


@dataclass(frozen=True)
class Figure:
    """A robot's footprint made ready to draw, robot's frame [m]."""

    rings: tuple[FloatArray, ...]
    """outline and holes of the union of its parts"""
    parts: tuple[FloatArray, ...]
    mark: FloatArray
    """(3, 2) heading mark, a triangle pointing along x at the widest place of the footprint"""
    reach: float
    """[m] largest distance of a vertex from the reference point"""


def figure(parts: Sequence[FloatArray]) -> Figure:
    """Prepare a footprint given as convex parts (n, 2)."""
    polygons = [shapely.make_valid(shapely.Polygon(part)) for part in parts]
    union = shapely.union_all([shapely.buffer(p, SEAM, join_style="mitre") for p in polygons])
    union = shapely.buffer(union, -SEAM, join_style="mitre")
    pieces = [p for p in shapely.get_parts(union) if p.geom_type == "Polygon" and not p.is_empty]
    rings = [
        shapely.get_coordinates(ring)[:-1] for p in pieces for ring in (p.exterior, *p.interiors)
    ]
    radius_line = shapely.maximum_inscribed_circle(max(pieces, key=lambda p: float(p.area)))
    middle, edge = shapely.get_coordinates(radius_line)
    size = float(np.hypot(*(edge - middle)))
    mark = middle + 0.72 * size * np.array([[0.95, 0.0], [-0.6, 0.72], [-0.6, -0.72]])
    reach = max(float(np.hypot(*np.asarray(part).T).max()) for part in parts)
    return Figure(tuple(rings), tuple(np.asarray(p) for p in parts), mark, reach)


def placed(points: FloatArray, pose: FloatArray) -> FloatArray:
    """Return points (n, 2) of a robot's frame in the world frame."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return points @ np.array([[c, s], [-s, c]]) + pose[:2]


def draw_robot(
    view: Image, lens: Lens, shape: Figure, pose: FloatArray, mode: int, touching: bool
) -> None:
    """Draw one robot; a robot that touches something has a firm outline in the contact colour."""
    colour = theme.mode_colour(mode)
    rings = [lens.fixed(placed(ring, pose)) for ring in shape.rings]
    cv2.fillPoly(view, rings, colour, cv2.LINE_AA, SHIFT)
    edge, width = (theme.CONTACT, 3) if touching else (theme.mix(colour, (0, 0, 0), 0.6), 1)
    cv2.polylines(view, rings, True, edge, width, cv2.LINE_AA, SHIFT)
    mark = lens.fixed(placed(shape.mark, pose))
    cv2.fillPoly(view, [mark], theme.WHITE, cv2.LINE_AA, SHIFT)
