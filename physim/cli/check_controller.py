"""``physim check-controller``."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from typing import Any

from physim.cli.compiling import tell_compiling
from physim.cli.progress import Bar
from physim.errors import Fault, Location, WorldError, plural
from physim.scene_builder import build_scene
from physim.testing.candidate import Candidate, candidate
from physim.testing.check import (
    SECONDS,
    SITUATIONS,
    WorldResult,
    check_worlds,
    worlds_to_try,
)
from physim.warm_up import is_warm, warm_up
from physim.world_file import Document, apply_overrides, load_world, located, read_document

FOUND = 1
COMPILING = 25
"""[s] about, for all that a run needs"""


def check_controller_command(options: argparse.Namespace) -> int:
    """Check a controller and print what is found; returns the exit code."""
    chosen = _chosen(options)
    worlds = worlds_to_try(options.worlds)
    _prepare()
    bar = Bar("check", len(worlds) + len(SITUATIONS), "worlds", quiet=False)
    parts: list[WorldResult] = []
    try:
        for part in check_worlds(chosen, worlds, options.seconds or SECONDS):
            parts.append(part)
            bar.update(len(parts), part.world)
    finally:
        bar.close()
    if options.json:
        print(json.dumps(json_of(chosen.name, parts), indent=1))
    else:
        print(text_of(chosen.name, parts), end="")
    return FOUND if any(part.findings for part in parts) else 0


def _chosen(options: argparse.Namespace) -> Candidate:
    """Find the controller and check its settings; each fault with its place."""
    document = Document("--set", read_document("controller: {}", "--set").root)
    settings, document = _settings(document, options.overrides)
    chosen = candidate(options.controller, settings or None)
    try:
        if settings:
            chosen.maker()
    except WorldError as error:
        raise located(error.faults, document) from None
    return chosen


def _settings(document: Document, overrides: Sequence[str]) -> tuple[Mapping[str, Any], Document]:
    """Settings that the command line gives. Raises WorldError for what is none."""
    document = apply_overrides(document, overrides)
    values = document.values()
    settings = values.pop("controller", None) or {}
    message = "is no setting of the controller; those are written controller.KEY=VALUE"
    faults = [Fault(place, message) for place in _ends(values)]
    if not isinstance(settings, dict):
        faults.append(
            Fault(("controller",), "is no KEY=VALUE of the controller; write controller.KEY=VALUE")
        )
    elif "type" in settings:
        faults.append(Fault(("controller", "type"), "is what CONTROLLER says"))
    if faults or document.faults:
        raise located(faults, document)
    return settings, document


def _ends(values: object) -> list[Location]:
    """Places of the values in a tree of mappings."""
    if not isinstance(values, dict):
        return [()]
    return [(key, *end) for key, value in values.items() for end in _ends(value)]


def _prepare() -> None:
    """Compile the kernels where that is still to be done, and say so."""
    if not is_warm():
        tell_compiling("all that a run needs", COMPILING, quiet=False)
        warm_up(build_scene(load_world("straight")))


def text_of(name: str, parts: list[WorldResult]) -> str:
    """A line a finding or world left out, and a last line that sums up."""
    found = sum(len(part.findings) for part in parts)
    tried = [part for part in parts if not part.skipped]
    worlds, odd = (sum(part.situation is is_odd for part in tried) for is_odd in (False, True))
    decisions = sum(part.decisions for part in tried)
    lines = [line for part in parts for line in part.lines()]
    lines.append(
        f"{name}: {plural(found, 'finding') if found else 'no findings'} in "
        f"{plural(decisions, 'decision')} of {plural(worlds, 'world')} and "
        f"{plural(odd, 'situation')}"
    )
    return "\n".join(lines) + "\n"


def json_of(name: str, parts: list[WorldResult]) -> dict[str, object]:
    """Everything that was found, as JSON holds it."""
    return {
        "format": "physim-check-controller",
        "version": 1,
        "controller": name,
        "findings": [finding.as_json() for part in parts for finding in part.findings],
        "worlds": [
            {
                "world": part.world,
                "situation": part.situation,
                "decisions": part.decisions,
                "skipped": part.skipped or None,
            }
            for part in parts
        ],
    }
