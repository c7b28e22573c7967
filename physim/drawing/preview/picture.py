"""One picture of a world before it is run: the map, the width profile, words about both, and
the key of what each mark means.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

from physim.drawing import palette
from physim.drawing.labels import round_step, shortened, significant
from physim.drawing.palette import hexed
from physim.drawing.plots.frame import clear_marks
from physim.drawing.plots.style import INK, QUIET, WIDTHS, save_figure
from physim.drawing.preview.contents import Contents, contents, counts, drawable, families
from physim.drawing.preview.ground_plan import DASH, MOST_TICKS, TOGETHER, draw_map, is_crowd
from physim.drawing.preview.lettering import text_size
from physim.drawing.preview.profile import draw_profile
from physim.errors import PhysimError
from physim.parts.declarations import Declared
from physim.parts.registry import CONTROLLER, make_part
from physim.world.scene import Layout

PATH = 1.15
"""[pt]"""


def draw_key(axis: Any, preview: Contents, named: int) -> None:
    """Draw the key; ``named`` robots have their names on the map."""
    axis.set_axis_off()
    handles, meanings = zip(*(*_areas(preview), *_paths(preview), *_marks(preview)), strict=True)
    axis.legend(
        handles, meanings, loc="upper left", borderaxespad=0.0, handlelength=2.4, labelspacing=0.75,
        fontsize=8.2,
    )  # fmt: skip
    if named < len(preview.scene.names):
        words = f"{named:,} of {len(preview.scene.names):,} names are on the map"
        axis.text(0.0, 0.0, words, fontsize=8.0, color=QUIET)


def _areas(preview: Contents) -> Iterator[tuple[Any, str]]:
    for area in reversed(preview.scene.areas):
        near = f": within L = {significant(preview.scene.safe_distance)} m"
        yield _area(area.colour), area.name + near * (area.colour == palette.DANGER_AREA)
    yield _line(color=hexed(palette.WALL), linewidth=1.6), "boundary"
    if preview.scene.obstacles:
        yield _area(palette.OBSTACLE, palette.WALL), "obstacle"


def _paths(preview: Contents) -> Iterator[tuple[Any, str]]:
    step = round_step(preview.course_length, MOST_TICKS)
    crowd, alone = is_crowd(preview.scene), len(preview.scene.names) == 1
    yield _line(color=hexed(palette.REFERENCE), linewidth=2.6, alpha=0.55), "reference path"
    ticks = _line(color=QUIET, linewidth=0.0, marker="|", markersize=7.0)
    yield ticks, f"stations, every {step:,g} m"
    first, second = (hexed(palette.robot_colour(i)) for i in (0, 1))
    first = TOGETHER if crowd else first
    words = "paths of all robots" if crowd else f"path of {'the' if alone else 'a'} robot"
    yield _line(color=first, linewidth=PATH), words
    if any(route.danger for route in preview.routes):
        dash = (0.0, tuple(length / PATH for length in DASH))
        yield _line(color=first, linewidth=PATH, linestyle=dash), "path in the danger area"
    if not crowd and any(len(route.robots) > 1 for route in preview.routes):
        turns = _line(color=first, gapcolor=second, linewidth=PATH, linestyle=(0.0, (5.0, 5.0)))
        yield turns, "path that robots share"


def _marks(preview: Contents) -> Iterator[tuple[Any, str]]:
    if is_crowd(preview.scene):
        yield _mark("s", 2.0, "white", TOGETHER, 0.4), "stop stations"
        yield (
            _mark("o", 2.4, TOGETHER, TOGETHER, 0.0),
            f"{preview.scene.robots:,} robots at the start",
        )
    else:
        colour = hexed(palette.robot_colour(0))
        yield _mark("s", 4.2, "white", colour, 1.1), "stop station"
        yield _mark((3, 0, -90), 7.0, colour, INK, 0.5), "robot at the start, heading"
    if preview.widths.narrowest is not None:
        yield (
            _line(color=WIDTHS, linewidth=1.8, marker="o", markersize=3.4),
            "narrowest place",
        )
    if preview.boundary_widths is not None:
        quiet = _line(color=QUIET, linewidth=0.9, linestyle="--")
        yield quiet, "width without obstacles"
    if not preview.widths.between.all():
        yield _line(color=WIDTHS, linewidth=0.8, linestyle=":"), "width, walls not abreast"


def _area(colour: palette.Colour, edge: palette.Colour = palette.RULE) -> Any:
    from matplotlib.patches import Patch

    return Patch(facecolor=hexed(colour), edgecolor=hexed(edge), linewidth=0.7)


def _line(**style: Any) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], **style)


def _mark(marker: Any, size: float, face: str, edge: str, width: float) -> Any:
    return _line(
        linestyle="", marker=marker, markersize=size, markerfacecolor=face, markeredgecolor=edge,
        markeredgewidth=width,
    )  # fmt: skip


FORMATS = ("png", "svg")
SIZE = (11.0, 9.0)
"""[in]"""
DPI = 150
MAP = (0.075, 0.315, 0.68, 0.57)
PROFILE = (0.075, 0.065, 0.68, 0.175)
KEY = (0.772, 0.315, 0.218, 0.57)
"""left, bottom, width, height as shares of the picture: the same for every world"""


def make_figure(preview: Contents, format: str = "png") -> Any:
    """Figure of a world; call it within `physim.drawing.plots.style.styled`."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    fonts, signs = families(preview)
    matplotlib.rcParams["font.family"] = fonts
    figure = Figure(figsize=SIZE, dpi=DPI)
    FigureCanvasAgg(figure)
    _title(figure, preview)
    plan = figure.add_axes(MAP)
    known = None if format == "svg" else signs  # who looks at an SVG has fonts of their own
    names = [drawable(name, i, known) for i, name in enumerate(preview.scene.names)]
    named = draw_map(plan, preview, names)
    draw_profile(figure.add_axes(PROFILE), preview)
    draw_key(figure.add_axes(KEY), preview, named)
    clear_marks(figure)
    return figure


def preview_of(layout: Layout, trusted: bool = False) -> Contents:
    """The preview of a world, with the modes of its controller and the L that it keeps."""
    choice = layout.world.controller
    controller = make_part(CONTROLLER, choice.type, choice.settings, trusted=trusted)
    settings = getattr(controller, "settings", None)
    safe_distance = float(getattr(settings, "safe_distance", 0.0))
    return contents(layout, Declared.of(controller).modes, safe_distance)


def _title(figure: Any, preview: Contents) -> None:
    lines = [(preview.scene.name, 13.0, "bold", INK), (counts(preview), 9.0, "normal", QUIET)]
    if preview.description.strip():
        lines.insert(1, (preview.description, 9.0, "normal", INK))
    for k, (text, size, weight, colour) in enumerate(lines):
        cut = shortened(text, partial(_has_room, figure, size, weight))
        figure.text(
            0.03, (0.968, 0.938, 0.912)[k], cut, fontsize=size, fontweight=weight, color=colour,
            va="center",
        )  # fmt: skip


def _has_room(figure: Any, size: float, weight: str, text: str) -> bool:
    return text_size(figure, text, size, weight)[0] <= 0.94 * 72.0 * SIZE[0]


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
            path,
            format,
            lambda: make_figure(preview_of(layout, trusted), format),
            dpi=DPI,
            **options,
        )
    except OSError as error:
        raise PhysimError(f"{path}: cannot be written ({error.strerror})") from None
