"""A report of each contact: who, where, how hard, and who was responsible.

Responsibility follows the paper's priority rule: a robot has to consider those that are further
along the reference path s* (equal stations: the lower index has priority). So of two robots the
one that was behind at its own last decision before the contact had to avoid it. With a boundary
or an obstacle it is always the robot.

Departure: the rule speaks of robots that move by their own commands. One that was pushed into the
contact, or stood by command while the other came, is not charged but the one that did it, see
`physim.validation.pushing`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from physim.contacts import Kind, Phase
from physim.control import NO_MODE
from physim.geometry.path import path_length, project
from physim.geometry.shapes import FloatArray
from physim.metrics import Episode, contact_episodes
from physim.record import Record
from physim.validation.decisions import DecisionTable
from physim.validation.ledger import Ledger
from physim.validation.prediction import Prediction, Predictor
from physim.validation.pushing import Touch, pushed_by, stands

MOST_EARLY = 100
"""Pairs whose earlier predictions are looked at, too."""


@dataclass(frozen=True)
class Side:
    """One robot in a contact."""

    body: int
    part: str
    """where on the robot, seen from its reference point: front, front left, left, …"""
    speed: float
    """[m/s] of its reference point in the step that led to the contact"""
    station: float
    """[m] along s* when the contact began"""
    decided: float | None
    """[s] its last decision before the contact, and what it was:"""
    mode: int | None
    v: float
    """[m/s] command"""
    omega: float
    """[rad/s] command"""
    reported_time: float
    """[s] collision time that its controller reported; inf none within its horizon, NaN not
    looked at"""
    reported_distance: float
    """[m] to the nearest robot it considered; inf none, NaN not looked at"""
    reported_boundary: float
    """[m] to the nearest boundary; NaN not looked at"""
    considered: int
    """robots it considered"""
    behind: float | None
    """[m] how far it was behind the other along s* at that decision; negative: ahead. None for
    a boundary"""
    stands: bool
    """its command in that step was to stand, v = omega = 0"""
    pushed_by: int | None
    """robot that pushed it into the contact, or ran into it where it stood, and so is charged in
    its place; None where there is none, or where it did not have to keep clear"""
    responsible: bool


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
    closing: float
    """[m/s] speed at which the two closed along the normal just before"""
    sliding: float
    """[m/s] speed along each other"""
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
    sides: tuple[Side, ...]
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
class GrazeReport:
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
    sides: tuple[Side, ...]
    """the robots, a first"""
    responsible: tuple[int, ...]
    """robots that were responsible; a third one where it pushed one of the two"""


def graze_reports(record: Record, table: DecisionTable) -> tuple[GrazeReport, ...]:
    """Report every recorded contact between two samples, in the order of time."""
    reports = []
    for row in record.contacts[record.contacts["kind"] == Kind.SWEPT]:
        a, b, step = (int(row[key]) for key in ("a", "b", "step"))
        x, y, nx, ny, depth = (float(row[key]) for key in ("x", "y", "nx", "ny", "depth"))
        sides, charged = _sides(record, table, Touch(a, b, step, (x, y), (nx, ny)))
        reports.append(GrazeReport(a, b, step * record.dt, (x, y), (nx, ny), depth, sides, charged))
    return tuple(reports)


def contact_reports(
    record: Record, ledger: Ledger, table: DecisionTable, predictor: Predictor
) -> tuple[ContactReport, ...]:
    """Report every contact episode of a record, in the order of their beginning."""
    episodes = contact_episodes(record)
    key = (ledger.touching["step"], ledger.touching["a"], ledger.touching["b"])
    entries = dict(
        zip(zip(*(k.tolist() for k in key), strict=True), ledger.touching["entry"], strict=True)
    )
    seen: set[tuple[int, int]] = set()
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
        reports.append(_report(record, table, predictor, number, episode, touched, earlier, busy))
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
) -> ContactReport:
    a, b, step = episode.a, episode.b, episode.step
    rows = record.contacts
    mine = rows[(rows["a"] == a) & (rows["b"] == b) & (rows["phase"] != Phase.ENDED)]
    mine = mine[mine["kind"] == Kind.PHYSICAL]
    row = mine[mine["step"] == step][0]
    point, normal = (float(row["x"]), float(row["y"])), (float(row["nx"]), float(row["ny"]))
    relative = _velocity(record, a, step, point) - _velocity(record, b, step, point)
    closing = float(relative @ np.array(normal))
    sliding = float(abs(relative @ np.array((-normal[1], normal[0]))))
    prediction = predictor.predict(a, b, step, touched, abs(closing), earlier)
    sides, charged = _sides(record, table, Touch(a, b, step, point, normal))
    return ContactReport(
        number, a, b, episode.time, point,
        float(
            project(
                record.reference, 0, *point, 0.0, path_length(record.reference, 0)
            )[0]
        ),
        normal, closing, sliding, episode.depth, episode.samples * record.dt,
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


def _velocity(record: Record, body: int, step: int, point: tuple[float, float]) -> FloatArray:
    """Velocity [m/s] of a body's material at a point in the step that led to a sample."""
    if body >= record.robots or step == 0:
        return np.zeros(2)
    before, now = record.read("/steps/pose", step - 1, step + 1)[:, body]
    vx, vy, omega = (now - before) / record.dt
    x, y = point[0] - now[0], point[1] - now[1]
    return np.array((vx - omega * y, vy + omega * x))


