"""The pages: `content` of a report, as Markdown (the dialect of GitHub) and as HTML.

Verdicts first, then every figure and study. The HTML needs nothing beside it but videos and pages
of runs.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

from physim import html as markup
from physim.drawing.page.colours import styles
from physim.errors import plural
from physim.escaping import escaped
from physim.html import Html, tag
from physim.reproduction.model import Outcome, Part, Report, Section, Verdict

TITLE = "The paper, reproduced"
MARKDOWN, HTML, JSON = "REPRODUCTION.md", "reproduction.html", "reproduction.json"
PAGES = (MARKDOWN, HTML, JSON)
SPECIAL = re.compile(r"[\\`*_{}\[\]<>#|~$&]")
"""Characters that have a meaning in Markdown wherever they stand."""
WIDE = 1000
"""[px] Wider pictures (maps) have a line for themselves."""


class Words(NamedTuple):
    """A part of a line that is not plain text."""

    kind: str
    """code, strong, or link"""
    text: str
    goal: str = ""
    """of a link: title of a section"""


Block = tuple[Any, ...]
"""A part of the page: its kind, and what it holds. Lines are texts and `Words`."""


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
        yield Words("strong", one)
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
    return row.reported, row.measured, Words("strong", row.outcome)


def _whole(row: Verdict) -> tuple[str | Words, ...]:
    reported, measured, verdict = _judged(row)
    return _claim(row), reported, measured, row.spread, row.met, row.without, verdict


def anchor_of(title: str) -> str:
    """Name of a heading in links; the same that GitHub makes of its title."""
    kept = (c if c.isalnum() or c in "-_" else " " if c == " " else "" for c in title)
    return "".join(kept).lower().replace(" ", "-")


def markdown(report: Report) -> str:
    """The page in the dialect of GitHub."""
    return "\n\n".join(map(_marked, content(report))) + "\n"


def _marked(block: Block) -> str:
    match block:
        case "p", *words:
            return "".join(map(_inline, words))
        case "table", (head, *rows):
            table = (map(_inline, head), ["---"] * len(head), *(map(_inline, row) for row in rows))
            return "\n".join(f"| {' | '.join(cells)} |" for cells in table)
        case "picture", file, caption:
            return f"![{_inline(caption)}]({quote(file)})"
        case "run", file, words:
            return f"[{_inline(words)}]({quote(file)})"
        case "commands", lines:
            return "\n".join(("```sh", *map(escaped, lines), "```"))
        case heading, title:
            return f"{'#' * int(heading[1])} {_inline(title)}"
    raise ValueError(block)


def _inline(words: str | Words) -> str:
    if isinstance(words, str):
        return SPECIAL.sub(r"\\\g<0>", escaped(words))
    if words.kind == "code":
        return f"`{escaped(words.text)}`"
    text = _inline(words.text)
    return f"[{text}](#{anchor_of(words.goal)})" if words.goal else f"**{text}**"


def html(report: Report, folder: Path) -> str:
    """The page for browsers, with the pictures, which are read from ``folder``, in it."""
    body = tag("main", (_element(block, folder) for block in content(report)), class_="sheet")
    icon = tag("link", rel="icon", href="data:,")
    style = styles("reproduction.css")
    return markup.page(TITLE, body, style=style, head=icon, beside=True)


def _element(block: Block, folder: Path) -> Html:
    match block:
        case "p", *words:
            return tag("p", map(_words, words))
        case "table", (head, *rows):
            return markup.table(head, (map(_words, row) for row in rows))
        case "picture", file, caption:
            content = (folder / file).read_bytes()
            width = int.from_bytes(content[16:20], "big")  # from the header of a PNG
            data = f"data:image/png;base64,{base64.b64encode(content).decode('ascii')}"
            whole = "whole" if width > WIDE else None
            image = tag("img", src=data, alt=caption)
            return tag("figure", image, tag("figcaption", caption), class_=whole)
        case "run", file, words:
            link = tag("a", words, href=quote(file))
            if not file.endswith(".html"):
                film = tag("video", controls=True, preload="metadata", src=quote(file))
                return tag("figure", film, link)
            frame = tag("iframe", loading="lazy", src=quote(file), title="the run in the browser")
            run = tag("details", tag("summary", "Watch the run here"), frame)
            return tag("figure", run, link, class_="whole")
        case "commands", lines:
            return tag("pre", tag("code", markup.together(map(markup.text, lines), "\n")))
        case heading, title:
            return tag(heading, title, id=anchor_of(title))
    raise ValueError(block)


def _words(words: str | Words) -> Html:
    if isinstance(words, str):
        return markup.text(words)
    if words.kind == "link":
        return tag("a", words.text, href=f"#{anchor_of(words.goal)}")
    style = f"outcome {words.text.replace(' ', '-')}" if words.text in set(Outcome) else None
    return tag(words.kind, words.text, class_=style)


def pages(report: Report, folder: Path) -> dict[str, str]:
    """Texts of the files that present the report, by name; pictures are read from ``folder``."""
    return {MARKDOWN: markdown(report), HTML: html(report, folder), JSON: report.to_json()}
