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

import json
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.analysis.crashtest.drawing import KINDS, TIME_STEPS
from physim.geometry.shapes import FloatArray, IntArray
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


class Classified(NamedTuple):
    """Verdict on one case, with what is wrong where it is unexplained."""

    verdict: Verdict
    reason: str = ""


def first_sample(distance: FloatArray) -> int:
    """First sample at which a distance (K,) is a contact, or NEVER."""
    touching = distance <= CONTACT
    return int(touching.argmax()) if touching.any() else NEVER


def classify(dt: float, physical: int, xi: float, gap: float, distance: FloatArray) -> Classified:
    """Verdict on one case.

    Of the sample of its first physical contact, xi [s], the distance at xi and at the samples [m].
    """
    tolerance = False
    if physical != (first := first_sample(distance)):
        early = first == NEVER or NEVER < physical < first
        at = physical if early else first
        if abs(distance[at] - CONTACT) > ROUNDING:
            return Classified(Verdict.UNEXPLAINED, _sample_reason(early, at, float(distance[at])))
        tolerance = True
    before = distance[np.arange(len(distance)) * dt < xi - TIME]
    if len(before) and (least := float(before.min())) <= CONTACT:
        if least < -CONTACT:
            return Classified(Verdict.UNEXPLAINED, _late_reason(before, xi))
        tolerance = True
    if xi < np.inf and not gap <= CONTACT + ROUNDING:
        return Classified(
            Verdict.UNEXPLAINED,
            f"the collision time {xi:.9g} s is false: the shapes are {gap:.3g} m apart then",
        )
    if tolerance:
        return Classified(Verdict.TOLERANCE)
    if xi == np.inf:
        return Classified(Verdict.NO_CONTACT)
    if physical != NEVER and physical * dt < xi + dt:
        return Classified(Verdict.SAME_SAMPLE)
    return Classified(Verdict.GRAZE)


def _sample_reason(early: bool, sample: int, distance: float) -> str:
    if early:
        return (
            f"the engine reports contact at sample {sample}, where the shapes are "
            f"{distance:.3g} m apart"
        )
    return (
        f"the engine reports no contact at sample {sample}, where the shapes overlap by "
        f"{-distance:.3g} m"
    )


def _late_reason(before: FloatArray, xi: float) -> str:
    sample = first_sample(before)
    when = f"{xi:.9g} s" if xi < np.inf else "never"
    return (
        f"the collision time is late ({when}): the shapes overlap by "
        f"{-before[sample]:.3g} m at sample {sample}"
    )


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


@dataclass
class CrashReport:
    """Outcome of a crash test; equal for equal seed and number of cases."""

    seed: int
    asked: int
    """cases that were asked for"""
    kind: list[IntArray] = field(default_factory=list)
    step: list[IntArray] = field(default_factory=list)
    verdict: list[IntArray] = field(default_factory=list)
    lag: list[FloatArray] = field(default_factory=list)
    """share of a step by which the physical contact is later than xi, where in the same sample"""
    swept: list[FloatArray] = field(default_factory=list)
    """(M, 2) how far the swept contact is from xi [s], and the chord tolerance [m]; where the
    shapes close at CLOSING_SPEED or more"""
    swept_beyond: int = 0
    """swept contacts at which the shapes, on the exact arcs, are farther from touching than the
    chord tolerance"""
    grazes: list[NDArray[np.bool_]] = field(default_factory=list)
    """(M, 2) of each graze: does the swept check find it, is all motion free of chords"""
    unexplained: list[Unexplained] = field(default_factory=list)
    rejected: int = 0
    """false contacts of the engine that were kept out"""
    renewed: int = 0
    """collision times whose search reached its cap and went on from the lower bound"""
    interrupted: bool = False
    """whether fewer cases were compared than were asked for"""

    @property
    def cases(self) -> int:
        """Cases compared."""
        return sum(map(len, self.verdict))

    def count(self, verdict: Verdict) -> int:
        """Cases with a verdict."""
        return sum(int((rows == verdict).sum()) for rows in self.verdict)

    def to_json(self) -> str:
        """JSON text: the same for the same seed and number of cases."""
        return json.dumps(_plain(self), indent=2, ensure_ascii=False) + "\n"


def _joined(rows: list[Any], columns: int = 0) -> Any:
    empty = np.zeros((0, columns) if columns else 0)
    return np.concatenate(rows) if rows else empty


def _counts(verdict: IntArray) -> dict[str, int]:
    return dict(zip(WORDS, np.bincount(verdict, minlength=len(WORDS)).tolist(), strict=True))


