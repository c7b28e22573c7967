"""What does not move: areas, walls, obstacles and paths, cut into simple things to draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from physim import palette
from physim.geometry.shapes import FloatArray
from physim.palette import Colour
from physim.scene_model import SceneModel, closed, pieces_of
from physim.timeline import Timeline

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
    """Keep what can be told apart when small: the accessible area, walls, the reference path."""
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
    """The reference path, and over it the robots' own, dashed outside of the safe area."""
    strokes = [Stroke(pieces_of([scene.reference]), palette.REFERENCE, 2)]
    for own, (safe, danger) in zip(scene.colours, scene.path_pieces, strict=True):
        colour = palette.mix(own, palette.WHITE, PATH_TINT)
        for lines, dash in ((safe, None), (danger, (5.0, 5.0))):
            if lines:
                strokes.append(Stroke(pieces_of(lines), colour, 1, dash))
    return strokes


def _extent(timeline: Timeline) -> tuple[FloatArray, FloatArray]:
    """Of the scene, and of every place that a robot went to."""
    places, reach = timeline.record.pose[:, :, :2].reshape(-1, 2), timeline.scene.reach.max()
    low, high = timeline.scene.extent
    return np.minimum(low, places.min(axis=0) - reach), np.maximum(high, places.max(axis=0) + reach)
