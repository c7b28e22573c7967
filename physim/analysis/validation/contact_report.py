"""A report of each contact: who, where, how hard, who was responsible, as values and in words."""

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
from physim.analysis.validation.wording import joined, length, short
from physim.contacts import Kind
from physim.geometry.path import path_length, project
from physim.geometry.shapes import FloatArray
from physim.parts.declarations import AT_STOP
from physim.record import Record
from physim.tolerances import PUSH

MOST_EARLY = 100
"""Pairs whose earlier predictions are compared, too."""


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
    prediction: Prediction
    warning: float | None
    """[s] for how long before the contact it lay ahead without a break, under the commands of
    the moment; None where earlier decisions were not looked at"""
    responsible: tuple[int, ...]
    """robots that were responsible; a third one where it pushed one of the two; none where no rule
    of the controller says who"""
    along: str
    """where along a wall, `physim.analysis.metrics.walls.along_wall`; empty between robots"""


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
    """robots that were responsible; a third one where it pushed one of the two; none where no rule
    of the controller says who"""
    along: str
    """where along a wall, `physim.analysis.metrics.walls.along_wall`; empty between robots"""


def swept_contact_reports(record: Record, table: DecisionTable) -> tuple[SweptContactReport, ...]:
    """Report every recorded contact between two samples, in the order of time."""
    reports = []
    for row in record.contacts[record.contacts["kind"] == Kind.SWEPT]:
        a, b, step = (int(row[key]) for key in ("a", "b", "step"))
        x, y, nx, ny, depth = (float(row[key]) for key in ("x", "y", "nx", "ny", "depth"))
        sides, charged = robots_in_contact(record, table, Touch(a, b, step, (x, y), (nx, ny)))
        reports.append(
            SweptContactReport(a, b, step * record.dt, (x, y), (nx, ny), depth, sides, charged,
                               along_wall(record, b, (x, y)))
        )  # fmt: skip
    return tuple(reports)


def contact_reports(
    record: Record,
    analytic: AnalyticContacts,
    table: DecisionTable,
    predictor: Predictor,
    most: int | None = None,
) -> tuple[ContactReport, ...]:
    """Report the contact episodes of a record, in the order of their beginning.

    Every one, or the first ``most``.
    """
    episodes = contact_episodes(record)
    key = (analytic.touching["step"], analytic.touching["a"], analytic.touching["b"])
    entries = dict(
        zip(zip(*(k.tolist() for k in key), strict=True), analytic.touching["entry"], strict=True)
    )
    seen: set[tuple[int, int]] = set()
    mass = masses(record)
    reports = []
    for number, episode in enumerate(episodes[:most], 1):
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
    row = first_row(record, episode)
    point, normal = (float(row["x"]), float(row["y"])), (float(row["nx"]), float(row["ny"]))
    impact = severity(record, episode, mass, table.held)
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
        sides, busy, prediction, _warning(prediction), charged, along_wall(record, b, point),
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


def describe_bodies(one: ContactReport | SweptContactReport, names: list[str]) -> str:
    """``front of r2 against rear left of r1``, the one that ran into the other first."""
    sides = sorted(one.sides, key=lambda side: not (side.responsible or _by_third(side, one)))
    words = [f"{side.part} of {names[side.body]}" for side in sides]
    if len(sides) == 1:
        words.append(names[one.b])
    return " against ".join(words)


def describe_responsibility(one: ContactReport | SweptContactReport, names: list[str]) -> str:
    """``Responsible is r2: it was 1.2 m behind r1 …``, who had to keep clear, and why.

    Empty where the controller has no rule that says so.
    """
    if not one.responsible:
        return ""
    return f"Responsible is {_why(one, names)}"


def _why(one: ContactReport | SweptContactReport, names: list[str]) -> str:
    pushed = [side for side in one.sides if side.pushed_by is not None]
    if pushed:
        return " ".join(_push(side, one, names) for side in pushed)
    charged = [side for side in one.sides if side.responsible]
    who = joined([names[side.body] for side in charged])
    if one.sides[0].behind is None:
        return f"{who}: a robot has to keep clear of boundaries and obstacles."
    if len(charged) > 1:
        return f"{who}: each was behind the other at its own last decision."
    side = charged[0]
    other = names[one.a + one.b - side.body]
    behind = side.behind or 0.0
    if behind > 0.0:
        return (
            f"{who}: it was {length(behind)} behind {other} along the reference path, "
            f"so by the paper's rule of priority it had to consider {other}."
        )
    if behind == 0.0:
        return f"{who}: level with {other}, which has the lower number and so priority."
    return f"{who}: it was behind {other} when they touched; the two changed places just before."


