"""Settings reach the controller that they are for, or that is told; its errors name its lines."""

from __future__ import annotations

import json

from tests.edges.shell import Shell

NUMBER = "controller"
OWN = """\
from pydantic import BaseModel

from physim import Decision


class Push:
    class Settings(BaseModel):
        strength: float = 0.5

    def __init__(self, settings):
        self.strength = settings.strength

    def decide(self, observation, memory):
        return Decision(v=self.strength, omega=0.0, hold=0.5)


class Plain:
    def decide(self, observation, memory):
        return {}["missing"]
"""
WORLD = """\
name: one
time: {{step: 0.02, duration: 1.0}}  # [s]
corridor: {{centreline: [[0, 0], [20, 0]], width: 8.0}}  # [m]
robots:
  - name: a
    footprint: {{length: 1.8, width: 1.0}}
    pose: [6.0, 1.0, 0.0]
    path: {{offset: 1.0}}
controller: {{{}}}
"""


def ran(shell: Shell, settings: str, *more: str) -> tuple[float, str, dict[str, object]]:
    """Speed of the robot, what was said, and the controller as the summary names it."""
    shell.write("own.py", OWN)
    shell.write("w.yaml", WORLD.format(settings))
    given = ("run", "w.yaml", "--controller", "own:Push", "--no-video", "--quiet", "--force")
    done = shell.physim(*given, "-o", "out", *more)
    assert done.code == 0, done.err
    told = json.loads((shell.folder / "out/summary.json").read_text())
    return told["mean_speed_m_per_s"], done.err, told["controller"]


def try_settings_without_a_type_reach_it(shell: Shell) -> None:
    speed, said, named = ran(shell, "strength: 0.7")
    assert abs(speed - 0.7) < 1e-9, "it ran with its default"
    assert "WARNING" not in said
    assert named == {"type": "own:Push", "settings": {"strength": 0.7}}


def try_settings_of_another_are_told(shell: Shell) -> None:
    speed, said, _ = ran(shell, "type: mode_switching, look_ahead: 1.5")
    assert abs(speed - 0.5) < 1e-9
    for part in ("WARNING", "w.yaml:9:", "look_ahead", "mode_switching", "own:Push"):
        assert part in said, said


def try_set_reaches_it(shell: Shell) -> None:
    speed, _, _ = ran(shell, "type: mode_switching", "--set", "controller.strength=0.3")
    assert abs(speed - 0.3) < 1e-9


def try_an_unknown_one_is_refused_by_name(shell: Shell) -> None:
    shell.write("own.py", OWN)
    shell.write("w.yaml", WORLD.format("strenght: 0.7"))
    for name, part in (("own:Push", "strength"), ("own:Plain", "Plain")):
        done = shell.physim("run", "w.yaml", "--controller", name)
        done.refused("w.yaml:9:", "controller.strenght", part)


def try_an_error_names_its_line(shell: Shell) -> None:
    shell.write("own.py", OWN)
    shell.write("w.yaml", WORLD.format("type: mode_switching"))
    given = ("run", "w.yaml", "--controller", "own:Plain", "--no-video", "--quiet", "--force")
    done = shell.physim(*given)
    assert (done.code, done.err.count("\n")) == (2, 1), done.err
    for part in ("own.py:19", "KeyError", "missing"):
        assert part in done.err, done.err
    assert "in decide" in shell.physim(*given, "--traceback").err


def try_another_controller_for_a_record_is_told(shell: Shell) -> None:
    ran(shell, "strength: 0.7")
    done = shell.physim("validate", "out/record.h5", "--rerun", "--controller", "own:Plain")
    for part in ("WARNING", "strength", "own:Push", "own:Plain"):
        assert part in done.err, done.err
