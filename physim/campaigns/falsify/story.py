"""What happens in a run, told in a paragraph: who, when, where, how fast, in which mode."""

from __future__ import annotations

import math

from physim.analysis.validation import Validation
from physim.analysis.validation.contact_report import (
    ContactReport,
    SweptContactReport,
    describe_bodies,
    describe_cause,
    describe_responsibility,
)
from physim.analysis.validation.decisions import DecisionTable
from physim.analysis.validation.wording import joined, length, short, wrapped
from physim.errors import plural
from physim.geometry.shapes import FloatArray
from physim.parts.declarations import NO_NUMBER
from physim.record import Record

MOST_TOLD = 6
"""Robots whose starts are told one by one"""
STANDS = 5e-4
"""[m/s, rad/s] below which a robot is said to stand, or to go straight"""


def story(record: Record, found: Validation) -> str:
    """Tell what a record shows, ending in a newline; ``found`` is its validation.

    The first contact; without one, where two came nearest.
    """
    touches: list[ContactReport | SweptContactReport] = [*found.contacts, *found.grazes]
    touches.sort(key=lambda one: one.time)
    said = [_scene(record)]
    if touches:
        first = touches[0]
        said += _contact(record, found, first)
        if others := _others(found, first):
            said.append(others)
    else:
        said += _nearest(record, found)
    return "\n".join(wrapped(" ".join(said), "", "")) + "\n"


def _scene(record: Record) -> str:
    """Who starts where."""
    names = [body.name for body in record.bodies]
    count = plural(record.robots, "robot")
    if record.robots > MOST_TOLD:
        return f"{count} start, {names[0]} at {_pose(record.pose[0, 0])}."
    starts = [f"{names[i]} at {_pose(record.pose[0, i])}" for i in range(record.robots)]
    verb = "starts" if record.robots == 1 else "start"
    return f"{count} {verb}: {joined(starts)}."


def _pose(pose: FloatArray) -> str:
    x, y, heading = pose.tolist()
    turned = math.degrees(math.remainder(heading, 2.0 * math.pi))
    return f"{_place(x, y)} facing {turned:.0f} degrees"


def _place(x: float, y: float) -> str:
    return f"({round(x, 2) + 0.0:.2f}, {round(y, 2) + 0.0:.2f}) m"  # of no -0.00


def _contact(
    record: Record, found: Validation, one: ContactReport | SweptContactReport
) -> list[str]:
    """The contact, what each robot was doing, who was responsible, and why it was not avoided."""
    names, x, y = found.names, *one.place
    bodies = describe_bodies(one, names)
    if isinstance(one, ContactReport):
        closing = f", closing at {one.severity.closing:.2f} m/s"
        where = f"{_place(x, y)}, {one.station:.2f} m along the reference path"
        said = [f"At {one.time:.2f} s {bodies} touch at {where}{closing}."]
    else:
        said = [
            f"Just before {one.time:.2f} s, between two samples, {bodies} touch at "
            f"{_place(x, y)}, {length(one.depth)} deep, and are apart again after it."
        ]
    step = round(one.time / record.dt)
    table = DecisionTable(record)
    said += [_doing(record, table, side.body, step, side.speed, names) for side in one.sides]
    said.append(describe_responsibility(one, names))
    if isinstance(one, ContactReport):
        said.append(describe_cause(one, names))
    return [one for one in said if one]


def _doing(
    record: Record,
    table: DecisionTable,
    robot: int,
    step: int,
    speed: float,
    names: list[str],
) -> str:
    """What a robot did in the step that led to a sample, and by which decision."""
    name, row = names[robot], table.last(robot, max(step - 1, 0))
    if row is None or step == 0:
        return f"{name} had made no decision yet."
    v, omega = table.held(robot, step - 1)
    ago = short((step - int(row["step"])) * record.dt)
    decided = []
    if row["mode"] != NO_NUMBER:
        decided.append(f"in mode {record.modes[row['mode']]}")
    if row["rule"] != NO_NUMBER:
        decided.append(f"by the rule: {record.declared.rules[row['rule']]}")
    considered = plural(int(row["considered"]), "robot")
    tail = f", {', '.join(decided)}" if decided else ""
    return (
        f"{name} moved at {speed:.2f} m/s; it was told to {_motion(v, omega)}, decided {ago} "
        f"before{tail}, with {considered} considered."
    )


def _motion(v: float, omega: float) -> str:
    """Say a command in words."""
    if abs(v) < STANDS and abs(omega) < STANDS:
        return "stand"
    side = "left" if omega > 0.0 else "right"
    turn = f"turn {side} at {abs(omega):.2f} rad/s"
    if abs(v) < STANDS:
        return f"{turn} on the spot"
    way = f"go {'ahead' if v > 0.0 else 'back'} at {abs(v):.2f} m/s"
    return f"{way} straight on" if abs(omega) < STANDS else f"{way} and {turn}"


def _others(found: Validation, first: ContactReport | SweptContactReport) -> str:
    """How many more contacts there are."""
    more = len(found.contacts) + len(found.grazes) - 1
    after = found.run.seconds - first.time
    if not more:
        return ""
    verb = "follows" if more == 1 else "follow"
    return f"{plural(more, 'contact')} {verb} in the {after:.2f} s after it."


def _nearest(record: Record, found: Validation) -> list[str]:
    """Where two came nearest, and what they were doing."""
    near, names = found.near_misses, found.names
    some = [one for one in (near.smallest_robots, near.smallest_boundary) if one is not None]
    if not some:
        return [f"Nothing comes near in {found.run.seconds:.2f} s."]
    one = min(some, key=lambda one: one.value)
    table = DecisionTable(record)
    said = [
        f"Nothing touches in {found.run.seconds:.2f} s. The nearest are {names[one.a]} and "
        f"{names[one.b]} at {one.time:.2f} s, {length(one.value)} apart."
    ]
    for body in (one.a, one.b):
        if body < record.robots:
            pose = record.pose_at(one.step)[body]
            before = record.pose_at(max(one.step - 1, 0))[body]
            speed = math.hypot(*(pose - before)[:2]) / record.dt
            said.append(f"{names[body]} was at {_pose(pose)}.")
            said.append(_doing(record, table, body, one.step, speed, names))
    return said