def describe_cause(one: ContactReport, names: list[str]) -> str:
    """Why it was not avoided, as far as the record shows."""
    pushed = next((side for side in one.sides if _by_third(side, one)), None)
    if pushed is not None and pushed.pushed_by is not None:
        name, by = names[pushed.body], names[pushed.pushed_by]
        if pushed.stands and pushed.speed <= PUSH:
            return f"{name} stood by command; the other was pushed by {by}."
        return f"{name} {'stood by command and ' if pushed.stands else ''}was pushed by {by}."
    said = []
    if one.warning is not None:
        said.append(
            f"Contact lay ahead at every decision of the last {short(one.warning)}."
            if one.warning > 0.0
            else "Contact did not lie ahead at the last decision."
        )
    charged = next((side for side in one.sides if side.responsible), None)
    sides = one.sides if charged is None else (charged,)
    return " ".join([*said, *(_decided(side, one, names) for side in sides)])


def _decided(side: RobotInContact, one: ContactReport, names: list[str]) -> str:
    """Why a robot did not avoid the contact, as far as the record shows."""
    name, other = names[side.body], names[one.a + one.b - side.body]
    if side.decided is None:
        return f"{name} had made no decision yet."
    if side.stands:
        return f"{name} stood by command, and the record shows no robot that pushed it."
    wall = len(one.sides) == 1
    looked = not math.isnan(side.reported_time)
    looked |= not math.isnan(side.reported_boundary if wall else side.reported_distance)
    if not looked:
        return f"{name} reported no distance to {other} and no collision time."
    if not wall and side.considered == 0:
        return f"{name} considered no robot."
    if not wall and math.isinf(side.reported_time) and _moves_by_choice(side):
        did = "looked" if side.mode is None else "was avoiding"
        return (
            f"{name} {did}, and reported no collision for the command it took; {other} "
            f"{_held_or_changed(one, side)}."
        )
    if side.mode is None:
        return f"{name} looked, but took no command that kept it clear of {other}."
    if side.mode.danger:
        return f"{name} was avoiding, but took no command that kept it clear of {other}."
    if side.mode.name == AT_STOP.name:
        return f"{name} said that it had arrived, yet its command was to move."
    return f"{name} was in mode {side.mode}: it did not take {other} for a danger."


def _moves_by_choice(side: RobotInContact) -> bool:
    """Whether a robot looked for a command that keeps clear, as far as its mode says."""
    return side.mode is None or side.mode.danger


def _held_or_changed(one: ContactReport, side: RobotInContact) -> str:
    """What the other robot did since this one decided: a collision time holds for its command."""
    (other,) = (each for each in one.sides if each is not side)
    assert side.decided is not None
    if other.decided is None or other.decided < side.decided:
        return "held the command that it had then"
    return f"decided anew {'in the same step' if other.decided == side.decided else 'after it'}"


def _by_third(side: RobotInContact, one: ContactReport | SweptContactReport) -> bool:
    """Whether a robot other than the two brought this one into the contact."""
    return side.pushed_by is not None and side.pushed_by not in (one.a, one.b)


def _push(side: RobotInContact, one: ContactReport | SweptContactReport, names: list[str]) -> str:
    """Who is charged in place of a robot, and why."""
    name, other = names[side.body], names[one.a + one.b - side.body]
    by = names[side.pushed_by] if side.pushed_by is not None else ""
    if not _by_third(side, one):
        return f"{by}: it ran into {name}, which stood by command."
    if side.stands and side.speed <= PUSH:
        return f"{by}: it pushed {other} into {name}, which stood by command."
    if side.stands:
        return f"{by}: {name}, which stood by command, was pushed by {by} against {other}."
    return f"{by}: {name} was pushed by {by} against {other}, beyond its own command."
