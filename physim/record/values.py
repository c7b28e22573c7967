"""Check the values of a record as they are read: indices, steps, kinds and modes, poses.

Every check goes over whole columns at once. What is refused is one line: file, table, row, what was
given and what is allowed.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.contacts import Kind, Phase
from physim.control import LONGEST_HOLD
from physim.declared import NO_NUMBER
from physim.errors import RecordError
from physim.record import layout

FINITE: dict[str, tuple[str, ...]] = {
    "/updates": ("nominal_v", "nominal_omega", "applied_v", "applied_omega"),
    "/commands": (layout.COMMAND.names or ())[2:],
    "/considered": (),
    "/contacts": ("x", "y", "nx", "ny", "depth", "impulse"),
    "/false_contacts": ("distance",),
}
"""Columns of the tables that are finite in every row."""
ONCE = {
    "/updates": ("robot",),
    "/commands": ("robot",),
    "/considered": ("robot", "other"),
    "/contacts": ("a", "b", "kind"),
    "/false_contacts": ("a", "b"),
}
"""Columns that no two rows of one step have alike."""


class Range(NamedTuple):
    """Least and greatest value that a column may have."""

    column: str
    low: Any
    """a number, or one for each row"""
    high: Any


class Bounds(NamedTuple):
    """What the values of a record are held against."""

    robots: int
    bodies: int
    last_step: int
    """last step of the run"""
    modes: int
    rules: int
    """how many the controller declares"""


def check_table(path: str, rows: NDArray[np.void], bounds: Bounds, where: str, first: int) -> None:
    """Check rows of one of `layout.TABLES`, of which ``first`` is the number of the first.

    Raises RecordError for the first value that is out of its range, for a number that is not
    finite and has to be, an impulse below 0, and where the rows are not in
    the order of steps or one is there twice.
    """
    for column, low, high in _ranges(path, rows, bounds):
        values = rows[column]
        wrong = (values < low) | (values > high)
        if wrong.any():
            k = int(np.argmax(wrong))
            least, most = (int(np.broadcast_to(v, len(rows))[k]) for v in (low, high))
            raise _refused(where, path, first + k, f"{column} is {values[k]}", (least, most))
    for column in FINITE[path]:
        wrong = ~np.isfinite(rows[column])
        if wrong.any():
            k = int(np.argmax(wrong))
            given = f"{column} is {rows[column][k]}"
            raise _refused(where, path, first + k, given, "it must be finite")
    if path == "/contacts" and (wrong := rows["impulse"] < 0.0).any():
        k = int(np.argmax(wrong))
        given = f"impulse is {rows['impulse'][k]:.6g}"
        raise _refused(where, path, first + k, given, "it must not be negative")
    back = np.diff(rows["step"]) < 0
    if back.any():
        k = int(np.argmax(back)) + 1
        given = f"step {rows['step'][k]} comes after step {rows['step'][k - 1]}"
        raise _refused(where, path, first + k, given, "rows must be in the order of steps")
    _check_once(path, rows, where, first)


def _check_once(path: str, rows: NDArray[np.void], where: str, first: int) -> None:
    """Raise RecordError for a second row of the same step and bodies."""
    columns = [rows["step"], *(rows[name] for name in ONCE[path])]
    order = np.lexsort(columns[::-1])
    same = np.ones(max(len(rows) - 1, 0), dtype=np.bool_)
    for column in columns:
        same &= np.diff(column[order]) == 0
    if same.any():
        k = int(order[np.argmax(same) + 1])
        who = ", ".join(f"{name} {rows[name][k]}" for name in ONCE[path])
        given = f"step {rows['step'][k]}, {who} again"
        raise _refused(where, path, first + k, given, "it may be there once")


def check_steps(path: str, rows: NDArray[Any], where: str, first: int) -> None:
    """Check rows of one of `layout.STEPS`: steps that increase from 0, finite poses, no NaN.

    Raises RecordError for the first sample that is not so.
    """
    if path == "/steps/step":
        back = np.diff(rows) <= 0
        if back.any():
            k = int(np.argmax(back)) + 1
            given = f"step {rows[k]} comes after step {rows[k - 1]}"
            raise _refused(where, path, first + k, given, "steps must increase from 0")
        if len(rows) and first == 0 and rows[0] != 0:
            raise _refused(where, path, 0, f"the first step is {rows[0]}", "it must be 0")
        return
    wrong = ~np.isfinite(rows) if path == "/steps/pose" else np.isnan(rows)
    if wrong.any():
        k, robot, *column = (int(v) for v in np.argwhere(wrong)[0])
        what = ("x", "y", "heading")[column[0]] if column else "distance"
        given = f"{what} of robot {robot} is {rows[(k, robot, *column)]}"
        must = "it must be finite" if column else "it must be a number"
        raise _refused(where, path, first + k, given, must)


def check_extremes(path: str, rows: NDArray[np.void], bounds: Bounds, where: str) -> None:
    """Check who and when of `layout.EXTREMES` or `layout.EXTREMES_FARTHEST`; -1 is nobody, never.

    Raises RecordError for the first value that is out of its range, and for a distance of NaN.
    """
    rows = np.atleast_1d(rows)
    last, robots, bodies = bounds.last_step, bounds.robots, bounds.bodies
    ranges = [("step", last), ("a", robots - 1), ("b", robots - 1)]
    distances = ["farthest"]
    if path == layout.EXTREMES:
        ranges = [("clearance_step", last), ("clearance_other", robots - 1),
                  ("boundary_step", last), ("boundary_other", bodies - 1)]  # fmt: skip
        distances = ["clearance", "boundary_clearance"]
    for column, high in ranges:
        wrong = (rows[column] < -1) | (rows[column] > high)
        if wrong.any():
            k = int(np.argmax(wrong))
            raise _refused(where, path, k, f"{column} is {rows[column][k]}", (-1, high))
    for column in distances:
        if np.isnan(rows[column]).any():
            k = int(np.argmax(np.isnan(rows[column])))
            raise _refused(where, path, k, f"{column} is nan", "it must be a number")


def check_arrived(rows: NDArray[np.int64], bounds: Bounds, where: str) -> None:
    """Check the samples from which on robots have arrived; -1 is never. Raises RecordError."""
    wrong = (rows < -1) | (rows > bounds.last_step)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise _refused(where, layout.ARRIVED, k, f"it is {rows[k]}", (-1, bounds.last_step))


def check_start(
    path: str,
    start: NDArray[Any],
    whole: int,
    where: str,
    *,
    empty: bool = True,
    runs: int | None = None,
) -> None:
    """Check the starts of packed runs: from 0 to ``whole``, never back.

    ``empty``: whether runs may have nothing in them; ``runs``: how many there must be, if that is
    known. Raises RecordError for the first wrong one.
    """
    if start.ndim != 1 or not len(start) or not np.issubdtype(start.dtype, np.integer):
        raise RecordError(f"{where}: {path} holds no list of starts; make the record again")
    if runs is not None and len(start) != runs + 1:
        raise RecordError(
            f"{where}: {path}: {len(start)} rows; {runs + 1} are needed; make the record again"
        )
    wrong = (start < 0) | (start > whole)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise _refused(where, path, k, f"it is {start[k]}", (0, whole))
    if start[0] != 0 or start[-1] != whole:
        k, must = (0, 0) if start[0] != 0 else (len(start) - 1, whole)
        raise _refused(where, path, k, f"it is {start[k]}", f"it must be {must}")
    back = np.diff(start) < (0 if empty else 1)
    if back.any():
        k = int(np.argmax(back)) + 1
        given = f"{start[k]} comes after {start[k - 1]}"
        raise _refused(where, path, k, given, "starts must increase")


def check_points(path: str, points: NDArray[Any], where: str) -> None:
    """Check points (n, 2) [m]. Raises RecordError for another shape, and for what is not finite."""
    if points.ndim != 2 or points.shape[1] != 2 or points.dtype != np.float64:
        raise RecordError(f"{where}: dataset {path} holds no points (n, 2)")
    wrong = ~np.isfinite(points)
    if wrong.any():
        k, column = (int(v) for v in np.argwhere(wrong)[0])
        given = f"{'xy'[column]} is {points[k, column]}"
        raise _refused(where, path, k, given, "it must be finite")


def _ranges(path: str, rows: NDArray[np.void], bounds: Bounds) -> list[Range]:
    robots, bodies, last, modes, rules = bounds
    if path == "/updates":
        step = rows["step"]
        return [
            Range("step", 0, last),
            Range("robot", 0, robots - 1),
            Range("mode", NO_NUMBER, modes - 1),
            Range("rule", NO_NUMBER, rules - 1),
            Range("considered", 0, robots - 1),
            Range("next_step", step + 1, step + LONGEST_HOLD),
        ]
    if path == "/commands":
        return [Range("step", 0, last), Range("robot", 0, robots - 1)]
    if path == "/considered":
        ranges = (Range("robot", 0, robots - 1), Range("other", 0, robots - 1))
        return [Range("step", 0, last), *ranges]
    found = [
        Range("step", 0, last),
        Range("a", 0, robots - 1),
        Range("b", rows["a"] + 1, bodies - 1),
    ]
    if path == "/contacts":
        found += [Range("phase", min(Phase), max(Phase)), Range("kind", min(Kind), max(Kind))]
    return found


def _refused(
    where: str, path: str, row: int, given: str, allowed: str | tuple[int, int]
) -> RecordError:
    if not isinstance(allowed, str):
        allowed = f"allowed: {allowed[0]} to {allowed[1]}"
    return RecordError(f"{where}: {path}, row {row}: {given}; {allowed}; make the record again")
