"""What a reproduction found, as plain values: rows of the tables, files of pictures and films.

Pages are written from it alone, and it is kept beside them as JSON.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, replace
from typing import ClassVar

from pydantic import ConfigDict, TypeAdapter

from physim.errors import PhysimError
from physim.json_text import parse_json
from physim.reproduction.study import Verdict

FORMAT = "physim-reproduction"
VERSION = 2


@dataclass(frozen=True)
class Section:
    """A figure of the paper, its words, or a study: pictures, commands and claims."""

    key: str
    title: str
    about: str
    """a sentence: what was run"""
    commands: tuple[str, ...]
    rows: tuple[Verdict, ...]
    pictures: tuple[str, ...] = ()
    """files, relative to the page"""
    captions: tuple[str, ...] = ()
    films: tuple[str, ...] = ()
    """videos and pages of the run, relative to the page"""
    missing: str = ""
    """why it is not whole; empty when it is"""

    @property
    def short(self) -> str:
        """What it is called in a line: "Figure 4", "study alpha"."""
        what, _, _ = self.title.partition(":")
        return f"study {self.key}" if what == "Study" else what


@dataclass(frozen=True)
class Report:
    """All that the pages say."""

    __pydantic_config__: ClassVar = ConfigDict(extra="forbid")

    physim: str
    """version"""
    command: str
    seeds: int
    """asked for, of each world"""
    sections: tuple[Section, ...]
    figures: dict[str, dict[str, float]] = field(default_factory=dict)
    """figures of the pictured runs by world; absent where they have no meaning"""
    interrupted: bool = False

    @property
    def rows(self) -> tuple[Verdict, ...]:
        """Every claim."""
        return tuple(row for section in self.sections for row in section.rows)

    def to_json(self) -> str:
        """As JSON text; figures with nine digits."""
        figures = {
            world: {name: float(f"{value:.9g}") for name, value in run.items()}
            for world, run in self.figures.items()
        }
        tree = {"format": FORMAT, "version": VERSION, **asdict(replace(self, figures=figures))}
        return json.dumps(tree, indent=1, ensure_ascii=False) + "\n"

    @classmethod
    def from_json(cls, text: str) -> Report:
        """Read back. Raises PhysimError for what is no such text."""
        try:
            tree = parse_json(text)
            if tree.pop("format") != FORMAT or tree.pop("version") != VERSION:
                raise KeyError("format")
            return TypeAdapter(cls).validate_python(tree)
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise PhysimError(f"no reproduction of this version: {error}") from None
