"""Rows that cannot be true: they contradict themselves, or another row of the same run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from physim.campaigns.rows import COLUMNS, FAILED, FINISHED, TIMES

if TYPE_CHECKING:
    import pyarrow as pa

OUTCOMES = tuple(
    name
    for name in COLUMNS[COLUMNS.index("ended") :]
    if name not in (*TIMES, "reason", "metrics", "record", "world_hash")
)
"""Columns that are alike in all rows of a run that did not fail"""
ROUNDING = 1e-6
"""[m] by which distances may be off"""


def of_itself(table: pa.Table) -> tuple[int, str] | None:
    """The first row of a table that contradicts itself, and what cannot be; null says nothing."""

    def number(name: str) -> Any:
        return table[name].to_numpy().astype(float)

    contacts, walls, first = map(number, ("contacts", "contacts_with_boundaries", "first_contact"))
    robots = number("contacts_between_robots")
    near, to_wall = number("shortest_distance"), number("shortest_boundary_distance")
    least, finish = number("least_distance"), number("time_to_finish")
    ended = np.array(table["ended"].to_pylist(), object)
    less = np.fmin(near, to_wall)
    named = np.array([bool(names) for names in table["not_arrived"].to_pylist()], bool)
    rules = [
        ("contacts are not those with robots and with boundaries together",
         np.abs(contacts - np.nan_to_num(robots) - walls) > 0),
        ("least_distance is not the less of the two others", np.abs(least - less) > ROUNDING),
        ("contacts: 0 beside a distance below 0", (contacts == 0) & (least < 0)),
        ("contacts_between_robots: 0 beside a distance below 0", (robots == 0) & (near < 0)),
        ("contacts_with_boundaries: 0 beside a distance below 0", (walls == 0) & (to_wall < 0)),
        ("contacts beside a least_distance above 0", (contacts > 0) & (least > ROUNDING)),
        ("first_contact beside contacts: 0", (contacts == 0) & ~np.isnan(first)),
        ("time_to_finish beside ended: not finished", (ended != FINISHED) & ~np.isnan(finish)),
        ("not_arrived beside ended: finished", (ended == FINISHED) & named),
    ]  # fmt: skip
    found = [(int(np.argmax(wrong)), words) for words, wrong in rules if wrong.any()]
    return min(found, default=None)


def of_another(table: pa.Table) -> dict[str, Any] | None:
    """Columns of the first row that differs from an earlier one of its run; None without one.

    What failed may come to another end another time; null says nothing.
    """
    codes = table["run"].combine_chunks().dictionary_encode().indices.to_numpy()
    often = np.bincount(codes)[codes] > 1 if len(codes) else np.zeros(0, bool)
    if not often.any():
        return None
    known: dict[str, dict[str, Any]] = {}
    for row in table.select(["run", *OUTCOMES]).take(np.flatnonzero(often)).to_pylist():
        if row["ended"] in FAILED:
            continue
        before = known.setdefault(row["run"], {})
        for name in OUTCOMES:
            value = row[name]
            if value not in (None, "") and before.setdefault(name, value) != value:
                return {"run": row["run"], name: value}
    return None


__all__ = ["of_another", "of_itself"]
