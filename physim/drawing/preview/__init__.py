"""A picture of a world before it is run, from the world alone: the map and the width along the
first robot's path, as `physim plot` draws them of a run. No kernel is called, and matplotlib is
loaded late.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.drawing import palette
from physim.drawing.labels import shortened, significant, spread
from physim.drawing.palette import hexed
from physim.drawing.plots.frame import settle_marks
from physim.drawing.plots.map import draw_start, draw_widths
from physim.drawing.plots.style import INK, QUIET, families, save_figure
from physim.drawing.scene_model import SceneModel, closed, pieces_of
from physim.errors import PhysimError, plural
from physim.geometry.polygon import least_width
from physim.geometry.shapes import FloatArray
from physim.parts.declarations import Declared, kept_distance
from physim.parts.registry import made_controller
from physim.simulation.team import driving, united
from physim.world.ground.corridor import SIDES, Widths, sampled_widths, width_spacing
from physim.world.layout.scene_builder import is_random
from physim.world.layout.shape_checks import corners_of_line
from physim.world.scene import Layout

FORMATS = ("png", "svg")
SIZE = (11.0, 9.0)
"""[in]"""
DPI = 150
MAP = (0.075, 0.315, 0.68, 0.57)
PROFILE = (0.075, 0.065, 0.68, 0.175)
KEY = (0.77, 0.885)
"""left, bottom, width, height as shares of the picture, the same for every world; and the upper
left corner of the legend"""
PLACES = 600
"""Stations at which the width is worked out at least, besides every waypoint: as close as in a
record."""
LONGEST_NAME = 24
"""Characters of the name of a robot"""


@dataclass(frozen=True)
class Contents:
    """Everything that a preview shows; world frame [m]."""

    scene: SceneModel
    lines: tuple[str, ...]
    """what is written above: the name of the world, its description, figures about it"""
    course: FloatArray
    """(n, 2) path of the first robot, along which stations and widths are (Fig. 4), as of a run"""
    widths: Widths
    """between boundaries and obstacles"""
    boundary_widths: Widths | None
    """between the boundaries alone, where there are obstacles too"""


def preview_of(layout: Layout, trusted: bool = False) -> Contents:
    """What a preview shows of a world, with the modes of its controller and the L that it keeps."""
    world = layout.world
    controller = united(driving(world, made_controller(world, trusted)))
    safe_distance = kept_distance(controller)
    scene = SceneModel.of_layout(layout, Declared.of(controller).modes, safe_distance)
    # the two walls of a corridor without its caps; of another world all boundaries
    sides, walls = _segments(layout.boundaries.values()), None
    if world.corridor is not None:
        left, right = (_segments([layout.boundaries[side]]) for side in SIDES)
        sides, walls = _segments([]), (left, right)
    rings = _segments(map(closed, scene.obstacles))
    course = corners_of_line(scene.paths[0])
    length = float(shapely.LineString(course).length)
    places = max(PLACES, int(length / width_spacing(length)) + 2)
    widths = sampled_widths(course, np.concatenate((sides, rings)), places, walls)
    alone = sampled_widths(course, sides, places, walls) if len(rings) else None
    words = [plural(scene.robots, "robot"), plural(len(scene.boundaries), "boundary", "boundaries")]
    if scene.obstacles:
        words.append(plural(len(scene.obstacles), "obstacle"))
    if layout.pushed:
        words.append(plural(len(layout.pushed), "obstacle to push", "obstacles to push"))
    if world.movers:
        words.append(plural(len(world.movers), "mover"))
    reference = shapely.LineString(corners_of_line(scene.reference))
    words.append(f"reference path {significant(reference.length, 4)} m")
    if is_random(world):
        what = "road and start" if world.is_road_random else "start"
        words.append(f"{what} drawn with seed {scene.seed}")
    lines = (scene.name, world.description.strip(), "  ·  ".join(words))
    return Contents(scene, tuple(filter(None, lines)), course, widths, alone)


def _segments(lines: Iterable[FloatArray]) -> FloatArray:
    """(S, 4) segments ax, ay, bx, by of polylines (n, 2)."""
    return pieces_of(lines).reshape(-1, 4)


def make_figure(seen: Contents, format: str = "png") -> Any:
    """Figure of a world; call it within `physim.drawing.plots.style.styled`."""
    import matplotlib
    from matplotlib.figure import Figure

    scene = seen.scene
    called = *scene.names, *scene.moved_names
    fonts, signs = families("".join((*seen.lines, *called)))
    matplotlib.rcParams["font.family"] = fonts
    figure = Figure(figsize=SIZE, dpi=DPI)
    for k, words in enumerate(seen.lines):
        size, weight = (13.0, "bold") if not k else (9.0, "normal")
        colour = INK if k < len(seen.lines) - 1 else QUIET
        line = figure.text(0.03, (0.968, 0.938, 0.912)[k], "", fontsize=size, fontweight=weight,
                           color=colour, va="center")  # fmt: skip

        def fits(cut: str, line: Any = line) -> bool:
            line.set_text(cut)
            return bool(line.get_window_extent().x1 <= 0.97 * figure.bbox.width)

        line.set_text(shortened(words, fits))
    names = [shortened(name, LONGEST_NAME) for name in called]
    if format != "svg":  # who looks at an SVG has fonts of their own
        names = [
            n if signs.issuperset(map(ord, n)) else f"{body.kind} {body.id + 1}"
            for n, body in zip(names, scene.bodies, strict=False)
        ]
    above, below = figure.add_axes(MAP), figure.add_axes(PROFILE)
    for side in above.spines.values():
        side.set_visible(True)
    handles = draw_start(above, scene, names, seen.course, seen.widths)
    handles += draw_widths(above, below, seen.widths, "the first robot")
    if seen.boundary_widths is not None:
        other = seen.boundary_widths
        alone = np.where(other.between, other.width, np.nan)
        handles += below.plot(other.station, alone, "--", color=QUIET, linewidth=0.9,
                              label="width without obstacles")  # fmt: skip
    _needs(below, seen)
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=KEY, borderaxespad=0.0,
                  handlelength=2.4, labelspacing=0.75, fontsize=8.2)  # fmt: skip
    settle_marks(figure)
    return figure


def _needs(axis: Any, seen: Contents) -> None:
    """Areas below the width, and lines of what the robots need, named at their right ends."""
    scene, station, width = seen.scene, seen.widths.station, seen.widths.width
    turning = 2.0 * float(scene.reach.max())
    aligned = max(least_width(outline) for outline in scene.outlines)
    levels = [
        (turning, "every robot fits at any heading", INK, (0, (5, 2))),
        (aligned, "every robot fits if aligned", INK, (0, (1, 1.5))),
    ]
    needed = 2.0 * scene.safe_distance
    if needed:
        levels.append((needed, "= 2L: no safe area below", QUIET, (0, (7, 2))))
    levels.sort()
    finite = np.isfinite(width)
    top = 1.12 * max(width[finite].max(initial=0.0), *(level for level, *_ in levels))
    axis.set_ylim(0.0, top)
    floor = palette.SAFE_AREA if needed else palette.FLOOR
    under = np.where(finite, width, top)
    for where, colour in ((np.ones_like(finite), floor), (width < needed, palette.DANGER_AREA)):
        axis.fill_between(station, 0.0, under, where=where, color=hexed(colour), linewidth=0.0)
    high = axis.figure.get_size_inches()[1] * axis.get_position().height * 72.0
    wanted = spread(np.array([level for level, *_ in levels]), 10.5 * top / high, 0.0, top)
    beside = axis.get_yaxis_transform()
    for (level, words, colour_, dash), place in zip(levels, wanted, strict=True):
        axis.axhline(level, color=colour_, linewidth=1.0, linestyle=dash)
        axis.annotate(
            f"{significant(level)} m  {words}", (1.0, level), (1.012, place),
            xycoords=beside, textcoords=beside, color=colour_, fontsize=7.8, va="center",
            annotation_clip=False,
            arrowprops={
                "arrowstyle": "-", "color": colour_, "linewidth": 0.6, "shrinkA": 0.5,
                "shrinkB": 0.0, "relpos": (0.0, 0.5), "clip_on": False,
            },
        )  # fmt: skip


def save_preview(layout: Layout, path: str | os.PathLike[str], trusted: bool = False) -> None:
    """Draw a world as PNG or SVG, by the ending of ``path``: whole or not at all.

    The same world gives the same file. Raises PhysimError for another ending and where the file
    cannot be written.
    """
    path = Path(path)
    format = path.suffix[1:].lower()
    if format not in FORMATS:
        raise PhysimError(f"{path}: pictures end in .png or .svg")
    options = {"pil_kwargs": {"compress_level": 1}} if format == "png" else {}
    try:
        save_figure(
            path, format, lambda: make_figure(preview_of(layout, trusted), format), dpi=DPI,
            **options,
        )  # fmt: skip
    except OSError as error:
        raise PhysimError(f"{path}: cannot be written ({error.strerror})") from None
