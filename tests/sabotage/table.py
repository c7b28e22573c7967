"""The table of edits: docs/SABOTAGE.md."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from tests.sabotage.edit import Edit

PAGE = Path("docs/SABOTAGE.md")
"""Where the table is, in a checkout."""
HEAD = """\
# Sabotage: what is broken on purpose, and who notices

Made by `python -m tests.sabotage --table` from `tests/sabotage/edits/`; what an edit is and how to
try them: [CONTRIBUTING.md](../CONTRIBUTING.md#sabotage).

"""


def page(edits: Iterable[Edit]) -> str:
    """The page, Markdown: one row an edit, by room."""
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
    return HEAD + "\n".join(lines) + "\n"


def short(test: str) -> str:
    """A test without the folder of all tests."""
    return test.removeprefix("tests/")
