"""What a preview shows, worked out from the world alone: no figure, no kernel."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from physim.declared import Mode
from physim.geometry.corridor import SIDES
from physim.geometry.corridor_width import Widths, sampled_widths
from physim.geometry.shapes import FloatArray
from physim.scene import Layout
from physim.scene_builder import is_random
from physim.scene_model import SceneModel, closed, pieces_of
from physim.world_file.geometry_check import corners_of_line

PLACES = 600
"""Stations at which the width is worked out, besides every waypoint."""


@dataclass(frozen=True)
class Route:
    """A path, and the robots that follow it."""

    robots: tuple[int, ...]
    """indices; robots with the same waypoints share one route"""
    safe: list[FloatArray]
    """pieces (n, 2) [m] in the safe area"""
    danger: list[FloatArray]
    """pieces (n, 2) [m] elsewhere"""


@dataclass(frozen=True)
class Contents:
    """Everything that a preview shows; world frame [m]."""

    scene: SceneModel
    description: str
    random: bool
    """whether the seed decides anything"""
    reference: FloatArray
    """(n, 2) without waypoints that are there twice"""
    length: float
    """[m] of the reference path"""
    routes: list[Route]
    widths: Widths
    """between boundaries and obstacles"""
    boundary_widths: Widths | None
    """between the boundaries alone, where there are obstacles too"""


def contents(layout: Layout, modes: Sequence[Mode] = (), safe_distance: float = 0.0) -> Contents:
    """Work out what to show of a world whose controller has these modes and this L [m]."""
    scene = SceneModel.of_layout(layout, modes, safe_distance)
    reference = corners_of_line(scene.reference)
    others, walls = _sides(layout)
    rings = _segments(map(closed, scene.obstacles))
    widths = sampled_widths(reference, np.concatenate((others, rings)), PLACES, walls)
    alone = sampled_widths(reference, others, PLACES, walls) if len(rings) else None
    return Contents(
        scene=scene,
        description=layout.world.description,
        random=is_random(layout.world),
        reference=reference,
        length=float(shapely.LineString(reference).length),
        routes=_routes(scene),
        widths=widths,
        boundary_widths=alone,
    )


def _sides(layout: Layout) -> tuple[FloatArray, tuple[FloatArray, FloatArray] | None]:
    """Segments of the boundaries between which a width is meant, and the two walls of a corridor.

    The caps of a corridor are in neither.
    """
    drawn = layout.boundaries
    if layout.world.corridor is None:
        return _segments(drawn.values()), None
    return _segments([]), (_segments([drawn[SIDES[0]]]), _segments([drawn[SIDES[1]]]))


def _segments(lines: Iterable[FloatArray]) -> FloatArray:
    """(S, 4) segments ax, ay, bx, by of polylines (n, 2)."""
    return pieces_of(lines).reshape(-1, 4)


def _routes(scene: SceneModel) -> list[Route]:
    """Paths of the robots, each once, in the order of the robots that come first on them."""
    shared: dict[bytes, list[int]] = {}
    for i, path in enumerate(scene.paths):
        shared.setdefault(path.tobytes(), []).append(i)
    return [Route(tuple(robots), *scene.path_pieces[robots[0]]) for robots in shared.values()]
