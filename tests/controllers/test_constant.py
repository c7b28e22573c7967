"""One command for each robot, whatever happens."""

from __future__ import annotations

import numpy as np

from physim.world import Robot
from tests.controllers.random_scenes import random_history
from tests.controllers.scenes import observations
from tests.helpers import inside

Constant, ConstantSettings = inside("physim.controllers", "Constant", "ConstantSettings")

COMMANDS = ((1.5, -0.3), (-0.2, 1.6))


def test_every_robot_holds_its_own_and_those_beyond_the_list_stand() -> None:
    controller = Constant(ConstantSettings(commands=COMMANDS))
    histories = (random_history(np.random.default_rng([90, k]), moments=1) for k in range(20))
    seen = next(o for o in (observations(h, 0) for h in histories) if len(o) == 4)
    decided = [controller.decide(observation, None) for observation in seen]
    assert [(d.v, d.omega) for d in decided] == [*COMMANDS, (0.0, 0.0), (0.0, 0.0)]
    assert all(d.hold >= 1e6 and d.mode is None for d in decided)
    alone = Constant().decide(seen[0], None)
    assert (alone.v, alone.omega) == (0.0, 0.0)


def test_commands_beyond_the_limits_are_faults() -> None:
    robots = {
        i: Robot.model_validate(
            {
                "name": f"r{i}",
                "footprint": {"length": 1.8, "width": 1.0},
                "pose": [0.0, 0.0, 0.0],
                "path": {"offset": 0.0},
                "limits": {"v": 1.5, "omega": 1.6},
            }
        )
        for i in range(2)
    }
    assert Constant(ConstantSettings(commands=COMMANDS)).robot_faults(robots) == []
    slow = {**robots, 1: robots[1].model_copy(update={"limits": robots[1].limits.model_copy(
        update={"omega": 1.5})})}  # fmt: skip
    faults = Constant(ConstantSettings(commands=((-2.0, -1.6), (0.0, 1.6))))
    assert [tuple(f.location) for f in faults.robot_faults(slow)] == [
        ("controller", "commands", 0, 0),
        ("controller", "commands", 1, 1),
    ]


def test_a_command_of_no_robot_is_a_fault() -> None:
    robot = Robot.model_validate(
        {"name": "r", "footprint": {"length": 1.8, "width": 1.0}, "pose": [0.0, 0.0, 0.0],
         "path": {"offset": 0.0}}
    )  # fmt: skip
    for given, of in ((0, 2), (1, 2), (2, 2), (3, 2), (4, 1)):
        made = Constant(ConstantSettings(commands=((0.1, 0.0),) * given))
        faults = made.robot_faults(dict.fromkeys(range(of), robot))
        assert [tuple(f.location) for f in faults] == [("controller", "commands", of)] * (
            given > of
        )
        assert all(f"{given} commands for {of}" in f.message for f in faults)
