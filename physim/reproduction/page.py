"""The pages: `content` of a report, as Markdown (the dialect of GitHub) and as HTML.

Verdicts first, then every figure and study. The HTML needs nothing beside it but videos and pages
of runs.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple
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


Line = Sequence[str | Words]


class Block(NamedTuple):
    """A part of the page."""

    kind: str
    """h1, h2, h3, p, table, picture, run, commands"""
    lines: Sequence[Line] = ()
    """one; of commands several"""
    rows: Sequence[Sequence[Line]] = ()
    """of a table, its head first"""
    file: str = ""
    """of a picture or a run, relative to the page"""


def _text(kind: str, *words: str | Words) -> Block:
    return Block(kind, [words])


def content(report: Report) -> Iterator[Block]:
    """What the page says."""
    physim = Words("code", "physim")
    yield _text("h1", TITLE)
    yield _text(
        "p", "What the paper reports, beside what ", physim, f" {report.physim} measures: "
        "every number and every verdict on this page was computed by ",
        Words("code", report.command), ".",
    )  # fmt: skip
    if report.seeds < Part.seeds:
        yield _text(
            "p", Words("strong", "Preliminary."), " Verdicts rest on at most "
            f"{plural(report.seeds, 'seed')} of each world; the whole page, without ",
            Words("code", "--quick"), f", takes up to {Part.seeds} and may come to others.",
        )  # fmt: skip
    if report.interrupted:
        yield _text("p", "It was interrupted: this page holds only what was done by then.")
    rows = report.rows
    if rows:
        yield _text("p", f"{plural(len(rows), 'claim')}: ", *_counts(rows), ".")
        differing: list[tuple[Line, ...]] = [
            ([_claim(row)], [Words("link", section.short, section.title)], *_cells(row, True))
            for section in report.sections
            for row in section.rows
            if row.outcome is not Outcome.MET
        ]
        if differing:
            yield _text("h3", "Where we differ from the paper")
            head = ("claim", "where", "reported", "measured", "verdict")
            yield Block("table", rows=[[[name] for name in head], *differing])
    yield _text("h2", "How to read it")
    yield _text(
        "p", "The paper aims at path following, formation control and collision avoidance that let "
        "several robots move together through confined space, decentralised and cooperative; its "
        "funding note is NSFC 62203133. Only its text, with the numbers of equations and figures, "
        "is available to us; its title, its authors and its printed formulas are not, and the "
        "formulas are restored from the text.",
    )  # fmt: skip
    yield _text(
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
    yield _text(
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


def _section(section: Section) -> Iterator[Block]:
    yield _text("h2", section.title)
    for text in filter(None, (section.about, section.missing)):
        yield _text("p", text)
    if section.rows:
        head = (
            "claim", "reported", "measured", "median (range) over seeds", "met in",
            "met without avoidance in", "verdict",
        )  # fmt: skip
        lines = [([_claim(row)], *_cells(row)) for row in section.rows]
        kept = [k for k in range(len(head)) if any(line[k][0] for line in lines)]
        table = [[[name] for name in head], *lines]
        yield Block("table", rows=[[line[k] for k in kept] for line in table])
    for file, caption in zip(section.pictures, section.captions, strict=True):
        yield Block("picture", [[caption]], file=file)
    for file in section.films:
        words = "The run in the browser" if file.endswith(".html") else "Video of the run"
        yield Block("run", [[words]], file=file)
    if section.commands:
        yield Block("commands", [[line] for line in section.commands])


def _claim(row: Verdict) -> str:
    end = "" if row.claim.endswith(".") else "."
    return f"{row.claim}{end} {row.remark}" if row.remark else row.claim


def _cells(row: Verdict, short: bool = False) -> tuple[Line, ...]:
    """A verdict but for its claim; empty cells are those that a section may leave out."""
    over_seeds = () if short else (row.spread, row.met, row.without)
    texts = (row.reported, row.measured, *over_seeds)
    return (*([text] for text in texts), [Words("strong", row.outcome)])


def anchor_of(title: str) -> str:
    """Name of a heading in links; the same that GitHub makes of its title."""
    kept = (c if c.isalnum() or c in "-_" else " " if c == " " else "" for c in title)
    return "".join(kept).lower().replace(" ", "-")


def markdown(report: Report) -> str:
    """The page in the dialect of GitHub."""
    return "\n\n".join(map(_marked, content(report))) + "\n"


def _marked(block: Block) -> str:
    lines = [_inline(line) for line in block.lines]
    match block.kind:
        case "p":
            return lines[0]
        case "table":
            head, *rows = ([_inline(cell) for cell in row] for row in block.rows)
            table = (head, ["---"] * len(head), *rows)
            return "\n".join(f"| {' | '.join(cells)} |" for cells in table)
        case "picture":
            return f"![{lines[0]}]({quote(block.file)})"
        case "run":
            return f"[{lines[0]}]({quote(block.file)})"
        case "commands":
            return "\n".join(("```sh", *(escaped(str(line[0])) for line in block.lines), "```"))
    return f"{'#' * int(block.kind[1])} {lines[0]}"


def _inline(line: Line) -> str:
    def part(words: str | Words) -> str:
        if isinstance(words, str):
            return SPECIAL.sub(r"\\\g<0>", escaped(words))
        if words.kind == "code":
            return f"`{escaped(words.text)}`"
        text = part(words.text)
        return f"[{text}](#{anchor_of(words.goal)})" if words.goal else f"**{text}**"

    return "".join(map(part, line))


def html(report: Report, folder: Path) -> str:
    """The page for browsers, with the pictures, which are read from ``folder``, in it."""
    body = tag("main", (_element(block, folder) for block in content(report)), class_="sheet")
    icon = tag("link", rel="icon", href="data:,")
    style = styles("reproduction.css")
    return markup.page(TITLE, body, style=style, head=icon, beside=True)


def _element(block: Block, folder: Path) -> Html:
    lines = [markup.together(map(_words, line)) for line in block.lines]
    match block.kind:
        case "table":
            head, *rows = (
                [markup.together(map(_words, cell)) for cell in row] for row in block.rows
            )
            return markup.table(head, rows)
        case "picture":
            content = (folder / block.file).read_bytes()
            width = int.from_bytes(content[16:20], "big")  # from the header of a PNG
            data = f"data:image/png;base64,{base64.b64encode(content).decode('ascii')}"
            image = tag("img", src=data, alt=block.lines[0][0])
            whole = "whole" if width > WIDE else None
            return tag("figure", image, tag("figcaption", lines), class_=whole)
        case "run":
            goal = quote(block.file)
            frame = tag("iframe", loading="lazy", src=goal, title="the run in the browser")
            shown = (
                tag("details", tag("summary", "Watch the run here"), frame)
                if goal.endswith(".html")
                else tag("video", controls=True, preload="metadata", src=goal)
            )
            whole = "whole" if goal.endswith(".html") else None
            return tag("figure", shown, tag("a", lines, href=goal), class_=whole)
        case "commands":
            return tag("pre", tag("code", markup.together(lines, "\n")))
    anchor = anchor_of(str(block.lines[0][0])) if block.kind.startswith("h") else None
    return tag(block.kind, lines, id=anchor)


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
