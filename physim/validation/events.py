"""Single events of a record against the shapes: swept contacts, and rejected false contacts."""

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
from physim.validation.ledger import AnalyticContacts
from physim.validation.rows import distances_over, places, row_keys, stretches

LEAST_SLACK = 1e-8
"""[m] Two searches for the least distance of a step agree to this: each ends within 1e-9 m of it,
from poses of one motion."""

NEAR_TOUCH = 2.0 * CONTACT
"""[m] A least distance within this of 0 may count as touching or not."""


def check_swept_contacts(record: Record, analytic: AnalyticContacts) -> list[Disagreement]:
    """Contacts between two samples, which the engine cannot see: the record against the shapes.

    Where only one of the two has it, or their depths differ, it is unexplained. Raises RecordError
    for one before the start.
    """
    rows = record.contacts[record.contacts["kind"] == Kind.SWEPT]
    if (rows["step"] == 0).any():
        raise RecordError(
            f"{record.path or 'record in memory'}: a contact between samples in the step that ends "
            f"at 0; steps are 1 to {record.samples - 1}"
        )
    swept = analytic.grazes
    entries = dict(zip(places(swept), swept["entry"].tolist(), strict=True))
    depths = dict(zip(places(rows), rows["depth"].tolist(), strict=True))
    found = []
    for place in sorted({*entries, *depths}):
        step, a, b = place
        least = _least(record, a, b, step)
        cause, what = GRAZE, "touching between two samples, apart at both"
        if place not in depths:
            cause, what = _one_sided(least), f"{what}; not in the record"
        elif place not in entries:
            cause, what = _one_sided(least), "contact between samples in the record, shapes apart"
        elif abs(depths[place] - max(-least, 0.0)) > LEAST_SLACK:
            cause = UNEXPLAINED
            what = (
                f"touching between two samples, depth {depths[place]:.3g} m in the record, "
                f"{max(-least, 0.0):.3g} m by the shapes"
            )
        time = (step - 1) * record.dt + entries.get(place, record.dt)
        found.append(Disagreement(a, b, step, 1, time, least, cause, what))
    return found


def check_false_contacts(record: Record) -> list[Disagreement]:
    """Contacts that the engine reported and the exact check rejected, by stretches of samples.

    Unexplained where the shapes touch after all, or are not as far apart as recorded.
    """
    rows, bodies = record.false_contacts, len(record.bodies)
    recorded = dict(zip(places(rows), rows["distance"].tolist(), strict=True))
    found = []
    for a, b, step, steps in stretches(row_keys(rows, bodies), bodies):
        exact = distances_over(record, a, b, step, steps)
        cause, what = REJECTED, "contact by the engine, shapes apart; not counted"
        for k, d in enumerate(exact):
            noted = recorded[step + k, a, b]
            if d <= CONTACT - ROUNDING:
                cause, what = UNEXPLAINED, "contact by the engine, rejected, but the shapes touch"
            elif abs(d - noted) > DEPTH_SLACK:
                cause = UNEXPLAINED
                what = f"false contact at a distance of {noted:.3g} m in the record"
        found.append(
            Disagreement.at(record, (a, b), step, exact[0], what, steps=steps, cause=cause)
        )
    return found


def _one_sided(least: float) -> str:
    """Cause of a contact between samples that only record or shapes have."""
    return TOLERANCE if math.fabs(least) <= NEAR_TOUCH else UNEXPLAINED


def _least(record: Record, a: int, b: int, step: int) -> float:
    """Least signed distance [m] of two bodies within the step that ends at a sample."""
    shapes = record.shapes
    old, new = record.read("/steps/pose", step - 1, step + 1)
    if b < record.robots:
        return float(least_gap_pair(shapes, a, old[a], new[a], b, old[b], new[b], record.dt)[0])
    walls = record.walls
    first, last = walls.body_start[b - record.robots : b - record.robots + 2]
    parts: IntArray = np.arange(first, last)
    return float(least_gap_walls(shapes, a, old[a], new[a], walls, parts, record.dt)[0])