def quantiles(values: FloatArray) -> dict[str, float] | None:
    """Named quantiles; None without values."""
    if not len(values):
        return None
    return {name: float(np.quantile(values, share)) for name, share in QUANTILES.items()}


def _plain(report: CrashReport) -> dict[str, Any]:
    kind = _joined(report.kind).astype(int)
    step = _joined(report.step).astype(int)
    verdict = _joined(report.verdict).astype(int)
    lag, swept = _joined(report.lag), _joined(report.swept, 2)
    off, flat = swept[:, 0], swept[:, 1] == 0.0
    seen, still = _joined(report.grazes, 2).astype(bool).T
    return {
        "format": "physim-crashtest",
        "version": 1,
        "seed": report.seed,
        "cases": report.cases,
        "cases_asked": report.asked,
        "interrupted": report.interrupted,
        "verdicts": _counts(verdict),
        "rejected_false_contacts": report.rejected,
        "by_kind": {name: _counts(verdict[kind == k]) for k, name in enumerate(KINDS)},
        "by_time_step": {f"{dt:g}": _counts(verdict[step == k]) for k, dt in enumerate(TIME_STEPS)},
        "contact_after_collision_time": {
            "unit": "share of a step",
            "contacts": len(lag),
            "quantiles": quantiles(lag),
            "histogram": np.histogram(np.clip(lag, 0.0, 1.0), BINS, (0.0, 1.0))[0].tolist(),
        },
        "swept_contact_against_collision_time": {
            "unit": "s",
            "straight": {"contacts": int(flat.sum()), "quantiles": quantiles(off[flat])},
            "arcs": {"contacts": int((~flat).sum()), "quantiles": quantiles(off[~flat])},
            "beyond_chord_tolerance": report.swept_beyond,
        },
        "grazes_found_by_swept_check": {
            "straight": {"found": int((seen & still).sum()), "of": int(still.sum())},
            "arcs": {"found": int((seen & ~still).sum()), "of": int((~still).sum())},
        },
        "searches_taken_up_again": report.renewed,
        "unexplained": [vars(one) for one in report.unexplained],
    }


def text(report: CrashReport) -> str:
    """Table for people, with the verdict as its last line."""
    found = _plain(report)
    heads = ("same sample", "no contact", "graze", "tolerance", "unexplained")
    rows = [("", "cases", *heads)]
    for name, counts in [*found["by_kind"].items(), ("all", found["verdicts"])]:
        rows.append((name, str(sum(counts.values())), *map(str, counts.values())))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [
        "  ".join(
            cell.ljust(width) if k == 0 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
    lines.append("")
    lines += _figures(found)
    lines += _verdict(report)
    return "\n".join(lines) + "\n"


def _figures(found: dict[str, Any]) -> list[str]:
    lines = []
    lag = found["contact_after_collision_time"]["quantiles"]
    if lag:
        values = ", ".join(f"{name} {value:.3f}" for name, value in lag.items())
        lines.append(f"physical contact after collision time, in steps: {values}")
    swept = found["swept_contact_against_collision_time"]
    for name in ("straight", "arcs"):
        if swept[name]["quantiles"]:
            values = ", ".join(f"{n} {v:.1e}" for n, v in swept[name]["quantiles"].items())
            lines.append(f"swept contact off collision time, {name} [s]: {values}")
    lines.append(f"swept contacts beyond the chord tolerance: {swept['beyond_chord_tolerance']}")
    for name, share in found["grazes_found_by_swept_check"].items():
        lines.append(
            f"grazes that the swept check finds, {name}: {share['found']} of {share['of']}"
        )
    lines.append(
        f"collision times that were lower bounds at first: {found['searches_taken_up_again']}"
    )
    lines.append(f"false contacts of the engine, rejected: {found['rejected_false_contacts']}")
    return lines


MOST_LISTED = 10
"""Unexplained cases that are listed one by one; the JSON has them all."""


def _verdict(report: CrashReport) -> list[str]:
    missed = report.unexplained
    lines = [
        f"  case {one.number} ({one.kind}, step {one.dt:g} s): {one.reason}"
        + (f" -> {one.world}" if one.world else "")
        for one in missed[:MOST_LISTED]
    ]
    if len(missed) > MOST_LISTED:
        lines.append(f"  and {len(missed) - MOST_LISTED} more")
    of = f"of {report.cases} cases (seed {report.seed})"
    verdict = (
        f"checks disagree: {len(missed)} {of} unexplained"
        if missed
        else f"engine and analysis agree: 0 {of} unexplained"
    )
    if report.interrupted:
        verdict += f"; interrupted before the other {report.asked - report.cases:,}"
    return [*lines, verdict]
