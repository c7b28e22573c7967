"""The map of a preview: ground, walls, paths, robots at the start, the narrowest place."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor, log10
from typing import Any

import numpy as np
import shapely

from physim.drawing import palette
from physim.drawing.crowd import NAMED
from physim.drawing.labels import decimal, round_step
from physim.drawing.palette import hexed, robot_colour
from physim.drawing.plots.scene import add_bodies, add_lines, draw_scene
from physim.drawing.plots.style import INK, WIDTHS
from physim.drawing.preview.contents import Contents, Route
from physim.drawing.preview.lettering import letter
from physim.drawing.scene_model import SceneModel
from physim.geometry.shapes import FloatArray

MARGIN = 0.04
"""Share of the map that is left free round the world."""
MOST_TICKS = 14
"""Station ticks along the reference path, about."""
MOST_DIGITS = 7
"""Signs of a number at the axes."""
SMALL = 2.5
"""[pt] A robot smaller than this has a ring round it."""
STALK = 5.0
"""[pt] by which the heading line reaches beyond the footprint"""
DOT = 1.6
"""[pt] size at least of a robot in a crowd"""
TOGETHER = hexed(palette.BAND)
"""Colour of all robots and paths of a crowd."""
DASH = (3.2, 2.6)
"""[pt] in the danger area"""
TURN = 14.5
"""[pt] length that each colour of a shared path has; a whole number of dashes and gaps"""


def draw_map(axis: Any, preview: Contents, names: Sequence[str]) -> int:
    """Draw the map; ``names`` (N,) are the labels of the robots. Returns how many are preview."""
    _frame(axis, preview)
    draw_scene(axis, preview.scene, _wall(axis, preview), zorder=3.0)
    _reference(axis, preview)
    if is_crowd(preview.scene):
        _routes_alike(axis, preview.routes)
    else:
        for route in preview.routes:
            _route(axis, route)
    _narrowest(axis, preview)
    _stops(axis, preview.scene)
    _robots(axis, preview.scene)
    point, _, station = station_ticks(preview)
    return letter(axis, preview, names, (point, station))


def _frame(axis: Any, preview: Contents) -> None:
    """Equal scales on a box of fixed size: the world in its middle."""
    figure = axis.figure
    wide, high = figure.get_size_inches() * axis.get_position().size
    low, top = preview.scene.extent
    middle, span = (low + top) / 2.0, (top - low) * (1.0 + 2.0 * MARGIN)
    scale = max(span[0] / wide, span[1] / high)  # [m] an inch
    axis.set_xlim(middle[0] - scale * wide / 2.0, middle[0] + scale * wide / 2.0)
    axis.set_ylim(middle[1] - scale * high / 2.0, middle[1] + scale * high / 2.0)
    axis.set_aspect("equal", adjustable="box")
    axis.set(facecolor=hexed(palette.OUTSIDE))
    _scale(axis.xaxis, "x", axis.get_xlim())
    _scale(axis.yaxis, "y", axis.get_ylim())
    axis.grid(False)
    for side in axis.spines.values():
        side.set_visible(True)


def _scale(axis: Any, name: str, limits: tuple[float, float]) -> None:
    """Numbers of an axis; far from the origin they count from a round number."""
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    base, decimals = readable_scale(*limits)
    axis.set_major_locator(MaxNLocator(9, steps=(1, 2, 5, 10)))

    words = FuncFormatter(lambda value, _: decimal(value - base, decimals))
    axis.set_major_formatter(words)
    sign = "\u2212" if base > 0.0 else "+"
    axis.set_label_text(f"{name} {sign} {abs(base):,.0f} [m]" if base else f"{name} [m]")


def readable_scale(low: float, high: float) -> tuple[float, int]:
    """Number [m] to take off the values of an axis so that they stay short, and their decimals."""
    span = high - low
    decimals = max(0, -floor(log10(span / 9.0)))
    digits = len(f"{max(abs(low), abs(high)):.{decimals}f}")
    if digits <= MOST_DIGITS:
        return 0.0, decimals
    power = 10.0 ** max(0, ceil(log10(span)) + 1)
    return round((low + high) / 2.0 / power) * power, decimals


def points_a_metre(axis: Any) -> float:
    """Scale of the map [pt/m]."""
    low, high = axis.get_xlim()
    wide = axis.figure.get_size_inches()[0] * axis.get_position().width
    return float(72.0 * wide / (high - low))


def _wall(axis: Any, preview: Contents) -> float:
    """Width of a wall [pt]: two walls close together must stay two."""
    k = preview.widths.narrowest
    room = points_a_metre(axis) * preview.widths.width[k] if k is not None else 10.0
    return float(min(max(0.2 * room, 0.4), 1.6))


def _reference(axis: Any, preview: Contents) -> None:
    """The reference path, and a tick across the first robot's path every round number of metres."""
    grey = hexed(palette.REFERENCE)
    add_lines(axis, [preview.reference], colors=grey, linewidths=2.6, alpha=0.55, zorder=2.0,
           gid="reference")  # fmt: skip
    point, normal, _ = station_ticks(preview)
    half = 3.2 / points_a_metre(axis)
    ticks = np.stack((point - half * normal, point + half * normal), axis=1)
    add_lines(axis, list(ticks), colors=hexed(palette.QUIET), linewidths=0.9, zorder=2.6,
           gid="stations")  # fmt: skip


