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
from physim.reproduction.papers import papers

MARKDOWN, HTML, JSON = "REPRODUCTION.md", "reproduction.html", "reproduction.json"
PAGES = (MARKDOWN, HTML, JSON)


def content(report: Report) -> Iterator[Block]:
    """What the page says."""
    physim, paper = Words("code", "physim"), papers()[report.paper]
    yield "h1", paper.title
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
    for text in paper.about:
        yield "p", text.format(last=report.seeds - 1)
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
        MARKDOWN: markdown(blocks), HTML: html(papers()[report.paper].title, blocks, folder, style),
        JSON: report.to_json(),
    }  # fmt: skip
