"""The distances in a record against exact ones, worked out anew at every sample of every robot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physim.geometry.clearance import clearances
from physim.geometry.nearby import build_nearby
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record
from physim.record.extremes import Extremes
from physim.validation.findings import DEPTH_SLACK, UNEXPLAINED, Disagreement
from physim.validation.ledger import blocks, robot_shapes
from physim.validation.rows import distance_at

REACH, CELL = 10.0, 2.0
"""[m] of the look-up of walls: a matter of speed, not of values"""


@dataclass(frozen=True)
class Exact:
    """What the shapes say at all samples."""

    extremes: Extremes
    """shortest and largest distances, when, of whom"""
    disagreements: tuple[Disagreement, ...]
    """where ``/steps/clearance`` or ``/steps/boundary_clearance`` differ by more than
    `DEPTH_SLACK`: one for each robot and block of samples"""


def exact_distances(record: Record) -> Exact:
    """Work out every distance of a record with the poses of every step, block by block."""
    shapes, walls = robot_shapes(record), record.walls
    nearby = build_nearby(walls, REACH, CELL)
    extremes = Extremes(record.robots)
    found: list[Disagreement] = []
    for poses, start in blocks(record):
        first = 0 if start == 0 else 1
        block = clearances(poses[first:], shapes, walls, nearby)
        step = np.arange(start + first, start + len(poses))
        extremes.note(step, block)
        for path, exact, others, what in (
            ("/steps/clearance", block.clearance, block.other, "nearest robot"),
            ("/steps/boundary_clearance", block.boundary_clearance, block.boundary_other,
             "nearest boundary"),
        ):  # fmt: skip
            told = record.read(path, start + first, start + len(poses))
            found += _differences(record, step, told, exact, others, what)
    return Exact(extremes, tuple(found))


def _differences(
    record: Record, step: IntArray, told: FloatArray, exact: FloatArray, others: IntArray, what: str
) -> list[Disagreement]:
    wrong = _differ(told, exact)
    found = []
    for i in np.flatnonzero(wrong.any(axis=0)).tolist():
        k = int(np.argmax(wrong[:, i]))
        count = int(np.count_nonzero(wrong[:, i]))
        text = (
            f"distance to the {what} {told[k, i]:.9g} m in the record, "
            f"{exact[k, i]:.9g} m by the shapes"
        )
        found.append(
            _one(record, i, int(others[k, i]), int(step[k]), float(exact[k, i]), text, count)
        )
    return found


def recorded_extremes(record: Record, exact: Exact, reach: float) -> list[Disagreement]:
    """Where ``/extremes`` and ``/extremes_farthest`` are not those of the shapes.

    Values below ``reach`` [m] are held against the ledger elsewhere. A run that was killed has
    notes only up to its last burst of writing: they are left out.
    """
    if record.ended == "running":
        return []
    found = []
    for value, when, who, most in (
        ("clearance", "clearance_step", "clearance_other", "nearest robot"),
        ("boundary_clearance", "boundary_step", "boundary_other", "nearest boundary"),
    ):
        for i, (told, true) in enumerate(zip(record.extremes, exact.extremes.rows, strict=True)):
            what = f"smallest distance to the {most}"
            if _differ(told[value], true[value]) and min(told[value], true[value]) <= reach:
                continue
            found += _moment(record, i, told, true, (value, when, who), what)
    told, true = record.farthest, exact.extremes.farthest
    i = max(int(told["a"]), 0)
    found += _moment(record, i, told, true, ("farthest", "step", "b"), "largest distance of robots")
    return found


def _moment(
    record: Record,
    i: int,
    told: NDArray[np.void] | np.void,
    true: NDArray[np.void] | np.void,
    columns: tuple[str, str, str],
    what: str,
) -> list[Disagreement]:
    """Disagreement about one extreme value, or about when and of whom it was; or none."""
    value, when, who = columns
    noted, exact, at, it = float(told[value]), float(true[value]), int(told[when]), int(told[who])
    if not _differ(noted, exact):
        if not np.isfinite(exact):
            return []
        if 0 <= at < record.samples and it >= 0 and it != i:
            there = distance_at(record, min(i, it), max(i, it), at)
            if abs(there - exact) <= DEPTH_SLACK:
                return []
            text = f"{what}: at this sample in the record, but the shapes are {there:.9g} m apart"
            return [_one(record, i, it, at, exact, f"{text} then")]
    true_at, true_it = int(true[when]), int(true[who])
    names = [body.name for body in record.bodies]
    of = f"{names[true_it]} at {true_at * record.dt:.2f} s" if true_it >= 0 else "nothing"
    its = f"{names[it]} at {at * record.dt:.2f} s" if it >= 0 else "nothing"
    text = f"{what} {noted:.9g} m ({its}) in the record, {exact:.9g} m ({of}) by the shapes"
    return [_one(record, i, true_it, max(true_at, 0), exact, text)]


def _one(
    record: Record, i: int, it: int, step: int, exact: float, what: str, count: int = 1
) -> Disagreement:
    a, b = (i, None) if it < 0 or it == i else (min(i, it), max(i, it))
    return Disagreement(a, b, step, count, step * record.dt, exact, UNEXPLAINED, what)


def _differ(told: FloatArray | float, exact: FloatArray | float) -> NDArray[np.bool_]:
    """Whether they differ by more than `DEPTH_SLACK`; infinite ones must be equal."""
    with np.errstate(invalid="ignore"):
        return np.asarray(~((told == exact) | (np.abs(np.subtract(told, exact)) <= DEPTH_SLACK)))
