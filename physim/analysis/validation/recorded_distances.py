"""The distances in a record against exact ones, computed anew at every sample of every robot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.analytic_contacts import AnalyticContacts, pose_blocks
from physim.analysis.validation.disagreements import DEPTH_SLACK, Disagreement, distance_at
from physim.analysis.validation.mismatch import differs
from physim.geometry.clearance import clearances
from physim.geometry.shapes import FloatArray, IntArray
from physim.geometry.wall_grid import build_wall_grid
from physim.record import Record
from physim.record.layout import NO_EXTREME
from physim.record.writer import Extremes

REACH, CELL = 10.0, 2.0
"""[m] of the look-up of walls: a matter of speed, not of values"""
SMALLEST = (
    (("clearance", "clearance_step", "clearance_other"), "nearest robot"),
    (("boundary_clearance", "boundary_step", "boundary_other"), "nearest boundary"),
)
"""Columns of a row of extremes: value, sample and other body; and what they are about."""


@dataclass(frozen=True)
class Exact:
    """What the shapes say at all samples."""

    extremes: Extremes
    """shortest and largest distances, when, of whom"""
    disagreements: tuple[Disagreement, ...]
    """where ``/steps/clearance`` or ``/steps/boundary_clearance`` differ by more than
    `DEPTH_SLACK`: one for each robot and block of samples"""


def exact_distances(record: Record) -> Exact:
    """Compute every distance of a record with the poses of every step, block by block."""
    shapes, walls = record.shapes, record.walls
    wall_grid = build_wall_grid(walls, REACH, CELL)
    extremes = Extremes(record.robots)
    found: list[Disagreement] = []
    for poses, start in pose_blocks(record):
        first = 0 if start == 0 else 1
        block = clearances(poses[first:], shapes, walls, wall_grid)
        step = np.arange(start + first, start + len(poses))
        extremes.note(step, block)
        for path, exact, others, what in (
            ("/steps/clearance", block.clearance, block.other, "nearest robot"),
            ("/steps/boundary_clearance", block.boundary_clearance, block.boundary_other,
             "nearest boundary"),
        ):  # fmt: skip
            recorded = record.read(path, start + first, start + len(poses))
            found += _differences(record, step, recorded, exact, others, what)
    return Exact(extremes, tuple(found))


def _differences(
    record: Record,
    step: IntArray,
    recorded: FloatArray,
    exact: FloatArray,
    others: IntArray,
    what: str,
) -> list[Disagreement]:
    wrong = differs(recorded, exact, DEPTH_SLACK)
    found = []
    for i in np.flatnonzero(wrong.any(axis=0)).tolist():
        k = int(np.argmax(wrong[:, i]))
        text = (
            f"distance to the {what} {recorded[k, i]:.9g} m in the record, "
            f"{exact[k, i]:.9g} m by the shapes"
        )
        pair = _pair(i, int(others[k, i]))
        count = int(np.count_nonzero(wrong[:, i]))
        found.append(Disagreement.at(record, pair, step[k], exact[k, i], text, steps=count))
    return found


def check_extremes(record: Record, analytic: AnalyticContacts, exact: Exact) -> list[Disagreement]:
    """Where ``/extremes`` and ``/extremes_farthest`` are not those of the shapes.

    Smallest distances within reach of the analytic contacts are held against their approaches,
    which another code finds than notes them during a run, all else against the exact distances.
    """
    found, near = [], _nearest(record, analytic)
    for i, (noted, true) in enumerate(zip(record.extremes, exact.extremes.rows, strict=True)):
        for columns, what in SMALLEST:
            within = min(noted[columns[0]], near[i][columns[0]]) <= analytic.reach
            row, none = (near[i], f"over {analytic.reach:.3g} m") if within else (true, "none")
            text = f"smallest distance to the {what}"
            found += _moment(record, i, noted, row, columns, text, none)
    noted, true = record.farthest, exact.extremes.farthest
    columns, text = ("farthest", "step", "b"), "largest distance of robots"
    found += _moment(record, max(int(noted["a"]), 0), noted, true, columns, text, "none")
    return found


def _nearest(record: Record, analytic: AnalyticContacts) -> NDArray[np.void]:
    """Smallest distances of each robot by its approaches, as rows of extremes (N,)."""
    near: NDArray[np.void] = np.full(record.robots, NO_EXTREME)
    for one in reversed(analytic.approaches):  # ends with the nearest
        columns, _ = SMALLEST[one.b >= record.robots]
        for me, other in ((one.a, one.b), (one.b, one.a)):
            if me < record.robots:
                for column, value in zip(columns, (one.distance, one.step, other), strict=True):
                    near[column][me] = value
    return near


def _moment(
    record: Record,
    i: int,
    noted: NDArray[np.void] | np.void,
    true: NDArray[np.void] | np.void,
    columns: tuple[str, str, str],
    what: str,
    none: str,
) -> list[Disagreement]:
    """Disagreement about one extreme value, or about when and of whom it was; or none.

    ``none`` is what is said where the shapes have no such value.
    """
    value, when, who = columns
    exact, at, other = float(true[value]), int(noted[when]), int(noted[who])
    if not differs(noted[value], exact, DEPTH_SLACK):
        if not np.isfinite(exact):
            return []
        if 0 <= at < record.samples and other >= 0 and other != i:
            there = distance_at(record, min(i, other), max(i, other), at)
            if abs(there - exact) <= DEPTH_SLACK:
                return []
            text = f"{what}: at this sample in the record, but the shapes are {there:.9g} m apart"
            return [Disagreement.at(record, _pair(i, other), at, exact, f"{text} then")]
    names = [body.name for body in record.bodies]
    recorded, shapes = (
        f"{row[value]:.9g} m ({names[row[who]]} at {row[when] * record.dt:.2f} s)"
        if row[who] >= 0
        else absent
        for row, absent in ((noted, f"{noted[value]:.9g} m (of nothing)"), (true, none))
    )
    text = f"{what} {recorded} in the record, {shapes} by the shapes"
    return [Disagreement.at(record, _pair(i, int(true[who])), max(int(true[when]), 0), exact, text)]


def _pair(i: int, other: int) -> tuple[int, int | None]:
    """Body ids of a disagreement, the lower first; one where there is no other."""
    return (i, None) if other < 0 or other == i else (min(i, other), max(i, other))
