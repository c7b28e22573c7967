"""Do engine and analysis agree on a case, and if they differ, why? And what a whole test found.

Three things are compared: the sample P of the first physical contact; the signed distances d
at the samples, on the exact arcs; the collision time xi.

1. P is the first sample with d <= CONTACT. At the samples the engine's poses lie on the exact
   arcs to rounding, so this is exact, but for distances within ROUNDING of CONTACT.
2. xi is not late: d > CONTACT at every sample before xi - TIME.
3. xi is true: the shapes are within CONTACT at xi.
4. P is sample ceil((xi - TIME) / dt), that is xi - TIME <= P dt < xi + dt. If it is not, then
   by 1 and 2 no sample lies in the contact that begins at xi: it is a graze between samples.

What fails 1, 2 or 3 by no more than the tolerance is reported as such; what fails by more is
unexplained. A report counts verdicts by kind and time step, tells the lag of contacts behind
xi, and lists every unexplained case.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.analysis.crashtest.drafts import KINDS, TIME_STEPS
from physim.geometry.shapes import FloatArray
from physim.json_text import json_text
from physim.tolerances import CONTACT, ROUNDING, TIME

NEVER = -1
"""Sample of a contact that does not happen."""


class Verdict(IntEnum):
    """What became of a case."""

    SAME_SAMPLE = 0
    """contact, in the sample that xi predicts"""
    NO_CONTACT = 1
    """by neither"""
    GRAZE = 2
    """touching between two samples only: no sample lies in the analytic contact"""
    TOLERANCE = 3
    """the distance that decides is within the tolerance"""
    UNEXPLAINED = 4


WORDS = ("same sample", "no contact", "graze between samples", "within tolerance", "unexplained")
"""Name of each `Verdict`."""


def first_sample(distance: FloatArray) -> int:
    """First sample at which a distance (K,) is a contact, or NEVER."""
    touching = distance <= CONTACT
    return int(touching.argmax()) if touching.any() else NEVER


def classify(
    dt: float, physical: int, xi: float, gap: float, distance: FloatArray
) -> tuple[Verdict, str]:
    """Verdict on one case, with what is wrong where it is unexplained.

    Of the sample of its first physical contact, xi [s], the distance at xi and at the samples [m].
    """
    tolerance = False
    if physical != (first := first_sample(distance)):
        early = first == NEVER or NEVER < physical < first
        at = physical if early else first
        if abs(distance[at] - CONTACT) > ROUNDING:
            says, shapes = ("contact", "are") if early else ("no contact", "overlap by")
            there = f"{distance[at]:.3g} m apart" if early else f"{-distance[at]:.3g} m"
            return Verdict.UNEXPLAINED, (
                f"the engine reports {says} at sample {at}, where the shapes {shapes} {there}"
            )
        tolerance = True
    before = distance[np.arange(len(distance)) * dt < xi - TIME]
    if len(before) and (least := float(before.min())) <= CONTACT:
        if least < -CONTACT:
            sample, when = first_sample(before), f"{xi:.9g} s" if xi < np.inf else "never"
            return Verdict.UNEXPLAINED, (
                f"the collision time is late ({when}): the shapes overlap by "
                f"{-before[sample]:.3g} m at sample {sample}"
            )
        tolerance = True
    if xi < np.inf and not gap <= CONTACT + ROUNDING:
        return Verdict.UNEXPLAINED, (
            f"the collision time {xi:.9g} s is false: the shapes are {gap:.3g} m apart then"
        )
    if tolerance:
        return Verdict.TOLERANCE, ""
    if xi == np.inf:
        return Verdict.NO_CONTACT, ""
    if physical != NEVER and physical * dt < xi + dt:
        return Verdict.SAME_SAMPLE, ""
    return Verdict.GRAZE, ""


QUANTILES = {"least": 0.0, "5 %": 0.05, "median": 0.5, "95 %": 0.95, "most": 1.0}
BINS = 10
"""of the histogram of the lag over a step"""


@dataclass(frozen=True)
class Unexplained:
    """One case on which engine and analysis differ for no known reason."""

    number: int
    kind: str
    dt: float
    """[s]"""
    physical_sample: int | None
    """of the first physical contact"""
    collision_time: float | None
    """[s]"""
    expected_sample: int | None
    """ceil((xi - TIME) / dt)"""
    reason: str
    world: str | None = None
    """file of the world that replays it"""


MOST_LISTED = 10
"""Unexplained cases that are listed one by one; the JSON has them all."""
ROW = np.dtype(
    [("kind", "i1"), ("step", "i1"), ("verdict", "i1"), ("renewed", "?"), ("lag", "f8"),
     ("off", "f8"), ("chord", "f8"), ("beyond", "?"), ("swept", "?")]
)  # fmt: skip
"""A case: numbers of its kind, time step and `Verdict`; whether the search for its collision time
went on from a lower bound; share of a step by which the physical contact is later than xi, where
in the same sample (else NaN); how far the swept contact is from xi [s], where the shapes close at
CLOSING_SPEED or more (else NaN); chord tolerance [m]; whether at the swept contact the shapes, on
the exact arcs, are farther from touching than that; whether there is a swept contact."""


@dataclass
class CrashReport:
    """Outcome of a crash test; equal for equal seed and number of cases."""

    seed: int
    asked: int
    """cases that were asked for"""
    batches: list[NDArray[np.void]] = field(default_factory=list)
    """rows of `ROW`"""
    unexplained: list[Unexplained] = field(default_factory=list)
    rejected: int = 0
    """false contacts of the engine that were kept out"""
    interrupted: bool = False
    """whether fewer cases were compared than were asked for"""

    @property
    def rows(self) -> NDArray[np.void]:
        """(M,) rows of `ROW`, of the cases that were compared."""
        return np.concatenate([np.zeros(0, ROW), *self.batches])

    @property
    def cases(self) -> int:
        """Cases compared."""
        return sum(map(len, self.batches))

    def count(self, verdict: Verdict) -> int:
        """Cases with a verdict."""
        return int((self.rows["verdict"] == verdict).sum())

    def to_json(self) -> str:
        """JSON text: the same for the same seed and number of cases."""
        rows = self.rows
        kinds, steps = _tables(rows)
        lag, flat = rows["lag"], rows["chord"] == 0.0
        seen, grazes = rows["swept"], rows["verdict"] == Verdict.GRAZE
        tree = {
            "format": "physim-crashtest",
            "version": 1,
            "seed": self.seed,
            "cases": self.cases,
            "cases_asked": self.asked,
            "interrupted": self.interrupted,
            "verdicts": _counts(rows),
            "rejected_false_contacts": self.rejected,
            "by_kind": kinds,
            "by_time_step": steps,
            "contact_after_collision_time": {
                "unit": "share of a step",
                **_spread(lag),
                "histogram": np.histogram(
                    np.clip(lag[~np.isnan(lag)], 0.0, 1.0), BINS, (0.0, 1.0)
                )[0].tolist(),
            },
            "swept_contact_against_collision_time": {
                "unit": "s",
                "straight": _spread(rows["off"][flat]),
                "arcs": _spread(rows["off"][~flat]),
                "beyond_chord_tolerance": int(rows["beyond"].sum()),
            },
            "grazes_found_by_swept_check": {
                name: {"found": int((seen & some).sum()), "of": int(some.sum())}
                for name, some in (("straight", grazes & flat), ("arcs", grazes & ~flat))
            },
            "searches_taken_up_again": int(rows["renewed"].sum()),
            "unexplained": self.unexplained,
        }  # fmt: skip
        return json_text(tree)


def _counts(rows: NDArray[np.void]) -> dict[str, int]:
    counted = np.bincount(rows["verdict"], minlength=len(WORDS)).tolist()
    return dict(zip(WORDS, counted, strict=True))


def _tables(rows: NDArray[np.void]) -> tuple[dict[str, dict[str, int]], ...]:
    """Verdicts by kind and by time step."""
    kinds = {name: _counts(rows[rows["kind"] == k]) for k, name in enumerate(KINDS)}
    steps = {f"{dt:g}": _counts(rows[rows["step"] == k]) for k, dt in enumerate(TIME_STEPS)}
    return kinds, steps


def _spread(values: FloatArray) -> dict[str, Any]:
    """How many values are known, and their quantiles."""
    known = values[~np.isnan(values)]
    shares = {name: float(np.quantile(known, at)) for name, at in QUANTILES.items() if len(known)}
    return {"contacts": len(known), "quantiles": shares or None}


def text(report: CrashReport) -> str:
    """Verdicts by kind and by time step for people; the last line is that on all."""
    kinds, steps = _tables(report.rows)
    lines = _table({**kinds, "all": _counts(report.rows)})
    lines += ["", *_table({f"step {dt} s": counts for dt, counts in steps.items()}), ""]
    missed = report.unexplained
    lines += [
        f"  case {one.number} ({one.kind}, step {one.dt:g} s): {one.reason}"
        + (f" -> {one.world}" if one.world else "")
        for one in missed[:MOST_LISTED]
    ]
    if len(missed) > MOST_LISTED:
        lines.append(f"  and {len(missed) - MOST_LISTED} more")
    of = f"of {report.cases} cases (seed {report.seed})"
    verdict = f"engine and analysis agree: 0 {of} unexplained"
    if missed:
        verdict = f"checks disagree: {len(missed)} {of} unexplained"
    if report.interrupted:
        verdict += f"; interrupted before the other {report.asked - report.cases:,}"
    return "\n".join([*lines, verdict]) + "\n"


def _table(counts: Mapping[str, Mapping[str, int]]) -> list[str]:
    rows: list[tuple[str, ...]] = [
        ("", "cases", "same sample", "no contact", "graze", "tolerance", "unexplained")
    ]
    for name, some in counts.items():
        rows.append((name, str(sum(some.values())), *map(str, some.values())))
    first, *widths = (max(map(len, column)) for column in zip(*rows, strict=True))
    return [
        "  ".join([name.ljust(first), *map(str.rjust, cells, widths)]).rstrip()
        for name, *cells in rows
    ]
