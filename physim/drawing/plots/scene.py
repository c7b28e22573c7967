"""What does not move, as all figures of matplotlib show it: areas, obstacles and walls."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from physim.drawing.palette import OBSTACLE, WALL, hexed
from physim.drawing.scene_model import SceneModel, closed, region, rings_of
from physim.geometry.shapes import FloatArray


def draw_scene(axis: Any, scene: SceneModel, wall: float, zorder: float = 1.2) -> list[Any]:
    """Draw areas, obstacles and, ``wall`` [pt] wide, boundaries; returns handles of the areas.

    The safe area first. Obstacles and walls are in front of what has a lower ``zorder``.
    """
    areas = [
        _add_area(axis, area.rings, hexed(area.colour), label=area.name, linewidth=0.0, zorder=1.0)
        for area in scene.areas
    ]
    edge = hexed(WALL)
    if scene.solid_rings:
        _add_area(axis, scene.solid_rings, hexed(OBSTACLE), edgecolor=edge, linewidth=0.7,
                  zorder=zorder, gid="obstacles")  # fmt: skip
    add_lines(axis, scene.boundaries, colors=edge, linewidths=wall, zorder=zorder + 0.1,
              gid="boundaries", capstyle="round", joinstyle="round")  # fmt: skip
    return areas[::-1]


def add_lines(axis: Any, lines: Iterable[FloatArray], **style: Any) -> Any:
    """Add lines (n, 2) to a map, whose limits they leave alone; returns their collection."""
    from matplotlib.collections import LineCollection

    return axis.add_collection(LineCollection(list(lines), **style), autolim=False)


def add_bodies(axis: Any, outlines: Sequence[FloatArray], **style: Any) -> Any:
    """Add filled outlines (n, 2) to a map, whose limits they leave alone."""
    from matplotlib.collections import PolyCollection

    return axis.add_collection(PolyCollection(list(outlines), **style), autolim=False)


def _add_area(axis: Any, rings: Sequence[FloatArray], colour: str, **style: Any) -> Any:
    """Fill rings by the even-odd rule: holes go the other way round than what they are in."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    outlines = [Path(closed(ring), closed=True) for ring in rings_of(region(rings))]
    whole = Path.make_compound_path(*outlines)
    return axis.add_patch(PathPatch(whole, facecolor=colour, **style))
