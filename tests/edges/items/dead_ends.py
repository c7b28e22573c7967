"""Robots arrive before an end wall, and check foresees a stop too close to one."""

from __future__ import annotations

from tests.edges.shell import Shell
from tests.helpers import dead_end

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


def try_arrival_without_a_tolerance_is_told_at_load(shell: Shell) -> None:
    text = dead_end(3.0, [2.013])
    text = "\n".join(line for line in text.split("\n") if not line.startswith("formation"))
    text = text.replace("{type: mode_switching}", "{type: mode_switching, arrival_tolerance: 0}")
    file = shell.write("w.yaml", text + "arrival: {tolerance: 0}\n")
    for command in (("check",), ("run", "--quiet", "--no-video", "-o", "out")):
        done = shell.physim(command[0], file, *command[1:])
        assert "arrival.tolerance" in done.out + done.err
        assert "0.05 m" in done.out + done.err, (done.out, done.err)
