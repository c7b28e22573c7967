"""Physical contacts held against the analytic ledgers, step by step and pair by pair.

A disagreement has a cause. Explained are

- ``within tolerance``: the signed distance is within CONTACT = 1e-9 m of 0, where either answer
  is right;
- ``graze between samples``: apart at both samples of a step, touching in between. The engine
  looks at samples only; the swept check finds these, and the record tells them as contacts of
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

from physim.contacts import touching
from physim.errors import RecordError
from physim.geometry.shapes import IntArray
from physim.record import Record
from physim.tolerances import CONTACT
from physim.validation.contact_rows import contact_rows
from physim.validation.events import false_contacts, grazes
from physim.validation.findings import DEPTH_SLACK, ROUNDING, TOLERANCE, UNEXPLAINED, Disagreement
from physim.validation.ledger import Ledger
from physim.validation.recorded import Exact, recorded_extremes
from physim.validation.rows import body_keys, distance_at, stretches


class Confusion(NamedTuple):
    """How often two ledgers say contact or apart, counted over pairs and steps."""

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


def compare(record: Record, ledger: Ledger, exact: Exact) -> Comparison:
    """Hold contacts and distances of a record against the shapes.

    Raises RecordError for an impossible id.
    """
    bodies = len(record.bodies)
    physical = physical_rows(record)
    theirs = body_keys(physical, bodies)
    ours = body_keys(ledger.touching, bodies)
    found = _at_samples(record, physical, ledger, theirs, ours)
    found += grazes(record, ledger)
    found += false_contacts(record)
    found += _lost_entries(record, ledger)
    found += _depths(record, physical, ledger, theirs, ours)
    found += _extremes(record, ledger)
    found += exact.disagreements
    found += recorded_extremes(record, exact, ledger.reach)
    found += contact_rows(record)
    found.sort(key=lambda one: (one.step, one.a, -1 if one.b is None else one.b))
    swept = np.union1d(_spread(ours, bodies, ledger.samples), body_keys(ledger.grazes, bodies))
    return Comparison(
        _tables(record, ledger, theirs, ours, ledger.samples),
        _tables(record, ledger, _spread(theirs, bodies, ledger.samples), swept, ledger.samples - 1),
        len(record.false_contacts),
        tuple(found),
    )


def physical_rows(record: Record) -> NDArray[np.void]:
    """Contact rows at which the engine says that two bodies touch."""
    rows = record.contacts
    count = len(record.bodies)
    wrong = (rows["a"] < 0) | (rows["a"] >= rows["b"]) | (rows["b"] >= count)
    wrong |= (rows["a"] >= record.robots) | (rows["step"] < 0) | (rows["step"] >= record.samples)
    if wrong.any():
        row = rows[int(np.argmax(wrong))]
        raise RecordError(
            f"{record.path or 'record in memory'}: a contact at step {row['step']} of bodies "
            f"{row['a']} and {row['b']}; bodies are 0 to {count - 1}, "
            f"steps 0 to {record.samples - 1}"
        )
    return touching(rows)


def _spread(keys: IntArray, bodies: int, samples: int) -> IntArray:
    """Steps (numbered by the sample at their end) that have one of these samples at an end."""
    step = keys // (bodies * bodies)
    both = np.concatenate((keys[step > 0], keys[step < samples - 1] + bodies * bodies))
    return np.unique(both)


def _tables(
    record: Record, ledger: Ledger, theirs: IntArray, ours: IntArray, times: int
) -> dict[str, Confusion]:
    def table(pairs: int, robots: bool) -> Confusion:
        n = len(record.bodies)
        a, b = (keys[(keys % n < record.robots) == robots] for keys in (theirs, ours))
        both = len(np.intersect1d(a, b, assume_unique=True))
        total = pairs * max(0, times)
        rest = total - len(a) - len(b) + both
        return Confusion(both, len(a) - both, len(b) - both, rest)

    return {
        "robots": table(ledger.robot_pairs, True),
        "boundaries": table(ledger.wall_pairs, False),
    }


def _at_samples(
    record: Record,
    physical: NDArray[np.void],
    ledger: Ledger,
    theirs: IntArray,
    ours: IntArray,
) -> list[Disagreement]:
    """Samples at which one says contact and the other apart."""
    found = []
    for keys, claim in (
        (np.setdiff1d(theirs, ours), "contact in the record, shapes apart"),
        (np.setdiff1d(ours, theirs), "no contact in the record, shapes overlap"),
    ):
        for a, b, step, steps in stretches(keys, len(record.bodies)):
            at = [distance_at(record, a, b, step + k) for k in range(min(steps, 1000))]
            close = all(abs(d) <= CONTACT + ROUNDING for d in at)
            found.append(
                Disagreement(
                    a,
                    b,
                    step,
                    steps,
                    step * record.dt,
                    at[0],
                    TOLERANCE if close else UNEXPLAINED,
                    claim,
                )
            )
    return found


def _lost_entries(record: Record, ledger: Ledger) -> list[Disagreement]:
    """Contacts at a sample whose beginning the swept check did not find in the step before."""
    rows = ledger.touching[np.isinf(ledger.touching["entry"])]
    return [
        Disagreement(
            int(row["a"]),
            int(row["b"]),
            int(row["step"]),
            1,
            float(row["step"] * record.dt),
            float(row["distance"]),
            TOLERANCE if abs(row["distance"]) <= CONTACT + ROUNDING else UNEXPLAINED,
            "touching at the sample, but no contact in the step that led to it",
        )
        for row in rows
    ]


def _depths(
    record: Record,
    physical: NDArray[np.void],
    ledger: Ledger,
    theirs: IntArray,
    ours: IntArray,
) -> list[Disagreement]:
    """Contacts whose recorded depth is not that of the shapes."""
    rows, n = ledger.touching, len(record.bodies)
    both = np.intersect1d(theirs, ours, assume_unique=True)
    depth = np.zeros(len(both))
    distance = np.zeros(len(both))
    depth[np.searchsorted(both, _where(physical, n, both)[1])] = physical["depth"][
        _where(physical, n, both)[0]
    ]
    distance[np.searchsorted(both, _where(rows, n, both)[1])] = rows["distance"][
        _where(rows, n, both)[0]
    ]
    wrong = np.abs(depth - np.maximum(-distance, 0.0)) > DEPTH_SLACK
    found = []
    for a, b, step, steps in stretches(both[wrong], n):
        k = int(np.searchsorted(both, (step * n + a) * n + b))
        what = f"depth {depth[k]:.3g} m in the record, {max(-distance[k], 0.0):.3g} m by the shapes"
        found.append(
            Disagreement(a, b, step, steps, step * record.dt, float(distance[k]), UNEXPLAINED, what)
        )
    return found


def _where(rows: NDArray[np.void], bodies: int, keys: IntArray) -> tuple[IntArray, IntArray]:
    """Places of rows whose key is among ``keys``, and their keys."""
    key = ((rows["step"] * bodies + rows["a"]) * bodies + rows["b"]).astype(np.int64)
    place = np.flatnonzero(np.isin(key, keys))
    return place.astype(np.int64), key[place]


def _extremes(record: Record, ledger: Ledger) -> list[Disagreement]:
    """Smallest distance of each robot, as noted during the run, against the approaches.

    A run that was killed has notes only up to its last burst of writing: they are left out.
    """
    found: list[Disagreement] = []
    if record.ended == "running":
        return found
    for value, step, other, robots in (
        ("clearance", "clearance_step", "clearance_other", True),
        ("boundary_clearance", "boundary_step", "boundary_other", False),
    ):
        least = np.full(record.robots, np.inf)
        when = np.full(record.robots, -1)
        whom = np.full(record.robots, -1)
        for near in reversed(ledger.approaches):  # ends with the nearest
            if (near.b < record.robots) == robots:
                for me, it in ((near.a, near.b), (near.b, near.a)):
                    if me < record.robots:
                        least[me], when[me], whom[me] = near.distance, near.step, it
        for i, row in enumerate(record.extremes):
            noted = float(row[value])
            if min(noted, least[i]) > ledger.reach or abs(noted - least[i]) <= DEPTH_SLACK:
                continue
            at, it = (when[i], whom[i]) if least[i] < noted else (row[step], row[other])
            what = (
                f"smallest distance {noted:.6g} m in the record, "
                + (f"{least[i]:.6g} m" if np.isfinite(least[i]) else f"over {ledger.reach:.3g} m")
                + " by the shapes"
            )
            a, b = (i, None) if it < 0 else (min(i, int(it)), max(i, int(it)))
            found.append(
                Disagreement(
                    a, b, int(at), 1, float(at * record.dt), float(least[i]), UNEXPLAINED, what
                )
            )
    return found
