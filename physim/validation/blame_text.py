"""Responsibility in words: who ran into whom, who had to keep clear and why it did not."""

from __future__ import annotations

import math

from physim.declared import AT_STOP
from physim.tolerances import PUSH
from physim.validation.contact_report import ContactReport, SweptContactReport
from physim.validation.numbers import joined, length, short
from physim.validation.sides import RobotInContact


def describe_bodies(one: ContactReport | SweptContactReport, names: list[str]) -> str:
    """``front of r2 against rear left of r1``, the one that ran into the other first."""
    sides = sorted(one.sides, key=lambda side: not (side.responsible or _by_third(side, one)))
    words = [f"{side.part} of {names[side.body]}" for side in sides]
    if len(sides) == 1:
        words.append(names[one.b])
    return " against ".join(words)


def describe_responsibility(one: ContactReport | SweptContactReport, names: list[str]) -> str:
    """``r2: it was 1.2 m behind r1 …``, who had to keep clear, and why."""
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
            f"so it had to consider {other}."
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
    side = next(side for side in one.sides if side.responsible)
    name, other = names[side.body], names[one.a + one.b - side.body]
    if side.decided is None:
        return f"{name} had made no decision yet."
    said = []
    if one.warning is not None:
        said.append(
            f"Contact lay ahead at every decision of the last {short(one.warning)}."
            if one.warning > 0.0
            else "Contact did not lie ahead at the last decision."
        )
    if side.stands:
        said.append(f"{name} stood by command, and the record shows nobody that pushed it.")
        return " ".join(said)
    wall = len(one.sides) == 1
    looked = not math.isnan(side.reported_time)
    looked |= not math.isnan(side.reported_boundary if wall else side.reported_distance)
    if not looked:
        said.append(f"{name} reported no look at {other}: no distance and no collision time.")
    elif not wall and side.considered == 0:
        said.append(f"{name} considered no robot, though it had to consider {other}.")
    elif side.mode is None:
        said.append(f"{name} looked, but took no command that kept it clear of {other}.")
    elif side.mode.danger:
        said.append(f"{name} was avoiding, but took no command that kept it clear of {other}.")
    elif side.mode.name == AT_STOP.name:
        said.append(f"{name} said that it had arrived, yet its command was to move.")
    else:
        said.append(f"{name} was in mode {side.mode}: it did not take {other} for a danger.")
    return " ".join(said)


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
