"""A page as a list of blocks, which Markdown and HTML are both written from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from physim.reproduction.study import Outcome


@dataclass(frozen=True)
class Code:
    """Words to be typed or named exactly."""

    text: str


@dataclass(frozen=True)
class Link:
    """To a heading of the same page, or to a file beside it."""

    text: str
    target: str
    """``#anchor`` or a relative path"""


Inline = str | Code | Link | Outcome
Words = str | Sequence[Inline]


@dataclass(frozen=True)
class Heading:
    """Title of level 1 to 3."""

    level: int
    text: str
    anchor: str = ""


@dataclass(frozen=True)
class Paragraph:
    """Running text."""

    words: Words


@dataclass(frozen=True)
class Commands:
    """Lines for a terminal."""

    lines: tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """Rows of words under a header."""

    header: tuple[str, ...]
    rows: tuple[tuple[Words, ...], ...]


@dataclass(frozen=True)
class Picture:
    """A picture file, relative to the page."""

    file: str
    caption: str


@dataclass(frozen=True)
class Film:
    """A video file, relative to the page."""

    file: str
    caption: str


Block = Heading | Paragraph | Commands | Table | Picture | Film


def inlines(words: Words) -> Sequence[Inline]:
    """Words as a sequence, also where they are a single string."""
    return (words,) if isinstance(words, str) else words
