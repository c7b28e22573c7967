"""Robots that start nearer to another leg of a path, beyond a wall, than to that which is meant."""

from __future__ import annotations

from pathlib import Path

import pytest

from physim import check_world
from tests.checking.worlds import check, lines, with_facts
from tests.cli.commands import physim

HAIRPIN = """\
name: hairpin
time: {{step: 0.01, duration: 10}}
corridor:
  centreline: [[0, 0], [30, 0], [34, 0], [34, 5.2], [30, 5.2], [0, 5.2]]
  width: [8, 8, 2, 2, 2, 2]
robots:
  - {{name: r1, footprint: {{length: 0.8, width: 0.4}}, pose: [8, {y}, 0], path: {path}}}
{more}"""
FORMATION = "formation: {gain: 0.05, speed: 0.8, limits: [0.5, 1.0]}\n"
OWN = "[[8, {}], [27, {}], [31, 0], [34, 0], [34, 5.2], [0, 5.2]]"


def told(tmp_path: Path, y: float, path: str, more: str = "") -> list[str]:
    file = tmp_path / "hairpin.yaml"
    file.write_text(HAIRPIN.format(y=y, path=path, more=more), encoding="utf-8")
    found = check_world(file)
    assert found.ok
    return [one.message for one in found.warnings if "beyond a wall or an obstacle" in one.message]


def test_the_reference_path_beyond_a_wall_is_a_warning(tmp_path: Path) -> None:
    """2.2 m to the way back, 3 m to the way out: the others would wait for it 57 m behind."""
    (message,) = told(tmp_path, 3.0, OWN.format(3, 3), FORMATION)
    assert "2.2 m from the reference path at 65.20 m" in message
    assert "stretch at 8.00 m, in sight, is 3 m away" in message


def test_its_own_path_beyond_a_wall_is_a_warning(tmp_path: Path) -> None:
    (message,) = told(tmp_path, 3.0, "{offset: 0}")
    assert "2.2 m from its path at 65.20 m" in message


@pytest.mark.parametrize(
    ("y", "path", "more"),
    [
        (2.5, OWN.format(3, 3), FORMATION),  # nearer to the way out
        (3.0, OWN.format(3, 3), ""),  # nobody measures on the reference path
    ],
)
def test_the_stretch_that_is_meant_is_none(tmp_path: Path, y: float, path: str, more: str) -> None:
    assert told(tmp_path, y, path, more) == []


def test_an_obstacle_between_is_a_wall(tmp_path: Path) -> None:
    """As the inner walls of imported drawings and maps are."""
    file = tmp_path / "hall.yaml"
    file.write_text(
        """\
name: hall
time: {step: 0.01, duration: 10}
boundaries: [[[-3, -4], [38, -4], [38, 10], [-3, 10], [-3, -4]]]
obstacles: [[[-3, 4], [30, 4], [30, 4.2], [-3, 4.2]]]
reference_path: [[0, 0], [34, 0], [34, 5.2], [0, 5.2]]
robots:
  - {name: a, footprint: {length: 0.8, width: 0.4}, pose: [8, 3, 0],
     path: [[0, 0], [34, 0], [34, 5.2], [0, 5.2]]}
""",
        encoding="utf-8",
    )
    told = [one.message for one in check_world(file).warnings if "an obstacle, and" in one.message]
    assert len(told) == 1
    assert "2.2 m from its path" in told[0]
    assert "stretch at 8.00 m, in sight, is 3 m away" in told[0]


def test_a_path_round_a_pillar_is_none(tmp_path: Path) -> None:
    """The nearest stretch is behind the pillar, and the robot on its way there."""
    file = tmp_path / "pillar.yaml"
    file.write_text(
        """\
name: pillar
time: {step: 0.01, duration: 10}
boundaries:
  - [[-2, -6], [22, -6], [22, 6], [-2, 6], [-2, -6]]
  - [[9, 0], [11, 0]]
reference_path: [[0, -1], [9, -1], [10, 0.6], [11, -1], [20, -1]]
robots:
  - {name: a, footprint: {length: 0.5, width: 0.4}, pose: [10, -0.5, 0],
     path: [[0, -1], [9, -1], [8.5, 0.6], [11.5, 0.6], [11, -1], [20, -1]]}
formation: {gain: 0.05, speed: 0.8, limits: [0.5, 1.0]}
""",
        encoding="utf-8",
    )
    assert not [
        one for one in check_world(file).warnings if "beyond a wall or an obstacle" in one.message
    ]


def test_another_robot_beyond_the_wall_is_counted(tmp_path: Path) -> None:
    box = "{length: 0.8, width: 0.4}"
    second = f"  - {{name: r2, footprint: {box}, pose: [11, 3, 0], path: {{offset: 0}}}}\n"
    (message,) = told(tmp_path, 3.0, "{offset: 0}", second)
    assert "and 1 more robot so" in message


@pytest.mark.parametrize(("y", "told_lines"), [(3.0, 1), (2.5, 0)])
def test_a_run_tells_it_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], y: float, told_lines: int
) -> None:
    file = tmp_path / "hairpin.yaml"
    file.write_text(HAIRPIN.format(y=y, path="{offset: 0}", more=""), encoding="utf-8")
    short = ("--set", "time.duration=0.5", "--no-video", "--quiet")
    done = physim("run", file, *short, "-o", tmp_path / "out", capture=capsys)
    lines = [one for one in done.err.splitlines() if "beyond a wall or an obstacle" in one]
    assert len(lines) == told_lines
    assert all("hairpin.yaml:7:60: robots[0].pose" in one for one in lines)


@pytest.mark.parametrize(("pose", "is_told"), [
    ([4, 19, 0], False), ([19, 4, 0], True), ([4, 10, 0], False),
])  # fmt: skip
def test_a_start_far_from_its_path_is_told(tmp_path, pose, is_told):
    """As where x and y are swapped; not where the seed places the robots."""
    text = (
        "name: far\ntime: {step: 0.02, duration: 90}\n"
        "boundaries: [[[0, 0], [40, 0], [40, 30], [0, 30], [0, 0]]]\n"
        "reference_path: [[2, 19], [36, 19]]\nrobots:\n"
        f"  - {{name: a, footprint: {{length: 1.8, width: 1.0}}, pose: {pose}, "
        "path: {offset: 0}}\n"
    )
    told = with_facts(lines(check(tmp_path, text))[1], "robots[0].pose", "15 m away", "(19, 19)")
    assert bool(told) == is_told
    drawn = text.replace(f"pose: {pose}, ", "")
    drawn += "start: {region: [[2, 2], [8, 2], [8, 5], [2, 5]], heading: along}\n"
    assert not with_facts(lines(check(tmp_path, drawn))[1], "m away")
