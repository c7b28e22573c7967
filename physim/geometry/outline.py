"""Outlines of bodies where they stand, as shapely polygons."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray


def placed_outlines(footprint: ArrayLike, poses: ArrayLike) -> NDArray[np.object_]:
    """Outlines (B,) in the world frame of a footprint (n, 2) [m] at poses (B, 3) [m, m, rad]."""
    at = np.asarray(poses, dtype=np.float64)
    c, s = np.cos(at[:, 2])[:, None], np.sin(at[:, 2])[:, None]
    x, y = np.asarray(footprint, dtype=np.float64).T
    corners = np.stack([at[:, :1] + c * x - s * y, at[:, 1:2] + s * x + c * y], axis=-1)
    return np.asarray(shapely.polygons(corners))


def placed_outline(footprint: ArrayLike, pose: ArrayLike) -> Any:
    """Outline in the world frame of a footprint (n, 2) [m] at a pose (3,) [m, m, rad]."""
    return placed_outlines(footprint, np.asarray(pose)[None])[0]
