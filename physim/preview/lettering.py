"""Texts on the map of a preview: the least width, names of robots, stations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.plots.style import BLUE, INK, QUIET
from physim.preview.contents import Contents
from physim.preview.labels import Label, along, placed
from physim.preview.words import metres

MOST_NAMED = 300
"""Robots whose names are tried; beyond that every k-th."""
ON_WALL, ON_PATH = 0.8, 0.15
"""What every 3 pt of a line cost that a text covers; see `physim.preview.labels`."""
AIR = (3.0, 1.6)
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
        text = Text(f"{metres(shown.widths.width[k])} m", BLUE, 8.5, "bold")
        add(text, points(shown.widths.left_foot[k][None])[0], 3.0)
    first = len(texts)
    scale = float(np.hypot(*np.diff(points(shown.reference[:2]), axis=0)[0])) / float(
        np.hypot(*np.diff(shown.reference[:2], axis=0)[0])
    )
    for i in range(0, len(names), max(1, ceil(len(names) / MOST_NAMED))):
        add(Text(names[i], INK, 7.5), anchors[i], shown.robots[i].reach * scale)
    last = len(texts)
    for at, station in zip(points(ticks[0]), ticks[1], strict=True):
        add(Text(f"{station:.12g}", QUIET, 6.5), at, 3.0)
    middles = placed(labels, _taken(shown, points), _lines(shown, points), anchors, room)
    inverse = transform.inverted()
    for text, middle in zip(texts, middles, strict=True):
        if middle is not None:
            _write(axis, text, inverse.transform(middle / 72.0))
    return sum(middle is not None for middle in middles[first:last])


def _write(axis: Any, text: Text, at: FloatArray) -> None:
    ground = {"facecolor": "white", "alpha": 0.7, "linewidth": 0.0, "pad": 0.5}
    axis.text(
        *at, text.words, color=text.colour, fontsize=text.size, fontweight=text.weight,
        ha="center", va="center", zorder=5.0, bbox=ground,
    )  # fmt: skip


def _taken(shown: Contents, points: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Boxes (M, 4) [pt] of robots with their headings, and of stop stations."""
    boxes = [_box(points(robot.outline), 2.0) for robot in shown.robots]
    boxes += [_box(points(robot.stop[None]), 3.2) for robot in shown.robots]
    return np.array(boxes)


def _box(corners: FloatArray, more: float) -> FloatArray:
    return np.concatenate((corners.min(axis=0) - more, corners.max(axis=0) + more))


def _lines(shown: Contents, points: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Points [pt] of the lines that texts should keep off, walls more than paths."""
    walls = [*shown.boundaries, *(np.concatenate((o, o[:1])) for o in shown.obstacles)]
    k = shown.widths.narrowest
    if k is not None:
        walls.append(np.array([shown.widths.left_foot[k], shown.widths.right_foot[k]]))
    paths = [piece for route in shown.routes for piece in (*route.safe, *route.danger)]
    costs = ((walls, ON_WALL), (paths, ON_PATH))
    return np.concatenate([along([points(line) for line in ls], price) for ls, price in costs])


def text_size(figure: Any, words: str, size: float, weight: str) -> tuple[float, float]:
    """Width and height [pt] of a text, with a little air."""
    from matplotlib.font_manager import FontProperties

    renderer = figure.canvas.get_renderer()
    font = FontProperties(size=size, weight=weight)
    wide, high, _ = renderer.get_text_width_height_descent(words, font, False)
    scale = 72.0 / figure.dpi
    return scale * wide + AIR[0], max(scale * high, size) + AIR[1]
