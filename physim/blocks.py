"""Blocks of a page, written once: as Markdown (the dialect of GitHub) and as HTML.

A block is its kind and what it holds: h1 to h3 with a title; p with words; table with a head and
rows; picture with a file and a caption; run with the file of a video or page, and words; commands
with lines.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

from physim import html as markup
from physim.escaping import escaped
from physim.html import Html, tag

SPECIAL = re.compile(r"[\\`*_{}\[\]<>#|~$&]")
"""Characters that have a meaning in Markdown wherever they stand."""
WIDE = 1000
"""[px] Wider pictures (maps) have a line for themselves."""


class Words(NamedTuple):
    """A part of a line that is not plain text."""

    kind: str
    """code, strong, outcome (strong, coloured by what it says), or link"""
    text: str
    goal: str = ""
    """of a link: title of a section"""


Block = tuple[Any, ...]
"""A part of the page: its kind, and what it holds. Lines are texts and `Words`."""


def anchor_of(title: str) -> str:
    """Name of a heading in links; the same that GitHub makes of its title."""
    kept = (c if c.isalnum() or c in "-_" else " " if c == " " else "" for c in title)
    return "".join(kept).lower().replace(" ", "-")


def markdown(blocks: Iterable[Block]) -> str:
    """Blocks in the dialect of GitHub."""
    return "\n\n".join(map(_marked, blocks)) + "\n"


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


def html(
    title: str, blocks: Iterable[Block], folder: Path, style: str, generator: str = ""
) -> Html:
    """Blocks as a page that loads nothing but the videos and pages beside it.

    Pictures are read from ``folder`` and stand within it.
    """
    body = tag("main", (_element(block, folder) for block in blocks), class_="sheet")
    icon = tag("link", rel="icon", href="data:,")
    return markup.page(title, body, style=style, head=icon, beside=True, generator=generator)


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
    if words.kind == "outcome":
        return tag("strong", words.text, class_=f"outcome {words.text.replace(' ', '-')}")
    return tag(words.kind, words.text)
