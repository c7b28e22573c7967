"""Closed paths: robots that start next to the joint are told what way is left to them."""

from __future__ import annotations

from math import cos, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest

from physim import simulate
from physim.world.file import parse_world
from tests.checking.worlds import check, check_finding, lines
from tests.helpers import inside

clearance_profiles = inside("physim.world.checks", "clearance_profiles")
partial_layout = inside("physim.world.layout", "partial_layout")

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


HALL = """\
name: hall
time: {step: 0.02, duration: 60.0}
boundaries: [[[-10, -15], [30, -15], [30, 25], [-10, 25], [-10, -15]]]
obstacles: [[[3.1, -2], [3.3, -3], [2.9, -3]]]
reference_path: [[0, -12], [20, -12]]
robots:
  - {name: r1, footprint: {length: 1.0, width: 0.6}, pose: POSE, path: PATH}
controller: {type: path_following}
"""
LASSO = "[[0, 0], [10, 0], [10, 10], [0.1, 10], [0.1, -5]]"


def hall(pose: str, path: str = LASSO) -> str:
    return HALL.replace("POSE", pose).replace("PATH", path)


def driven(text: str) -> float:
    with simulate(parse_world(text)) as record:
        return float(np.hypot(*np.diff(record.pose[:, 0, :2], axis=0).T).sum())


def test_a_robot_that_is_nearer_to_a_later_leg_than_the_one_it_faces_is_told(
    tmp_path: Path,
) -> None:
    (line,) = lines(check(tmp_path, hall("[0, 0.3, 0]")))[1]
    check_finding(
        line, "7:79 robots[0].path", "r1", "station 0.00 m", "0.30 m away", "skips 39.60 m"
    )
    assert driven(hall("[0, 0.3, 0]")) < 10.0


@pytest.mark.parametrize(
    "pose",
    [
        pytest.param("[0, 0.05, 0]", id="on the first leg"),
        pytest.param("[0.1, 0.3, -1.57]", id="along the later leg, as meant"),
        pytest.param("[2, 0.3, 0]", id="out of reach of the later leg"),
        pytest.param("[0, 0.3, 3.14]", id="along neither"),
    ],
)
def test_and_no_other_is(tmp_path: Path, pose: str) -> None:
    assert not any("faces" in line for line in lines(check(tmp_path, hall(pose)))[1])
    if pose == "[0, 0.05, 0]":
        assert driven(hall(pose)) > 40.0


def test_the_narrowest_place_is_in_the_lap_that_is_driven() -> None:
    lap = "[0, 0], [10, 0], [10, 10], [0, 10], "
    laid = partial_layout(parse_world(hall("[6, 0, 0]", f"[{lap}{lap}[0, 5]]")))
    (profile,) = clearance_profiles(laid, None)
    assert profile.reached == (6.0, 75.0)
    assert profile.narrowest == pytest.approx((43.1, 3.1, 0.0, 2.0))
