"""A map of what does not move: areas, walls, obstacles and paths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.plots.style import DANGER_AREA, INK, OBSTACLE, SAFE_AREA
from physim.record import Record
from physim.scene_model import SceneModel


def draw_areas(axis: Any, scene: SceneModel) -> list[Any]:
    """Draw danger and safe area, obstacles and walls; returns the handles of a legend."""
    from matplotlib.collections import LineCollection

    fills = ((scene.accessible, DANGER_AREA, "danger area"), (scene.safe, SAFE_AREA, "safe area"))
    handles = [
        _filled(axis, rings, colour, label)
        for rings, colour, label in fills
        if scene.safe_distance > 0.0 and rings
    ]
    if scene.solid_rings:
        _filled(axis, scene.solid_rings, OBSTACLE, "obstacle").set_zorder(1.2)
    axis.add_collection(LineCollection(scene.boundaries, color=INK, linewidth=1.1, zorder=1.4))
    return handles[::-1]


def frame_map(axis: Any, scene: SceneModel, record: Record, height: float, share: float) -> float:
    """Set the axes of a map about all there is; returns its height [in], ``height`` at most.

    ``share`` [in] is the width that it has.
    """
    points = list(scene.extent)
    if record.samples:
        places = record.pose[:, :, :2].reshape(-1, 2)
        points += [places.min(axis=0), places.max(axis=0)]
    cloud = np.array(points)
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    margin = 0.02 * float((high - low).max()) + 0.1
    low, high = low - margin, high + margin
    axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axis.set(xlabel="x [m]", ylabel="y [m]")
    axis.grid(False)
    wide, tall = high - low
    return float(min(height, max(1.2, share * tall / wide + 0.6)))


def _filled(axis: Any, rings: Sequence[FloatArray], colour: str, label: str) -> Any:
    """Fill rings by the even-odd rule: each drawn in the sense that makes it a hole or not."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    codes, points = [], []
    for ring, hole in zip(rings, _holes(rings), strict=True):
        turned = ring[::-1] if hole != (not shapely.is_ccw(shapely.LinearRing(ring))) else ring
        points.append(np.vstack((turned, turned[:1])))
        codes += [Path.MOVETO, *[Path.LINETO] * (len(ring) - 1), Path.CLOSEPOLY]
    path = Path(np.concatenate(points), codes)
    return axis.add_patch(PathPatch(path, facecolor=colour, linewidth=0.0, label=label, zorder=1.0))


def _holes(rings: Sequence[FloatArray]) -> list[bool]:
    """Whether each ring lies within an odd number of the others."""
    areas = [shapely.Polygon(ring) for ring in rings]
    places = [shapely.Point(ring[0]) for ring in rings]
    return [
        sum(bool(a.contains(p)) for k, a in enumerate(areas) if k != j) % 2 == 1
        for j, p in enumerate(places)
    ]
