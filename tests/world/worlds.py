"""Worlds to check: one with a corridor, one with drawn boundaries, and ways to change them."""

from __future__ import annotations

import re
from pathlib import Path

from physim.world.checks import Findings, check_world
from tests.helpers import check_error, facts

CORRIDOR = """\
name: corridor
time: {step: 0.01, duration: 60.0}
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0}
robots:
  - name: a
    footprint: {length: 1.8, width: 1.0}
    pose: [6.0, 1.0, 0.0]
    path: {offset: 1.0}
  - name: b
    footprint: {length: 1.8, width: 1.0}
    pose: [3.0, -1.0, 0.0]
    path: {offset: -1.0}
formation: {spacing: [0.0, -3.0]}
"""

DRAWN = """\
name: drawn
time: {step: 0.01, duration: 60.0}
boundaries:
  - [[-3, -4], [33, -4], [33, 4]]
  - [[33, 4], [-3, 4], [-3, -4]]
reference_path: [[0, 0], [30, 0]]
robots:
  - name: a
    footprint: {length: 1.8, width: 1.0}
    pose: [6.0, 1.0, 0.0]
    path: [[0, 1], [30, 1]]
  - name: b
    footprint: {length: 1.8, width: 1.0}
    pose: [3.0, -1.0, 0.0]
    path: {offset: -1.0}
formation: {spacing: [0.0, -3.0]}
"""


REGION = """\
name: region
seed: 3
time: {step: 0.01, duration: 60.0}
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0}
start: {region: [[0, -3.5], [12, -3.5], [12, 3.5], [0, 3.5]], min_gap: 0.4}
robots:
  - {name: a, footprint: {length: 1.8, width: 1.0}, path: {offset: 1.0}}
  - {name: b, footprint: {length: 1.8, width: 1.0}, path: {offset: -1.0}}
"""


def changed(text: str, *changes: tuple[str, str]) -> str:
    """A text with each first part replaced by the second; every one must be there."""
    for old, new in changes:
        assert text.count(old) >= 1, old
        text = text.replace(old, new)
    return text


def check(folder: Path, text: str) -> Findings:
    """Check a text as the file ``w.yaml``."""
    file = folder / "w.yaml"
    file.write_text(text, encoding="utf-8")
    return check_world(file)


def lines(findings: Findings) -> tuple[list[str], list[str]]:
    """Errors and warnings as ``line:column key message``."""
    groups = [
        [f"{f.line}:{f.column} {f.key} {f.message}" for f in group]
        for group in (findings.errors, findings.warnings)
    ]
    return groups[0], groups[1]


def check_finding(line: str, place: str, *parts: str) -> None:
    """A finding of `lines` stands at this place (``line:column key``) and has each part, whole."""
    check_error(line + "\n", place, *parts)


def with_facts(found: list[str], *parts: str) -> list[str]:
    """Those of some findings in which every part stands."""
    return [line for line in found if re.search(facts(*parts), line)]


def only_error(tmp_path: Path, text: str) -> str:
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 1, errors
    return errors[0]


def only_warning(tmp_path: Path, text: str) -> str:
    found = lines(check(tmp_path, text))
    assert (len(found[0]), len(found[1])) == (0, 1), found
    return found[1][0]


def check_told(found: Findings, *told: tuple[str, ...]) -> None:
    """Each of ``told``, (E or W, place, *parts), is an error or warning, and there is no other.

    Warnings beside errors may be others; so may all after an ellipsis.
    """
    both = dict(zip("EW", lines(found), strict=True))
    if told[:1] == (...,):
        for kind, place, *parts in told[1:]:
            near = [line for line in with_facts(both[kind], *parts) if line.startswith(place)]
            assert near, (place, parts, both)
        return
    for kind, group in both.items():
        wanted = [one for one in told if one[0] == kind]
        if kind == "E" or wanted or not both["E"]:
            assert len(group) == len(wanted), group
        for line, (_, place, *parts) in zip(group, wanted, strict=bool(wanted)):
            check_finding(line, place, *parts)
