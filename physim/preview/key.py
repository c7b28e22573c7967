"""The key of a preview: what each mark means."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from physim import palette
from physim.labels import round_step, significant
from physim.palette import hexed
from physim.plots.style import INK, QUIET, WIDTHS
from physim.preview.contents import Contents
from physim.preview.ground_plan import DASH, MOST_TICKS

PATH = 1.15
"""[pt]"""


def draw_key(axis: Any, shown: Contents, named: int) -> None:
    """Draw the key; ``named`` robots have their names on the map."""
    axis.set_axis_off()
    handles, meanings = zip(*(*_ground(shown), *_paths(shown), *_marks(shown)), strict=True)
    axis.legend(
        handles, meanings, loc="upper left", borderaxespad=0.0, handlelength=2.4, labelspacing=0.75,
        fontsize=8.2,
    )  # fmt: skip
    if named < len(shown.scene.names):
        words = f"{named:,} of {len(shown.scene.names):,} names have room on the map"
        axis.text(0.0, 0.0, words, fontsize=8.0, color=QUIET)


def _ground(shown: Contents) -> Iterator[tuple[Any, str]]:
    for area in reversed(shown.scene.areas):
        near = f": within L = {significant(shown.scene.safe_distance)} m"
        yield _area(area.colour), area.name + near * (area.colour == palette.DANGER_AREA)
    yield _line(color=hexed(palette.WALL), linewidth=1.6), "boundary"
    if shown.scene.obstacles:
        yield _area(palette.OBSTACLE, palette.WALL), "obstacle"


def _paths(shown: Contents) -> Iterator[tuple[Any, str]]:
    step = round_step(shown.length, MOST_TICKS)
    reference = _line(
        color=hexed(palette.REFERENCE), linewidth=2.6, alpha=0.55, marker="|",
        markeredgecolor=QUIET, markersize=7.0,
    )  # fmt: skip
    yield reference, f"reference path, ticks every {step:,g} m"
    first, second = (hexed(palette.robot_colour(i)) for i in (0, 1))
    alone = len(shown.scene.names) == 1
    yield _line(color=first, linewidth=PATH), f"path of {'the' if alone else 'a'} robot"
    if any(route.danger for route in shown.routes):
        dash = (0.0, tuple(length / PATH for length in DASH))
        yield _line(color=first, linewidth=PATH, linestyle=dash), "path in the danger area"
    if any(len(route.robots) > 1 for route in shown.routes):
        turns = _line(color=first, gapcolor=second, linewidth=PATH, linestyle=(0.0, (5.0, 5.0)))
        yield turns, "path that robots share"


def _marks(shown: Contents) -> Iterator[tuple[Any, str]]:
    colour = hexed(palette.robot_colour(0))
    yield _mark("s", 4.2, "white", colour, 1.1), "stop station"
    yield _mark((3, 0, -90), 7.0, colour, INK, 0.5), "robot at the start, heading"
    if shown.widths.narrowest is not None:
        yield (
            _line(color=WIDTHS, linewidth=1.8, marker="o", markersize=3.4),
            "narrowest place",
        )
    if shown.boundary_widths is not None:
        quiet = _line(color=QUIET, linewidth=0.9, linestyle="--")
        yield quiet, "width without obstacles"
    if not shown.widths.between.all():
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
