"""The report as a page: verdicts first, then every figure and every study."""

from __future__ import annotations

from collections.abc import Iterator

from physim.errors import plural
from physim.reproduction.document import (
    Block,
    Code,
    Commands,
    Film,
    Heading,
    Inline,
    Link,
    Paragraph,
    Picture,
    Table,
    Words,
)
from physim.reproduction.report import Report, Row, Section
from physim.reproduction.study import Outcome

TITLE = "The paper, reproduced"


def page(report: Report) -> list[Block]:
    """Blocks of the page."""
    blocks: list[Block] = [Heading(1, TITLE), *_opening(report), *_overview(report)]
    for section in report.sections:
        blocks += _section(section)
    return blocks


def _opening(report: Report) -> Iterator[Block]:
    yield Paragraph(
        (
            "What the paper reports, beside what ", Code("physim"), f" {report.physim} measures: ",
            "every number and every verdict on this page was computed by ", Code(report.command),
            ".",
        )
    )  # fmt: skip
    if report.interrupted:
        yield Paragraph("It was interrupted: only what was done by then stands here.")
    yield Paragraph(
        "The paper aims at path following, formation control and collision avoidance that let "
        "several robots move together through confined space, decentralised and cooperative; its "
        "funding note is NSFC 62203133. Its text with the numbers of equations and figures reached "
        "us; its title, its authors and its printed formulas did not, and the formulas are "
        "restored from the text."
    )
    yield Paragraph(
        "The paper's waypoints, robot shapes and thresholds are lost; worlds, footprints and "
        "settings are ours, tuned so that the reported figures come out in the same range. A "
        "measured figure is that of one run, the one in the pictures; beside it stand the median "
        f"and, in parentheses, the range over other random headings (seeds 0 to {report.seeds - 1})"
        " and in how many of these runs the claim is met. A claim is met when the run in the "
        "pictures and nine tenths of the others meet it (all of them, where the paper says always "
        "or never), partly met when only one of the two does or a weaker form of it holds. Claims "
        "about avoidance are also held against the same runs without it; one that holds there, "
        "too, says so: it is no evidence for avoidance."
    )


def _overview(report: Report) -> Iterator[Block]:
    rows = report.rows
    if not rows:
        return
    count = {one: sum(row.outcome is one for row in rows) for one in Outcome}
    told: list[Inline] = [f"{plural(len(rows), 'claim')}: "]
    for one in Outcome:
        told += [one, f" {count[one]}", ", " if one is not Outcome.NOT_MET else "."]
    yield Paragraph(told)
    open_rows = [
        (section, row)
        for section in report.sections
        for row in section.rows
        if row.outcome is not Outcome.MET
    ]
    if open_rows:
        yield Heading(3, "Where we differ from the paper")
        yield Table(
            ("claim", "where", "reported", "measured", "verdict"),
            tuple(
                (
                    _claim(row),
                    (Link(section.short, f"#{anchor_of(section)}"),),
                    row.reported, row.measured, (row.outcome,),
                )
                for section, row in open_rows
            ),
        )  # fmt: skip


def _section(section: Section) -> Iterator[Block]:
    yield Heading(2, section.title, anchor_of(section))
    if section.about:
        yield Paragraph(section.about)
    if section.missing:
        yield Paragraph(section.missing)
    if section.rows:
        yield _table(section.rows)
    for file, caption in zip(section.pictures, section.captions, strict=True):
        yield Picture(file, caption)
    for file in section.films:
        yield Film(file, "Video of the run")
    if section.commands:
        yield Commands(section.commands)


def _table(rows: tuple[Row, ...]) -> Table:
    spread = any(row.spread for row in rows)
    bare = any(row.without for row in rows)
    more: tuple[str, ...] = ("median (range) over seeds", "met in") if spread else ()
    more += ("met without avoidance in",) if bare else ()
    header = ("claim", "reported", "measured", *more, "verdict")
    cells: list[tuple[Words, ...]] = []
    for row in rows:
        over: tuple[str, ...] = (row.spread, row.met) if spread else ()
        over += (row.without,) if bare else ()
        cells.append((_claim(row), row.reported, row.measured, *over, (row.outcome,)))
    return Table(header, tuple(cells))


def _claim(row: Row) -> Words:
    end = "" if row.claim.endswith(".") else "."
    return f"{row.claim}{end} {row.remark}" if row.remark else row.claim


def anchor_of(section: Section) -> str:
    """Name of a section's heading in links; the same that GitHub makes of its title."""
    kept = (c if c.isalnum() or c in "-_" else " " if c == " " else "" for c in section.title)
    return "".join(kept).lower().replace(" ", "-")
