"""Texts on the map of a preview: the least width, names of robots, stations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.plots.style import INK, QUIET, WIDTHS
from physim.preview.contents import Contents
from physim.preview.labels import Label, along, leader, placed
from physim.preview.words import metres

MOST_NAMED = 300
"""Robots whose names are tried; beyond that every k-th."""
ON_WALL, ON_PATH, ON_ROBOT = 0.8, 0.15, 3.0
"""What every 3 pt of a line cost that a text covers; see `physim.preview.labels`."""
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
    axis: Any, shown: Contents, names: Sequence[str], ticks: tuple[FloatArray, FloatArray]
) -> int:
    """Write on the map what does not overlap; returns the number of names of robots.

    ``names`` (N,) of the robots; ``ticks`` are the points (T, 2) [m] and stations (T,) [m] of the
    station ticks. The width goes first, then names in the order of the robots, then stations.
    """
    figure = axis.figure
    transform = axis.transData + figure.dpi_scale_trans.inverted()
    inches = figure.get_size_inches()
    room = 72.0 * (axis.get_position().extents.reshape(2, 2) * inches).ravel() + (2, 2, -2, -2)

    def points(places: FloatArray) -> FloatArray:
        return 72.0 * np.asarray(transform.transform(places))

    anchors = points(np.array([robot.pose[:2] for robot in shown.robots]))
    texts: list[Text] = []
    labels: list[Label] = []

    def add(text: Text, at: FloatArray, reach: float) -> None:
        texts.append(text)
        size = text_size(figure, text.words, text.size, text.weight)
        labels.append(Label((at[0], at[1]), reach, size))

    k = shown.widths.narrowest
    if k is not None:
        text = Text(f"{metres(shown.widths.width[k])} m", WIDTHS, 8.5, "bold")
        add(text, points(shown.widths.left_foot[k][None])[0], 3.0)
    first = len(texts)
    scale = float(np.hypot(*np.diff(points(shown.reference[:2]), axis=0)[0])) / float(
        np.hypot(*np.diff(shown.reference[:2], axis=0)[0])
    )
    for i in range(0, len(names), max(1, ceil(len(names) / MOST_NAMED))):
        add(Text(names[i], INK, 7.5), anchors[i], max(shown.robots[i].reach * scale, LEAST))
    last = len(texts)
    for at, station in zip(points(ticks[0]), ticks[1], strict=True):
        add(Text(f"{station:.12g}", QUIET, 6.5), at, 3.0)
    middles = placed(labels, _taken(shown, points), _lines(shown, points), anchors, room)
    inverse = transform.inverted()
    for text, middle in zip(texts, middles, strict=True):
        if middle is not None:
            _write(axis, text, inverse.transform(middle / 72.0))
    leaders = [
        line
        for label, middle in zip(labels[first:last], middles[first:last], strict=True)
        if middle is not None and (line := leader(label, middle)) is not None
    ]
    _lead(axis, [inverse.transform(line / 72.0) for line in leaders])
    return sum(middle is not None for middle in middles[first:last])


def _lead(axis: Any, lines: list[FloatArray]) -> None:
    from matplotlib.collections import LineCollection

    drawn = LineCollection(lines, colors=QUIET, linewidths=0.5, zorder=4.9, gid="leaders")
    axis.add_collection(drawn, autolim=False)


def _write(axis: Any, text: Text, at: FloatArray) -> None:
    ground = {"facecolor": "white", "alpha": 0.7, "linewidth": 0.0, "pad": 0.5}
    axis.text(
        *at, text.words, color=text.colour, fontsize=text.size, fontweight=text.weight,
        ha="center", va="center", zorder=5.0, bbox=ground,
    )  # fmt: skip


def _taken(shown: Contents, points: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Boxes (M, 4) [pt] of stop stations, and of the inner parts of robots."""
    stops = points(np.array([robot.stop for robot in shown.robots]))
    outlines = [points(robot.outline) for robot in shown.robots]
    low = np.array([outline.min(axis=0) for outline in outlines])
    high = np.array([outline.max(axis=0) for outline in outlines])
    rim = RIM * (high - low)
    bodies = np.concatenate((low + rim, high - rim), axis=1)
    return np.concatenate((bodies, np.concatenate((stops - 2.8, stops + 2.8), axis=1)))


def _lines(shown: Contents, points: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Points [pt] of the lines that texts should keep off, walls more than paths."""
    walls = [*shown.scene.boundaries, *(np.concatenate((o, o[:1])) for o in shown.scene.obstacles)]
    k = shown.widths.narrowest
    if k is not None:
        walls.append(np.array([shown.widths.left_foot[k], shown.widths.right_foot[k]]))
    paths = [piece for route in shown.routes for piece in (*route.safe, *route.danger)]
    bodies = [np.concatenate((robot.outline, robot.outline[:1])) for robot in shown.robots]
    costs = ((walls, ON_WALL), (paths, ON_PATH), (bodies, ON_ROBOT))
    return np.concatenate([along([points(line) for line in ls], price) for ls, price in costs])


def text_size(figure: Any, words: str, size: float, weight: str) -> tuple[float, float]:
    """Width and height [pt] of a text, with a little air."""
    from matplotlib.font_manager import FontProperties

    renderer = figure.canvas.get_renderer()
    font = FontProperties(size=size, weight=weight)
    wide, high, _ = renderer.get_text_width_height_descent(words, font, False)
    line = renderer.get_text_width_height_descent("lp", font, False)[1]  # what it takes at least
    scale = 72.0 / figure.dpi
    return scale * wide + AIR[0], scale * max(high, line) + AIR[1]
