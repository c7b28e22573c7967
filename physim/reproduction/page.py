"""The report as a page: Markdown (the dialect of GitHub), and HTML made from it.

Verdicts first, then every figure and study. Every name is written so that it is only a name:
nothing in it is read as markup. The HTML needs nothing beside it but videos and pages of runs.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from urllib.parse import quote, unquote

from markdown_it import MarkdownIt
from markdown_it.common.utils import escapeHtml
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token
from markdown_it.utils import EnvType, OptionsDict

from physim.drawing.page.colours import styles
from physim.errors import plural
from physim.escaping import escaped
from physim.reproduction.plan import SEEDS
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
    if report.seeds < SEEDS:
        yield (
            f"**Preliminary.** Verdicts rest on at most {plural(report.seeds, 'seed')} of each "
            f"world; the whole page, without {_code('--quick')}, takes up to {SEEDS} and may come "
            "to others."
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
    yield (
        "Two of our rules depart from the paper's: in a formation the speed pair of (5) is a "
        "choice of omega alone, as (7) gives the forward speed; and in (11) boundaries count "
        "within the sensing range only, so that a robot on its way into one beyond reports no"
        " collision time. The modules of the controller list these and smaller departures."
    )
    yield (
        "Deviations and formation errors in the tables are those at the decisions of the robots, "
        f"which are up to 0.2 s apart; {_code('physim summary')} takes them at every sample."
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
        words = "The run in the browser" if file.endswith(".html") else "Video of the run"
        yield f"[{words}]({quote(file)})"
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
    return escaped(re.sub(r"[\r\n]", " ", text))


def _plain(text: str) -> str:
    """One line of text in which nothing has a meaning of its own."""
    return SPECIAL.sub(r"\\\g<0>", _one_line(text))


def _code(text: str) -> str:
    """Words to be typed or named exactly."""
    text = escaped(" ".join(text.split()))
    room = " " if text.startswith("`") or text.endswith("`") else ""
    ticks = _fence(text, 1)
    return f"{ticks}{room}{text}{room}{ticks}"


def _fence(text: str, least: int) -> str:
    longest = max((len(run) for run in re.findall("`+", text)), default=0)
    return "`" * max(least, longest + 1)


WIDE = 1000
"""[px] Wider pictures (maps) have a line for themselves."""


def html(text: str, title: str, folder: Path) -> str:
    """Page made from Markdown; pictures are read from ``folder``. Raises OSError for a missing one.

    Markup within the Markdown (raw HTML) is shown, not followed.
    """
    parser = MarkdownIt("js-default", {"html": False}, renderer_cls=_Renderer)
    tokens = parser.parse(text)
    for opening, inline, closing in zip(tokens, tokens[1:], tokens[2:], strict=False):
        children = inline.children or []
        if opening.type == "heading_open":
            opening.attrSet("id", anchor_of("".join(child.content for child in children)))
        for child, following in pairwise(children):
            if child.type == "strong_open" and following.content in set(Outcome):
                child.attrSet("class", f"outcome {following.content.replace(' ', '-')}")
        if opening.type == "paragraph_open" and _is_figure(children):
            opening.tag = closing.tag = "figure"
            if _is_run(children[0]):
                opening.attrSet("class", "whole")
            if children[0].type == "image" and _embed(children[0], folder) > WIDE:
                opening.attrSet("class", "whole")
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<link rel="icon" href="data:,">\n<title>{escapeHtml(escaped(title))}</title>\n'
        f"<style>{styles('reproduction.css')}</style>\n"
        '</head>\n<body>\n<main class="sheet">\n'
        f"{parser.renderer.render(tokens, parser.options, {})}</main>\n</body>\n</html>\n"
    )


class _Renderer(RendererHTML):
    """Tables that scroll, pictures with captions, videos that play."""

    def table_open(
        self, tokens: Sequence[Token], idx: int, options: OptionsDict, env: EnvType
    ) -> str:
        return f'<div class="wide">{self.renderToken(tokens, idx, options, env)}'

    def table_close(
        self, tokens: Sequence[Token], idx: int, options: OptionsDict, env: EnvType
    ) -> str:
        return f"{self.renderToken(tokens, idx, options, env).rstrip()}</div>\n"

    def image(self, tokens: Sequence[Token], idx: int, options: OptionsDict, env: EnvType) -> str:
        picture = super().image(tokens, idx, options, env)
        return f"{picture}<figcaption>{escapeHtml(str(tokens[idx].attrs['alt']))}</figcaption>"

    def link_open(
        self, tokens: Sequence[Token], idx: int, options: OptionsDict, env: EnvType
    ) -> str:
        link = self.renderToken(tokens, idx, options, env)
        file = escapeHtml(str(tokens[idx].attrs["href"]))
        if _is_run(tokens[idx]):
            return (
                f"<details><summary>Watch the run here</summary>"
                f'<iframe loading="lazy" src="{file}" title="the run in the browser"></iframe>'
                f"</details>{link}"
            )
        if not _is_film(tokens[idx]):
            return link
        return f'<video controls preload="metadata" src="{file}"></video>{link}'


def _is_figure(children: Sequence[Token]) -> bool:
    """Whether a paragraph is a picture, a video or a run in the browser."""
    return (len(children) == 1 and children[0].type == "image") or any(
        _is_film(child) or _is_run(child) for child in children[:1]
    )


def _is_film(token: Token) -> bool:
    return token.type == "link_open" and str(token.attrs["href"]).endswith(".mp4")


def _is_run(token: Token) -> bool:
    return token.type == "link_open" and str(token.attrs["href"]).endswith("/page.html")


def _embed(picture: Token, folder: Path) -> int:
    """Put the file of a picture into the page itself; returns its width [pixels]."""
    content = (folder / unquote(str(picture.attrs["src"]))).read_bytes()
    picture.attrSet("src", f"data:image/png;base64,{base64.b64encode(content).decode('ascii')}")
    return int.from_bytes(content[16:20], "big")  # from the header of a PNG
