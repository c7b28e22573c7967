"""Contacts in words: what went wrong, where, and who was responsible."""

from __future__ import annotations

import math

from physim.control import Mode
from physim.tolerances import CONTACT, PUSH
from physim.validation.contact_report import ContactReport, GrazeReport, Side
from physim.validation.numbers import joined, length, names_of, short, wrapped
from physim.validation.validation import Validation

SHOWN = 8
"""Pairs whose first contact is told in full"""

MODES = {
    int(Mode.SAFE): "safe mode",
    int(Mode.DISTANCE): "danger mode (by distance)",
    int(Mode.TIME): "danger mode (by collision time)",
    int(Mode.ARRIVED): "arrived, standing",
}


def opening(validation: Validation) -> list[str]:
    """What happened, in two or three sentences."""
    return [
        line for text in _sentences(validation) for line in wrapped(text, "  ", "  ")
    ]  # fmt: skip


def _sentences(validation: Validation) -> list[str]:
    run, names, near = validation.run, names_of(validation), validation.near_misses
    if not validation.contacts and validation.grazes:
        return [f"No contact at a sample in {run.seconds:.2f} s.", *_grazes(validation)]
    if not validation.contacts:
        told = [
            f"{names[one.a]} and {names[one.b]} {_came(one.value)} at {one.time:.2f} s"
            for one in (near.smallest_robots, near.smallest_boundary)
            if one is not None
        ]
        if any(
            one is not None and one.value < 0.0
            for one in (near.smallest_robots, near.smallest_boundary)
        ):
            return [
                f"The record tells no contact in {run.seconds:.2f} s, yet bodies overlap: "
                f"{'; '.join(told)}."
            ]
        return [f"No contact in {run.seconds:.2f} s. Nearest: {'; '.join(told) or 'nothing'}."]
    first = validation.contacts[0]
    robots = sum(one.b < run.robots for one in validation.contacts)
    said = [
        f"{robots} between robots, {len(validation.contacts) - robots} with boundaries or "
        f"obstacles, in {run.seconds:.2f} s.",
        f"First at {first.time:.2f} s: {_who(first, names)}. "
        f"Responsible is {_charge(first, names)} {_finding(first, names)}",
    ]
    if len(validation.contacts) > 1:
        shares = [
            f"{names[i]} {sum(i in one.responsible for one in validation.contacts)}"
            for i in sorted({i for one in validation.contacts for i in one.responsible})
        ]
        said.append(f"Responsible, by number of contacts: {', '.join(shares)}.")
    return said + _grazes(validation)


def _came(distance: float) -> str:
    """How near two bodies came; a negative distance is an overlap."""
    near = f"came within {length(distance)}"
    return near if distance >= -CONTACT else f"overlapped by {length(-distance)}"


def _grazes(validation: Validation) -> list[str]:
    """What happened between samples; nothing where nothing did."""
    if not validation.grazes:
        return []
    names, first = names_of(validation), validation.grazes[0]
    count = len(validation.grazes)
    times = "once" if count == 1 else f"{count} times"
    return [
        f"Between samples, where the engine does not look, bodies touched {times}; touching is a "
        "contact all the same.",
        f"{'That' if count == 1 else 'The first of these'} was just before {first.time:.2f} s: "
        f"{_who(first, names)}, {length(first.depth)} deep, at ({first.place[0]:.3f}, "
        f"{first.place[1]:.3f}) m. Responsible is {_charge(first, names)}",
    ]


def table_lines(validation: Validation) -> list[str]:
    """One line for each pair that touched."""
    names = names_of(validation)
    pairs: dict[tuple[int, int], list[ContactReport]] = {}
    for one in validation.contacts:
        pairs.setdefault((one.a, one.b), []).append(one)
    width = max(len(f"{names[a]} and {names[b]}") for a, b in pairs)
    head = "contacts  first at  in contact  deepest        impulse   responsible"
    lines = [f"  {'pair':<{width}}  {head}"]
    for (a, b), some in pairs.items():
        who = sorted({i for one in some for i in one.responsible})
        lines.append(
            f"  {f'{names[a]} and {names[b]}':<{width}}  {len(some):>8}  {some[0].time:>6.2f} s"
            f"  {sum(one.duration for one in some):>8.2f} s"
            f"  {length(max(one.depth for one in some)):>7}"
            f"  {sum(one.impulse for one in some):>9,.0f} N s   {joined([names[i] for i in who])}"
        )
    return lines


def contact_lines(validation: Validation) -> list[str]:
    """The first contact of each pair in full, `SHOWN` pairs at most."""
    lines = []
    shown = first_of_pairs(validation)[:SHOWN]
    for one in shown:
        lines += ["", *_contact(validation, one)]
    left = len(validation.contacts) - len(shown)
    if left:
        lines += ["", f"  and {left} more (--json FILE has all)"]
    return lines


def first_of_pairs(validation: Validation) -> list[ContactReport]:
    """First contact of each pair, in the order of time."""
    seen: dict[tuple[int, int], ContactReport] = {}
    for one in validation.contacts:
        seen.setdefault((one.a, one.b), one)
    return list(seen.values())


