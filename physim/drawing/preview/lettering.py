"""Texts on the map of a preview: the least width, names of robots, stations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from physim.drawing.crowd import NAMED
from physim.drawing.labels import (
    DISC,
    TURNS,
    Label,
    around,
    covered,
    grown,
    leader,
    overlaps,
    places,
    significant,
)
from physim.drawing.palette import hexed
from physim.drawing.plots.scene import add_lines
from physim.drawing.plots.style import INK, QUIET, WIDTHS
from physim.drawing.preview.contents import Contents
from physim.drawing.scene_model import SceneModel, closed, pieces_of
from physim.geometry.shapes import FloatArray

FEW_NAMED = 12
"""Names of a crowd that are tried, of robots as far apart in the list as can be."""
GAPS = (2.0, 6.0, 12.0, 20.0, 32.0, 48.0)
"""[pt] between what is labelled and its label"""
NEAR = 4.0
"""[pt] A label farther off than this has a line to what it belongs to."""
PRICES = (0.0, 1.0, 2.5, 4.0, 7.0, 11.0)
"""What these gaps cost; a direction costs up to 1."""
ON_WALL, ON_PATH, ON_ROBOT = 0.27, 0.05, 1.0
"""What every pt of a line costs that a text covers."""
ASTRAY = 50.0
"""What it costs to stand beside another robot: more than all lines together"""
CLEARER, FAR = 5.0, 10.0
"""[pt] by which a text is nearer to its own robot than to others; or it is so far from the others
and has a line to its own"""
LEAST = 3.0
"""[pt] least distance kept from a reference point"""
RIM = 0.15
"""Share of a robot's extent, on every side, that a text may cover if need be."""
AIR = (2.0, 0.6)
"""[pt] round a text"""


class Text(NamedTuple):
    """A text and how it is written."""

    words: str
    colour: str
    size: float
    weight: str = "normal"


def letter(
    axis: Any, preview: Contents, names: Sequence[str], ticks: tuple[FloatArray, FloatArray]
) -> int:
    """Write on the map what does not overlap; returns the number of names of robots.

    ``names`` (N,) of the robots; ``ticks`` are the points (T, 2) [m] and stations (T,) [m] of the
    station ticks. The width goes first, then names in the order of the robots, then stations.
    """
    figure, scene = axis.figure, preview.scene
    transform = axis.transData + figure.dpi_scale_trans.inverted()
    inches = figure.get_size_inches()
    room = 72.0 * (axis.get_position().extents.reshape(2, 2) * inches).ravel() + (2, 2, -2, -2)

    def points(places: FloatArray) -> FloatArray:
        return 72.0 * np.asarray(transform.transform(places))

    def metres(places: FloatArray) -> FloatArray:
        return np.asarray(transform.inverted().transform(places / 72.0))

    robots, k = points(scene.start[:, :2]), preview.widths.narrowest
    scale = np.hypot(*(points(np.eye(2)) - points(np.zeros((2, 2)))).T)[0]
    texts: list[tuple[Text, FloatArray, float]] = []
    if k is not None:
        words = f"{significant(preview.widths.width[k])} m"
        at = points(preview.widths.left_foot[k][None])[0]
        texts.append((Text(words, WIDTHS, 8.5, "bold"), at, 3.0))
    first = len(texts)
    every = 1 if len(names) <= NAMED else ceil(len(names) / FEW_NAMED)
    for i in range(0, len(names), every):
        colour = INK if len(names) > NAMED else hexed(scene.colours[i])
        reach = max(scene.reach[i] * scale, LEAST)
        texts.append((Text(names[i], colour, 7.5, "bold"), robots[i], reach))
    last = len(texts)
    for at, station in zip(points(ticks[0]), ticks[1], strict=True):
        texts.append((Text(f"{station:.12g}", QUIET, 6.5), at, 3.0))
    labels = [
        Label((at[0], at[1]), reach, text_size(figure, text.words, text.size, text.weight))
        for text, at, reach in texts
    ]
    middles = placed(labels, _taken(scene, points), _lines(preview, points), robots, room)
    leaders = []
    for index, ((text, *_), label, middle) in enumerate(zip(texts, labels, middles, strict=True)):
        if middle is not None:
            _write(axis, text, metres(middle))
            own, other = _nearest(around(middle[None], label.size), label, robots)
            mixed_up = bool(other[0] < own[0] + CLEARER)
            line = leader(label, middle, DISC * label.reach if mixed_up else label.reach + NEAR)
            if first <= index < last and line is not None:
                leaders.append(metres(line))
    add_lines(axis, leaders, colors=QUIET, linewidths=0.5, zorder=4.9, gid="leaders")
    return sum(middle is not None for middle in middles[first:last])


