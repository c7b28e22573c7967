"""The examples of docs/how-to/extend.md, installed as somebody's distribution would be."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import NamedTuple

PAGE = Path(__file__).parents[2] / "docs/how-to/extend.md"


class Block(NamedTuple):
    """A fenced block of the page."""

    section: str
    language: str
    text: str


def blocks() -> list[Block]:
    """Every fenced block, in order, with the heading above it."""
    found, section = [], ""
    pattern = r"^## ([^\n]+)$|^```(\w+)\n(.*?)^```$"
    for match in re.finditer(pattern, PAGE.read_text("utf-8"), re.DOTALL | re.MULTILINE):
        if match[1]:
            section = match[1]
        else:
            found.append(Block(section, match[2], match[3]))
    return found


def of(language: str) -> list[Block]:
    """Blocks of one language."""
    return [block for block in blocks() if block.language == language]


def entry_points() -> dict[str, dict[str, str]]:
    """Groups of entry points with their names and targets, as the page gives them."""
    given = "\n".join(block.text for block in of("toml"))
    found: dict[str, dict[str, str]] = tomllib.loads(given)["project"]["entry-points"]
    return found


def install(folder: Path) -> Path:
    """Put the files of the page into a folder, with the metadata of a distribution; returns it.

    On PYTHONPATH it is what ``pip install`` would make of them.
    """
    info = folder / "my_robots-1.0.dist-info"
    info.mkdir(parents=True)
    for block in of("python"):
        named = re.match(r"# (\w+\.py)\n", block.text)
        assert named, block.text
        (folder / named[1]).write_text(block.text, encoding="utf-8")
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: my-robots\nVersion: 1.0\n")
    groups = [
        f"[{group}]\n" + "".join(f"{name} = {target}\n" for name, target in names.items())
        for group, names in entry_points().items()
    ]
    (info / "entry_points.txt").write_text("\n".join(groups))
    return folder
