"""A contact in sentences, the same wherever it is told: text, page, JSON and `falsify`."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

from physim.analysis.validation.contact import Contact
from physim.analysis.validation.responsibility import RobotInContact
from physim.errors import place_text, plural
from physim.tolerances import PUSH
from physim.units import amount, joined, length, span

COLUMNS = 100


def sentences(one: Contact, names: Sequence[str], considered: str = "robot") -> list[str]:
    """What is to be said of a contact; ``names`` by body id, ``considered`` what robots consider.

    What touched and where; how hard; who was responsible and why; for how long it lay ahead; what
    each robot had decided. What is not known is left out.
    """
    ahead = ""
    if one.warning is not None:
        ahead = "Contact did not lie ahead at the last decision."
        if one.warning > 0.0:
            ahead = f"Contact lay ahead at every decision of the last {span(one.warning)}."
    said = [_what(one, names), _how_hard(one, names), _who(one, names), ahead]
    decided = [_decided(side, one, names, considered) for side in one.sides]
    return [text for text in said if text] + decided


def _what(one: Contact, names: Sequence[str]) -> str:
    """What touched what, the one that ran into the other first; how fast and where."""
    sides = sorted(one.sides, key=lambda side: not (side.responsible or side.pushed_by is not None))
    bodies = [f"{side.part} of {names[side.body]}" for side in sides]
    touch = " against ".join(bodies if len(bodies) > 1 else [*bodies, names[one.b]])
    motion = f"closing at {one.severity.closing:.2f} m/s, sliding at {one.severity.sliding:.2f} m/s"
    if one.prediction is None:
        motion = "apart at both samples"
    elif one.time == 0.0:
        motion = "in contact from the start"
    if one.also_touching:
        motion += f", already touching {joined([names[i] for i in one.also_touching])}"
    when = one.when[0].upper() + one.when[1:]
    return f"{when}: {touch}, {motion}, {one.along or f'at {place_text(*one.place, 4)}'}."


def _how_hard(one: Contact, names: Sequence[str]) -> str:
    if one.prediction is None:
        return f"It is {length(one.depth)} deep, at {one.time:.2f} s."
    lasts = f"It lasts {one.duration:.2f} s"
    if one.lasting:
        lasts = f"It lasts to the end of the run, {one.duration:.2f} s"
    said = f"{lasts}, {length(one.depth)} deep"
    if one.first_impulse is not None and one.impulse is not None:
        said += (
            f"; impulse {amount(one.first_impulse, 'N s', 1)} at first, "
            f"{amount(one.impulse, 'N s', 1)} in all"
        )
    hit = one.severity
    if hit.changes is None or hit.energy is None:
        return f"{said}."
    changes = [
        f"{names[side.body]} {change:.2f} m/s"
        for side, change in zip(one.sides, hit.changes, strict=True)
    ]
    return f"{said}; {amount(hit.energy, 'J', 1)} lost, change of speed {joined(changes)}."


def _who(one: Contact, names: Sequence[str]) -> str:
    """Who was responsible, and why; empty where no rule of the controller says so."""
    if not one.responsible:
        return ""
    who, why = joined([names[i] for i in one.responsible]), []
    for side in one.sides:
        if side.pushed_by is not None:
            moved, still = names[side.body], names[one.a + one.b - side.body]
            if side.stands and side.speed <= PUSH:
                moved, still = still, moved
            third = side.pushed_by not in (one.a, one.b)
            did = f"pushed {moved} into {still}" if third else f"ran into {names[side.body]}"
            why.append(f"{names[side.pushed_by]} {did}")
    charged = [side for side in one.sides if side.responsible]
    if not why and len(charged) == 1 and charged[0].behind is not None:
        behind, other = charged[0].behind, names[one.a + one.b - charged[0].body]
        if behind > 0.0:
            why = [f"it was {length(behind)} behind {other}, which has priority"]
        elif behind == 0.0:
            why = [f"{other} was level with it and has priority by its lower number"]
        else:
            why = [f"it was behind {other} when they touched; they had just changed places"]
    return f"Responsible: {who}{', as ' * bool(why)}{'; '.join(why)}."


def _decided(side: RobotInContact, one: Contact, names: Sequence[str], considered: str) -> str:
    """How a robot moved, what it had decided, and what its controller reported to have seen."""
    moved = f"{names[side.body]} moved at {side.speed:.2f} m/s"
    if side.stands:
        moved = f"{names[side.body]} stood by command"
        if side.responsible:
            moved += ", and the record shows no robot that pushed it"
    if one.impulse is None:  # of a log nothing more is known
        return f"{moved}."
    if side.decided is None:
        return f"{moved}; it had made no decision yet."
    touched = one.time if one.prediction is None else one.prediction.touched
    mode = "" if side.mode is None else f", mode {side.mode}"
    rule = "" if side.rule is None else f", {side.rule}"
    seen = [
        f"{what} {'none' if math.isinf(value) else text(value)}"
        for what, value, text in (
            ("nearest", side.reported_distance, length),
            ("boundary", side.reported_boundary, length),
            ("collision time", side.reported_time, span),
        )
        if not math.isnan(value)
    ]
    saw = "reported no distance, no collision time"
    if seen:
        saw = f"considered {plural(side.considered, considered)}: {', '.join(seen)}"
    return (
        f"{moved}; decided {span(touched - side.decided)} before{mode}{rule}, "
        f"v {side.v:.3f} m/s, omega {side.omega:.3f} rad/s; {saw}."
    )


def wrapped(text: str, indent: str, hanging: str) -> list[str]:
    """Lines of at most `COLUMNS` columns, the first indented by ``indent``."""
    return textwrap.wrap(
        text, COLUMNS, initial_indent=indent, subsequent_indent=hanging, break_on_hyphens=False
    )
