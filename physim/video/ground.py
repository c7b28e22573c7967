"""What does not move: areas, walls, obstacles and paths, cut into simple things to draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.scene_model import SceneModel
from physim.video import theme
from physim.video.story import Story
from physim.video.theme import Colour


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


def ground(story: Story) -> Ground:
    """Collect what does not move in a story."""
    scene = story.scene
    floor = theme.DANGER_AREA if scene.safe_distance > 0.0 else theme.FLOOR
    strokes = _paths(scene)
    rings = [np.concatenate((ring, ring[:1])) for ring in scene.solid_rings]
    if rings:
        strokes.append(Stroke(_steps(rings), theme.WALL, 1))
    strokes.append(Stroke(_steps(scene.boundaries), theme.WALL, 3))
    fills = (
        (scene.accessible, floor),
        (scene.safe, theme.SAFE_AREA),
        (scene.solid_rings, theme.OBSTACLE),
    )
    return Ground(fills, strokes, _extent(scene, story.record.pose[:, :, :2].reshape(-1, 2)))


def plain(story: Story, whole: Ground) -> Ground:
    """Keep what can be told apart when small: the accessible area, walls, the reference path."""
    scene = story.scene
    strokes = [
        Stroke(stroke.pieces, stroke.colour, 1)
        for stroke in whole.strokes
        if stroke.colour in (theme.WALL, theme.REFERENCE)
    ]
    floor = theme.SAFE_AREA if scene.safe else whole.fills[0][1]
    fills = ((scene.accessible, floor), (scene.solid_rings, theme.OBSTACLE))
    return Ground(fills, strokes, whole.extent)


def _paths(scene: SceneModel) -> list[Stroke]:
    """The reference path, and over it the robots' own, dashed outside of the safe area."""
    strokes = [Stroke(_steps([scene.reference]), theme.REFERENCE, 2)]
    for own, (safe, danger) in zip(scene.colours, scene.path_pieces, strict=True):
        colour = theme.mix(own, theme.WHITE, 0.42)
        for lines, dash in ((safe, None), (danger, (5.0, 5.0))):
            if lines:
                strokes.append(Stroke(_steps(lines), colour, 1, dash))
    return strokes


def _steps(lines: Sequence[FloatArray]) -> FloatArray:
    """Straight pieces (M, 2, 2) of lines."""
    pieces = [np.stack((line[:-1], line[1:]), axis=1) for line in lines]
    return np.concatenate(pieces) if pieces else np.zeros((0, 2, 2))


def _extent(scene: SceneModel, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    reach = max(float(np.hypot(*points.T).max()) for points in scene.outlines)
    low, high = scene.extent
    return (
        np.minimum(low, places.min(axis=0) - reach),
        np.maximum(high, places.max(axis=0) + reach),
    )
