"""Times beside the snapshots of a map: where they stand, and which are left out."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.drawing.plots.style import INK
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record

AWAY = 15.0
"""[pt] from the robots to the middle of a time"""
TRIED = ((1.0, 0.0), (1.0, 1.2), (1.0, -1.2), (1.9, 0.0), (1.9, 1.2), (1.9, -1.2))
"""Places of a time, to the side and along the way, in times of that, the best first"""
UP = np.array([0.0, 1.0])


def write_times(axis: Any, record: Record, at: IntArray) -> None:
    """Write the time of each of the samples ``at`` left of its robots as they go."""
    wide = float(np.ptp(axis.get_xlim()))
    for row in at:
        group = _group(record.pose[row, :, :2], 0.1 * wide)
        places = record.pose[row, group, :2]
        middle = np.median(places, axis=0)
        around = np.clip([row - record.samples // 100, row + record.samples // 100], 0, None)
        ends = np.median(record.pose[np.minimum(around, record.samples - 1)][:, group, :2], axis=1)
        ahead = np.hypot(*(ends[1] - ends[0]))
        left = np.array([-1.0, 1.0]) * (ends[1] - ends[0])[::-1] / ahead if ahead > 0.0 else UP
        beside = float(((places - middle) @ left).max())
        time = float(record.time[row])
        said = f"{time:.3g} s" if time < 999.5 else f"{time:.0f} s"
        axis.annotate(
            said, middle + beside * left, xytext=tuple(AWAY * left),
            textcoords="offset points", ha="center", va="center", fontsize=7.5, color=INK,
            zorder=6, gid="time",
            bbox={"boxstyle": "square,pad=0.1", "fc": "white", "alpha": 0.75, "linewidth": 0},
        )  # fmt: skip


def _group(places: FloatArray, near: float) -> NDArray[np.bool_]:
    """Robots (N,) beside which a time is written: those about the middle of all, or, where these
    are few since robots come from several sides, the first robot and those about it."""
    middle, first = (
        np.asarray(np.hypot(*(places - about).T) <= near)
        for about in (np.median(places, axis=0), places[0])
    )
    return middle if np.count_nonzero(middle) >= len(places) / 4.0 else first


def clear_times(figure: Any) -> None:
    """Move times that lie over others, over obstacles or the edge; leave out those without a place.

    To be called when the figure has its size.
    """
    if not any(text.get_gid() == "time" for axis in figure.axes for text in axis.texts):
        return
    figure.draw_without_rendering()
    for axis in figure.axes:
        solid = [
            patch.get_transform().transform_path(patch.get_path())
            for patch in axis.patches
            if patch.get_gid() == "obstacles"
        ]
        kept: list[Any] = []
        room = axis.get_window_extent()
        for text in [one for one in axis.texts if one.get_gid() == "time"]:
            aside = np.array(text.xyann)
            along = np.array([aside[1], -aside[0]])
            for across, ahead in TRIED:
                text.xyann = tuple(across * aside + ahead * along)
                box = text.get_window_extent()
                is_inside = room.x0 <= box.x0 and box.x1 <= room.x1 and room.y0 <= box.y0
                is_inside &= box.y1 <= room.y1
                covers = any(path.intersects_bbox(box, filled=True) for path in solid)
                if is_inside and not covers and not any(box.overlaps(one) for one in kept):
                    kept.append(box)
                    break
            else:
                text.remove()
