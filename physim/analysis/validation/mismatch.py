"""Values of a record that are not those computed anew: one for each robot and column."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physim.errors import plural
from physim.parts.declarations import NO_NUMBER
from physim.record import Record
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
    ) -> Mismatch:
        """One value; its time follows from the step."""
        time = None if step is None else step * record.dt
        return cls(table, column, row, robot, step, time, plain(recorded), plain(exact), by)

    def line(self, names: list[str]) -> str:
        """One line: when, who, where in the record, both values; ``names`` of the robots."""
        when = [] if self.time is None else [f"{self.time:.4f} s"]
        who = [] if self.robot is None else [names[self.robot]]
        place = " ".join([*when, *who])
        more = self.count - 1
        others = f" (and {plural(more, 'more row')} of it)" if more else ""
        return (
            f"{place}{': ' if place else ''}{self.where} is {_text(self.recorded)} in the record, "
            f"{_text(self.exact)} {self.by}{others}"
        )

    @property
    def where(self) -> str:
        """``/updates, row 12, collision_time`` or ``attribute ended``."""
        if self.table == "attribute":
            return f"attribute {self.column}"
        row = None if self.row is None else f"row {self.row}"
        return ", ".join(part for part in (self.table, row, self.column) if part)


class Mismatches:
    """Gathers mismatches: the first of each robot and column, with how many there are."""

    def __init__(self, record: Record) -> None:
        self._record = record
        self._found: dict[tuple[str, str | None, int | None], Mismatch] = {}

    @property
    def found(self) -> tuple[Mismatch, ...]:
        """All of them: those about the whole run first, then by time."""
        order = sorted(self._found.values(), key=lambda one: -1 if one.step is None else one.step)
        return tuple(order)

    def add(
        self,
        table: str,
        column: str | None,
        recorded: Value,
        exact: Value,
        by: str,
        *,
        row: int | None = None,
        robot: int | None = None,
        step: int | None = None,
    ) -> None:
        """Note one value."""
        key = (table, column, robot)
        before = self._found.get(key)
        if before is not None:
            self._found[key] = replace(before, count=before.count + 1)
            return
        self._found[key] = Mismatch.of(
            self._record, table, column, recorded, exact, by, row=row, robot=robot, step=step
        )

    def add_rows(
        self,
        table: str,
        column: str,
        rows: NDArray[np.void],
        first: int,
        wrong: NDArray[np.bool_],
        exact: ArrayLike,
        by: str,
    ) -> None:
        """Note rows (M,) of a table, from number ``first`` on, whose column is wrong.

        ``exact`` (M,) or one value is what it should be.
        """
        if not wrong.any():
            return
        values = np.broadcast_to(np.asarray(exact), len(rows))
        for k in np.flatnonzero(wrong).tolist():
            self.add(
                table, column, rows[column][k], values[k], by, row=first + k,
                robot=int(rows["robot"][k]), step=int(rows["step"][k]),
            )  # fmt: skip

    def add_columns(
        self,
        table: str,
        rows: NDArray[np.void],
        first: int,
        exact: dict[str, NDArray[Any]],
        by: str,
    ) -> None:
        """Hold columns of rows (M,) against those computed, each within its slack."""
        for column, values in exact.items():
            wrong = differs(rows[column], values, SLACKS.get(column, SLACK))
            self.add_rows(table, column, rows, first, wrong, values, by)


def differs(recorded: ArrayLike, exact: ArrayLike, slack: float) -> NDArray[np.bool_]:
    """Whether values differ by more than ``slack``; infinite ones and NaN must be alike."""
    recorded, exact = np.asarray(recorded), np.asarray(exact)
    with np.errstate(invalid="ignore"):
        alike = (recorded == exact) | (np.isnan(recorded) & np.isnan(exact))
        return np.asarray(~(alike | (np.abs(np.subtract(recorded, exact)) <= slack)))


def words(record: Record, column: str | None, value: Any) -> Value:
    """A value of a table as it is told: modes and rules by name."""
    if column not in ("mode", "rule"):
        return plain(value)
    names = [one.name for one in (record.modes if column == "mode" else record.declared.rules)]
    if value == NO_NUMBER:
        return "none"
    return names[int(value)] if 0 <= value < len(names) else plain(value)


def plain(value: Any) -> Value:
    """A value as Python has it."""
    if isinstance(value, bytes):  # texts of a record
        return value.decode("utf-8", "replace")
    made: Value = value.item() if isinstance(value, np.generic) else value
    return made


def _text(value: Value) -> str:
    """A value as people read it."""
    return f"{value:.9g}" if isinstance(value, float) else str(value)
