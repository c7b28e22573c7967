"""What is wrong with a record: the one form in which all checks say it; values that differ."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physim.errors import plural
from physim.geometry.shapes import IntArray
from physim.parts.declarations import NO_NUMBER
from physim.record import Record
from physim.record.layout import ARRIVED, EXTREMES, OTHERS, STEPS, TABLES
from physim.tolerances import LENGTH, TIME

SLACK = LENGTH
"""[m, rad, m/s] How well a value must agree with the one computed here."""
SLACKS = {"collision_time": TIME}
"""[s] of columns that are no lengths, angles or speeds"""


UNEXPLAINED = "unexplained"


@dataclass(frozen=True)
class Finding:
    """Two sources that disagree: about the whole run, or over a stretch of consecutive samples."""

    what: str
    """what each of the two says"""
    bodies: tuple[int, ...] = ()
    """ids; none where it is about no body"""
    step: int | None = None
    """first sample"""
    time: float | None = None
    """[s] of that sample; of a contact between samples, of its first touch"""
    steps: int = 1
    """number of samples"""
    distance: float = math.nan
    """[m] signed, of two bodies at the first sample, from the poses; of a contact between samples
    the least there; NaN where no distance is in question"""
    cause: str = UNEXPLAINED

    @property
    def words(self) -> str:
        """The cause, and what each of the two says."""
        return f"{self.cause} ({self.what})"

    def line(self, names: Sequence[str]) -> str:
        """One line: when, who, what; ``names`` by body id."""
        when = [] if self.time is None else [f"{self.time:.4f} s"]
        place = " ".join([*when, *(names[body] for body in self.bodies)])
        return f"{place}{': ' if place else ''}{self.what}"


def unlike(
    record: Record,
    table: str,
    column: str | None,
    recorded: Any,
    exact: Any,
    by: str,
    *,
    row: int | None = None,
    robot: int | None = None,
    step: int | None = None,
    count: int = 1,
) -> Finding:
    """A value of a dataset, or of an ``attribute``, that is not the ``exact`` one ``by`` something.

    Says where it is (``/updates, row 12, collision_time`` or ``attribute ended``), both values,
    modes and rules by their names, and how many more of the ``count`` there are.
    """
    where = f"attribute {column}"
    if table != "attribute":
        parts = (table, None if row is None else f"row {row}", column)
        where = ", ".join(part for part in parts if part)
    told, due = (_text(record, column, one) for one in (recorded, exact))
    more = f" (and {plural(count - 1, 'more row')} of it)" if count > 1 else ""
    return Finding(
        f"{where} is {told} in the record, {due} {by}{more}", () if robot is None else (robot,),
        step, None if step is None else step * record.dt,
    )  # fmt: skip


def stretches(step: IntArray, *who: IntArray) -> Iterator[IntArray]:
    """Numbers of rows (M,) in runs of consecutive steps of the same bodies, body by body."""
    order = np.lexsort((step, *reversed(who)))
    cut = np.diff(step[order]) != 1
    for one in who:
        cut |= np.diff(one[order]) != 0
    yield from np.split(order, np.flatnonzero(cut) + 1) if len(order) else ()


def _text(record: Record, column: str | None, value: Any) -> str:
    if column in ("mode", "rule") and not isinstance(value, str):
        some = record.modes if column == "mode" else record.declared.rules
        if value == NO_NUMBER:
            return "none"
        if 0 <= value < len(some):
            return some[int(value)].name
    if isinstance(value, np.ndarray):
        return f"({', '.join(f'{one:.10g}' for one in value.tolist())})"
    if isinstance(value, bytes):  # texts of a record
        return value.decode("utf-8", "replace")
    return f"{value:.9g}" if isinstance(value, float | np.floating) else str(value)


def unlike_rows(
    record: Record,
    table: str,
    column: str | None,
    rows: NDArray[np.void],
    exact: ArrayLike,
    by: str,
    wrong: NDArray[np.bool_] | None = None,
) -> Iterator[Finding]:
    """The first row of each robot whose column is not ``exact``, (M,) or one value.

    ``rows`` (M,) are those of a whole table. Which are wrong says ``wrong`` (M,); without it those
    beyond the slack of the column. Without a column rows are wrong that should not be there.
    """
    values = np.broadcast_to(np.asarray(exact), len(rows))
    if wrong is None:
        wrong = differs(rows[column or ""], values, SLACKS.get(column or "", SLACK))
    some = np.flatnonzero(wrong)
    robots, first, count = np.unique(rows["robot"][some], return_index=True, return_counts=True)
    for robot, k, number in zip(robots.tolist(), some[first].tolist(), count.tolist(), strict=True):
        recorded, step = "there" if column is None else rows[column][k], int(rows["step"][k])
        place = {"row": k, "robot": robot, "step": step, "count": number}
        yield unlike(record, table, column, recorded, values[k], by, **place)


def differs(recorded: ArrayLike, exact: ArrayLike, slack: float) -> NDArray[np.bool_]:
    """Whether values differ by more than ``slack``; infinite ones and NaN must be alike."""
    recorded, exact = np.asarray(recorded), np.asarray(exact)
    with np.errstate(invalid="ignore"):
        alike = (recorded == exact) | (np.isnan(recorded) & np.isnan(exact))
        return np.asarray(~(alike | (np.abs(np.subtract(recorded, exact)) <= slack)))


def first_difference(
    record: Record,
    path: str,
    rows: NDArray[Any],
    others: NDArray[Any],
    by: str,
    exact: bool,
    steps: NDArray[np.int64] | None = None,
) -> Finding | None:
    """First row of a dataset that differs from others, or that one of the two lacks.

    ``exact``: to the bit, otherwise within the slack of a column. ``steps`` are those of samples.
    """
    names = rows.dtype.names or (None,)
    for name in names:
        if name is not None and name not in (others.dtype.names or ()):
            return unlike(record, path, name, "there", "not", by)
    common = min(len(rows), len(others))
    differ: dict[str | None, NDArray[np.bool_]] = {}
    for name in names:
        some, more = (
            one[:common] if name is None else one[name][:common] for one in (rows, others)
        )
        differ[name] = _differ(some, more, exact, SLACKS.get(name or "", SLACK))
    wrong = [np.asarray(one.any(axis=tuple(range(1, one.ndim)))) for one in differ.values()]
    first = min((int(np.argmax(one)) for one in wrong if one.any()), default=common)
    if first == common == max(len(rows), len(others)):
        return None
    row = (rows if first < len(rows) else others)[first]
    step = None if steps is None else int(steps[first])
    robot = first if path in (ARRIVED, EXTREMES) else None
    if path in TABLES or path == OTHERS:
        who = next(name for name in ("robot", "a", "observer") if name in row.dtype.names)
        step, robot = int(row["step"]), int(row[who])
    if first == common:
        told, due = ("there", "not") if first < len(rows) else ("not there", "there")
        return unlike(record, path, None, told, due, by, row=first, robot=robot, step=step)
    column = next(name for name, one in zip(names, wrong, strict=True) if one[first])
    both = [one[first] if column is None else one[column][first] for one in (rows, others)]
    if path in STEPS:
        robot, *part = np.argwhere(differ[None][first])[0].tolist()
        both = [one[(robot, *part)] for one in both]
        column = ("x", "y", "heading")[part[0]] if part else None
    told, due = both
    return unlike(record, path, column, told, due, by, row=first, robot=robot, step=step)


def _differ(
    some: NDArray[Any], others: NDArray[Any], exact: bool, slack: float
) -> NDArray[np.bool_]:
    if some.dtype.kind != "f":
        return np.asarray(some != others)
    if not exact:
        return differs(some, others, slack)
    bits = [np.ascontiguousarray(one).view(np.int64) for one in (some, others)]
    return np.asarray(bits[0] != bits[1])


def unlike_attributes(
    record: Record, other: Record, names: Iterable[str], by: str
) -> Iterator[Finding]:
    """Attributes that are not those of the other record; of the world its first line."""
    for name in names:
        recorded, repeated = (
            getattr(one, "world_text" if name == "world" else name) for one in (record, other)
        )
        if recorded != repeated and name == "world":
            lines, others = recorded.splitlines(), repeated.splitlines()
            both = zip(lines, others, strict=False)
            counts = f"{len(lines)} lines", f"{len(others)} lines"
            recorded, repeated = next((two for two in both if two[0] != two[1]), counts)
        if recorded != repeated:
            yield unlike(record, "attribute", name, recorded, repeated, by)


def unlike_scene(
    record: Record, other: Record, paths: Iterable[str], by: str, exact: bool
) -> Iterator[Finding]:
    """Datasets of what stands still that are not as in the other record, each by its first row."""
    for path in paths:
        rows, others = record.read(path), other.read(path)
        if rows.shape != others.shape:
            yield unlike(record, path, None, f"{len(rows)} rows", f"{len(others)} rows", by)
        elif found := first_difference(record, path, rows, others, by, exact):
            yield found
