"""A tolerance of arrival that is large for the robot, in worlds written and imported."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from physim import check_world, load_world
from physim.cli import main
from tests.helpers import facts

SMALL = """\
name: small
time: {step: 0.01, duration: 60}
corridor: {centreline: [[0, 0], [2, 0]], width: 0.4}
robots: [{name: e, footprint: {length: 0.07, width: 0.06}, pose: [0.2, 0, 0], path: {offset: 0}}]
controller: {type: path_following, speed: 0.04}
"""


@pytest.mark.parametrize(("tolerance", "told"), [("", True), ("0.036", True), ("0.034", False)])
def test_more_than_half_a_robot_is_told(tmp_path: Path, tolerance: str, told: bool) -> None:
    text = SMALL + (f"arrival: {{tolerance: {tolerance}}}\n" if tolerance else "")
    path = tmp_path / "small.yaml"
    path.write_text(text, encoding="utf-8")
    found = [one for one in check_world(path).warnings if "half" in one.message]
    assert len(found) == told
    if told:
        assert found[0].key == "arrival.tolerance"
        said = facts(f"{tolerance or 0.1} m", "half", '"e"', "0.07")
        assert re.search(said, found[0].message)


def test_an_imported_world_of_small_robots_has_a_small_one(tmp_path: Path) -> None:
    """The robots shrank, and with them all lengths but this one: 0.1 m, more than one of them."""
    arena = tmp_path / "arena.wkt"
    arena.write_text("POLYGON ((0 0, 1.6 0, 1.6 0.5, 0 0.5, 0 0))", encoding="utf-8")
    world = tmp_path / "arena.yaml"
    made = main(["import", str(arena), "-o", str(world), "--robot", "0.07,0.07", "--quiet"])
    assert made == 0
    assert load_world(world).arrival.tolerance == pytest.approx(0.1 * 0.07 / 1.8, rel=0.01)
    assert not [one for one in check_world(world).warnings if "arrival" in one.key]
