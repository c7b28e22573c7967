"""A formation in parts that no chain of neighbours connects: told by the check, shown by runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from physim import Simulation
from physim.world.file import parse_world
from tests.checking.worlds import check, lines, with_facts
from tests.helpers import inside

FloatArray = inside("physim.geometry", "FloatArray")

WORLD = """\
name: four
time: {{step: 0.01, duration: 60.0}}
corridor: {{centreline: [[0, 0], [80, 0]], width: 6.0}}
robots:
  - {{name: a, footprint: &box {{length: 1.8, width: 1.0}}, pose: [{a}, 0, 0], path: {{offset: 0}}}}
  - {{name: b, footprint: *box, pose: [{b}, 0, 0], path: {{offset: 0}}}}
  - {{name: c, footprint: *box, pose: [20.0, 0, 0], path: {{offset: 0}}}}
  - {{name: d, footprint: *box, pose: [16.0, 0, 0], path: {{offset: 0}}}}
formation: {{gain: {gain}, spacing: {spacing}, {neighbours}}}
sensing: {{range: 12.0}}
"""
EVEN = "[0, -5, -10, -15]"


def text(
    neighbours: str, spacing: str = EVEN, a: float = 29.0, b: float = 25.0, gain: float = 0.1
) -> str:
    return WORLD.format(neighbours=neighbours, spacing=spacing, a=a, b=b, gain=gain)


def driven(world: str) -> FloatArray:
    """Poses (4, 3) after 3 s."""
    simulation = Simulation(parse_world(world))
    for _ in range(300):
        simulation.step()
    return np.array(simulation.pose)


CASES = [
    # neighbours, spacing, a, b, what is told
    ("range: 6.0", EVEN, 29.0, 25.0, []),
    ("range: 4.99", EVEN, 29.0, 25.0, ["range", "5 m ahead", "in formation"]),
    ("range: 6.0", "[0, -4, -11, -15]", 29.0, 25.0, ["range", "7 m ahead", '"b"', '"c"']),
    ("range: 6.0", EVEN, 33.0, 29.0, ["range", "9 m ahead", "at the start", '"b"', '"c"']),
    ("range: 6.0", "initial", 33.0, 29.0, ["range", "9 m ahead", '"b"', '"c"']),
    ("range: 1.0, neighbours: all", EVEN, 33.0, 29.0, []),
    ("neighbours: [[d, a], [a, b], [c, b]]", EVEN, 33.0, 29.0, []),
    ("neighbours: [[a, b], [c, d]]", EVEN, 29.0, 25.0, ["neighbours", '"c", "d"']),
    ("neighbours: [[a, b], [d, b]]", EVEN, 29.0, 25.0, ["neighbours", '"c"']),
    ("neighbours: []", EVEN, 29.0, 25.0, ["neighbours", '"b", "c", "d"']),
]


@pytest.mark.parametrize(("neighbours", "spacing", "a", "b", "told"), CASES)
def test_a_formation_in_parts_is_told(
    tmp_path: Path, neighbours: str, spacing: str, a: float, b: float, told: list[str]
) -> None:
    _, warnings = lines(check(tmp_path, text(neighbours, spacing, a, b)))
    found = [one for one in warnings if "(7)" in one and "whatever the gain" in one]
    assert len(found) == bool(told)
    if told:
        where, *facts = told
        assert with_facts(found, f"formation.{where}", *facts)


@pytest.mark.parametrize(
    ("neighbours", "in_parts"),
    [
        ("neighbours: [[a, b], [c, d]]", True),
        ("neighbours: [[a, b], [b, c], [c, d]]", False),
        ("range: 1.5", True),
        ("range: 6.0", False),
    ],
)
def test_what_is_told_is_so_in_a_run(tmp_path: Path, neighbours: str, in_parts: bool) -> None:
    """The two behind drive as if there were nobody before them; else they do not."""
    near, far = (text(neighbours, EVEN, a, a - 4.0) for a in (29.0, 28.0))
    assert in_parts == ("whatever the gain" in str(lines(check(tmp_path, near))))
    behind = [driven(world)[2:] for world in (near, far)]
    assert np.array_equal(*behind) == in_parts


def test_nobody_keeps_a_distance_at_a_gain_of_zero(tmp_path: Path) -> None:
    _, warnings = lines(check(tmp_path, text("neighbours: []", gain=0.0)))
    assert "whatever the gain" not in str(warnings)


def test_the_range_that_is_named_connects_all(tmp_path: Path) -> None:
    _, (warning,) = lines(check(tmp_path, text("range: 4.0", "initial", 33.3, 27.7)))
    named = float(warning.split("range of at least ")[1].split()[0])
    _, warnings = lines(check(tmp_path, text(f"range: {named}", "initial", 33.3, 27.7)))
    assert warnings == []


@pytest.mark.parametrize(
    "neighbours",
    ["[[a, b, c]]", "[[a]]", "[[1, 2]]", "[a, b]", "{a: 1}", "none", "true", "3", "", "[[a, z]]"],
)
def test_neighbours_of_the_wrong_kind_are_an_error_and_nothing_more(
    tmp_path: Path, neighbours: str
) -> None:
    errors, warnings = lines(check(tmp_path, text(f"neighbours: {neighbours}")))
    assert errors
    assert all("formation.neighbours" in one for one in errors)
    assert "whatever the gain" not in str(warnings)
