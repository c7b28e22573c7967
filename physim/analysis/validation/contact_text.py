"""Contacts and their predictions in words: what went wrong, where, what each robot had decided."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from physim.analysis.validation.contact_report import (
    ContactReport,
    SweptContactReport,
    describe_bodies,
    describe_cause,
    describe_responsibility,
)
from physim.analysis.validation.prediction import AGREES, DISAGREES, Early
from physim.analysis.validation.responsibility import RobotInContact
from physim.analysis.validation.validation import Validation
from physim.analysis.validation.wording import HUGE, joined, length, short, wrapped
from physim.errors import amount_text
from physim.tolerances import CONTACT

MOST_LISTED = 8
"""Pairs whose first contact is described in full"""


def opening(validation: Validation) -> list[str]:
    """What happened, in two or three sentences."""
    return [
        line for text in _sentences(validation) for line in wrapped(text, "  ", "  ")
    ]  # fmt: skip


def _sentences(validation: Validation) -> list[str]:
    run, names, near = validation.run, validation.names, validation.near_misses
    if not validation.contacts and validation.grazes:
        return [f"No contact at a sample in {run.seconds:.2f} s.", *_grazes(validation)]
    if not validation.contacts:
        nearest = [
            f"{names[one.a]} and {names[one.b]} {_came(one.value)} at {one.time:.2f} s"
            f"{one.along and f', {one.along}'}"
            for one in (near.smallest_robots, near.smallest_boundary)
            if one is not None
        ]
        if any(
            one is not None and one.value < 0.0
            for one in (near.smallest_robots, near.smallest_boundary)
        ):
            return [
                f"The record has no contact in {run.seconds:.2f} s, yet bodies overlap: "
                f"{'; '.join(nearest)}."
            ]
        return [f"No contact in {run.seconds:.2f} s. Nearest: {'; '.join(nearest) or 'nothing'}."]
    first = validation.contacts[0]
    robots = sum(one.b < run.robots for one in validation.contacts)
    said = [
        f"{robots} between robots, {len(validation.contacts) - robots} with boundaries or "
        f"obstacles, in {run.seconds:.2f} s.",
        " ".join(
            part
            for part in (
                f"First at {first.time:.2f} s: {describe_bodies(first, names)}.",
                describe_responsibility(first, names),
                describe_cause(first, names),
            )
            if part
        ),
    ]
    shares = [
        f"{names[i]} {sum(i in one.responsible for one in validation.contacts)}"
        for i in sorted({i for one in validation.contacts for i in one.responsible})
    ]
    if shares and len(validation.contacts) > 1:
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
    names, first = validation.names, validation.grazes[0]
    count = len(validation.grazes)
    times = "once" if count == 1 else f"{count} times"
    where = f"({first.place[0]:.3f}, {first.place[1]:.3f}) m{_along(first)}"
    return [
        f"Between samples, where the engine does not look, bodies touched {times}; touching is a "
        "contact all the same.",
        f"{'That' if count == 1 else 'The first of these'} was just before {first.time:.2f} s: "
        f"{describe_bodies(first, names)}, {length(first.depth)} deep, at {where}. "
        f"{describe_responsibility(first, names)}".rstrip(),
    ]


def table_lines(validation: Validation) -> list[str]:
    """One line for each pair that touched."""
    names = validation.names
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
            f"  {amount_text(sum(one.impulse for one in some), 0):>9} N s"
            f"   {joined([names[i] for i in who])}".rstrip()
        )
    return lines


def contact_lines(validation: Validation) -> list[str]:
    """The first contact of each pair in full, `MOST_LISTED` pairs at most."""
    lines = []
    listed = first_of_pairs(validation)[:MOST_LISTED]
    for one in listed:
        lines += ["", *_contact(validation, one)]
    left = len(validation.contacts) - len(listed)
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
    lines = [f"  {heading(one, validation.names)}"]
    for label, text in paragraph(one, validation.names, validation.contacts):
        lines += wrapped(text, f"    {label:<11} ", 16 * " ")
    return lines


def heading(one: ContactReport, names: list[str]) -> str:
    """``Contact 3 at 5.10 s: r1 and r2``."""
    return f"Contact {one.number} at {one.time:.2f} s: {names[one.a]} and {names[one.b]}"


def paragraph(
    one: ContactReport, names: list[str], contacts: Sequence[ContactReport]
) -> list[tuple[str, str]]:
    """A contact in full, label and text of each line; ``contacts`` are those of its run."""
    end = "still touching at the end" if one.lasting else f"for {one.duration:.2f} s"
    hit = one.severity
    motion = f"closing at {hit.closing:.3f} m/s, sliding at {hit.sliding:.3f} m/s"
    if one.time == 0.0:
        motion = "in contact from the start"
    before = _before(one, names, contacts)
    push = f", pushing with {amount_text(one.impulse / one.duration, 0)} N on average"
    items = [
        ("what", f"{describe_bodies(one, names)}; {motion}"),
        (
            "where",
            f"({one.place[0]:.3f}, {one.place[1]:.3f}) m, "
            f"{one.station:.2f} m along the reference path{_along(one)}",
        ),
        (
            "contact",
            f"{end}{push}, depth up to {length(one.depth)}, impulse "
            f"{amount_text(one.first_impulse, 1)} N s at "
            f"first, {amount_text(one.impulse, 1)} N s in all",
        ),
        *_severity(one, names),
        ("responsible", describe_responsibility(one, names).removeprefix("Responsible is ")),
        *((names[side.body], _decision(side, one)) for side in one.sides),
        ("finding", describe_cause(one, names)),
    ]
    return [item for item in (*items, ("note", before)) if item[1]]


def _along(one: ContactReport | SweptContactReport) -> str:
    """The stretch of the boundary as the file has it; empty elsewhere."""
    _, comma, stretch = one.along.rpartition("), ")
    return f"; {stretch}" if comma else ""


def _severity(one: ContactReport, names: list[str]) -> list[tuple[str, str]]:
    """What the impact did to each robot; nothing where masses are not known."""
    hit = one.severity
    if hit.changes is None or hit.energy is None:
        return []
    changes = joined(
        [
            f"{names[side.body]} by {change:.3f} m/s"
            for side, change in zip(one.sides, hit.changes, strict=True)
        ]
    )
    return [("severity", f"changes the speed of {changes}, {amount_text(hit.energy, 1)} J lost")]


def _decision(side: RobotInContact, one: ContactReport) -> str:
    if side.decided is None:
        return "made no decision before the contact"
    mode = "" if side.mode is None else f"mode {side.mode}, "
    rule = "" if side.rule is None else f"{side.rule}, "
    ago = one.prediction.touched - side.decided
    return (
        f"decided {short(ago)} before: {mode}{rule}v {side.v:.3f} m/s, "
        f"omega {side.omega:.3f} rad/s; it {_saw(side)}"
    )


def _saw(side: RobotInContact) -> str:
    """What its controller reported to have looked at."""
    time, near, boundary = side.reported_time, side.reported_distance, side.reported_boundary
    if math.isnan(time) and math.isnan(near) and math.isnan(boundary):
        return "reported no distance and no collision time"
    words = [f"considered {side.considered} robot{'s' if side.considered != 1 else ''}"]
    if near == math.inf and side.considered:
        words.append("the nearest infinitely far")
    elif not math.isnan(near):
        words.append(f"nearest of them {'none' if near == math.inf else length(near)}")
    if not math.isnan(boundary):
        words.append(f"nearest boundary {'none' if boundary == math.inf else length(boundary)}")
    if math.isnan(time):
        words.append("no collision time")
    else:
        words.append(f"collision time {'none' if time == math.inf else _seconds(time)}")
    return ", ".join(words)


def _seconds(time: float) -> str:
    return short(time) if abs(time) >= HUGE else f"{time:.3f} s"


def _before(one: ContactReport, names: list[str], contacts: Sequence[ContactReport]) -> str:
    """What led up to this contact, and what followed between the two."""
    notes = []
    if one.also_touching:
        notes.append(f"already touching {joined([names[i] for i in one.also_touching])}")
    pair = [other for other in contacts if (other.a, other.b) == (one.a, one.b)]
    after = pair[pair.index(one) + 1 :]
    if after:
        gap = after[0].time - one.time - one.duration
        times = "once more" if len(after) == 1 else f"{len(after)} times more"
        notes.append(
            f"they parted and touched {times}, first {short(gap)} later, "
            f"last at {after[-1].time:.2f} s"
        )
    return "; ".join(notes)


LEADS = (0.0, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0)
"""[s] edges of the table of lead times"""


def prediction_lines(validation: Validation) -> list[str]:
    """Table of first contacts, errors at the last decision, errors by lead time."""
    if not validation.contacts:
        return []
    return [
        "FIRST CONTACT: predicted (collision time + time of prediction) against physical",
        *_table(validation),
        *_errors(validation),
        *_by_lead(validation),
    ]


def _table(validation: Validation) -> list[str]:
    names = validation.names
    lines = [
        f"  {'':<4}{'predicted at':>13}{'contact due':>14}{'touched':>14}{'seen at':>10}"
        f"{'error':>12}   pair"
    ]
    for one in first_of_pairs(validation)[:MOST_LISTED]:
        p = one.prediction
        made = "-" if p.made is None else f"{p.made:.2f} s"
        due = "-" if p.predicted is None else "none"
        if p.predicted is not None and math.isfinite(p.predicted):
            due = f"{p.predicted:.6f} s"
        error = "-" if p.error is None or math.isinf(p.error) else short(p.error)
        pair = f"{names[p.a]} and {names[p.b]}"
        note = "" if p.verdict == AGREES else f"  ({p.verdict})"
        lines.append(
            f"  {one.number:<4}{made:>13}{due:>14}{p.touched:>12.6f} s{p.found:>8.2f} s"
            f"{error:>12}   {pair}{note}"
        )
    return lines


def _errors(validation: Validation) -> list[str]:
    all_of = [one.prediction for one in validation.contacts]
    compared = [p for p in all_of if p.verdict in (AGREES, DISAGREES)]
    if not compared:
        return ["  At the last decision: none of them can be compared."]
    same = sum(p.verdict == AGREES for p in compared)
    errors = np.array([p.error for p in compared if p.error is not None and math.isfinite(p.error)])
    lines = [
        f"  Predicted by the last decision before contact: {same} of {len(compared)} in that step."
    ]
    if len(errors):
        size = np.abs(errors)
        lines.append(
            f"  Error: median {short(float(np.median(size)))}, "
            f"largest {short(float(size.max()))}; between samples robots move on chords."
        )
    left = len(all_of) - len(compared)
    if left:
        lines.append(
            f"  {left} more cannot be compared: a robot in contact does not move as commanded."
        )
    return lines


def _by_lead(validation: Validation) -> list[str]:
    early = [e for one in validation.contacts for e in one.prediction.early]
    if not early:
        return []
    lines = [
        "  Earlier predictions for the first contact of each pair (commands change on the way):",
        "  (foretold: share of decisions after which it would have come, had all kept their "
        "commands)",
        f"  {'lead time':>16}{'decisions':>11}{'foretold':>10}{'median error':>14}{'largest':>12}",
    ]
    for low, high in zip(LEADS[:-1], LEADS[1:], strict=True):
        some = [e for e in early if low <= e.lead < high]
        if some:
            lines.append(_lead_row(low, high, some))
    return lines


def _lead_row(low: float, high: float, some: list[Early]) -> str:
    size = np.abs([e.error for e in some if math.isfinite(e.error)])
    errors = f"{'-':>14}{'-':>12}"
    if len(size):
        errors = f"{short(float(np.median(size))):>14}{short(float(size.max())):>12}"
    return f"  {f'{low:g} to {high:g} s':>16}{len(some):>11}{len(size) / len(some):>10.0%}{errors}"
