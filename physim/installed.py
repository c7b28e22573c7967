"""What installed packages register by entry points: names and what they stand for, by group."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from functools import lru_cache
from importlib.metadata import entry_points

Stamp = tuple[tuple[str, int], ...]


def registered(group: str) -> Mapping[str, tuple[str, ...]]:
    """``module:Class`` by name: several where packages give different ones the same name.

    To read it of all packages takes some 10 ms, so it is read anew only where the path or a folder
    on it has changed, as it does when a package is installed.
    """
    return _read(tuple((folder, _changed(folder)) for folder in sys.path)).get(group, {})


def _changed(folder: str) -> int:
    try:
        return os.stat(folder or os.curdir).st_mtime_ns
    except OSError:
        return 0


@lru_cache(maxsize=1)
def _read(stamp: Stamp) -> dict[str, dict[str, tuple[str, ...]]]:
    """By group what is registered for physim while the path and its folders are as in ``stamp``."""
    found, groups = entry_points(), dict[str, dict[str, tuple[str, ...]]]()
    for group in found.groups:
        if group.startswith("physim."):
            targets: dict[str, set[str]] = {}
            for entry in found.select(group=group):
                targets.setdefault(entry.name, set()).add(entry.value)
            groups[group] = {name: tuple(sorted(several)) for name, several in targets.items()}
    return groups
