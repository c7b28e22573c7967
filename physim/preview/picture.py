"""One picture of a world before it is run: the map, the width profile, words about both."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path
from typing import Any

from physim.declared import Declared
from physim.errors import PhysimError
from physim.labels import shortened
from physim.plots.style import INK, QUIET, save_figure
from physim.preview.contents import Contents, contents
from physim.preview.ground_plan import draw_map
from physim.preview.key import draw_key
from physim.preview.lettering import text_size
from physim.preview.profile import draw_profile
from physim.preview.words import counts, drawable, families
from physim.registry import CONTROLLER, make_part
from physim.scene import Layout

FORMATS = ("png", "svg")
SIZE = (11.0, 9.0)
"""[in]"""
DPI = 150
MAP = (0.075, 0.315, 0.68, 0.57)
PROFILE = (0.075, 0.065, 0.68, 0.175)
KEY = (0.772, 0.315, 0.218, 0.57)
"""left, bottom, width, height as shares of the picture: the same for every world"""


def make_figure(shown: Contents, format: str = "png") -> Any:
    """Figure of a world; call it within `physim.plots.style.styled`."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    fonts, signs = families(shown)
    matplotlib.rcParams["font.family"] = fonts
    figure = Figure(figsize=SIZE, dpi=DPI)
    FigureCanvasAgg(figure)
    _title(figure, shown)
    plan = figure.add_axes(MAP)
    known = None if format == "svg" else signs  # who looks at an SVG has fonts of their own
    names = [drawable(name, i, known) for i, name in enumerate(shown.scene.names)]
    named = draw_map(plan, shown, names)
    draw_profile(figure.add_axes(PROFILE), shown)
    draw_key(figure.add_axes(KEY), shown, named)
    return figure


def shown_of(layout: Layout) -> Contents:
    """What to show of a world, with the modes of its controller and the L that it keeps."""
    choice = layout.world.controller
    controller = make_part(CONTROLLER, choice.type, choice.settings)
    settings = getattr(controller, "settings", None)
    safe_distance = float(getattr(settings, "safe_distance", 0.0))
    return contents(layout, Declared.of(controller).modes, safe_distance)


def _title(figure: Any, shown: Contents) -> None:
    lines = [(shown.scene.name, 13.0, "bold", INK), (counts(shown), 9.0, "normal", QUIET)]
    if shown.description.strip():
        lines.insert(1, (shown.description, 9.0, "normal", INK))
    for k, (text, size, weight, colour) in enumerate(lines):
        cut = shortened(text, partial(_has_room, figure, size, weight))
        figure.text(
            0.03, (0.968, 0.938, 0.912)[k], cut, fontsize=size, fontweight=weight, color=colour,
            va="center",
        )  # fmt: skip


def _has_room(figure: Any, size: float, weight: str, text: str) -> bool:
    return text_size(figure, text, size, weight)[0] <= 0.94 * 72.0 * SIZE[0]


def save_preview(layout: Layout, path: str | os.PathLike[str]) -> None:
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
        save_figure(path, format, lambda: make_figure(shown_of(layout), format), dpi=DPI, **options)
    except OSError as error:
        raise PhysimError(f"{path}: cannot be written ({error.strerror})") from None
