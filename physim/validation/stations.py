"""The stations of decisions against the poses: each robot is followed along the paths anew.

Who was ahead, and so who had to keep clear, is read from these columns.
"""

from __future__ import annotations

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.geometry.tracking import Tracking
from physim.record import Record
from physim.validation.findings import DEPTH_SLACK, UNEXPLAINED, Disagreement
from physim.validation.ledger import blocks, robot_shapes

COLUMNS = {
    "station": "station on its path",
    "deviation": "deviation from its path",
    "reference_station": "station on the reference path",
}


def stations(record: Record) -> list[Disagreement]:
    """Decisions whose stations or deviations are not those of the poses: one a robot and column."""
    rows = record.updates
    exact = _exact(record)
    found = []
    for k, (column, what) in enumerate(COLUMNS.items()):
        told, true = rows[column], exact[:, k]
        wrong = np.isfinite(told) & (np.abs(told - true) > DEPTH_SLACK)
        for i in np.unique(rows["robot"][wrong]).tolist():
            mine = np.flatnonzero(wrong & (rows["robot"] == i))
            first = int(mine[0])
            step = int(rows["step"][first])
            text = (
                f"{what} {told[first]:.9g} m in the record, {true[first]:.9g} m by its pose, at "
                f"{len(mine)} decision{'s' if len(mine) > 1 else ''}"
            )
            found.append(
                Disagreement(i, None, step, 1, step * record.dt, np.nan, UNEXPLAINED, text)
            )
    return found


def _exact(record: Record) -> FloatArray:
    """Station, deviation and reference station [m] at each decision (M, 3), from the poses."""
    rows, found = record.updates, np.full((len(record.updates), 3), np.nan)
    radius, tracking = robot_shapes(record).radius, None
    for poses, start in blocks(record):
        if tracking is None:
            tracking = Tracking(record.paths, record.reference, radius, poses[0])
        course = tracking.course(poses)  # the first is the last of the block before: it stays
        first, last = np.searchsorted(rows["step"], (start, start + len(poses)))
        found[first:last] = course[rows["step"][first:last] - start, rows["robot"][first:last]]
    return found
