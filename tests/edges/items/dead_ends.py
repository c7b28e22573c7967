"""Robots arrive before an end wall, and check foresees a stop too close to one."""

from __future__ import annotations

from tests.edges.shell import Shell
from tests.roads_to_stops import dead_end

NUMBER = "2"


def try_a_robot_arrives_with_the_end_wall_ahead(shell: Shell) -> None:
    for k, start in enumerate((2.0, 2.03)):
        file = shell.write(f"w{k}.yaml", dead_end(1.2, [start]) + "expect: {finished: true}\n")
        done = shell.physim("run", file, "-o", f"out{k}", "--no-video")
        assert done.code == 0, done.out


def try_check_foresees_a_stop_at_the_wall(shell: Shell) -> None:
    done = shell.physim("check", shell.write("w.yaml", dead_end(1.0)))
    assert "end_margin" in done.out, done.out
    assert "danger mode" in done.out, done.out


def try_check_foresees_robots_that_stop_close_behind_each_other(shell: Shell) -> None:
    done = shell.physim("check", shell.write("w.yaml", dead_end(3.0, [4.7, 2.0])))
    assert "danger mode" in done.out, done.out
