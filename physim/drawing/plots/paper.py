"""Figures fitted into a paper: at the width they are printed with, and without a title."""

from __future__ import annotations

from collections.abc import Callable
from operator import itemgetter
from typing import Any

from physim.drawing.plots.frame import clear_marks, in_rows, legend_below

LEAST, MOST = 2.0, 20.0
"""[in] of a width"""
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
        clear_marks(figure)
    return figure


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
    """Put each legend of the figure below it, in as many columns as there is room for."""
    for legend in list(figure.legends):
        handles = _entries(legend)
        legend.remove()
        for handle in handles:
            handle.set_label(handle.get_label().replace("\n", " "))
        for columns in range(min(len(handles), 5), 0, -1):
            legend_below(figure, handles, columns)
            below = figure.legends[-1]
            figure.draw_without_rendering()
            if columns == 1 or below.get_window_extent().width <= 0.97 * figure.bbox.width:
                break
            below.remove()


def _entries(legend: Any) -> list[Any]:
    """Handles of a legend in the order of reading, each with its label."""
    handles = list(legend.legend_handles)
    for handle, text in zip(handles, legend.get_texts(), strict=True):
        handle.set_label(text.get_text())
    columns = (legend.get_gid() or "").partition("columns ")[2]
    if not columns:
        return handles
    order = in_rows(len(handles), int(columns))
    return [handle for _, handle in sorted(zip(order, handles, strict=True), key=itemgetter(0))]


def _shortened(figure: Any) -> None:
    """Where the source is wider than the figure, leave out with what to compare."""
    figure.draw_without_rendering()
    for text in figure.texts:
        if text.get_gid() == "source" and text.get_window_extent().x0 < 0.0:
            text.set_text(text.get_text().partition(";")[0])
