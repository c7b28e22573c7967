"""Walls with a point every millimetre keep their safe area, and none is empty in silence."""

from __future__ import annotations

import json

from tests.edges.shell import Shell

NUMBER = "1"

WORLD = """\
name: road
time: {{step: 0.01, duration: 1.0}}
boundaries:
  - [{right}, {left}, [-3, {low}]]
reference_path: [[0, 0], [30, 0]]
robots:
  - {{name: a, footprint: {{length: 1.8, width: 1.0}}, pose: [5, 0.2, 0], path: {{offset: 0.0}}}}
"""
BOUND = 30
"""[s] of processor time, ten times what is needed where kernels need not be compiled"""


def road(points: int, half: float) -> str:
    """A straight road as one closed boundary of so many points a wall."""
    xs = [-3.0 + 36.0 * k / (points - 1) for k in range(points)]
    right = ", ".join(f"[{x:.9g}, {-half}]" for x in xs)
    left = ", ".join(f"[{x:.9g}, {half}]" for x in reversed(xs))
    return WORLD.format(right=right, left=left, low=-half)


def try_check_accepts_9000_points_a_wall(shell: Shell) -> None:
    done = shell.physim("check", shell.write("road.yaml", road(9_000, 3.0)), seconds=BOUND)
    assert done.code == 0, done.out
    assert "no errors, no warnings" in done.out, done.out


def try_100000_points_are_checked_in_time(shell: Shell) -> None:
    file = shell.write("road.yaml", road(49_990, 3.0))
    assert shell.physim("check", file, seconds=BOUND).code == 0


def try_a_run_has_its_safe_area(shell: Shell) -> None:
    file = shell.write("road.yaml", road(9_000, 3.0))
    done = shell.physim("run", file, "-o", "out", "--no-video")
    assert done.code == 0, done.err
    assert "WARNING" not in done.out, done.out
    told = json.loads((shell.folder / "out" / "summary.json").read_text())
    assert told["no_safe_area_at_m"] is None


def try_a_run_without_a_safe_area_says_so(shell: Shell) -> None:
    file = shell.write("road.yaml", road(2, 0.9))
    done = shell.physim("run", file, "-o", "out", "--no-video")
    assert "WARNING" in done.out, done.out
    assert "safe area" in done.out, done.out
    quiet = shell.physim("run", file, "-o", "again", "--no-video", "--quiet")
    assert "safe area" in quiet.err, quiet.err
