"""The robots of a contact: what each did and saw, who pushed whom, and who was responsible.

Between robots responsibility follows the paper's priority rule: a robot has to consider those that
are further along the reference path s* (equal stations: the lower index has priority). So of two
robots the one that was behind at its own last decision before the contact had to avoid it. The rule
is that of `mode_switching` alone: a robot with another controller is responsible only where it
pushed a robot, or ran into one that stood. With a boundary or an obstacle it is always the robot,
and so it is with a mover, which gives way to nobody.

Departure: the rule speaks of robots that move by their own commands. One that was pushed into the
contact, or stood by command while the other came, is not charged but the one that did it. A robot
counts as pushed when it closes on the other body by more than its command says, while it touches
a further robot; that one is the pusher, or whoever pushes it in turn. A robot that stands by
command and is pushed by nobody was run into by the other. Where there is no other that came, at a
wall or where both stand, it was moved by one that it touches, whichever way: by itself it does
not move. So a mover is charged where it ran into a robot that stood, or pushed one into another
body; and who pushed an obstacle into a robot that stood.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from physim.analysis.metrics.contacts import Touch, point_velocity
from physim.analysis.validation.decisions import STILL, DecisionTable
from physim.contacts import touching
from physim.geometry.motion import arcs
from physim.parts.declarations import NO_NUMBER, Mode, Rule
from physim.record import Record
from physim.tolerances import PUSH

PARTS = ("front", "front left", "left", "rear left", "rear", "rear right", "right", "front right")
"""Where on a robot a point lies, seen from its reference point"""
PRIORITY = "mode_switching"
"""Name of the controller that has the paper's rule of priority."""


def has_priority(record: Record, robot: int) -> bool:
    """Whether the controller of a robot has the paper's rule of priority."""
    return any(
        robot in robots or not robots  # of a world that does not say
        for part, robots in record.setup.controllers
        if part.name == PRIORITY
    )


def pushed_by(record: Record, table: DecisionTable, robot: int, touch: Touch) -> int | None:
    """Robot or mover to be charged in place of ``robot``; None where that moved as commanded."""
    if touch.step <= record.begun_at:
        return None
    ends = {touch.a, touch.b}
    pusher = _pusher(record, table, robot, touch, ends)
    if pusher is not None or not stands(table, robot, touch.step):
        return pusher
    other = touch.a + touch.b - robot
    if other < record.moving:
        pusher = _pusher(record, table, other, touch, ends)
        if pusher is None and not stands(table, other, touch.step):
            return other
    for one in (robot, other):
        if pusher is None and one < record.moving:
            pusher = _pusher(record, table, one, touch, ends, carried=True)
    return pusher


def stands(table: DecisionTable, robot: int, step: int) -> bool:
    """Whether a robot, or what else moves, was commanded to stand in the step that led to a sample.

    That is, to move no point of its footprint by `PUSH` or more: a command of 1e-15 rad/s stands.
    """
    if robot < table.record.robots and table.last(robot, step - 1) is None:
        return False
    v, omega, lateral = table.held(robot, step - 1)
    return math.hypot(v, lateral) + float(table.radius[robot]) * abs(omega) < PUSH


def _pusher(
    record: Record,
    table: DecisionTable,
    robot: int,
    touch: Touch,
    seen: set[int],
    carried: bool = False,
) -> int | None:
    """Body at the end of the chain of pushes into a contact, not counting those ``seen``.

    ``carried``: of a robot that stands by command, whichever way it moves.
    """
    if robot in table.movers or not (carried or _exceeds_command(record, table, robot, touch)):
        return None
    for contact in _contacts(record, robot, touch.step):
        third = contact.a + contact.b - robot
        if third >= record.moving or third in seen:
            continue
        idle = stands(table, third, touch.step)
        further = _pusher(record, table, third, contact, seen | {third}, carried and idle)
        if further is not None:
            return further
        if not idle:
            return third
    return None


def _exceeds_command(record: Record, table: DecisionTable, robot: int, touch: Touch) -> bool:
    """Whether a robot closed on the other body by more than its command says."""
    step, sign = touch.step, 1.0 if robot == touch.a else -1.0
    before, now = record.pose_at(step - 1)[robot], record.pose_at(step)[robot]
    command = np.array([table.held(robot, step - 1)])
    x, y, turn = (now - arcs(before[None], command, record.dt)[0]) / record.dt
    across, along = touch.place[0] - now[0], touch.place[1] - now[1]
    nx, ny = touch.normal
    return bool(sign * ((x - turn * along) * nx + (y + turn * across) * ny) > PUSH)


