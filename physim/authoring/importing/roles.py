"""What a layer, a shape or a feature is for, by its name: boundary, obstacle, path or robot."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from physim.authoring.importing.drawing import ImportSourceError, refused
from physim.errors import nearest, plural

NAME = re.compile(
    r"(boundar(?:y|ies)|walls?|obstacles?|paths?|reference(?:[\s_-]paths?)?|robots?)"
    r"(?:[\s_.:#-]+(.*)|(\d.*|[a-z]))?$"
)
"""Roles are words of their own: a wallpaper is no wall."""
OF_WORD = {"bou": "boundary", "wal": "wall", "obs": "obstacle", "pat": "path", "ref": "path",
           "rob": "robot"}  # fmt: skip
WORDS = ["boundary", "boundaries", "wall", "walls", "obstacle", "obstacles", "path", "robot",
         "robots"]  # fmt: skip
MOST_NAMED = 5


def role_named(name: str) -> tuple[str, str]:
    """Role that a name says, and the rest of it: ``boundary`` and ``left`` of ``Boundary-left``.

    Both are empty where it says none. ``wall`` is told apart by what is drawn: an open line is a
    boundary.
    """
    text = name.strip()
    found = NAME.match(text.lower())
    if found is None:
        return "", ""
    return OF_WORD[text[:3].lower()], text[len(found[1]) :].strip(" _:#-")


def hint(name: str) -> str:
    """``; did you mean ...?`` for a name that is nearly one of a role; else empty."""
    return nearest(name.strip().lower()[:60], WORDS)


def unroled(
    path: Path, shapes: Sequence[tuple[str, str, str, int | None]], how: str
) -> ImportSourceError:
    """Refusal of shapes without a role; ``how`` says how a source of this kind gives one.

    Of each shape: what it is called, a hint, a name to ignore it by, and a line.
    """
    once = list(dict.fromkeys((called, near, line) for called, near, _, line in shapes))
    others = list[str]()
    hints = set[str]()
    for called, near, line in once[:MOST_NAMED]:
        at = "" if line is None else f" (line {line})"
        others.append(called + ("" if near in hints else near) + at)
        hints.add(near)
    more = f" and {len(once) - MOST_NAMED} more" if len(once) > MOST_NAMED else ""
    named = next((name for _, _, name, _ in shapes if name), "")
    by_name = f' --ignore "{named[:60]}" or' if named else ""
    return refused(
        path,
        f"{plural(len(shapes), 'shape')} without a role: {', '.join(others)}{more}; "
        f"{how}, or leave out by{by_name} --ignore-others",
        shapes[0][3],
    )
