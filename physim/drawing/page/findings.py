"""What a validation found, as a part of the page of its run; each finding leads to its moment."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from urllib.parse import urlencode

from physim.analysis.summary import Summary
from physim.analysis.validation import Validation, report
from physim.analysis.validation.told import sentences
from physim.drawing.page.tables import numbered
from physim.errors import amount_text
from physim.escaping import escaped_lines, html_text

MOST_FINDINGS = 300
"""that have a line; others are counted, and told in the JSON of the validation"""


@dataclass(frozen=True)
class Finding:
    """One line: of what kind, when [s], of which bodies, and what is said of it."""

    kind: str
    time: float | None
    bodies: tuple[int, ...]
    text: str
    contact: int | None = None
    """its number in the page"""
    robot: int | None = None
    """to ask why"""


def opening(found: Validation, summary: Summary) -> str:
    """The verdict, and the severest contact with a link to it, at which the page opens."""
    worst, at = "", summary.metrics.get("closing_speed")
    for one in found.contacts:
        if at is not None and (one.a, one.b, one.time) == (*at.bodies, at.time):
            hit, place = one.severity, f"{one.time:.2f} s, {_names(found, one.a, one.b)}"
            how = f"closing at {hit.closing:.3f} m/s"
            if hit.energy is not None:
                how += f", {amount_text(hit.energy, 1)} J lost"
            link = _link(one.time, {"contact": _numbers(summary)[one.a, one.b, round(one.time, 6)]})
            worst = f' Severest: <a class="worst" href="{link}">{html_text(place)}</a>, {how}.'
    bad = " bad" if found.code else ""
    return f'<p class="verdict{bad}">Validation: {html_text(found.verdict)}.{worst}</p>'


def _names(found: Validation, *bodies: int) -> str:
    return " and ".join(found.names[body] for body in bodies)


def _link(time: float, asked: dict[str, object]) -> str:
    return f"#{escape(urlencode({'t': f'{time:.3f}', **asked}))}"


def _numbers(summary: Summary) -> dict[tuple[int, int, float], int]:
    """Number of each contact in the page, by its bodies and time."""
    return {(row.a, row.b, round(row.time, 6)): k for k, row in enumerate(numbered(summary), 1)}


def findings_section(found: Validation, summary: Summary) -> str:
    """The verdict, a table of all findings, and the whole report, as HTML."""
    lines = list(_findings(found, summary))
    left = len(lines) - MOST_FINDINGS
    more = f"<p>and {left} more (physim validate --json has all)</p>" if left > 0 else ""
    head = "".join(f'<th scope="col">{word}</th>' for word in ("finding", "moment", "who", "what"))
    body = "".join(_row(one, found) for one in lines[:MOST_FINDINGS])
    table = (
        '<div class="wide"><table class="findings">'
        "<caption>Findings, each with its moment</caption>"
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>{more}"
    )
    return (
        '<section id="validation" aria-label="validation"><h2>Validation</h2>'
        f'<p class="verdict{" bad" if found.code else ""}">{html_text(found.verdict)}</p>'
        f"{table if lines else ''}"
        "<details><summary>The whole report</summary>"
        f"<pre>{escape(escaped_lines(report(found, full=True)))}</pre></details></section>"
    )


def _row(one: Finding, found: Validation) -> str:
    names = found.names
    moment = "–" if one.time is None else f"{one.time:.2f} s"
    if one.time is not None:
        asked: dict[str, object] = {}
        robot = one.robot if one.robot is not None else min(one.bodies, default=found.run.robots)
        if one.contact is not None:
            asked["contact"] = one.contact
        elif robot < found.run.robots:
            asked["robot"] = names[robot]
        moment = f'<a href="{_link(one.time, asked)}">{moment}</a>'
    who = html_text(_names(found, *one.bodies))
    cells = (html_text(one.kind), moment, who, html_text(one.text))
    return "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def _findings(found: Validation, summary: Summary) -> Iterator[Finding]:
    """What is wrong with the record first, then contacts, what was missed, and near misses."""
    yield from _disagreements(found)
    yield from _contacts(found, summary)
    for missed in found.missed:
        yield Finding("not as expected", None, (), f"{missed.key}: {missed}")
    near, names = found.near_misses, found.names
    for what, unit, digits, some in (
        ("distance", "m", 4, near.distances), ("collision time", "s", 3, near.times)
    ):  # fmt: skip
        for one in some:
            duty = "" if one.behind is None else f"; {names[one.behind]} had to give way"
            text = f"{what} {one.value:.{digits}f} {unit}{duty}"
            yield Finding("near miss", one.time, (one.a, one.b), text, robot=one.behind)


def _disagreements(found: Validation) -> Iterator[Finding]:
    for line in found.origin.differences:
        yield Finding("disagreement", None, (), line)
    wrong = list(found.recomputed.mismatches)
    if found.rerun is not None and found.rerun.difference is not None:
        wrong.insert(0, found.rerun.difference)
    for value in wrong:
        who = () if value.robot is None else (value.robot,)
        yield Finding("disagreement", value.time, who, value.line(found.names))
    for stray in found.motion.strays:
        yield Finding("disagreement", stray.time, (stray.robot,), stray.sentence)
    for one in found.comparison.disagreements:
        bodies = (one.a,) if one.b is None else (one.a, one.b)
        yield Finding("disagreement", one.time, bodies, f"{one.cause} ({one.what})")
    for p in found.mispredicted:
        yield Finding(
            "disagreement", p.found, (p.a, p.b), "first touch in another step than was predicted"
        )


def _contacts(found: Validation, summary: Summary) -> Iterator[Finding]:
    number, names = _numbers(summary), found.names
    deep = {(one.a, one.b): one.sentence(names) for one in found.deep}

    for one in (*found.contacts, *found.grazes):
        said = " ".join([*sentences(one, names)[:3], deep.pop((one.a, one.b), "")]).rstrip()
        place = number.get((one.a, one.b, round(one.time, 6)))
        yield Finding(
            "contact", one.time, (one.a, one.b), said, place, min(one.responsible, default=None)
        )
