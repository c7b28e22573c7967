"""Single events of a record against the shapes: grazes, and false contacts that were rejected."""

from __future__ import annotations

import math

import numpy as np

from physim.contacts import Kind
from physim.errors import RecordError
from physim.geometry.shapes import IntArray
from physim.geometry.swept import least_gap_pair, least_gap_walls
from physim.record import Record
from physim.tolerances import CONTACT
from physim.validation.findings import (
    DEPTH_SLACK,
    GRAZE,
    REJECTED,
    ROUNDING,
    TOLERANCE,
    UNEXPLAINED,
    Disagreement,
)
from physim.validation.ledger import Ledger, robot_shapes
from physim.validation.rows import body_keys, distance_at, stretches

LEAST_SLACK = 1e-8
"""[m] Two searches for the least distance of a step agree to this: each ends within 1e-9 m of it,
from poses of one motion."""

NEAR_TOUCH = 2.0 * CONTACT
"""[m] A least distance within this of 0 may count as touching or not."""


def grazes(record: Record, ledger: Ledger) -> list[Disagreement]:
    """Contacts between two samples, which the engine cannot see, by both: record and ledger.

    Where only one of the two has it, or their depths differ, it is unexplained.
    """
    rows, n = record.contacts[record.contacts["kind"] == Kind.SWEPT], len(record.bodies)
    entries = dict(zip(_places(ledger.grazes), ledger.grazes["entry"].tolist(), strict=True))
    depths = dict(zip(_places(rows), rows["depth"].tolist(), strict=True))
    found = []
    for place in sorted({*entries, *depths}):
        step, a, b = place
        if not (0 < step < record.samples and 0 <= a < b < n and a < record.robots):
            raise RecordError(
                f"{record.path or 'record in memory'}: a contact between samples, of bodies {a} "
                f"and {b} in the step that ends at {step}; bodies are 0 to {n - 1}, steps 1 to "
                f"{record.samples - 1}"
            )
        least = _least(record, a, b, step)
        cause, what = GRAZE, "touching between two samples, apart at both"
        if place not in depths:
            cause, what = _missing(least), f"{what}; not in the record"
        elif place not in entries:
            cause, what = _missing(least), "contact between samples in the record, shapes apart"
        elif abs(depths[place] - max(-least, 0.0)) > LEAST_SLACK:
            cause = UNEXPLAINED
            what = (
                f"touching between two samples, depth {depths[place]:.3g} m in the record, "
                f"{max(-least, 0.0):.3g} m by the shapes"
            )
        time = (step - 1) * record.dt + entries.get(place, record.dt)
        found.append(Disagreement(a, b, step, 1, time, least, cause, what))
    return found


def false_contacts(record: Record) -> list[Disagreement]:
    """Contacts that the engine reported and the exact check rejected, by stretches of samples.

    Unexplained where the shapes touch after all, or are not as far apart as recorded.
    """
    rows = record.false_contacts
    n = len(record.bodies)
    wrong = (rows["a"] < 0) | (rows["a"] >= rows["b"]) | (rows["b"] >= n)
    wrong |= (rows["a"] >= record.robots) | (rows["step"] < 0) | (rows["step"] >= record.samples)
    if wrong.any():
        raise RecordError(
            f"{record.path or 'record in memory'}: a false contact at step "
            f"{rows['step'][wrong][0]} of bodies {rows['a'][wrong][0]} and {rows['b'][wrong][0]}"
        )
    noted = dict(zip(_places(rows), rows["distance"].tolist(), strict=True))
    found = []
    for a, b, step, steps in stretches(body_keys(rows, n), n):
        at = [distance_at(record, a, b, step + k) for k in range(min(steps, 1000))]
        cause, what = REJECTED, "contact by the engine, shapes apart; not counted"
        for k, d in enumerate(at):
            told = noted[step + k, a, b]
            if d <= CONTACT - ROUNDING:
                cause, what = UNEXPLAINED, "contact by the engine, rejected, but the shapes touch"
            elif abs(d - told) > DEPTH_SLACK:
                cause = UNEXPLAINED
                what = f"false contact at a distance of {told:.3g} m in the record"
        time = step * record.dt
        found.append(Disagreement(a, b, step, steps, time, at[0], cause, what))
    return found


def _places(rows: np.ndarray[tuple[int, ...], np.dtype[np.void]]) -> list[tuple[int, int, int]]:
    """Step and bodies of each row."""
    return list(zip(*(rows[key].tolist() for key in ("step", "a", "b")), strict=True))


def _missing(least: float) -> str:
    """Cause of a contact between samples that only one of two ledgers has."""
    return TOLERANCE if math.fabs(least) <= NEAR_TOUCH else UNEXPLAINED


def _least(record: Record, a: int, b: int, step: int) -> float:
    """Least signed distance [m] of two bodies within the step that ends at a sample."""
    shapes = robot_shapes(record)
    old, new = record.read("/steps/pose", step - 1, step + 1)
    if b < record.robots:
        return float(least_gap_pair(shapes, a, old[a], new[a], b, old[b], new[b], record.dt)[0])
    walls = record.walls
    first, last = walls.body_start[b - record.robots : b - record.robots + 2]
    parts: IntArray = np.arange(first, last)
    return float(least_gap_walls(shapes, a, old[a], new[a], walls, parts, record.dt)[0])