def placed(
    labels: Sequence[Label],
    taken: FloatArray,
    lines: tuple[FloatArray, FloatArray],
    anchors: FloatArray,
    room: FloatArray,
) -> list[FloatArray | None]:
    """Middle (2,) of every label, or None for those that find no place; the first go first.

    ``taken`` (M, 4) are boxes left, bottom, right, top that no label may cover, ``lines`` pieces
    (s, 2, 2) and what a point of each costs, ``anchors`` (A, 2) the places of all robots, and
    ``room`` (4,) the box that all must lie in. Labels do not cover each other.
    """
    middles: list[FloatArray | None] = []
    for label in labels:
        found = places(label, GAPS)
        boxes = around(found, label.size)
        inside = ((boxes[:, :2] >= room[:2]) & (boxes[:, 2:] <= room[2:])).all(axis=1)
        free = inside & (overlaps(boxes, taken).max(axis=1) <= 0.0)
        cost = np.add.outer(PRICES, TURNS).ravel() + covered(boxes, *lines)
        own, other = _nearest(boxes, label, anchors)
        cost += ASTRAY * (other < np.minimum(own + CLEARER, FAR))
        best = int(np.argmin(np.where(free, cost, np.inf)))
        middles.append(found[best] if free[best] else None)
        if free[best]:
            taken = np.concatenate((taken, boxes[best : best + 1]))
    return middles


def _nearest(boxes: FloatArray, label: Label, anchors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Distances (n,) of boxes (n, 4) to what a label belongs to, and to the nearest of others."""
    points = np.concatenate(([label.at], anchors[(np.abs(anchors - label.at) > 1e-6).any(axis=1)]))
    beyond = np.maximum(boxes[:, None, :2] - points, points - boxes[:, None, 2:])
    apart = np.hypot(*np.maximum(beyond, 0.0).transpose(2, 0, 1))
    return apart[:, 0], apart[:, 1:].min(axis=1, initial=np.inf)


def _write(axis: Any, text: Text, at: FloatArray) -> None:
    ground = {"facecolor": "white", "alpha": 0.7, "linewidth": 0.0, "pad": 0.5}
    axis.text(
        *at, text.words, color=text.colour, fontsize=text.size, fontweight=text.weight,
        ha="center", va="center", zorder=5.0, bbox=ground,
    )  # fmt: skip


def _taken(scene: SceneModel, points: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Boxes (M, 4) [pt] of stop stations, and of the inner parts of robots."""
    outlines = [points(outline) for outline in scene.starting]
    low = np.array([outline.min(axis=0) for outline in outlines])
    high = np.array([outline.max(axis=0) for outline in outlines])
    rim = RIM * (high - low)
    bodies = np.concatenate((low + rim, high - rim), axis=1)
    return np.concatenate((bodies, grown(np.tile(points(scene.stops), 2), 2.8)))


def _lines(
    preview: Contents, points: Callable[[FloatArray], FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Pieces (s, 2, 2) [pt] that texts should keep off, and what a point of each costs."""
    walls, k = (
        [*preview.scene.boundaries, *map(closed, preview.scene.obstacles)],
        preview.widths.narrowest,
    )
    if k is not None:
        walls.append(np.array([preview.widths.left_foot[k], preview.widths.right_foot[k]]))
    paths = [piece for route in preview.routes for piece in (*route.safe, *route.danger)]
    bodies = map(closed, preview.scene.starting)
    kinds = [pieces_of(map(points, lines)) for lines in (walls, paths, bodies)]
    prices = np.repeat((ON_WALL, ON_PATH, ON_ROBOT), [len(pieces) for pieces in kinds])
    return np.concatenate(kinds), prices


def text_size(figure: Any, words: str, size: float, weight: str) -> tuple[float, float]:
    """Width and height [pt] of a text, with a little air."""
    from matplotlib.font_manager import FontProperties

    renderer = figure.canvas.get_renderer()
    font = FontProperties(size=size, weight=weight)
    wide, high, _ = renderer.get_text_width_height_descent(words, font, False)
    line = renderer.get_text_width_height_descent("lp", font, False)[1]  # what it takes at least
    scale = 72.0 / figure.dpi
    return scale * wide + AIR[0], scale * max(high, line) + AIR[1]
