"""What a controller cannot drive is refused when a world is read, at the key at fault."""

from __future__ import annotations

import pytest
from pydantic import BaseModel

from physim import Decision, Simulation, parse_world
from physim.errors import ControllerError, Fault, WorldError
from physim.world.checks import check_world
from physim.world.file import load_world
from tests.helpers import facts, inside
from tests.world.worlds import CORRIDOR, changed, check, check_finding, lines

robot_faults = inside("physim.parts", "robot_faults")

SLOW = changed(CORRIDOR, ("path: {offset: -1.0}", "path: {offset: -1.0}\n    limits: {omega: 0.1}"))


def test_a_limit_below_the_default_speeds_is_refused_at_the_limit(tmp_path):
    errors, _ = lines(check(tmp_path, SLOW))
    assert len(errors) == 1
    figures = ("0.1 rad/s", "below 1.5708 rad/s", "omegas")
    check_finding(errors[0], "13:21 robots[1].limits.omega", *figures)
    with pytest.raises(WorldError, match=r"w\.yaml:13:21: robots\[1\]\.limits\.omega: 0\.1 rad/s"):
        load_world(tmp_path / "w.yaml")


def test_speeds_of_the_controller_are_refused_where_they_stand(tmp_path):
    errors, _ = lines(check(tmp_path, CORRIDOR + "controller: {omegas: [-2.5, 0, 2.5]}\n"))
    assert len(errors) == 2
    limit = ("limits.omega = 1.6", '"a"', "1 more robot")
    check_finding(errors[0], "14:23 controller.omegas[0]", "-2.5 rad/s", *limit)
    check_finding(errors[1], "14:32 controller.omegas[2]", "2.5 rad/s", *limit)


def test_constant_commands_stay_within_the_limits(tmp_path):
    text = CORRIDOR + "controller: {type: constant, commands: [[1, 0], [9, -9]]}\n"
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 2
    forward, turn = ("9 m/s", "limits.v = 1.5", '"b"'), ("-9 rad/s", "limits.omega = 1.6", '"b"')
    check_finding(errors[0], "14:50 controller.commands[1][0]", *forward)
    check_finding(errors[1], "14:53 controller.commands[1][1]", *turn)


class Picky:
    """A controller of one's own that refuses every robot."""

    class Settings(BaseModel):
        fault: bool = True

    def __init__(self, settings=None):
        self.settings = settings or self.Settings()

    def robot_faults(self, robots):
        return [Fault(("robots", i, "name"), "never") for i in robots] if self.settings.fault else 7

    def decide(self, observation, memory):
        return Decision(0.0, 0.0, hold=1.0)


def test_a_controller_of_ones_own_may_refuse_robots(tmp_path):
    file = tmp_path / "w.yaml"
    file.write_text(CORRIDOR, encoding="utf-8")
    found = check_world(file, controller=f"{__name__}:Picky")
    assert [(e.line, e.key, e.message) for e in found.errors] == [
        (5, "robots[0].name", "never"),
        (9, "robots[1].name", "never"),
    ]
    with pytest.raises(WorldError, match="never"):
        Simulation(parse_world(CORRIDOR), controller=Picky())


def test_a_check_that_answers_something_else_is_reported_in_one_line():
    with pytest.raises(ControllerError, match=facts("Picky.robot_faults", "an int", "Fault")):
        robot_faults(Picky(Picky.Settings(fault=False)), [], [])
