"""What a validation found, and the contacts of a run, as parts of its page; each line leads to its
moment.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import Any, NamedTuple
from urllib.parse import urlencode

from physim.analysis.summary import Summary
from physim.analysis.validation import Validation, report
from physim.analysis.validation.told import sentences
from physim.html import Html, lines, table, tag
from physim.units import amount

MOST_FINDINGS = 300
"""that have a line; others are counted, and told in the JSON of the validation"""
MOST_CONTACTS = 200
"""Contacts that have a line; others are counted."""
OPEN = 12
"""Contacts up to which their table is open from the start."""


class Row(NamedTuple):
    """A contact at samples or, without a duration and an impulse, between two of them."""

    step: int
    a: int
    b: int
    time: float
    lasts: float | None
    depth: float
    impulse: float | None


def numbered(summary: Summary) -> list[Row]:
    """All contacts of a run in the order in which the page numbers them, from 1."""
    if summary.contacts is None:
        return []
    dt = summary.run.record.dt
    found = [
        Row(one.step, one.a, one.b, one.time, one.samples * dt, one.depth, one.impulse)
        for one in summary.contacts
    ]
    found += [
        Row(one.step, one.a, one.b, one.time, None, one.depth, None) for one in summary.run.grazes
    ]
    return sorted(found, key=lambda one: one[:3])


def _numbers(summary: Summary) -> dict[tuple[int, int, float], int]:
    """Number of each contact in the page, by its bodies and time."""
    return {(row.a, row.b, round(row.time, 6)): k for k, row in enumerate(numbered(summary), 1)}


def _link(words: str, time: float, asked: dict[str, Any], **attributes: Any) -> Html:
    return tag("a", words, href=f"#{urlencode({'t': f'{time:.3f}', **asked})}", **attributes)


def contact_table(summary: Summary, run: int, runs: int) -> Html:
    """The contacts of a run, each with a link to its moment; nothing where there are none."""
    found = numbered(summary)
    if not found:
        return Html()
    which = {"run": run + 1} if runs > 1 else {}
    rows = (
        (
            _link(f"{one.time:.2f} s", one.time, {**which, "contact": number}),
            " and ".join(summary.names_of(one.a, one.b)),
            "between samples" if one.lasts is None else f"{one.lasts:.2f} s",
            f"{1e3 * one.depth:.2f} mm",
            "–" if one.impulse is None else amount(one.impulse, "N s", 1),
        )
        for number, one in enumerate(found[:MOST_CONTACTS], 1)
    )
    left = len(found) - MOST_CONTACTS
    return tag(
        "details",
        tag("summary", f"Contacts: {len(found)}"),
        table(
            ("moment", "bodies", "in contact", "deepest", "impulse"), rows,
            caption="Contacts, each with its moment",
        ),
        tag("p", f"and {left} more, which the record holds") if left > 0 else None,
        open=len(found) <= OPEN,
    )  # fmt: skip


def opening(found: Validation, summary: Summary) -> Html:
    """The verdict, and the severest contact with a link to it, at which the page opens."""
    worst: list[Any] = []
    at = summary.metrics.get("closing_speed")
    for one in found.contacts:
        if at is not None and (one.a, one.b, one.time) == (*at.bodies, at.time):
            place = f"{one.time:.2f} s, {_names(found, one.a, one.b)}"
            number = _numbers(summary)[one.a, one.b, round(one.time, 6)]
            how = f", closing at {one.severity.closing:.3f} m/s"
            if one.severity.energy is not None:
                how += f", {amount(one.severity.energy, 'J', 1)} lost"
            link = _link(place, one.time, {"contact": number}, class_="worst")
            worst = [" Severest by closing speed: ", link, f"{how}."]
    words = f"Validation: {found.verdict}."
    return tag("p", words, worst, class_="verdict bad" if found.code else "verdict")


def _names(found: Validation, *bodies: int | None) -> str:
    return " and ".join(found.names[body] for body in bodies if body is not None)


def findings_section(found: Validation, summary: Summary) -> Html:
    """The verdict, a table of all findings, and the whole report."""
    rows = list(_findings(found, summary))
    left = len(rows) - MOST_FINDINGS
    told = table(
        ("finding", "moment", "who", "what"), rows[:MOST_FINDINGS], class_="findings",
        caption="Findings, each with its moment",
    )  # fmt: skip
    return tag(
        "section",
        tag("h2", "Validation"),
        tag("p", found.verdict, class_="verdict bad" if found.code else "verdict"),
        told if rows else None,
        tag("p", f"and {left} more (physim validate --json has all)") if left > 0 else None,
        tag("details", tag("summary", "The whole report"), lines(report(found, full=True))),
        id="validation",
        aria_label="validation",
    )


def _findings(found: Validation, summary: Summary) -> Iterator[tuple[object, ...]]:
    """Cells of a line each: what is wrong with the record, contacts, what was missed, near misses.

    A moment leads to its contact, or to the robot to ask.
    """
    names, number = found.names, _numbers(summary)

    def row(
        kind: str,
        time: float | None,
        bodies: tuple[int | None, ...],
        words: str,
        contact: int | None = None,
        robot: int | None = None,
    ) -> tuple[object, ...]:
        moment: object = "–"
        if time is not None:
            who = min((b for b in bodies if b is not None), default=found.run.robots)
            who = who if robot is None else robot
            asked: dict[str, Any] = {"robot": names[who]} if who < found.run.robots else {}
            asked = asked if contact is None else {"contact": contact}
            moment = _link(f"{time:.2f} s", time, asked)
        return kind, moment, _names(found, *bodies), words

    for one in chain.from_iterable(found.findings):
        yield row("disagreement", one.time, one.bodies, one.words)
    without = found.undisturbed
    blame = {(one.a, one.b): one.words for one in without.pairs} if without is not None else {}
    deep = {(low.a, low.b): low.sentence(names) for low in found.deep}
    for hit in (*found.contacts, *found.grazes):
        pair = (hit.a, hit.b)
        words = " ".join([*sentences(hit, names)[:3], blame.get(pair, ""), deep.pop(pair, "")])
        words = " ".join(words.split())
        place, blamed = number.get((*pair, round(hit.time, 6))), min(hit.responsible, default=None)
        yield row("contact", hit.time, pair, words, place, blamed)
    for missed in found.missed:
        yield row("not as expected", None, (), f"{missed.key}: {missed}")
    near = found.near_misses
    for what, unit, digits, some in (
        ("distance", "m", 4, near.distances), ("collision time", "s", 3, near.times)
    ):  # fmt: skip
        for miss in some:
            duty = "" if miss.behind is None else f"; {names[miss.behind]} had to give way"
            words = f"{what} {miss.value:.{digits}f} {unit}{duty}"
            yield row("near miss", miss.time, (miss.a, miss.b), words, robot=miss.behind)
