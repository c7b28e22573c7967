"""Packages that tests install for a moment: a folder on the path, with entry points."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from pathlib import Path

import pytest


def install(
    folder: Path, monkeypatch: pytest.MonkeyPatch, module: str, text: str,
    entries: Mapping[str, Mapping[str, str]],
) -> None:  # fmt: skip
    """Put a module and the metadata of its package into ``folder``, and that on the path.

    ``entries``: for each group, classes by the names of their entry points.
    """
    (folder / f"{module}.py").write_text(text, encoding="utf-8")
    about = folder / f"{module}-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
    lines = []
    for group, classes in entries.items():
        lines += [f"[{group}]", *(f"{name} = {module}:{one}" for name, one in classes.items())]
    (about / "entry_points.txt").write_text("\n".join(lines) + "\n")
    monkeypatch.syspath_prepend(str(folder))
    importlib.invalidate_caches()
