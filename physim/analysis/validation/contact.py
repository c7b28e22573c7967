"""Every contact as values: who, where, how hard, who was responsible."""

from __future__ import annotations

import math
from dataclasses import dataclass

from physim.analysis.metrics import Episode, Severity, contact_episodes, masses, severity
from physim.analysis.metrics.contacts import first_row
from physim.analysis.metrics.walls import along_wall
from physim.analysis.validation.analytic_contacts import AnalyticContacts
from physim.analysis.validation.decisions import DecisionTable
from physim.analysis.validation.prediction import Prediction, Predictor
from physim.analysis.validation.responsibility import RobotInContact, Touch, robots_in_contact
from physim.contacts import Kind
from physim.geometry.path import path_length, project
from physim.record import Record

MOST_EARLY = 100
"""Pairs whose earlier predictions are compared, too"""


@dataclass(frozen=True)
class Contact:
    """One contact: an episode at samples, or a touch between two samples, apart at both.

    Of one between samples no severity, duration, impulse and prediction are known.
    """

    number: int
    """from 1, in the order of their beginning, those of either kind by themselves"""
    a: int
    b: int
    time: float
    """[s] of the first sample in contact; between samples, of the one after it"""
    place: tuple[float, float]
    """[m] world frame, at that sample; between samples, where the two are closest"""
    station: float
    """[m] of that place along s*"""
    normal: tuple[float, float]
    """from a to b"""
    severity: Severity
    """of the impact, see `physim.analysis.metrics.Severity`"""
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
    prediction: Prediction | None
    """None between samples"""
    warning: float | None
    """[s] for how long before the contact it lay ahead without a break, under the commands of
    the moment; None where earlier decisions were not looked at"""
    responsible: tuple[int, ...]
    """robots that were responsible; a third one where it pushed one of the two; none where no rule
    of the controller says who"""
    along: str
    """where along a wall, `physim.analysis.metrics.walls.along_wall`; empty between robots"""

    @property
    def hardness(self) -> tuple[float, float, float]:
        """Greater for the worse contact: closing speed, then energy lost, then impulse."""
        closing = 0.0 if math.isnan(self.severity.closing) else self.severity.closing
        return closing, self.severity.energy or 0.0, self.impulse


def swept_contacts(record: Record, table: DecisionTable) -> tuple[Contact, ...]:
    """Every recorded contact between two samples, in the order of time."""
    unknown = Severity(math.nan, math.nan, None, None)
    found: list[Contact] = []
    for row in record.contacts[record.contacts["kind"] == Kind.SWEPT]:
        a, b, step = (int(row[key]) for key in ("a", "b", "step"))
        x, y, nx, ny, depth = (float(row[key]) for key in ("x", "y", "nx", "ny", "depth"))
        sides, charged = robots_in_contact(record, table, Touch(a, b, step, (x, y), (nx, ny)))
        found.append(
            Contact(
                len(found) + 1, a, b, step * record.dt, (x, y), _station(record, x, y), (nx, ny),
                unknown, depth, 0.0, False, 0.0, 0.0, sides, (), None, None, charged,
                along_wall(record, b, (x, y)),
            )
        )  # fmt: skip
    return tuple(found)


def _station(record: Record, x: float, y: float) -> float:
    """[m] of a point along the reference path."""
    path = record.reference
    return float(project(path, 0, x, y, 0.0, path_length(path, 0))[0])


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
    episodes = contact_episodes(record)
    key = (analytic.touching["step"], analytic.touching["a"], analytic.touching["b"])
    entries = dict(
        zip(zip(*(k.tolist() for k in key), strict=True), analytic.touching["entry"], strict=True)
    )
    seen: set[tuple[int, int]] = set()
    mass = masses(record)
    found = []
    for number, episode in enumerate(episodes[:most], 1):
        a, b, step = episode.a, episode.b, episode.step
        row = first_row(record, episode)
        x, y, nx, ny = (float(row[column]) for column in ("x", "y", "nx", "ny"))
        entry = float(entries.get((step, a, b), math.nan))
        touched = episode.time + (entry - record.dt if math.isfinite(entry) else 0.0)
        earlier = (a, b) not in seen and len(seen) < MOST_EARLY
        seen.add((a, b))
        hit = severity(record, episode, mass, table.held)
        prediction = predictor.predict(a, b, step, touched, hit.closing, earlier)
        sides, charged = robots_in_contact(record, table, Touch(a, b, step, (x, y), (nx, ny)))
        found.append(
            Contact(
                number, a, b, episode.time, (x, y), _station(record, x, y), (nx, ny), hit,
                episode.depth, episode.samples * record.dt,
                step + episode.samples >= record.samples, float(row["impulse"]), episode.impulse,
                sides, _touching_already(episodes, episode), prediction, _warning(prediction),
                charged, along_wall(record, b, (x, y)),
            )
        )  # fmt: skip
    return tuple(found)


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
