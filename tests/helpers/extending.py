"""The parts of your own in the how-to pages, installed as a stranger's distribution."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import NamedTuple

HOW_TO = Path(__file__).parents[2] / "docs/how-to"
INSTALLED = (HOW_TO / "stages.md", HOW_TO / "measure.md")
"""Pages whose commands need the parts to be installed"""
PAGES = (HOW_TO / "controller.md", HOW_TO / "all-robots.md", HOW_TO / "extend.md", *INSTALLED)


class Block(NamedTuple):
    """A fenced block of a page."""

    page: str
    language: str
    title: str | None
    text: str


def blocks() -> list[Block]:
    """Every fenced block of these pages, in order."""
    pattern = r"^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```$"
    return [
        Block(page.name, match[1], match[2], match[3])
        for page in PAGES
        for match in re.finditer(pattern, page.read_text("utf-8"), re.DOTALL | re.MULTILINE)
    ]


def of(language: str) -> list[Block]:
    """Blocks of one language."""
    return [block for block in blocks() if block.language == language]


def entry_points() -> dict[str, dict[str, str]]:
    """Groups of entry points with their names and targets, as extend.md gives them."""
    (given,) = of("toml")
    found: dict[str, dict[str, str]] = tomllib.loads(given.text)["project"]["entry-points"]
    return found


def install(folder: Path) -> Path:
    """Put the files of the pages into a folder, with the metadata of a distribution; returns it.

    On PYTHONPATH it is what ``pip install`` would make of them.
    """
    info = folder / "my_robots-1.0.dist-info"
    info.mkdir(parents=True)
    for block in of("python"):
        assert block.title, block.text
        (folder / block.title).write_text(block.text, encoding="utf-8")
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: my-robots\nVersion: 1.0\n")
    groups = [
        f"[{group}]\n" + "".join(f"{name} = {target}\n" for name, target in names.items())
        for group, names in entry_points().items()
    ]
    (info / "entry_points.txt").write_text("\n".join(groups))
    return folder