def _contacts(record: Record, robot: int, step: int) -> list[Touch]:
    """Contacts of a robot in the step that led to a sample, the hardest first."""
    rows = touching(record.contacts_over(step - 1, step + 1))
    rows = rows[(rows["a"] == robot) | (rows["b"] == robot)]
    rows = rows[np.argsort(-rows["impulse"], kind="stable")]
    columns = (rows[key].tolist() for key in ("a", "b", "depth", "x", "y", "nx", "ny"))
    return [
        Touch(a, b, b < record.robots, step, step * record.dt, depth, (x, y), (nx, ny))
        for a, b, depth, x, y, nx, ny in zip(*columns, strict=True)
    ]


@dataclass(frozen=True)
class RobotInContact:
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
    mode: Mode | None
    rule: Rule | None
    v: float
    """[m/s] command that drove it"""
    omega: float
    """[rad/s] command that drove it"""
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
    """its command in that step was to stand: no point of it was to move by `PUSH` or more"""
    pushed_by: int | None
    """robot or mover that pushed it into the contact, or ran into it where it stood, and so is
    charged in its place; None where there is none, or where it did not have to keep clear"""
    responsible: bool


def robots_in_contact(
    record: Record, table: DecisionTable, touch: Touch
) -> tuple[tuple[RobotInContact, ...], tuple[int, ...]]:
    """Robots of a contact, a first, and the ids of those that were responsible for it, if any."""
    a, b, step = touch.a, touch.b, touch.step
    robots = [i for i in (a, b) if i < record.robots]
    behind = {i: _behind(record, table, i, a + b - i, step) for i in robots}
    later = [i for i in robots if _has_to_consider(behind[i], i, a + b - i, len(robots))]
    if not later:  # they changed places between their last decisions
        later = [max(robots, key=lambda i: -table.reference_station(i, step))]
    ruled = later if len(robots) == 1 else [i for i in later if has_priority(record, i)]
    pushed: dict[int, int | None] = {}
    charged: set[int] = set()
    if record.judged is None:
        pushed = {i: pushed_by(record, table, i, touch) for i in ruled}
    if record.judged is not None:
        pass  # poses do not tell who was commanded to do what
    elif ruled:
        charged = {i if by is None else by for i, by in pushed.items()}
    else:  # no rule says who; facts may
        order = [*later, *(i for i in robots if i not in later)]
        pushed = {i: pushed_by(record, table, i, touch) for i in order}
        pushed = dict([(i, by) for i, by in pushed.items() if by is not None][:1])
        charged = {by for by in pushed.values() if by is not None}
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
    at = int(row["step"]) if row is not None else max(step - 1, record.begun_at)
    return table.reference_station(other, at) - table.reference_station(i, at)


def _side(
    record: Record,
    table: DecisionTable,
    i: int,
    touch: Touch,
    behind: float | None,
    pusher: int | None,
    responsible: bool,
) -> RobotInContact:
    step, (px, py) = touch.step, touch.place
    x, y, heading = record.pose_at(step)[i].tolist()
    vx, vy = point_velocity(record, i, step, (x, y), table.held)
    v, omega, _ = table.held(i, step - 1) if step else STILL
    bearing = math.atan2(py - y, px - x) - heading
    decided, mode, rule, considered = None, None, None, 0
    reported = dict.fromkeys(("collision_time", "distance", "boundary_distance"), math.nan)
    if (row := table.last(i, step - 1)) is not None:
        decided, considered = float(row["step"]) * record.dt, int(row["considered"])
        mode, rule = (
            None if row[name] == NO_NUMBER else among[row[name]]
            for name, among in (("mode", record.modes), ("rule", record.declared.rules))
        )
        known = reported.keys() & set(row.dtype.names or ())
        reported |= {name: float(row[name]) for name in known}
    return RobotInContact(
        body=i, part=PARTS[round(bearing / (math.pi / 4)) % 8], speed=math.hypot(vx, vy),
        station=table.reference_station(i, step), decided=decided, mode=mode, rule=rule, v=v,
        omega=omega, reported_time=reported["collision_time"],
        reported_distance=reported["distance"], reported_boundary=reported["boundary_distance"],
        considered=considered, behind=behind, stands=stands(table, i, step), pushed_by=pusher,
        responsible=responsible,
    )  # fmt: skip
