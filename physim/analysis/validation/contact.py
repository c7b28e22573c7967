"""Every contact as values: who, where, how hard, who was responsible."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from physim.analysis.metrics import Figures, Severity, masses, severity
from physim.analysis.metrics.contacts import Touch
from physim.analysis.metrics.distances import along_wall
from physim.analysis.validation.analytic_contacts import AnalyticContacts
from physim.analysis.validation.decisions import DecisionTable
from physim.analysis.validation.prediction import Prediction, Predictor
from physim.analysis.validation.responsibility import RobotInContact, robots_in_contact
from physim.geometry.path import path_length, project
from physim.record import Record
from physim.units import between

UNKNOWN = Severity(math.nan, math.nan, None, None)


@dataclass(frozen=True, kw_only=True)
class Contact:
    """One contact: an episode at samples, or a touch between two samples, apart at both.

    Of one between samples no severity, duration, impulse and prediction are known.
    """

    number: int
    """from 1, in the order of their beginning, those of either kind by themselves"""
    a: int
    b: int
    time: float
    """[s] of the first sample in contact; between samples, when the two are closest"""
    within: float = 0.0
    """[s] length of the step in which one between samples lies; 0 of one at samples"""
    place: tuple[float, float]
    """[m] world frame, at that sample; between samples, where the two are closest"""
    station: float
    """[m] of that place along s*"""
    normal: tuple[float, float]
    """from a to b"""
    severity: Severity = UNKNOWN
    """of the impact, see `physim.analysis.metrics.Severity`"""
    depth: float
    """[m] greatest"""
    duration: float = 0.0
    """[s]"""
    lasting: bool = False
    """still in contact at the end of the record"""
    first_impulse: float | None = 0.0
    """[N s] at the first sample: the impact"""
    impulse: float | None = 0.0
    """[N s] in all; both are None of a log that was judged"""
    sides: tuple[RobotInContact, ...]
    """the robots, a first"""
    also_touching: tuple[int, ...] = ()
    """bodies that one of the two was touching already when this contact began"""
    prediction: Prediction | None = None
    """None between samples"""
    warning: float | None = None
    """[s] for how long before the contact it lay ahead without a break, under the commands of
    the moment; None where there was no decision before it, and after the first contact of a pair"""
    responsible: tuple[int, ...]
    """robots and movers that were responsible; a third one where it pushed one of the two; none
    where no rule of the controller says who"""
    along: str
    """where along a wall, `physim.analysis.metrics.distances.along_wall`; empty between robots"""

    @property
    def when(self) -> str:
        """``at 4.50 s``, or ``between 4.00 and 4.50 s``."""
        if not self.within:
            return f"at {self.time:.2f} s"
        step = math.ceil(self.time / self.within - 1e-9)
        return between(step * self.within, self.within)

    @property
    def hardness(self) -> tuple[float, float, float]:
        """Greater for the worse contact: closing speed, then energy lost, then impulse."""
        closing = 0.0 if math.isnan(self.severity.closing) else self.severity.closing
        return closing, self.severity.energy or 0.0, self.impulse or 0.0


def swept_contacts(record: Record, table: DecisionTable) -> tuple[Contact, ...]:
    """Every recorded contact between two samples, in the order of time."""
    found = enumerate(Figures(record).grazes, 1)
    more: dict[str, float | None] = {"within": record.dt}
    if record.judged is not None:
        more |= dict.fromkeys(("first_impulse", "impulse"))
    return tuple(_contact(record, table, one, number=number, **more) for number, one in found)


def contacts_of(
    record: Record,
    analytic: AnalyticContacts,
    table: DecisionTable,
    predictor: Predictor,
    most: int | None = None,
) -> tuple[Contact, ...]:
    """The contact episodes of a record, in the order of their beginning.

    Every one, or the first ``most``.
    """
    episodes, mass, found = Figures(record).episodes, masses(record), []
    columns = (analytic.touching[name].tolist() for name in ("step", "a", "b", "entry"))
    entries = {(step, a, b): entry for step, a, b, entry in zip(*columns, strict=True)}
    seen: set[tuple[int, int]] = set()
    for number, one in enumerate(episodes[:most], 1):
        a, b, step = one.a, one.b, one.step
        entry = entries.get((step, a, b), math.nan)
        touched = one.time + (entry - record.dt if math.isfinite(entry) else 0.0)
        hit = severity(record, one, mass, table.held)
        prediction = predictor.predict(a, b, step, touched, hit.closing)
        is_known = (a, b) not in seen and prediction.made is not None
        seen.add((a, b))
        already = {
            body
            for other in episodes[: number - 1]
            if other.step < step <= other.step + other.samples and {other.a, other.b} & {a, b}
            for body in (other.a, other.b)
        }
        found.append(
            _contact(
                record, table, one, number=number, severity=hit,
                duration=one.samples * record.dt, lasting=step + one.samples > record.steps_run,
                first_impulse=one.impact, impulse=one.impulse,
                also_touching=tuple(sorted(already - {a, b})), prediction=prediction,
                warning=predictor.ahead(prediction) if is_known else None,
            )
        )  # fmt: skip
    return tuple(found)


def _contact(record: Record, table: DecisionTable, touch: Touch, **more: Any) -> Contact:
    """The contact of a touch; ``more`` are fields that do not follow from it."""
    sides, charged = robots_in_contact(record, table, touch)
    path = record.reference
    station = project(path, 0, *touch.place, 0.0, path_length(path, 0))[0]
    return Contact(
        a=touch.a, b=touch.b, time=touch.time, place=touch.place, depth=touch.depth,
        station=float(station), normal=touch.normal, sides=sides, responsible=charged,
        along=along_wall(record, touch.b, touch.place), **more,
    )  # fmt: skip
