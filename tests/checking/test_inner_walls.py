"""Walls that stand in the accessible area and enclose nothing, as between the rooms of a plan."""

from __future__ import annotations

from pathlib import Path

from tests.checking.worlds import check, lines

HALL = """\
name: hall
time: {step: 0.01, duration: 15.0}
boundaries:
  - [[0, -3], [30, -3], [30, 3], [0, 3], [0, -3]]
  - WALL
reference_path: [[2, 0], [28, 0]]
robots:
  - {name: r1, footprint: {length: 1.0, width: 0.6}, pose: [3, 0, 0], path: {offset: 0}}
controller: {type: path_following}
"""


def found(folder: Path, wall: str) -> list[str]:
    errors, warnings = lines(check(folder, HALL.replace("WALL", wall)))
    return errors + warnings


def test_a_path_through_a_wall_is_told_with_its_place(tmp_path: Path) -> None:
    (told,) = found(tmp_path, "[[15, -3], [15, 2]]")
    for part in ('path of "r1"', "boundaries[1]", "(15, 0)", "13.00 m"):
        assert part in told


def test_a_path_past_a_wall_is_not(tmp_path: Path) -> None:
    assert not found(tmp_path, "[[15, -3], [15, -1.5]]")


def test_no_route_leads_through_a_gap_that_is_too_small(tmp_path: Path) -> None:
    assert any("no route" in told for told in found(tmp_path, "[[15, -3], [15, 2.9]]"))
