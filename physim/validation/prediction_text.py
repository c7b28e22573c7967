"""Predictions against contacts, as lines of the report."""

from __future__ import annotations

import math

import numpy as np

from physim.validation.contact_text import SHOWN, first_of_pairs
from physim.validation.numbers import short
from physim.validation.prediction import AGREES, DISAGREES, Early
from physim.validation.validation import Validation

LEADS = (0.0, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0)
"""[s] edges of the table of lead times"""


def prediction_lines(validation: Validation) -> list[str]:
    """Table of first contacts, errors at the last decision, errors by lead time."""
    if not validation.contacts:
        return []
    return [
        "FIRST CONTACT: predicted (collision time + time of prediction) against physical",
        *_table(validation),
        *_errors(validation),
        *_by_lead(validation),
    ]


def _table(validation: Validation) -> list[str]:
    names = validation.names
    lines = [
        f"  {'':<4}{'predicted at':>13}{'contact due':>14}{'touched':>14}{'seen at':>10}"
        f"{'error':>12}   pair"
    ]
    for one in first_of_pairs(validation)[:SHOWN]:
        p = one.prediction
        made = "-" if p.made is None else f"{p.made:.2f} s"
        due = "-" if p.predicted is None else "none"
        if p.predicted is not None and math.isfinite(p.predicted):
            due = f"{p.predicted:.6f} s"
        error = "-" if p.error is None or math.isinf(p.error) else short(p.error)
        pair = f"{names[p.a]} and {names[p.b]}"
        note = "" if p.verdict == AGREES else f"  ({p.verdict})"
        lines.append(
            f"  {one.number:<4}{made:>13}{due:>14}{p.touched:>12.6f} s{p.found:>8.2f} s"
            f"{error:>12}   {pair}{note}"
        )
    return lines


def _errors(validation: Validation) -> list[str]:
    all_of = [one.prediction for one in validation.contacts]
    judged = [p for p in all_of if p.verdict in (AGREES, DISAGREES)]
    if not judged:
        return ["  At the last decision: none of them can be compared."]
    same = sum(p.verdict == AGREES for p in judged)
    errors = np.array([p.error for p in judged if p.error is not None and math.isfinite(p.error)])
    lines = [
        f"  Predicted by the last decision before contact: {same} of {len(judged)} in that step."
    ]
    if len(errors):
        size = np.abs(errors)
        lines.append(
            f"  Error: median {short(float(np.median(size)))}, "
            f"largest {short(float(size.max()))}; between samples robots move on chords."
        )
    left = len(all_of) - len(judged)
    if left:
        lines.append(
            f"  {left} more cannot be compared: a robot in contact does not move as commanded."
        )
    return lines


def _by_lead(validation: Validation) -> list[str]:
    early = [e for one in validation.contacts for e in one.prediction.early]
    if not early:
        return []
    lines = [
        "  Earlier predictions for the first contact of each pair (commands change on the way):",
        "  (foretold: share of decisions after which it would have come, had all kept their "
        "commands)",
        f"  {'lead time':>16}{'decisions':>11}{'foretold':>10}{'median error':>14}{'largest':>12}",
    ]
    for low, high in zip(LEADS[:-1], LEADS[1:], strict=True):
        some = [e for e in early if low <= e.lead < high]
        if some:
            lines.append(_lead_row(low, high, some))
    return lines


def _lead_row(low: float, high: float, some: list[Early]) -> str:
    size = np.abs([e.error for e in some if math.isfinite(e.error)])
    errors = f"{'-':>14}{'-':>12}"
    if len(size):
        errors = f"{short(float(np.median(size))):>14}{short(float(size.max())):>12}"
    return f"  {f'{low:g} to {high:g} s':>16}{len(some):>11}{len(size) / len(some):>10.0%}{errors}"
