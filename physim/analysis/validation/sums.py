"""What sums up a run, held against the same run simulated again: extremes and arrivals."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.mismatch import SLACK, SLACKS, Mismatch, differs
from physim.geometry.separation import body_distance
from physim.record import Record
from physim.record.layout import ARRIVED, EXTREMES, EXTREMES_FARTHEST

BY = "simulated again"
BLOCK = 4096
"""Samples that are compared at a time."""
MOMENTS = {
    EXTREMES: (
        ("clearance", "clearance_step", None, "clearance_other"),
        ("boundary_clearance", "boundary_step", None, "boundary_other"),
    ),
    EXTREMES_FARTHEST: (("farthest", "step", "a", "b"),),
}
"""Columns of a distance, its step and its two bodies; None: the robot of the row"""


def sums(record: Record, again: Record, exact: bool) -> Iterator[Mismatch]:
    """Extremes and arrivals that are not those of a whole run.

    Those of a killed run were written one after the other, each not before its last sample.
    """
    for path, moments in MOMENTS.items():
        rows, others = (np.atleast_1d(one.read(path)) for one in (record, again))
        for columns in moments:
            stood: dict[int, bool] = {}
            for column in filter(None, columns):
                if not exact and rows[column].dtype.kind == "i":
                    continue
                wrong = unlike(rows[column], others[column], exact, column)
                for k in np.flatnonzero(wrong).tolist():
                    if k not in stood:
                        stood[k] = _stood(record, again, path, columns, k, rows[k], others[k])
                    if not stood[k]:
                        yield _mismatch(record, path, column, k, rows[column][k], others[column][k])
            for k in np.flatnonzero(rows[columns[1]] >= 0).tolist() if not exact else ():
                yield from _moment(record, again, path, columns, k, rows[k])
    wrong = record.arrived != again.arrived
    if record.ended == "running":
        wrong &= (record.arrived >= 0) | (again.arrived < record.steps_run)
    for k in np.flatnonzero(wrong)[:1].tolist():
        yield _mismatch(record, ARRIVED, None, k, record.arrived[k], again.arrived[k])


def _stood(
    record: Record, again: Record, path: str, columns: tuple[str, str, str | None, str], k: int,
    row: np.void, final: np.void,
) -> bool:  # fmt: skip
    """Whether an extreme of a killed run stood when it was written, and was exceeded later."""
    value, when, *_ = columns
    until = max(record.steps_run, int(row[when]))
    if record.ended != "running" or final[when] <= until or row[when] < 0:
        return False
    if path == EXTREMES:
        least = again.read(f"/steps/{value}", 0, until + 1)[:, k]
        if int(np.argmin(least)) != row[when] or least.min() != row[value]:
            return False
    elif row[value] > final[value]:
        return False
    return not any(_moment(record, again, path, columns, k, row))


def _moment(
    record: Record, again: Record, path: str, columns: tuple[str, str, str | None, str], k: int,
    row: np.void,
) -> Iterator[Mismatch]:  # fmt: skip
    """An extreme distance that was not that of its bodies at its step. Of equal ones another
    version may take either, so that they need not be those of the run simulated again."""
    value, when, me, other = columns
    step, a, b = int(row[when]), k if me is None else int(row[me]), int(row[other])
    pose, robots = again.read("/steps/pose", step, step + 1), again.robots
    if not len(pose):
        yield _mismatch(record, path, when, k, step, "after its end", step)
        return
    shapes, j, there = again.shapes, b, pose[0, min(b, robots - 1)]
    if b >= robots:
        shapes, j, there = again.walls, b - robots, np.zeros(3)
    true = body_distance(again.shapes, a, pose[0, a], shapes, j, there)
    if differs(np.asarray(row[value]), np.asarray(true), SLACK):
        yield _mismatch(record, path, value, k, row[value], f"{true:.9g} of these bodies", step)


def _mismatch(
    record: Record, path: str, column: str | None, k: int, told: Any, true: Any,
    step: int | None = None,
) -> Mismatch:  # fmt: skip
    robot = None if path == EXTREMES_FARTHEST else k
    return Mismatch.of(record, path, column, told, true, BY, row=k, robot=robot, step=step)


def bounds(record: Record, again: Record, until: int) -> Iterator[Mismatch]:
    """Extremes and arrivals that the run up to a step does not have."""
    rows = record.read(EXTREMES)
    for column, when in (("clearance", "clearance_step"), ("boundary_clearance", "boundary_step")):
        least = np.full(record.robots, np.inf)
        for low in range(0, until + 1, BLOCK):
            part = again.read(f"/steps/{column}", low, min(low + BLOCK, until + 1))
            least = np.minimum(least, part.min(axis=0, initial=np.inf))
        told, step = rows[column], rows[when]
        wrong = (told > least + SLACK) | ((told < least - SLACK) & (step <= until))
        for k in np.flatnonzero(wrong)[:1].tolist():
            yield _mismatch(record, EXTREMES, column, k, told[k], least[k])
    told = record.arrived
    wrong = (told >= 0) & (told <= until) & (told != again.arrived) & (again.arrived <= until)
    for k in np.flatnonzero(wrong)[:1].tolist():
        yield _mismatch(record, ARRIVED, None, k, told[k], again.arrived[k])


def unlike(
    recorded: NDArray[Any], repeated: NDArray[Any], exact: bool, column: str
) -> NDArray[np.bool_]:
    """Whether values differ: to the bit, or by more than the slack of a column."""
    if exact:
        if recorded.dtype.kind == "f":
            recorded, repeated = (
                np.ascontiguousarray(v).view(np.int64) for v in (recorded, repeated)
            )
        return np.asarray(recorded != repeated)
    return differs(recorded, repeated, SLACKS.get(column, SLACK))
