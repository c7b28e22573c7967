"""Rooms whose sources are mutated: where they lie, and which tests exercise them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]


class Room(NamedTuple):
    """A folder or file of sources, and names of folders of tests, wherever these lie."""

    folder: str
    tests: tuple[str, ...]


ROOMS = {
    "controllers": Room("controllers", ("controllers",)),
    "geometry": Room("physim/geometry", ("geometry",)),
    "simulation": Room("physim/simulation", ("simulation",)),
    "engine": Room("physim/simulation/engine", ("engine",)),
    "record": Room("physim/record", ("record",)),
    "parts": Room("physim/parts", ("parts",)),
    "world": Room("physim/world", ("world",)),
    "validation": Room("physim/analysis/validation", ("validation", "forgeries")),
    "crashtest": Room("physim/analysis/crashtest", ("crashtest",)),
    "metrics": Room("physim/analysis/metrics", ("metrics",)),
    "statistics": Room("physim/statistics.py", ("statistics",)),
    "campaigns": Room("physim/campaigns", ("campaigns", "falsify")),
    "drawing": Room("physim/drawing", ("drawing",)),
    "authoring": Room("physim/authoring", ("authoring",)),
}

EQUIVALENT: dict[tuple[str, str, str], str] = {}
"""Mutants that change nothing: function, operator and change, and why."""


def sources_of(room: Room) -> list[str]:
    """Files of a room, without rooms inside it."""
    inner = tuple(f"{one.folder}/" for one in ROOMS.values() if one.folder > room.folder)
    place = ROOT / room.folder
    found = [place] if place.is_file() else place.rglob("*.py")
    files = (str(file.relative_to(ROOT)) for file in found)
    return sorted(file for file in files if not file.startswith(inner))


def tests_of(room: Room) -> list[str]:
    """Files of tests in the room's folders, and those in no folder that import from the room."""
    names = (file.removesuffix(".py").removesuffix("/__init__") for file in sources_of(room))
    modules = "|".join(names).replace("/", r"\.")
    imports = re.compile(rf"^from (physim\.)?({modules}) import", re.M)
    return [
        str(file.relative_to(ROOT))
        for file in sorted((ROOT / "tests").rglob("test_*.py"))
        if set(file.parts) & set(room.tests)
        or (file.parent == ROOT / "tests" and imports.search(file.read_text(encoding="utf-8")))
    ]
