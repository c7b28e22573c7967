"""Contact episodes of a record: when and where each began, who touched, and until when."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from physim.contacts import Kind, Phase
from physim.geometry.shapes import FloatArray, IntArray

if TYPE_CHECKING:
    from physim.record import Record


@dataclass(frozen=True)
class Episodes:
    """One row a contact episode, by the time it began; C episodes."""

    began: FloatArray
    """(C,) [s]"""
    ended: FloatArray
    """(C,) [s] first sample apart; after the record's end for a contact that lasts to the end"""
    bodies: IntArray
    """(C, 2) body ids"""
    place: FloatArray
    """(C, 2) [m] deepest point when it began"""

    def count(self, time: float) -> int:
        """Return how many began at or before ``time`` [s]."""
        return int(np.searchsorted(self.began, time + 1e-9, side="right"))

    def recent(self, time: float, lasts: float) -> IntArray:
        """Return the episodes that began at most ``lasts`` seconds before ``time``, old first."""
        first = int(np.searchsorted(self.began, time - lasts, side="right"))
        return np.arange(first, self.count(time))

    def touching(self, time: float, robots: int) -> NDArray[np.bool_]:
        """Return for each robot (N,) whether it touches anything at ``time``."""
        begun = self.count(time)
        now = self.bodies[:begun][self.ended[:begun] > time + 1e-9]
        result = np.zeros(robots, dtype=bool)
        result[now[now < robots]] = True
        return result


def episodes(record: Record) -> Episodes:
    """Gather the contact table of a record into episodes."""
    table = record.contacts
    phase = np.asarray(table["phase"])
    step, kind = np.asarray(table["step"], dtype=np.int64), np.asarray(table["kind"])
    bodies = np.column_stack((table["a"], table["b"])).astype(np.int64)
    last = int(record.steps[-1]) if len(record.steps) else 0
    first, end, open_rows = [], {}, {}
    for row in np.flatnonzero((phase == Phase.BEGAN) | (phase == Phase.ENDED)):
        pair = (int(bodies[row, 0]), int(bodies[row, 1]))
        if phase[row] == Phase.BEGAN:
            first.append(row)
            end[row] = int(step[row]) + 1 if kind[row] == Kind.SWEPT else last + 1
            open_rows[pair] = row
        elif pair in open_rows:
            end[open_rows.pop(pair)] = int(step[row])
    rows = np.array(sorted(first, key=lambda row: (step[row], row)), dtype=np.int64)
    place = np.column_stack((table["x"], table["y"])).astype(np.float64)
    ends = np.array([end[row] for row in rows], dtype=np.float64)
    return Episodes(
        (step[rows] * record.dt).astype(np.float64), ends * record.dt, bodies[rows], place[rows]
    )
