"""Compiled code that outlives an edit, so that not every edit compiles everything anew.

physim stamps compiled code with the state of all its sources: safe, and cheap for who edits once.
Here every edit is known, and most touch no kernel. What a kernel holds it has from its own file and
from those that this one imports when it is loaded, and theirs; so in the copy of an edit the
compiled code of kernels whose files lead to the edited one is deleted, and the stamp of the rest is
held at that of the unedited copy. Code that were kept in error could only hide an edit, which
would then be told as one that survived.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from tests.sabotage.anchors import definition_of

STAMP = "source_stamp"
"""Function of physim that stamps compiled code."""
COMPILER = ("physim/compiled.py", "physim/frontend.py", "physim/linking.py")
"""Files after whose edit nothing compiled is kept."""


def keep_compiled(copy: Path, edited: Path, stamp: str) -> None:
    """Let compiled code in a copy be used that an edit of a file (from its root) cannot touch.

    ``stamp``: the stamp of all sources before the edit.
    """
    caches = [file for file in copy.rglob("*.nb[ic]") if file.is_file()]
    if edited.as_posix() in COMPILER:
        kept: set[Path] = set()
    else:
        holders, imports = {holder_of(file).relative_to(copy) for file in caches}, Imports(copy)
        there = [holder for holder in holders if (copy / holder).is_file()]  # not what has moved
        kept = {holder for holder in there if edited not in imports.all_of(holder)}
        hold_stamp(copy, stamp)
    for file in caches:
        if holder_of(file).relative_to(copy) not in kept:
            file.unlink()


def holder_of(cache: Path) -> Path:
    """Source whose compiled code a file is: ``x/__pycache__/y.kernel-12.py311.nbi`` of x/y.py."""
    return cache.parent.parent / f"{cache.name.split('.')[0]}.py"


def hold_stamp(copy: Path, stamp: str) -> None:
    """Make physim in a copy stamp compiled code with a given text, whatever its sources are."""
    for name in COMPILER:
        file = copy / name
        if file.is_file():
            text = file.read_text(encoding="utf-8")
            span = definition_of(text, STAMP)
            if span is not None:
                body = f"def {STAMP}() -> str:\n    return {stamp!r}\n"
                file.write_text(text[: span[0]] + body + text[span[1] :], encoding="utf-8")
                return
    raise AssertionError(f"no {STAMP} in {COMPILER}")


class Imports:
    """Which files of a copy a file imports when it is loaded, directly or not."""

    def __init__(self, copy: Path) -> None:
        self.copy = copy
        self._direct: dict[Path, set[Path]] = {}

    def all_of(self, file: Path) -> set[Path]:
        """The file itself and all that it leads to; paths from the root of the copy."""
        found, rest = set(), [file]
        while rest:
            one = rest.pop()
            if one not in found:
                found.add(one)
                rest += self._of(one)
        return found

    def _of(self, file: Path) -> set[Path]:
        if file not in self._direct:
            tree = ast.parse((self.copy / file).read_text(encoding="utf-8"))
            names = (name for node in tree.body for name in imported(node, file))
            self._direct[file] = {found for name in names for found in self._files(name)}
        return self._direct[file]

    def _files(self, name: str) -> Iterator[Path]:
        """The module of a dotted name, if it is one, or the package that has it."""
        parts = name.split(".")
        if parts[0] == "physim" and parts[1:2] and parts[1] in ("controllers", "worlds"):
            parts = parts[1:]
        base = Path(*parts)
        for file in (base.with_suffix(".py"), base / "__init__.py"):
            if (self.copy / file).is_file():
                yield file


def imported(node: ast.stmt, file: Path) -> Iterator[str]:
    """Dotted names that a statement at the top of a file may import.

    What stands under ``if TYPE_CHECKING:`` counts too: a type that is only named there may still
    be that of an argument.
    """
    if isinstance(node, ast.If | ast.Try | ast.With):
        for child in ast.walk(node):
            if isinstance(child, ast.Import | ast.ImportFrom):
                yield from imported(child, file)
    elif isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        base = node.module or ""
        if node.level:
            above = file.parts[: len(file.parts) - node.level]
            base = ".".join([*above, *([base] if base else [])])
        yield base
        yield from (f"{base}.{alias.name}" for alias in node.names)