def station_ticks(preview: Contents) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points (T, 2), normals (T, 2), stations (T,) [m] of the ticks on the first robot's path."""
    length = preview.course_length
    step = round_step(length, MOST_TICKS)
    stations = step * np.arange(np.floor(length / step * (1.0 + 1e-12)) + 1.0)
    line = shapely.LineString(preview.course)
    hair = length * 1e-6
    ends = [np.clip(stations + d, 0.0, length) for d in (-hair, hair)]
    before, after = (shapely.get_coordinates(shapely.line_interpolate_point(line, e)) for e in ends)
    direction = after - before
    direction /= np.maximum(np.hypot(*direction.T), np.finfo(float).tiny)[:, None]
    point = shapely.get_coordinates(shapely.line_interpolate_point(line, stations))
    return point, np.stack((-direction[:, 1], direction[:, 0]), axis=1), stations


def _route(axis: Any, route: Route) -> None:
    """Solid in the safe area, dashed elsewhere; the colours of those that share it take turns."""
    colours = list(dict.fromkeys(hexed(robot_colour(i)) for i in route.robots))
    count = len(colours)
    on, off = DASH
    times = int(TURN // (on + off))
    rest = TURN - times * (on + off) + off + (count - 1) * TURN
    dashes = [*[on, off] * (times - 1), on, rest] if count > 1 else [on, off]
    for k, colour in enumerate(colours):
        solid = "-" if count == 1 else (-k * TURN, (TURN, (count - 1) * TURN))
        style = {"colors": colour, "linewidths": 1.15, "capstyle": "butt", "zorder": 2.3}
        add_lines(axis, route.safe, linestyles=[solid], gid=f"safe path {route.robots[0]}", **style)
        add_lines(axis, route.danger, linestyles=[(-k * TURN if count > 1 else 0.0, dashes)],
               gid=f"danger path {route.robots[0]}", **style)  # fmt: skip


def _routes_alike(axis: Any, routes: Sequence[Route]) -> None:
    """Paths of a crowd, all in one colour: solid in the safe area, dashed elsewhere."""
    style = {"colors": TOGETHER, "linewidths": 0.5, "capstyle": "butt", "zorder": 2.3}
    safe = [piece for route in routes for piece in route.safe]
    danger = [piece for route in routes for piece in route.danger]
    add_lines(axis, safe, gid="safe paths", **style)
    add_lines(axis, danger, linestyles=[(0.0, DASH)], gid="danger paths", **style)


def _narrowest(axis: Any, preview: Contents) -> None:
    """The shortest segments to both sides at the narrowest place."""
    k = preview.widths.narrowest
    if k is None:
        return
    bar = [preview.widths.left_foot[k], preview.widths.point[k], preview.widths.right_foot[k]]
    add_lines(axis, [np.array(bar)], colors=WIDTHS, linewidths=1.8, zorder=3.3, gid="narrowest")
    axis.plot(*np.array(bar)[[0, 2]].T, "o", color=WIDTHS, markersize=3.4, zorder=3.3)


def _stops(axis: Any, scene: SceneModel) -> None:
    crowd = is_crowd(scene)
    edges = TOGETHER if crowd else list(map(hexed, scene.colours))
    size, line = (3.0, 0.4) if crowd else (17.0, 1.1)
    axis.scatter(*scene.stops.T, s=size, marker="s", facecolors="white", edgecolors=edges,
                 linewidths=line, zorder=3.4, gid="stops")  # fmt: skip


def _robots(axis: Any, scene: SceneModel) -> None:
    """Robots at the start, in their colours; a crowd in one, without what would hide others."""
    crowd, scale = is_crowd(scene), points_a_metre(axis)
    colours = np.array([TOGETHER] * scene.robots if crowd else list(map(hexed, scene.colours)))
    add_bodies(axis, scene.starting, facecolors=colours, edgecolors=INK,
               linewidths=0.0 if crowd else 0.5, zorder=4.0, gid="robots")  # fmt: skip
    place, heading = scene.start[:, :2], scene.start[:, 2]
    small = scene.reach * scale < SMALL
    if crowd:
        axis.scatter(*place[small].T, s=DOT**2, c=TOGETHER, linewidths=0.0, zorder=4.2, gid="dots")
        if small.all():
            return
    direction = np.column_stack((np.cos(heading), np.sin(heading)))
    tip = place + direction * (scene.reach + (0.0 if crowd else STALK / scale))[:, None]
    add_lines(axis, np.stack((place, tip), axis=1), colors=INK, linewidths=0.4 if crowd else 1.1,
              zorder=4.1, gid="headings")  # fmt: skip
    if not crowd:
        rings = {"facecolors": "none", "edgecolors": colours[small], "linewidths": 1.0}
        axis.scatter(*place[small].T, s=(4.0 * SMALL) ** 2, zorder=4.2, gid="rings", **rings)


def is_crowd(scene: SceneModel) -> bool:
    """Whether robots and paths are drawn alike, in one colour."""
    return scene.robots > NAMED
