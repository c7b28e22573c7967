"""The table of edits in CONTRIBUTING.md."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from tests.sabotage.edit import Edit

BEGIN, END = "<!-- edits -->\n", "<!-- end of edits -->"


def table(edits: Iterable[Edit]) -> str:
    """Markdown: one row an edit, by room."""
    rows: dict[str, list[Edit]] = {}
    for edit in edits:
        rows.setdefault(edit.room, []).append(edit)
    lines = [
        "| room | edits | rule that is broken | in | test that is to notice |",
        "|---|---|---|---|---|",
    ]
    for room, some in rows.items():
        for k, edit in enumerate(some):
            first = (room, str(len(some))) if k == 0 else ("", "")
            cells = (*first, edit.breaks, f"`{edit.function}`", f"`{short(edit.notices)}`")
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def short(test: str) -> str:
    """A test without the folder of all tests."""
    return test.removeprefix("tests/")


def parts(file: Path) -> tuple[str, str, str]:
    """What stands before the table in a file, the table, and what stands after it."""
    before, rest = file.read_text(encoding="utf-8").split(BEGIN)
    inside, after = rest.split(END)
    return before + BEGIN, inside, END + after


def write(file: Path, edits: Iterable[Edit]) -> None:
    """Write the table anew."""
    before, _, after = parts(file)
    file.write_text(before + table(edits) + after, encoding="utf-8")
