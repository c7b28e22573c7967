"""Values of a record that are not those computed anew, or of the same run simulated again."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physim.errors import plural
from physim.parts.declarations import NO_NUMBER
from physim.record import Record
from physim.record.layout import ARRIVED, EXTREMES, OTHERS, STEPS, TABLES
from physim.tolerances import LENGTH, TIME

Value = bool | int | float | str

SLACK = LENGTH
"""[m, rad, m/s] How well a value must agree with the one computed here."""
SLACKS = {"collision_time": TIME}
"""[s] of columns that are no lengths, angles or speeds"""


@dataclass(frozen=True)
class Mismatch:
    """A value that is not the one computed, and how many more there are of its robot and column.

    ``table`` is a dataset of the record, or ``attribute``; what is about no row, column, robot or
    time has None there.
    """

    table: str
    column: str | None
    row: int | None
    robot: int | None
    step: int | None
    time: float | None
    """[s]"""
    recorded: Value = field(metadata={"json": "told"})
    """in the record; its key in the JSON of a validation is ``told``"""
    exact: Value
    """computed"""
    by: str
    """from what"""
    count: int = 1
    """values of this robot and column that do not agree"""

    @classmethod
    def of(
        cls,
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
    ) -> Mismatch:
        """One value; its time follows from the step, modes and rules are told by their names."""
        time = None if step is None else step * record.dt
        told, due = (_value(record, column, one) for one in (recorded, exact))
        return cls(table, column, row, robot, step, time, told, due, by, count)

    def line(self, names: Sequence[str]) -> str:
        """One line: when, who, where in the record, both values; ``names`` of the robots."""
        when = [] if self.time is None else [f"{self.time:.4f} s"]
        who = [] if self.robot is None else [names[self.robot]]
        place = " ".join([*when, *who])
        return f"{place}{': ' if place else ''}{self.what}"

    @property
    def what(self) -> str:
        """Where in the record, and both values."""
        more = self.count - 1
        others = f" (and {plural(more, 'more row')} of it)" if more else ""
        return (
            f"{self.where} is {_text(self.recorded)} in the record, {_text(self.exact)} "
            f"{self.by}{others}"
        )

    @property
    def where(self) -> str:
        """``/updates, row 12, collision_time`` or ``attribute ended``."""
        if self.table == "attribute":
            return f"attribute {self.column}"
        row = None if self.row is None else f"row {self.row}"
        return ", ".join(part for part in (self.table, row, self.column) if part)


def _value(record: Record, column: str | None, value: Any) -> Value:
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
    made: Value = value.item() if isinstance(value, np.generic) else value
    return made


def _text(value: Value) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def unlike_rows(
    record: Record,
    table: str,
    column: str | None,
    rows: NDArray[np.void],
    exact: ArrayLike,
    by: str,
    wrong: NDArray[np.bool_] | None = None,
) -> Iterator[Mismatch]:
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
        yield Mismatch.of(record, table, column, recorded, values[k], by, **place)


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
) -> Mismatch | None:
    """First row of a dataset that differs from others, or that one of the two lacks.

    ``exact``: to the bit, otherwise within the slack of a column. ``steps`` are those of samples.
    """
    names = rows.dtype.names or (None,)
    for name in names:
        if name is not None and name not in (others.dtype.names or ()):
            return Mismatch.of(record, path, name, "there", "not", by)
    common = min(len(rows), len(others))
    unlike: dict[str | None, NDArray[np.bool_]] = {}
    for name in names:
        some, more = (
            one[:common] if name is None else one[name][:common] for one in (rows, others)
        )
        unlike[name] = _unlike(some, more, exact, SLACKS.get(name or "", SLACK))
    wrong = [np.asarray(one.any(axis=tuple(range(1, one.ndim)))) for one in unlike.values()]
    first = min((int(np.argmax(one)) for one in wrong if one.any()), default=common)
    if first == common == max(len(rows), len(others)):
        return None
    row = (rows if first < len(rows) else others)[first]
    step = None if steps is None else int(steps[first])
    robot = first if path in (ARRIVED, EXTREMES) else None
    if path in TABLES or path == OTHERS:
        step, robot = int(row["step"]), int(row["a" if "a" in row.dtype.names else "robot"])
    if first == common:
        told, due = ("there", "not") if first < len(rows) else ("not there", "there")
        return Mismatch.of(record, path, None, told, due, by, row=first, robot=robot, step=step)
    column = next(name for name, one in zip(names, wrong, strict=True) if one[first])
    both = [one[first] if column is None else one[column][first] for one in (rows, others)]
    if path in STEPS:
        robot, *part = np.argwhere(unlike[None][first])[0].tolist()
        both = [one[(robot, *part)] for one in both]
        column = ("x", "y", "heading")[part[0]] if part else None
    told, due = both
    return Mismatch.of(record, path, column, told, due, by, row=first, robot=robot, step=step)


def _unlike(
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
) -> Iterator[Mismatch]:
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
            yield Mismatch.of(record, "attribute", name, recorded, repeated, by)


def unlike_scene(
    record: Record, other: Record, paths: Iterable[str], by: str, exact: bool
) -> Iterator[Mismatch]:
    """Datasets of what stands still that are not as in the other record, each by its first row."""
    for path in paths:
        rows, others = record.read(path), other.read(path)
        if rows.shape != others.shape:
            yield Mismatch.of(record, path, None, f"{len(rows)} rows", f"{len(others)} rows", by)
        elif found := first_difference(record, path, rows, others, by, exact):
            yield found
