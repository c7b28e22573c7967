"""Where an edit belongs: the function by its name, in whatever file it stands, and the fragment."""

from __future__ import annotations

import ast
import re
import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from tests.sabotage.edit import Edit

FOLDERS = ("physim", "controllers")
"""Where sources stand, below the root of a checkout."""
NAMES = re.compile(r"^\s*(?:async )?(?:def|class) (\w+)|^(\w+)\b[^=\n(]* = ", re.MULTILINE)
"""What a line may define."""


class BadAnchorError(Exception):
    """An edit whose fragment is nowhere, in more than one place, or leaves no Python; one line."""


class Place(NamedTuple):
    """Where an edit goes."""

    file: Path
    """from the root of the checkout"""
    text: str
    """the whole file with the edit made"""


class Sources:
    """Texts of all sources of a checkout, and the definitions in them."""

    def __init__(self, root: Path) -> None:
        self.texts = {
            file.relative_to(root): file.read_text(encoding="utf-8")
            for folder in FOLDERS
            for file in sorted((root / folder).rglob("*.py"))
        }
        self._named: dict[str, set[Path]] = {}
        for file, text in self.texts.items():
            for pair in NAMES.findall(text):
                self._named.setdefault(pair[0] or pair[1], set()).add(file)
        self._definitions: dict[Path, list[tuple[str, int, int]]] = {}

    def place_of(self, edit: Edit) -> Place:
        """The one place of an edit. Raises `BadAnchorError`."""
        spans = list(self._spans(edit.function))
        what = f"{edit.room}: {edit.function} (last seen in {edit.file})"
        if not spans:
            raise BadAnchorError(f"{what}: no function, class or constant has this name")
        pattern = re.compile(r"\s+".join(map(re.escape, edit.old.split())))
        found = [
            (file, match)
            for file, start, end in spans
            for match in pattern.finditer(self.texts[file], start, end)
        ]
        if len(found) != 1:
            shown = " ".join(edit.old.split())
            raise BadAnchorError(f"{what}: {shown!r} is there {len(found)} times, not once")
        ((file, match),) = found
        before = self.texts[file]
        text = before[: match.start()] + edit.new + before[match.end() :]
        start, end = next((a, b) for one, a, b in spans if one == file and a <= match.start() < b)
        try:
            ast.parse(textwrap.dedent(text[start : end + len(text) - len(before)]))
        except SyntaxError as error:
            raise BadAnchorError(f"{what}: edited, it is no Python: {error}") from None
        if text == before:
            raise BadAnchorError(f"{what}: the edit changes nothing")
        return Place(file, text)

    def _spans(self, name: str) -> Iterator[tuple[Path, int, int]]:
        """File, begin and end of the text of every definition with a qualified name."""
        for file in sorted(self._named.get(name.rpartition(".")[2], ())):
            if file not in self._definitions:
                self._definitions[file] = list(definitions(self.texts[file]))
            yield from ((file, a, b) for one, a, b in self._definitions[file] if one == name)


def definitions(text: str) -> Iterator[tuple[str, int, int]]:
    """Qualified name, begin and end of every function, class and named constant of a source."""
    begins = [0]
    for line in text.splitlines(keepends=True):
        begins.append(begins[-1] + len(line))

    def below(body: Sequence[ast.stmt], outer: str) -> Iterator[tuple[str, int, int]]:
        for node in body:
            span = begins[node.lineno - 1], begins[node.end_lineno or node.lineno]
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                yield f"{outer}{node.name}", *span
                yield from below(node.body, f"{outer}{node.name}.")
            elif isinstance(node, ast.Assign | ast.AnnAssign):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                for name in (one for target in targets for one in ast.walk(target)):
                    if isinstance(name, ast.Name):
                        yield f"{outer}{name.id}", *span

    yield from below(ast.parse(text).body, "")


def definition_of(text: str, name: str) -> tuple[int, int] | None:
    """Begin and end of the one definition with a name in a text; None where there is none."""
    return next(((a, b) for one, a, b in definitions(text) if one == name), None)
