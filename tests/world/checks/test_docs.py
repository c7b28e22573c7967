"""The examples of docs/reference/checks.md are what the command prints."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

from physim.world.checks import check_world

text_of = importlib.import_module("physim.cli.check").text_of
DOCS = Path(__file__).parents[3] / "docs/reference/checks.md"

MY_WORLD = """\
name: my world
time: {step: 0.01, duration: 60.0}
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0}
robots:
  - name: r1
    pose: [6.0, 3.15, 90]
    footprint: {length: 1.8, width: 1.0}
    path: {offset: 1.0}
"""

HALL = """\
name: hall
time: {step: 0.01, duration: 60.0}
boundaries:
  - [[-3, -4], [33, -4], [33, 4]]
  - [[33, 4], [17, 4], [15, 1.9], [13, 4], [-3, 4], [-3, -4]]
reference_path: [[0, 0], [30, 0]]
robots:
  - {name: r1, footprint: {length: 1.8, width: 1.0}, pose: [9, 0, 0], path: {offset: 0}}
  - {name: r2, footprint: {length: 1.8, width: 1.0}, pose: [6.1, 1, 0], path: {offset: 1.0}}
  - {name: r3, footprint: {length: 1.8, width: 1.0}, pose: [3, 1.7, 0], path: {offset: 1.7}}
"""


@pytest.mark.parametrize(
    ("name", "text", "skip"), [("my_world", MY_WORLD, 0), ("hall", HALL, 4)], ids=["faults", "room"]
)
def test_examples(tmp_path, monkeypatch, name, text, skip):
    monkeypatch.chdir(tmp_path)
    Path(f"{name}.yaml").write_text(text, encoding="utf-8")
    printed = text_of(check_world(f"{name}.yaml")).splitlines()[skip:]
    example = "\n".join(printed[:5] if name == "hall" else printed)
    assert example in DOCS.read_text(encoding="utf-8")
