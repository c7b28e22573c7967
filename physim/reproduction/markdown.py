"""Blocks as Markdown (the dialect of GitHub), every name written so that it is only a name."""

from __future__ import annotations

import re
from collections.abc import Sequence
from urllib.parse import quote

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
    inlines,
)
from physim.reproduction.study import Outcome

SPECIAL = re.compile(r"([\\`*_{}\[\]<>#|~$&])")


def markdown(blocks: Sequence[Block]) -> str:
    """Text of a page."""
    return "\n\n".join(_block(block) for block in blocks) + "\n"


def _block(block: Block) -> str:
    match block:
        case Heading():
            return f"{'#' * block.level} {_plain(block.text)}"
        case Paragraph():
            return _words(block.words)
        case Commands():
            lines = "\n".join(" ".join(line.split("\n")) for line in block.lines)
            ticks = _fence(lines, 3)
            return f"{ticks}sh\n{lines}\n{ticks}"
        case Table():
            rule = "|" + " --- |" * len(block.header)
            return "\n".join((_row(block.header), rule, *(_row(row) for row in block.rows)))
        case Picture():
            return f"![{_plain(block.caption)}]({quote(block.file)})"
        case Film():
            return f"[{_plain(block.caption)}]({quote(block.file)})"


def _row(cells: Sequence[Words]) -> str:
    return "| " + " | ".join(_words(cell) for cell in cells) + " |"


def _words(words: Words) -> str:
    return "".join(_inline(one) for one in inlines(words))


def _inline(one: Inline) -> str:
    match one:
        case Code():
            text = " ".join(one.text.split()).replace("|", "\\|")
            ticks = _fence(text, 1)
            room = " " if text.startswith("`") or text.endswith("`") else ""
            return f"{ticks}{room}{text}{room}{ticks}"
        case Link():
            target = one.target if one.target.startswith("#") else quote(one.target)
            return f"[{_plain(one.text)}]({target})"
        case Outcome():
            return f"**{one.value}**"
        case str():
            return _plain(one)


def _plain(text: str) -> str:
    """One line of text in which nothing has a meaning of its own."""
    return SPECIAL.sub(r"\\\1", " ".join(text.split(" ")).replace("\n", " "))


def _fence(text: str, least: int) -> str:
    longest = max((len(run) for run in re.findall("`+", text)), default=0)
    return "`" * max(least, longest + 1)