def _sides(
    record: Record, table: DecisionTable, touch: Touch
) -> tuple[tuple[Side, ...], tuple[int, ...]]:
    """The robots of a contact, and those that were responsible for it."""
    a, b, step = touch.a, touch.b, touch.step
    robots = [i for i in (a, b) if i < record.robots]
    behind = {i: _behind(record, table, i, a + b - i, step) for i in robots}
    ruled = [i for i in robots if _has_to_consider(behind[i], i, a + b - i, len(robots))]
    if not ruled:  # they changed places between their last decisions
        ruled = [max(robots, key=lambda i: -table.reference_station(i, step))]
    pushed = {i: pushed_by(record, table, i, touch) for i in ruled}
    charged = {i if by is None else by for i, by in pushed.items()}
    sides = tuple(
        _side(record, table, i, touch, behind[i], pushed.get(i), i in charged) for i in robots
    )
    return sides, tuple(sorted(charged))


def _has_to_consider(behind: float | None, i: int, other: int, robots: int) -> bool:
    """Whether Robot i had to consider the other: it was behind; ties by index."""
    if behind is None:
        return robots == 1
    return behind > 0.0 or (behind == 0.0 and other < i)


def _behind(record: Record, table: DecisionTable, i: int, other: int, step: int) -> float | None:
    """How far [m] Robot i was behind the other along s* at its last decision before a step."""
    if other >= record.robots:
        return None
    row = table.last(i, step - 1)
    at = int(row["step"]) if row is not None else max(step - 1, 0)
    return table.reference_station(other, at) - table.reference_station(i, at)


def _side(
    record: Record,
    table: DecisionTable,
    i: int,
    touch: Touch,
    behind: float | None,
    pusher: int | None,
    responsible: bool,
) -> Side:
    step, point = touch.step, touch.point
    pose = record.read("/steps/pose", step, step + 1)[0, i]
    vx, vy = _velocity(record, i, step, (float(pose[0]), float(pose[1])))
    row = table.last(i, step - 1)
    v, omega = table.held(i, step - 1) if step else (0.0, 0.0)
    nan = math.nan
    return Side(
        i, _part(pose, point), math.hypot(vx, vy), table.reference_station(i, step),
        None if row is None else float(row["step"]) * record.dt,
        None if row is None or row["mode"] == NO_MODE else int(row["mode"]), v, omega,
        nan if row is None else float(row["collision_time"]),
        nan if row is None else float(row["distance"]),
        nan if row is None else float(row["boundary_distance"]),
        0 if row is None else int(row["considered"]), behind, stands(table, i, step), pusher,
        responsible,
    )  # fmt: skip


def _part(pose: FloatArray, point: tuple[float, float]) -> str:
    """Where on a robot a point lies: one of eight directions from its reference point."""
    names = ("front", "front left", "left", "rear left", "rear", "rear right", "right",
             "front right")  # fmt: skip
    bearing = math.atan2(point[1] - pose[1], point[0] - pose[0]) - pose[2]
    return names[round(bearing / (math.pi / 4)) % 8]


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
