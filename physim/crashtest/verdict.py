"""Do engine and analysis agree on a case, and if they differ, why?

Three things are compared: the sample P of the first physical contact; the signed distances d at
the samples, on the exact arcs; the collision time xi.

1. P is the first sample with d <= CONTACT. At the samples the engine's poses lie on the exact arcs
   to rounding, so this is exact, but for distances within ROUNDING of CONTACT.
2. xi is not late: d > CONTACT at every sample before xi - TIME.
3. xi is true: the shapes are within CONTACT at xi.
4. P is sample ceil((xi - TIME) / dt), that is xi - TIME <= P dt < xi + dt. If it is not, then by 1
   and 2 no sample lies in the contact that begins at xi: it is a graze between samples.

What fails 1, 2 or 3 by no more than the tolerance is reported as such; what fails by more is
unexplained.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from physim.geometry.shapes import FloatArray
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
