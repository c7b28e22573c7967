"""Figures fitted into a paper: at the width they are printed with, and without a title."""

from __future__ import annotations

from collections.abc import Callable
from operator import itemgetter
from typing import Any

from physim.drawing.plots.frame import ROW, clear_marks, in_rows, legend_below
from physim.drawing.plots.times import clear_times

SLENDER = 4.5
"""[in] below which a legend stands below, not beside"""


def fitted(make: Callable[[], Any], title: bool, width: float | None) -> Any:
    """Return the figure that ``make()`` gives, ``width`` [in] wide, with a title or without.

    Its writing keeps its size, and its height where it gets narrower at least nine tenths.
    """
    figure = make()
    if not title:
        _untitled(figure)
    if width is not None:
        before, high = figure.get_size_inches()
        figure.set_size_inches(width, high * max(width / before, 0.9))
        if width < SLENDER:
            _legends_below(figure)
        if title:
            _shortened(figure)
        _cut_to_map(figure)
        clear_marks(figure)
    clear_times(figure)
    return figure


def _cut_to_map(figure: Any) -> None:
    """Take off the height that a map, of which x and y have one scale, leaves free."""
    figure.draw_without_rendering()
    free = [
        axis.get_position(original=True).height - axis.get_tightbbox().height / figure.bbox.height
        for axis in figure.axes
        if axis.get_aspect() != "auto"
    ]
    wide, high = figure.get_size_inches()
    figure.set_size_inches(wide, high * (1.0 - max([0.0, *free])))


def _untitled(figure: Any) -> None:
    """Take away what a caption says: title and source; their room goes to the axes."""
    head = figure.get_suptitle()
    for text in figure.texts:
        if text.get_gid() == "source" or (head and text.get_text() == head):
            text.set_visible(False)
            text.set_in_layout(False)
    engine = figure.get_layout_engine()
    if engine is not None and hasattr(engine, "set"):
        engine.set(rect=(0.0, 0.0, 1.0, 1.0))


def _legends_below(figure: Any) -> None:
    """Put each legend of the figure below it, in as many columns as there is room for.

    The figure grows by its rows.
    """
    lifted = any(
        text.get_gid() == "source" and text.get_visible() and text.get_va() == "bottom"
        for text in figure.texts
    )
    for legend in list(figure.legends):
        handles = _entries(legend)
        columns = _columns(legend)
        before = -(-len(handles) // columns) if columns else 0
        legend.remove()
        broken = [handle.get_label() for handle in handles]
        for handle, label in zip(handles, broken, strict=True):
            handle.set_label(label.replace("\n", " "))
        rows = legend_below(figure, handles, min(len(handles), 5), lifted)
        if figure.legends[-1].get_window_extent().width > figure.bbox.width:
            figure.legends[-1].remove()
            for handle, label in zip(handles, broken, strict=True):
                handle.set_label(label)
            legend_below(figure, handles, 1, lifted)
            rows = sum(label.count("\n") + 1 for label in broken)
        wide, high = figure.get_size_inches()
        figure.set_size_inches(wide, high + ROW * (rows - before))


def _columns(legend: Any) -> int:
    """Columns of a legend below a figure; 0 of one beside it."""
    return int((legend.get_gid() or "").partition("columns ")[2] or 0)


def _entries(legend: Any) -> list[Any]:
    """Handles of a legend in the order of reading, each with its label."""
    handles = list(legend.legend_handles)
    for handle, text in zip(handles, legend.get_texts(), strict=True):
        handle.set_label(text.get_text())
    columns = _columns(legend)
    if not columns:
        return handles
    order = in_rows(len(handles), columns)
    return [handle for _, handle in sorted(zip(order, handles, strict=True), key=itemgetter(0))]


def _shortened(figure: Any) -> None:
    """Where the source has no room, leave out with what to compare, then letters of the name."""
    figure.draw_without_rendering()
    head = figure._suptitle.get_window_extent()
    for text in figure.texts:
        if text.get_gid() != "source":
            continue
        least = head.x1 if text.get_window_extent().overlaps(head) else 0.0
        if text.get_window_extent().x0 < least:
            text.set_text(text.get_text().partition(";")[0])
        name, comma, seed = text.get_text().rpartition(",")
        while len(name) > 4 and text.get_window_extent().x0 < least:
            name = name[:-2].rstrip("\u2026 ") + "\u2026"
            text.set_text(f"{name}{comma}{seed}")
