"""Width of the corridor along the first robot's path, with its shortest segments (Fig. 4)."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.metrics import Width, corridor_width
from physim.metrics.width import width_extreme
from physim.plots.frame import framed, legend_beside, mark, nothing, short
from physim.plots.ground import add_lines, draw_ground
from physim.plots.style import INK, QUIET, WIDTH, WIDTHS
from physim.plots.trajectories import frame_map
from physim.record import Record
from physim.scene_model import SceneModel

MOST_SEGMENTS = 90
"""Places on the map at which the shortest segments are drawn."""


def width(record: Record) -> Any:
    """Figure: a map with the shortest segments to both sides above the width over the station."""
    figure = framed(record, "Corridor width", "Fig. 4", width=WIDTH, height=6.0)
    above, below = figure.subplots(2, 1, height_ratios=(3, 1))
    if not record.robots:
        nothing(above, "no robot")
        nothing(below, "no robot")
        return figure
    name = short(record.names[0])
    scene = SceneModel.of_record(record)
    tall = frame_map(above, scene, record, 4.6, 4.6)
    figure.set_size_inches(WIDTH, tall + 1.9)
    below.get_subplotspec().get_gridspec().set_height_ratios((tall, 1.4))
    found = corridor_width(record, 0)
    handles = draw_ground(above, scene, 1.1)
    handles += _segments(above, found)
    handles += above.plot(*scene.paths[0].T, color=INK, linewidth=1.2, label=f"path of {name}")
    below.set(xlabel=f"station along the path of {name} [m]", ylabel="width [m]")
    below.set_xlim(0.0, found.station[-1])
    ends = [width_extreme(found, 0, largest) for largest in (False, True)]
    if not np.isfinite(found.width).any():
        nothing(below, "nowhere between two walls")
        return figure
    below.plot(found.station, found.width, color=INK, linewidth=1.1)
    between = found.width[np.isfinite(found.width)]
    below.set_ylim(0.0, 1.3 * float(between.max()))
    if len(between) < len(found.width):
        apart = [np.hypot(*(feet - found.points).T) for feet in (found.left, found.right)]
        dots = below.plot(found.station, apart[0] + apart[1], ":", color=INK, linewidth=0.8)
        dots[0].set_label("walls not abreast")
        below.legend(handles=dots, loc="upper right", frameon=False)
    for end, word, colour in zip(ends, ("least", "greatest"), (WIDTHS, INK), strict=True):
        if end is not None:
            text = f"{word} {end.value:.2f} m"
            mark(below, end.station, end.value, text, below=word == "least", colour=colour)
            handles += _extreme(above, found, end.station, f"{text}", colour)
    legend_beside(figure, handles)
    return figure


def _segments(axis: Any, found: Width) -> list[Any]:
    """Shortest segments to the left and to the right at evenly spread places."""
    rows = np.unique(np.linspace(0, len(found.station) - 1, MOST_SEGMENTS).astype(int))
    handles = []
    for feet, colour, label in (
        (found.left, WIDTHS, "shortest to the left"),
        (found.right, QUIET, "shortest to the right"),
    ):
        pieces = np.stack((found.points[rows], feet[rows]), axis=1)
        counts = np.isfinite(pieces).all(axis=(1, 2)) & ~np.isnan(found.width[rows])
        handles.append(add_lines(axis, pieces[counts], color=colour, linewidth=0.7, label=label))
    return handles


def _extreme(axis: Any, found: Width, station: float, label: str, colour: str) -> list[Any]:
    """The two segments at the narrowest or widest place, thick."""
    k = int(np.argmin(np.abs(found.station - station)))
    points = np.array([found.left[k], found.points[k], found.right[k]])
    return list(axis.plot(*points.T, color=colour, linewidth=2.4, label=label, zorder=4))
