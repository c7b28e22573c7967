"""A report of each contact: who, where, how hard, and who was responsible."""

from __future__ import annotations

import math
from dataclasses import dataclass

from physim.contacts import Kind, touching
from physim.geometry.path import path_length, project
from physim.geometry.shapes import FloatArray
from physim.metrics import Episode, Severity, contact_episodes, masses, severity
from physim.record import Record
from physim.validation.decisions import DecisionTable
from physim.validation.ledger import AnalyticContacts
from physim.validation.prediction import Prediction, Predictor
from physim.validation.pushing import Touch
from physim.validation.sides import RobotInContact, robots_in_contact

MOST_EARLY = 100
"""Pairs whose earlier predictions are looked at, too."""


@dataclass(frozen=True)
class ContactReport:
    """One contact episode."""

    number: int
    """from 1, in the order of their beginning"""
    a: int
    b: int
    time: float
    """[s] of the first sample in contact"""
    place: tuple[float, float]
    """[m] world frame, at that sample"""
    station: float
    """[m] of that place along s*"""
    normal: tuple[float, float]
    """from a to b"""
    severity: Severity
    """of the impact, see `physim.metrics.Severity`"""
    depth: float
    """[m] greatest"""
    duration: float
    """[s]"""
    lasting: bool
    """still in contact at the end of the record"""
    first_impulse: float
    """[N s] at the first sample: the impact"""
    impulse: float
    """[N s] in all"""
    sides: tuple[RobotInContact, ...]
    """the robots, a first"""
    also_touching: tuple[int, ...]
    """bodies that one of the two was touching already when this contact began"""
    prediction: Prediction
    warning: float | None
    """[s] for how long before the contact it lay ahead without a break, under the commands of
    the moment; None where earlier decisions were not looked at"""
    responsible: tuple[int, ...]
    """robots that were responsible; a third one where it pushed one of the two"""


@dataclass(frozen=True)
class SweptContactReport:
    """One contact between two samples: apart at both, so that the engine let the two pass."""

    a: int
    b: int
    time: float
    """[s] of the sample after it"""
    place: tuple[float, float]
    """[m] world frame, where the two are closest within the step"""
    normal: tuple[float, float]
    """from a to b"""
    depth: float
    """[m] greatest within the step"""
    sides: tuple[RobotInContact, ...]
    """the robots, a first"""
    responsible: tuple[int, ...]
    """robots that were responsible; a third one where it pushed one of the two"""


def swept_contact_reports(record: Record, table: DecisionTable) -> tuple[SweptContactReport, ...]:
    """Report every recorded contact between two samples, in the order of time."""
    reports = []
    for row in record.contacts[record.contacts["kind"] == Kind.SWEPT]:
        a, b, step = (int(row[key]) for key in ("a", "b", "step"))
        x, y, nx, ny, depth = (float(row[key]) for key in ("x", "y", "nx", "ny", "depth"))
        sides, charged = robots_in_contact(record, table, Touch(a, b, step, (x, y), (nx, ny)))
        reports.append(
            SweptContactReport(a, b, step * record.dt, (x, y), (nx, ny), depth, sides, charged)
        )
    return tuple(reports)


def contact_reports(
    record: Record, analytic: AnalyticContacts, table: DecisionTable, predictor: Predictor
) -> tuple[ContactReport, ...]:
    """Report every contact episode of a record, in the order of their beginning."""
    episodes = contact_episodes(record)
    key = (analytic.touching["step"], analytic.touching["a"], analytic.touching["b"])
    entries = dict(
        zip(zip(*(k.tolist() for k in key), strict=True), analytic.touching["entry"], strict=True)
    )
    seen: set[tuple[int, int]] = set()
    mass = masses(record)
    reports = []
    for number, episode in enumerate(episodes, 1):
        pair = (episode.a, episode.b)
        earlier = pair not in seen and len(seen) < MOST_EARLY
        seen.add(pair)
        entry = float(entries.get((episode.step, *pair), math.nan))
        touched = episode.time
        if math.isfinite(entry):
            touched += entry - record.dt
        busy = _touching_already(episodes, episode)
        reports.append(
            _report(record, table, predictor, number, episode, touched, earlier, busy, mass)
        )
    return tuple(reports)


def _report(
    record: Record,
    table: DecisionTable,
    predictor: Predictor,
    number: int,
    episode: Episode,
    touched: float,
    earlier: bool,
    busy: tuple[int, ...],
    mass: FloatArray | None,
) -> ContactReport:
    a, b, step = episode.a, episode.b, episode.step
    rows = record.contacts
    row = touching(rows[(rows["a"] == a) & (rows["b"] == b) & (rows["step"] == step)])[0]
    point, normal = (float(row["x"]), float(row["y"])), (float(row["nx"]), float(row["ny"]))
    impact = severity(record, episode, mass)
    prediction = predictor.predict(a, b, step, touched, impact.closing, earlier)
    sides, charged = robots_in_contact(record, table, Touch(a, b, step, point, normal))
    return ContactReport(
        number, a, b, episode.time, point,
        float(
            project(
                record.reference, 0, *point, 0.0, path_length(record.reference, 0)
            )[0]
        ),
        normal, impact, episode.depth, episode.samples * record.dt,
        step + episode.samples >= record.samples, float(row["impulse"]), episode.impulse,
        sides, busy, prediction, _warning(prediction), charged,
    )  # fmt: skip


def _touching_already(episodes: tuple[Episode, ...], one: Episode) -> tuple[int, ...]:
    """Other bodies that touch one of the two at the sample before the contact begins."""
    found = set()
    for other in episodes:
        if other.step >= one.step:
            break
        if other.step + other.samples >= one.step and {other.a, other.b} & {one.a, one.b}:
            found |= {other.a, other.b}
    return tuple(sorted(found - {one.a, one.b}))


def _warning(prediction: Prediction) -> float | None:
    """[s] since when the contact lay ahead at every decision up to it."""
    if not prediction.early:
        return None
    warning = 0.0
    for one in reversed(prediction.early):
        if not math.isfinite(one.error):
            break
        warning = one.lead
    return warning
