"""The pages: `content` of a report, as Markdown (the dialect of GitHub) and as HTML.

Verdicts first, then every figure and study. The HTML needs nothing beside it but videos and pages
of runs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from physim.blocks import Block, Words, html, markdown
from physim.drawing.page.colours import styles
from physim.errors import plural
from physim.reproduction.model import Outcome, Part, Report, Section, Verdict

TITLE = "The paper, reproduced"
MARKDOWN, HTML, JSON = "REPRODUCTION.md", "reproduction.html", "reproduction.json"
PAGES = (MARKDOWN, HTML, JSON)


def content(report: Report) -> Iterator[Block]:
    """What the page says."""
    physim = Words("code", "physim")
    yield "h1", TITLE
    yield (
        "p", "What the paper reports, beside what ", physim, f" {report.physim} measures: "
        "every number and every verdict on this page was computed by ",
        Words("code", report.command), ".",
    )  # fmt: skip
    if report.seeds < Part.seeds:
        yield (
            "p", Words("strong", "Preliminary."), " Verdicts rest on at most "
            f"{plural(report.seeds, 'seed')} of each world; the whole page, without ",
            Words("code", "--quick"), f", takes up to {Part.seeds} and may come to others.",
        )  # fmt: skip
    if report.interrupted:
        yield "p", "It was interrupted: this page holds only what was done by then."
    rows = report.rows
    if rows:
        yield "p", f"{plural(len(rows), 'claim')}: ", *_counts(rows), "."
        differing = [
            (_claim(row), Words("link", section.short, section.title), *_judged(row))
            for section in report.sections
            for row in section.rows
            if row.outcome is not Outcome.MET
        ]
        if differing:
            yield "h3", "Where we differ from the paper"
            yield "table", [("claim", "where", "reported", "measured", "verdict"), *differing]
    yield "h2", "How to read it"
    yield (
        "p", "The paper aims at path following, formation control and collision avoidance that let "
        "several robots move together through confined space, decentralised and cooperative; its "
        "funding note is NSFC 62203133. Only its text, with the numbers of equations and figures, "
        "is available to us; its title, its authors and its printed formulas are not, and the "
        "formulas are restored from the text.",
    )  # fmt: skip
    yield (
        "p", "The paper's waypoints, robot shapes and thresholds are unknown; worlds, footprints "
        "and settings are ours, tuned so that the reported figures come out in the same range. A "
        "measured figure is that of one run, the one in the pictures; beside it stand the median "
        f"and, in parentheses, the range over other random headings (seeds 0 to {report.seeds - 1})"
        " and the number of these runs that meet the claim. A claim is met when the run in the "
        "pictures and nine tenths of the others meet it (all of them, where the paper says always "
        "or never), partly met when only one of the two does or a weaker form of it holds. Claims "
        "about avoidance are also tested on the same runs without it; one that holds there, too, "
        "is marked as such: it is no evidence for avoidance.",
    )  # fmt: skip
    yield (
        "p", "Two of our rules depart from the paper's: in a formation the speed pair of (5) is a "
        "choice of omega alone, as (7) gives the forward speed; and in (11) boundaries count "
        "within the sensing range only, so that a robot on its way into one beyond reports no "
        "collision time. The modules of the controller list these and smaller departures.",
    )  # fmt: skip
    for section in report.sections:
        yield from _section(section)


def _counts(rows: Sequence[Verdict]) -> Iterator[str | Words]:
    for k, one in enumerate(Outcome):
        yield ", " if k else ""
        yield Words("outcome", one)
        yield f" {sum(row.outcome is one for row in rows)}"


def verdicts(report: Report) -> str:
    """A line for every claim that is not met, and the count of all."""
    told = [
        f"{row.outcome.value:<10}  {section.short}: {row.claim}: reported {row.reported}, "
        f"measured {row.measured}"
        for section in report.sections
        for row in section.rows
        if row.outcome is not Outcome.MET
    ]
    rows = report.rows
    count = ", ".join(f"{sum(r.outcome is one for r in rows)} {one.value}" for one in Outcome)
    return "\n".join([*told, f"{plural(len(rows), 'claim')}: {count}"]) + "\n"


def _section(section: Section) -> Iterator[Block]:
    yield "h2", section.title
    yield from (("p", text) for text in (section.about, section.missing) if text)
    if section.rows:
        head = (
            "claim", "reported", "measured", "median (range) over seeds", "met in",
            "met without avoidance in", "verdict",
        )  # fmt: skip
        lines = [_whole(row) for row in section.rows]
        kept = [k for k in range(len(head)) if any(line[k] for line in lines)]
        yield "table", [[line[k] for k in kept] for line in (head, *lines)]
    for file, caption in zip(section.pictures, section.captions, strict=True):
        yield "picture", file, caption
    for file in section.films:
        words = "The run in the browser" if file.endswith(".html") else "Video of the run"
        yield "run", file, words
    if section.commands:
        yield "commands", section.commands


def _claim(row: Verdict) -> str:
    end = "" if row.claim.endswith(".") else "."
    return f"{row.claim}{end} {row.remark}" if row.remark else row.claim


def _judged(row: Verdict) -> tuple[str, str, Words]:
    return row.reported, row.measured, Words("outcome", row.outcome)


def _whole(row: Verdict) -> tuple[str | Words, ...]:
    reported, measured, verdict = _judged(row)
    return _claim(row), reported, measured, row.spread, row.met, row.without, verdict


def pages(report: Report, folder: Path) -> dict[str, str]:
    """Texts of the files that present the report, by name; pictures are read from ``folder``."""
    blocks = list(content(report))
    style = styles("reproduction.css")
    return {
        MARKDOWN: markdown(blocks), HTML: html(TITLE, blocks, folder, style),
        JSON: report.to_json(),
    }  # fmt: skip
