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
    first_row: IntArray
    """(C,) where an episode's rows begin in ``row_time`` and ``row_place``"""
    rows: IntArray
    """(C,) how many of them there are while the bodies touch, one at least"""
    row_time: FloatArray
    """(R,) [s] of the rows of the contact table, episode by episode"""
    row_place: FloatArray
    """(R, 2) [m] deepest point at those times"""
    swept: NDArray[np.bool_]
    """(C,) a graze: the two touch between two samples only"""

    def count(self, time: float) -> int:
        """Return how many began at or before ``time`` [s], grazes included."""
        return int(np.searchsorted(self.began, time + 1e-9, side="right"))

    def grazes(self, time: float) -> int:
        """Return how many of them are grazes."""
        return int(self.swept[: self.count(time)].sum())

    def recent(self, time: float, lasts: float) -> IntArray:
        """Return the episodes that began at most ``lasts`` seconds before ``time``, old first."""
        first = int(np.searchsorted(self.began, time - lasts, side="right"))
        return np.arange(first, self.count(time))

    def present(self, time: float) -> IntArray:
        """Return the episodes in which bodies touch at ``time`` [s], old first."""
        return np.flatnonzero(self.ended[: self.count(time)] > time + 1e-9)

    def place_at(self, episode: int, time: float) -> FloatArray:
        """Return the deepest point (2,) [m] at ``time``; after the end the last one."""
        first = int(self.first_row[episode])
        times = self.row_time[first : first + int(self.rows[episode])]
        last = max(int(np.searchsorted(times, time + 1e-9, side="right")) - 1, 0)
        place: FloatArray = self.row_place[first + last]
        return place

    def touching(self, time: float, robots: int) -> NDArray[np.bool_]:
        """Return for each robot (N,) whether it touches anything at ``time``."""
        now = self.bodies[self.present(time)]
        result = np.zeros(robots, dtype=bool)
        result[now[now < robots]] = True
        return result


def episodes(record: Record) -> Episodes:
    """Gather the contact table of a record into episodes."""
    table = np.asarray(record.contacts)
    # pair by pair, each in order of time: an episode is then a run of rows that starts with BEGAN
    table = table[np.lexsort((table["step"], table["b"], table["a"]))]
    step = table["step"].astype(np.int64)
    first = np.flatnonzero(table["phase"] == Phase.BEGAN)
    after = np.append(first[1:], len(step))[: len(first)]
    order = np.argsort(step[first], kind="stable")
    first, after = first[order], after[order]
    bodies = np.column_stack((table["a"], table["b"])).astype(np.int64)
    last_step = int(record.steps[-1]) if len(record.steps) else 0
    ends, rows = np.zeros(len(first)), np.zeros(len(first), dtype=np.int64)
    for index, (begin, end) in enumerate(zip(first.tolist(), after.tolist(), strict=True)):
        ended = begin + np.flatnonzero(table["phase"][begin:end] == Phase.ENDED)
        rows[index] = (int(ended[0]) if len(ended) else end) - begin
        if table["kind"][begin] == Kind.SWEPT:
            ends[index] = step[begin] + 1
        else:
            ends[index] = step[ended[0]] if len(ended) else last_step + 1
    place = np.column_stack((table["x"], table["y"])).astype(np.float64)
    time = np.asarray(step * record.dt, dtype=np.float64)
    return Episodes(
        time[first], ends * record.dt, bodies[first], place[first], first, rows, time, place,
        np.asarray(table["kind"][first] == Kind.SWEPT),
    )  # fmt: skip
