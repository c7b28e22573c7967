"""The report as Markdown (the dialect of GitHub): verdicts first, then every figure and study.

Every name is written so that it is only a name: nothing in it is read as markup.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from urllib.parse import quote

from physim.errors import plural
from physim.reproduction.report import Report, Section
from physim.reproduction.study import Outcome, Verdict

TITLE = "The paper, reproduced"
SPECIAL = re.compile(r"[\\`*_{}\[\]<>#|~$&]")
"""Characters that have a meaning in Markdown wherever they stand."""
FIRST = re.compile(r"^\s*(\d*)([-+=.)])")
"""What makes a list or a rule where it stands first."""


def markdown(report: Report) -> str:
    """Text of the page."""
    blocks = [f"# {TITLE}", *_opening(report), *_overview(report)]
    for section in report.sections:
        blocks += _section(section)
    return "\n\n".join(blocks) + "\n"


def anchor_of(title: str) -> str:
    """Name of a heading in links; the same that GitHub makes of its title."""
    kept = (c if c.isalnum() or c in "-_" else " " if c == " " else "" for c in title)
    return "".join(kept).lower().replace(" ", "-")


def _opening(report: Report) -> Iterator[str]:
    yield (
        f"What the paper reports, beside what {_code('physim')} {_plain(report.physim)} measures: "
        "every number and every verdict on this page was computed by "
        f"{_code(report.command)}."
    )
    if report.interrupted:
        yield "It was interrupted: this page holds only what was done by then."
    yield (
        "The paper aims at path following, formation control and collision avoidance that let "
        "several robots move together through confined space, decentralised and cooperative; its "
        "funding note is NSFC 62203133. Only its text, with the numbers of equations and figures, "
        "is available to us; its title, its authors and its printed formulas are not, and the "
        "formulas are restored from the text."
    )
    yield (
        "The paper's waypoints, robot shapes and thresholds are unknown; worlds, footprints and "
        "settings are ours, tuned so that the reported figures come out in the same range. A "
        "measured figure is that of one run, the one in the pictures; beside it stand the median "
        f"and, in parentheses, the range over other random headings (seeds 0 to {report.seeds - 1})"
        " and the number of these runs that meet the claim. A claim is met when the run in the "
        "pictures and nine tenths of the others meet it (all of them, where the paper says always "
        "or never), partly met when only one of the two does or a weaker form of it holds. Claims "
        "about avoidance are also tested on the same runs without it; one that holds there, too, "
        "is marked as such: it is no evidence for avoidance."
    )


def _overview(report: Report) -> Iterator[str]:
    rows = report.rows
    if not rows:
        return
    count = (f"**{one}** {sum(row.outcome is one for row in rows)}" for one in Outcome)
    yield f"{plural(len(rows), 'claim')}: {', '.join(count)}."
    differing = [
        (
            _claim(row),
            f"[{_plain(section.short)}](#{anchor_of(section.title)})",
            _plain(row.reported), _plain(row.measured), f"**{row.outcome}**",
        )
        for section in report.sections
        for row in section.rows
        if row.outcome is not Outcome.MET
    ]  # fmt: skip
    if differing:
        yield "### Where we differ from the paper"
        yield _table(("claim", "where", "reported", "measured", "verdict"), differing)


def _section(section: Section) -> Iterator[str]:
    yield f"## {_plain(section.title)}"
    for text in (section.about, section.missing):
        if text:
            yield FIRST.sub(r"\1\\\2", _plain(text))
    if section.rows:
        yield _verdicts(section.rows)
    for file, caption in zip(section.pictures, section.captions, strict=True):
        yield f"![{_plain(caption)}]({quote(file)})"
    for file in section.films:
        yield f"[Video of the run]({quote(file)})"
    if section.commands:
        lines = "\n".join(_one_line(line) for line in section.commands)
        fence = _fence(lines, 3)
        yield f"{fence}sh\n{lines}\n{fence}"


def _verdicts(rows: Sequence[Verdict]) -> str:
    """Table of a section: columns that all rows leave empty are left out."""
    columns = {
        "claim": [_claim(row) for row in rows],
        "reported": [_plain(row.reported) for row in rows],
        "measured": [_plain(row.measured) for row in rows],
        "median (range) over seeds": [_plain(row.spread) for row in rows],
        "met in": [_plain(row.met) for row in rows],
        "met without avoidance in": [_plain(row.without) for row in rows],
        "verdict": [f"**{row.outcome}**" for row in rows],
    }
    kept = {name: cells for name, cells in columns.items() if any(cells)}
    return _table(tuple(kept), list(zip(*kept.values(), strict=True)))


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _claim(row: Verdict) -> str:
    end = "" if row.claim.endswith(".") else "."
    return _plain(f"{row.claim}{end} {row.remark}" if row.remark else row.claim)


def _one_line(text: str) -> str:
    return re.sub(r"[\r\n]", " ", text)


def _plain(text: str) -> str:
    """One line of text in which nothing has a meaning of its own."""
    return SPECIAL.sub(r"\\\g<0>", _one_line(text))


def _code(text: str) -> str:
    """Words to be typed or named exactly."""
    text = " ".join(text.split())
    room = " " if text.startswith("`") or text.endswith("`") else ""
    ticks = _fence(text, 1)
    return f"{ticks}{room}{text}{room}{ticks}"


def _fence(text: str, least: int) -> str:
    longest = max((len(run) for run in re.findall("`+", text)), default=0)
    return "`" * max(least, longest + 1)
