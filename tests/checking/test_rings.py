"""Closed paths: robots that start next to the joint are told what way is left to them."""

from __future__ import annotations

from math import cos, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest

from physim import simulate
from physim.world.file import parse_world
from tests.checking.worlds import check, check_finding, lines

RADIUS = 10.0


def circle(radius: float, count: int = 48) -> list[list[float]]:
    angles = np.linspace(0.0, 2.0 * pi, count + 1)
    return [[round(radius * cos(a), 4), round(radius * sin(a), 4)] for a in angles]


def ring(*degrees: float, formation: str = "") -> str:
    """Robots on a closed path, counter-clockwise from 0 degrees."""
    lap = circle(RADIUS)
    robots = "".join(
        f"  - {{name: r{k}, footprint: {{length: 1.0, width: 0.6}}, path: {lap}, pose: "
        f"[{RADIUS * cos(a):.3f}, {RADIUS * sin(a):.3f}, {a + pi / 2:.3f}]}}\n"
        for k, a in enumerate(map(radians, degrees), 1)
    )
    return (
        f"name: ring\ntime: {{step: 0.02, duration: 90.0}}\nboundaries: [{circle(13.0)}, "
        f"{circle(7.0)}]\nreference_path: {lap}\n{formation}robots:\n{robots}"
        "controller: {type: path_following}\n"
    )


def test_a_lap_from_just_before_the_joint_is_told_to_be_short(tmp_path: Path) -> None:
    (line,) = lines(check(tmp_path, ring(-10.0)))[1]
    check_finding(line, "6:60 robots[0].path", "r1", "closed path", "not a lap", "1.74 m")
    assert lines(check(tmp_path, ring(0.0)))[1] == []


def test_and_it_is_so(tmp_path: Path) -> None:
    with simulate(parse_world(ring(-10.0))) as record:
        driven = np.hypot(*np.diff(record.pose[:, 0, :2], axis=0).T).sum()
    assert driven < 0.05 * 2.0 * pi * RADIUS
    with simulate(parse_world(ring(0.0))) as record:
        driven = np.hypot(*np.diff(record.pose[:, 0, :2], axis=0).T).sum()
    assert driven > 0.9 * 2.0 * pi * RADIUS


@pytest.mark.parametrize("spacing", ["initial", "[0, -4]"])
def test_a_formation_on_both_sides_of_the_joint_is_told(tmp_path: Path, spacing: str) -> None:
    formation = f"formation: {{spacing: {spacing}}}\n"
    line = lines(check(tmp_path, ring(12.0, -12.0, formation=formation)))[1][0]
    check_finding(
        line, "4:17 reference_path", "both sides of its joint", '"r1"', '"r2"', "2.09", "60.69"
    )
    fine = lines(check(tmp_path, ring(36.0, 12.0, formation=formation)))[1]
    assert not any("joint" in line for line in fine)