def _contact(validation: Validation, one: ContactReport) -> list[str]:
    names = names_of(validation)
    end = "still touching at the end" if one.lasting else f"for {one.duration:.2f} s"
    motion = f"closing at {one.closing:.3f} m/s, sliding at {one.sliding:.3f} m/s"
    if one.time == 0.0:
        motion = "in contact from the start"
    before = _before(validation, one)
    push = f", pushing with {one.impulse / one.duration:,.0f} N on average"
    lines = [
        f"  Contact {one.number} at {one.time:.2f} s: {names[one.a]} and {names[one.b]}",
        *_item("what", f"{_who(one, names)}; {motion}"),
        *_item(
            "where",
            f"({one.place[0]:.3f}, {one.place[1]:.3f}) m, "
            f"{one.station:.2f} m along the reference path",
        ),
        *_item(
            "contact",
            f"{end}{push}, depth up to {length(one.depth)}, impulse {one.first_impulse:.1f} N s at "
            f"first, {one.impulse:,.1f} N s in all",
        ),
        *_item("responsible", _charge(one, names)),
    ]
    for side in one.sides:
        lines += _item(names[side.body], _decision(side, one))
    lines += _item("finding", _finding(one, names))
    return lines + (_item("note", before) if before else [])


def _item(label: str, text: str) -> list[str]:
    return wrapped(text, f"    {label:<11} ", 16 * " ")


def _who(one: ContactReport | GrazeReport, names: list[str]) -> str:
    """``front of r2 against rear left of r1``, the one that ran into the other first."""
    sides = sorted(one.sides, key=lambda side: not (side.responsible or _by_third(side, one)))
    words = [f"{side.part} of {names[side.body]}" for side in sides]
    if len(sides) == 1:
        words.append(names[one.b])
    return " against ".join(words)


def _charge(one: ContactReport | GrazeReport, names: list[str]) -> str:
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


def _by_third(side: Side, one: ContactReport | GrazeReport) -> bool:
    """Whether another robot than the two brought this one into the contact."""
    return side.pushed_by is not None and side.pushed_by not in (one.a, one.b)


def _push(side: Side, one: ContactReport | GrazeReport, names: list[str]) -> str:
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


def _decision(side: Side, one: ContactReport) -> str:
    if side.decided is None:
        return "made no decision before the contact"
    mode = "" if side.mode is None else MODES.get(side.mode, f"mode {side.mode}") + ", "
    ago = one.prediction.touched - side.decided
    return (
        f"decided {short(ago)} before: {mode}v {side.v:.3f} m/s, omega {side.omega:.3f} rad/s; "
        f"it {_saw(side)}"
    )


def _saw(side: Side) -> str:
    """What its controller reported to have looked at."""
    if math.isnan(side.reported_time) and math.isnan(side.reported_distance):
        return "reported no distance and no collision time"
    words = [f"considered {side.considered} robot{'s' if side.considered != 1 else ''}"]
    if not math.isnan(side.reported_distance):
        near = "none" if math.isinf(side.reported_distance) else length(side.reported_distance)
        words.append(f"nearest of them {near}")
    if not math.isnan(side.reported_boundary):
        words.append(f"nearest boundary {length(side.reported_boundary)}")
    if math.isnan(side.reported_time):
        words.append("no collision time")
    else:
        seen = "none" if math.isinf(side.reported_time) else f"{side.reported_time:.3f} s"
        words.append(f"collision time {seen}")
    return ", ".join(words)


def _finding(one: ContactReport, names: list[str]) -> str:
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
    wall = len(one.sides) == 1
    looked = not math.isnan(side.reported_time)
    looked |= not math.isnan(side.reported_boundary if wall else side.reported_distance)
    if not looked:
        said.append(f"{name} reported no look at {other}: no distance and no collision time.")
    elif not wall and side.considered == 0:
        said.append(f"{name} considered no robot, though it had to consider {other}.")
    elif side.mode is None:
        said.append(f"{name} looked, but took no command that kept it clear of {other}.")
    elif side.mode == Mode.SAFE:
        said.append(f"{name} was in safe mode: it did not take {other} for a danger.")
    elif side.mode == Mode.ARRIVED:
        said.append(f"{name} had arrived and stood still.")
    else:
        said.append(f"{name} was avoiding, but took no command that kept it clear of {other}.")
    return " ".join(said)


def _before(validation: Validation, one: ContactReport) -> str:
    """What led up to this contact, and what followed between the two."""
    names = names_of(validation)
    notes = []
    if one.also_touching:
        notes.append(f"already touching {joined([names[i] for i in one.also_touching])}")
    pair = [other for other in validation.contacts if (other.a, other.b) == (one.a, one.b)]
    after = pair[pair.index(one) + 1 :]
    if after:
        gap = after[0].time - one.time - one.duration
        times = "once more" if len(after) == 1 else f"{len(after)} times more"
        notes.append(
            f"they parted and touched {times}, first {short(gap)} later, "
            f"last at {after[-1].time:.2f} s"
        )
    return "; ".join(notes)
