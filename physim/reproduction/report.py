"""What a reproduction found, as plain values: rows of the tables, files of pictures and films.

Pages are written from it alone, and it is kept beside them as JSON.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from typing import Any

from physim.errors import PhysimError
from physim.reproduction.study import Outcome

FORMAT = "physim-reproduction"
VERSION = 2


@dataclass(frozen=True)
class Row:
    """A claim and what came of it."""

    claim: str
    reported: str
    measured: str
    """of the pictured run; of all arms and seeds in a study"""
    outcome: Outcome
    remark: str = ""
    spread: str = ""
    """median and range over seeds; empty in a study"""
    met: str = ""
    """in how many seeds, "97 of 100"; empty in a study"""
    without: str = ""
    """in how many seeds without avoidance; empty where that was not tried"""


@dataclass(frozen=True)
class Section:
    """A figure of the paper, its words, or a study: pictures, commands and claims."""

    key: str
    title: str
    about: str
    """a sentence: what was run"""
    commands: tuple[str, ...]
    rows: tuple[Row, ...]
    pictures: tuple[str, ...] = ()
    """files, relative to the page"""
    captions: tuple[str, ...] = ()
    films: tuple[str, ...] = ()
    missing: str = ""
    """why it is not whole; empty when it is"""

    @property
    def short(self) -> str:
        """What it is called in a line: "Figure 4", "study alpha"."""
        what, _, _ = self.title.partition(":")
        return f"study {self.key}" if what == "Study" else what


@dataclass(frozen=True)
class Report:
    """All that the pages tell."""

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
    def rows(self) -> tuple[Row, ...]:
        """Every claim."""
        return tuple(row for section in self.sections for row in section.rows)

    def to_json(self) -> str:
        """As JSON text; figures with nine digits."""

        def plain(value: Any) -> Any:
            if isinstance(value, Outcome):
                return value.value
            if isinstance(value, dict):
                return {k: plain(v) for k, v in value.items()}
            if isinstance(value, list | tuple):
                return [plain(v) for v in value]
            return float(f"{value:.9g}") if isinstance(value, float) else value

        tree = {"format": FORMAT, "version": VERSION, **plain(asdict(self))}
        return json.dumps(tree, indent=1, ensure_ascii=False) + "\n"

    @classmethod
    def from_json(cls, text: str) -> Report:
        """Read back. Raises PhysimError for what is no such text."""
        try:
            tree = json.loads(text)
            if tree.pop("format") != FORMAT or tree.pop("version") != VERSION:
                raise KeyError("format")
            sections = [dict(one) for one in tree.pop("sections")]
            for one in sections:
                rows = [Row(**{**row, "outcome": Outcome(row["outcome"])}) for row in one["rows"]]
                one["rows"] = tuple(rows)
                for key in ("commands", "pictures", "captions", "films"):
                    one[key] = tuple(one[key])
            return cls(sections=tuple(Section(**one) for one in sections), **tree)
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise PhysimError(f"no reproduction of this version: {error}") from None
