"""The contacts of a run as a table that is read without scripts; its lines lead to moments."""

from __future__ import annotations

from html import escape
from typing import NamedTuple
from urllib.parse import urlencode

from physim.analysis.summary import Summary
from physim.errors import amount_text
from physim.escaping import html_text

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
    found = [
        Row(
            one.step,
            one.a,
            one.b,
            one.time,
            one.samples * summary.run.record.dt,
            one.depth,
            one.impulse,
        )
        for one in summary.contacts
    ]
    found += [
        Row(one.step, one.a, one.b, one.time, None, one.depth, None) for one in summary.run.grazes
    ]
    return sorted(found, key=lambda one: one[:3])


def contact_table(summary: Summary, run: int, runs: int) -> str:
    """The contacts of a run, each with a link to its moment; nothing where there are none."""
    found = numbered(summary)
    if not found:
        return ""
    head = "".join(
        f'<th scope="col">{words}</th>'
        for words in ("moment", "bodies", "in contact", "deepest", "impulse")
    )
    lines = []
    for number, (_, a, b, time, lasts, depth, impulse) in enumerate(found[:MOST_CONTACTS], 1):
        asked = {"t": f"{time:.3f}", **({"run": run + 1} if runs > 1 else {}), "contact": number}
        cells = (
            f'<a href="#{escape(urlencode(asked))}">{time:.2f} s</a>',
            html_text(" and ".join(summary.names_of(a, b))),
            "between samples" if lasts is None else f"{lasts:.2f} s",
            f"{1e3 * depth:.2f} mm",
            "–" if impulse is None else f"{amount_text(impulse, 1)} N s",
        )
        lines.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    left = len(found) - MOST_CONTACTS
    more = f"<p>and {left} more, which the record holds</p>" if left > 0 else ""
    return (
        f"<details{' open' if len(found) <= OPEN else ''}><summary>Contacts: {len(found)}</summary>"
        '<div class="wide"><table><caption>Contacts, each with its moment</caption>'
        f"<thead><tr>{head}</tr></thead>"
        f"<tbody>{''.join(lines)}</tbody></table></div>{more}</details>"
    )
