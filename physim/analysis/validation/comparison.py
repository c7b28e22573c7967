"""Physical contacts held against the analytic ones, step by step and pair by pair.

A disagreement has a cause. Explained are

- ``within tolerance``: the signed distance is within CONTACT = 1e-9 m of 0, where either answer
  is right;
- ``graze between samples``: apart at both samples of a step, touching in between. The engine
  looks at samples only; the swept check finds these, and the record lists them as contacts of
  their own kind;
- ``rejected false contact of the engine``: the engine reported a contact of shapes that are apart,
  and the exact check kept it out.

Everything else is ``unexplained``: one of the two is wrong.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.analytic_contacts import AnalyticContacts
from physim.analysis.validation.disagreements import (
    DEPTH_SLACK,
    ROUNDING,
    TOLERANCE,
    UNEXPLAINED,
    Disagreement,
    distances_over,
    distinct,
    row_keys,
    stretches,
)
from physim.analysis.validation.recorded_contacts import (
    check_contact_rows,
    check_false_contacts,
    check_swept_contacts,
)
from physim.analysis.validation.recorded_distances import Exact, check_extremes
from physim.contacts import touching
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record
from physim.tolerances import CONTACT


class Confusion(NamedTuple):
    """How often engine and shapes say contact or apart, counted over pairs and steps."""

    both: int
    physical_only: int
    analytic_only: int
    neither: int


@dataclass(frozen=True)
class Comparison:
    """Tables for the kinds of pairs, and every disagreement in the order of time."""

    at_samples: dict[str, Confusion]
    """keys "robots" and "boundaries": contact at a sample"""
    over_steps: dict[str, Confusion]
    """contact at any instant from one sample to the next, both included"""
    rejected: int
    """contacts between separated shapes that the engine reported and its guard kept out, counted
    over pairs and samples"""
    disagreements: tuple[Disagreement, ...]

    @property
    def unexplained(self) -> int:
        """Number of disagreements without a cause."""
        return sum(one.cause == UNEXPLAINED for one in self.disagreements)


def compare(record: Record, analytic: AnalyticContacts, exact: Exact) -> Comparison:
    """Hold contacts and distances of a record against the shapes.

    Raises RecordError for a contact between samples before the start.
    """
    bodies = len(record.bodies)
    physical = touching(record.contacts)
    theirs = distinct(row_keys(physical, bodies))
    ours = row_keys(analytic.touching, bodies)  # each once, in order
    found = _at_samples(record, theirs, ours, analytic.touching["distance"])
    found += check_swept_contacts(record, analytic)
    found += check_false_contacts(record)
    found += _lost_entries(record, analytic)
    found += _depths(record, physical, analytic)
    found += exact.disagreements
    found += check_extremes(record, analytic, exact)
    found += check_contact_rows(record)
    found.sort(key=lambda one: (one.step, one.a, -1 if one.b is None else one.b))
    spread = _spread(ours, bodies, analytic.samples)
    swept = distinct(np.concatenate((spread, row_keys(analytic.grazes, bodies))))
    return Comparison(
        _tables(record, analytic, theirs, ours, analytic.samples),
        _tables(
            record, analytic, _spread(theirs, bodies, analytic.samples), swept, analytic.samples - 1
        ),
        len(record.false_contacts),
        tuple(found),
    )


def _spread(keys: IntArray, bodies: int, samples: int) -> IntArray:
    """Steps (numbered by the sample at their end) that have one of these samples at an end."""
    step = keys // (bodies * bodies)
    both = np.concatenate((keys[step > 0], keys[step < samples - 1] + bodies * bodies))
    return distinct(both)


def _tables(
    record: Record, analytic: AnalyticContacts, theirs: IntArray, ours: IntArray, times: int
) -> dict[str, Confusion]:
    def table(pairs: int, robots: bool) -> Confusion:
        n = len(record.bodies)
        a, b = (keys[(keys % n < record.robots) == robots] for keys in (theirs, ours))
        both = len(np.intersect1d(a, b, assume_unique=True))
        total = pairs * max(0, times)
        rest = total - len(a) - len(b) + both
        return Confusion(both, len(a) - both, len(b) - both, rest)

    return {
        "robots": table(analytic.robot_pairs, True),
        "boundaries": table(analytic.wall_pairs, False),
    }


def _at_samples(
    record: Record, theirs: IntArray, ours: IntArray, distances: FloatArray
) -> list[Disagreement]:
    """Samples at which one says contact and the other apart; ours with their ``distances``."""
    found = []
    bodies = len(record.bodies)
    claim = "contact in the record, shapes apart"
    for a, b, step, steps in stretches(np.setdiff1d(theirs, ours, assume_unique=True), bodies):
        exact = np.array(distances_over(record, a, b, step, steps))
        found.append(_of_stretch(record, (a, b), step, steps, exact, claim))
    claim = "no contact in the record, shapes overlap"
    for a, b, step, steps in stretches(np.setdiff1d(ours, theirs, assume_unique=True), bodies):
        keys = ((step + np.arange(steps)) * bodies + a) * bodies + b
        exact = distances[np.searchsorted(ours, keys)]
        found.append(_of_stretch(record, (a, b), step, steps, exact, claim))
    return found


def _of_stretch(
    record: Record, pair: tuple[int, int], step: int, steps: int, exact: FloatArray, claim: str
) -> Disagreement:
    """Of a pair at so many samples, explained where all are as good as touching."""
    close = bool((np.abs(exact) <= CONTACT + ROUNDING).all())
    cause = TOLERANCE if close else UNEXPLAINED
    return Disagreement.at(record, pair, step, exact[0], claim, steps=steps, cause=cause)


def _lost_entries(record: Record, analytic: AnalyticContacts) -> list[Disagreement]:
    """Contacts at a sample whose beginning the swept check did not find in the step before."""
    what = "touching at the sample, but no contact in the step that led to it"
    return [
        Disagreement.at(
            record, (int(row["a"]), int(row["b"])), row["step"], row["distance"], what,
            cause=TOLERANCE if abs(row["distance"]) <= CONTACT + ROUNDING else UNEXPLAINED,
        )
        for row in analytic.touching[np.isinf(analytic.touching["entry"])]
    ]  # fmt: skip


def _depths(
    record: Record, physical: NDArray[np.void], analytic: AnalyticContacts
) -> list[Disagreement]:
    """Contacts whose recorded depth is not that of the shapes."""
    n = len(record.bodies)
    both, i, j = np.intersect1d(
        row_keys(physical, n), row_keys(analytic.touching, n), return_indices=True
    )
    depth, distance = physical["depth"][i], analytic.touching["distance"][j]
    wrong = np.abs(depth - np.maximum(-distance, 0.0)) > DEPTH_SLACK
    found = []
    for a, b, step, steps in stretches(both[wrong], n):
        k = int(np.searchsorted(both, (step * n + a) * n + b))
        what = f"depth {depth[k]:.3g} m in the record, {max(-distance[k], 0.0):.3g} m by the shapes"
        found.append(Disagreement.at(record, (a, b), step, distance[k], what, steps=steps))
    return found
