"""Robots of an imported world, each placed on its path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.lines import Pose
from physim.authoring.importing.outlines import Footprint
from physim.geometry.shapes import FloatArray


@dataclass(frozen=True)
class Placed:
    """One robot of the world, and the path (n, 2) [m] that it follows."""

    name: str
    footprint: Footprint
    pose: Pose
    path: FloatArray
    offset: float | None
    """[m] of its path from the reference path, left positive; None where points are needed"""


def shape_at(footprint: Footprint, pose: Pose) -> Any:
    """Outline of a robot as a shapely polygon, world frame."""
    x, y, heading = pose
    outline = footprint
    if isinstance(outline, tuple):
        a, b = 0.5 * outline[0], 0.5 * outline[1]
        outline = np.array([(-a, -b), (a, -b), (a, b), (-a, b)])
    c, s = np.cos(heading), np.sin(heading)
    return shapely.Polygon(outline @ np.array([[c, s], [-s, c]]) + (x, y))
