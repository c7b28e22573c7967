"""Worlds that come with physim, and finding a world by path or by name."""

from __future__ import annotations

import os
from importlib.resources import as_file, files
from pathlib import Path

import yaml

from physim.errors import Fault, WorldError, nearest

SUFFIXES = (".yaml", ".yml")


def shipped_folder() -> Path:
    """Folder of the shipped worlds."""
    with as_file(files("physim.worlds")) as folder:
        return folder


def shipped_worlds() -> dict[str, str]:
    """Name and one-line description of every shipped world, by name."""
    found = {}
    for file in sorted(shipped_folder().glob("*.yaml")):
        document = yaml.safe_load(file.read_text(encoding="utf-8"))
        found[file.stem] = str(document.get("description", ""))
    return found


def find_world(given: str | os.PathLike[str]) -> Path:
    """Path of a world given as a file, or as the name of a shipped one; a file goes first.

    Raises WorldError when there is neither, with the nearest names.
    """
    path, given = Path(given), str(given)
    plain = given.isprintable() and len(path.parts) == 1 and path.suffix not in SUFFIXES
    if not plain or path.exists():
        return path  # reading says what is wrong with it
    shipped = [file.stem for file in sorted(shipped_folder().glob("*.yaml"))]
    if given in shipped:
        return shipped_folder() / f"{given}.yaml"
    message = (
        f'{given}: no such file, and no shipped world is called "{given}"; '
        f"shipped: {', '.join(shipped)}{nearest(given, shipped)}"
    )
    raise WorldError([Fault((), message)])
