"""Decisions of a run, packed: what each robot saw and chose, robot by robot, by time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.drawing.page.packing import LARGEST, Pack
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record

MANY = 250_000
"""Decisions from which on numbers are kept to a hundredth rather than a thousandth."""
FINE, COARSE = 1e-3, 1e-2
"""[m], [s], …"""
SPEEDS = 1e-3
"""[m/s], [rad/s]"""
OWN = ("station", "reference_station", "formation_error", "deviation")
"""Columns that every record has and the page shows; the first two of few decisions only."""
MOST_OTHERS = 400_000
"""Considered robots, counted where they change; of more, the page shows only how many they are."""
MOST_COMMANDS = 60_000
"""Rows of commands; of more, those every tenth of a second are kept."""
EVERY = 0.1
"""[s]"""


def pack_decisions(
    record: Record, pack: Pack, thresholds: Sequence[Mapping[str, Any]] = ()
) -> dict[str, Any]:
    """Add decisions, considered robots and commands; returns what the header says of them.

    ``thresholds`` are those of `physim.drawing.page.why.explanations`, by which the page says why.
    """
    rows = record.updates
    order = np.lexsort((rows["step"], rows["robot"]))
    rows = rows[order]
    few = len(rows) < MANY
    quantum = FINE if few else COARSE
    pack.whole("decisions", np.bincount(rows["robot"], minlength=record.robots))
    pack.whole("step", rows["step"])
    hold = rows["next_step"] - rows["step"]
    pack.whole("hold", np.minimum(hold, LARGEST - 1))  # one decision for all time may be more
    for name in ("mode", "rule", "considered"):
        pack.whole(name, rows[name])
    for name in rows.dtype.names or ():
        if not name.startswith(("nominal_", "applied_")):
            continue
        if name.startswith("nominal") or len(record.commands):
            pack.real(name, rows[name], SPEEDS)
    shown = list(OWN if few else OWN[2:])
    for name in shown:
        pack.real(name, rows[name], quantum)
    bounds: dict[str, list[tuple[np.ufunc, float]]] = {}
    for one in thresholds:
        both = (np.less, one["enter"]), (np.less_equal, one["leave"])
        bounds.setdefault(one["column"], []).extend(both)
    for column in record.declared.columns:
        values = rows[column.name]
        # finer than usual where all of it is small
        largest = float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
        is_small = 0.0 < largest < 10.0 * quantum
        fine = max(largest * 1e-3, float(np.finfo(np.float64).tiny)) if is_small else quantum
        for below, bound in bounds.get(column.name, ()):
            values = _on_its_side(values, fine, below, bound)
        pack.real(f"own:{column.name}", values, fine)
    return {
        "count": len(rows),
        "quantum": quantum,
        "shown": shown,
        "others": _pack_others(record, rows, pack),
        "commands": _pack_commands(record, pack),
    }


def _on_its_side(values: FloatArray, quantum: float, below: np.ufunc, bound: float) -> FloatArray:
    """Values that stay ``below`` (less, less or equal) a bound, or not, rounded to ``quantum``.

    What rounding would take across is moved to the next number on its own side.
    """
    rounded, is_below = np.rint(values / quantum) * quantum, below(values, bound)
    across = np.isfinite(values) & (below(rounded, bound) != is_below)
    return np.where(across, rounded + np.where(is_below, -quantum, quantum), values)


def _pack_others(record: Record, rows: NDArray[np.void], pack: Pack) -> bool:
    """Add the considered robots of every decision at which they change; False for too many."""
    if "considered" not in record.tables:
        return False
    counted = record.considering
    begin = np.cumsum(counted["count"], dtype=np.int64) - counted["count"]
    order = np.lexsort((counted["step"], counted["robot"]))
    mine = {
        key: (int(first), int(first) + int(count))
        for key, first, count in zip(
            counted[["robot", "step"]][order].tolist(), begin[order], counted["count"][order],
            strict=True,
        )
    }  # fmt: skip
    others = np.ascontiguousarray(record.considered["other"])
    changed, kept = [], []
    before: tuple[int, bytes] | None = None
    for robot, step in rows[["robot", "step"]].tolist():
        first, last = mine.get((robot, step), (0, 0))
        now = (robot, others[first:last].tobytes())
        changed.append(now != before)
        if now != before:
            kept.append((first, last))
            before = now
    if sum(last - first for first, last in kept) > MOST_OTHERS:
        return False
    picked: IntArray = np.concatenate(
        [np.zeros(0, np.int64), *(others[first:last] for first, last in kept)]
    )
    pack.whole("others_new", changed)
    pack.whole("others_count", [last - first for first, last in kept])
    pack.whole("others", picked)
    return True


def _pack_commands(record: Record, pack: Pack) -> float:
    """Add the commands that differ between stages; returns how far apart [s] they are kept at most,
    0 where every row is, -1 where there are none.
    """
    rows = record.commands
    if not len(rows):
        return -1.0
    apart = 0.0
    if len(rows) > MOST_COMMANDS:
        steps = max(1, round(EVERY / record.dt))
        rows, apart = rows[rows["step"] % steps == 0], steps * record.dt
    rows = rows[np.lexsort((rows["step"], rows["robot"]))]
    pack.whole("command_robot", rows["robot"])
    pack.whole("command_step", rows["step"])
    for name in rows.dtype.names or ():
        if name not in ("robot", "step"):
            pack.real(f"command:{name}", rows[name], SPEEDS)
    return apart
