"""Robots arrive before an end wall whenever they decide, as long as they stop clear of it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import physim
from physim.world.file import parse_world
from tests.controllers.agreement import hold_against_oracle
from tests.controllers.scenes import single_robot
from tests.helpers import dead_end, inside

ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")

SLANTED = """
name: slanted
time: {{step: 0.01, duration: 30.0}}
boundaries: [[[-2, -1.5], [7.3069, -1.5], [7.7572, 1.5], [-2, 1.5], [-2, -1.5]]]
reference_path: [[0, 0], [6.232, 0]]
robots:
  - name: a
    footprint: {{length: 1.321, width: 0.792}}
    pose: [0, 0, {heading}]
    path: {{offset: 0.0}}
"""


@pytest.mark.parametrize("margin", [1.2, 1.6])
@pytest.mark.parametrize("start", [2.0, 2.03, 2.06, 2.09])
def test_arrival_does_not_depend_on_the_phase_of_decisions(margin: float, start: float) -> None:
    """The gap at the stop, 0.3 or 0.7 m, is well below time_low at 1 m/s."""
    record = physim.simulate(parse_world(dead_end(margin, [start], width=2.4)))
    assert record.ended == "finished"
    assert len(record.contacts) == 0


@pytest.mark.parametrize("heading", [-0.213, -0.1, 0.1, 0.25])
def test_arrival_before_a_slanted_wall_does_not_depend_on_the_heading(heading: float) -> None:
    """Where its way to the target is a turn it would stand for ever 0.25 m before its stop."""
    record = physim.simulate(parse_world(SLANTED.format(heading=heading)))
    assert record.ended == "finished"
    assert len(record.contacts) == 0


@pytest.mark.parametrize("seed", [39, 79])
def test_a_wall_beside_the_stop_keeps_nobody_from_it(seed: int) -> None:
    """Led on to where it was nearer than boundary_low, r1 backed and came again for ever."""
    record = physim.simulate(physim.load_world("three_robots").changed(seed=seed))
    assert record.ended == "finished"
    assert len(record.contacts) == 0


@pytest.mark.parametrize(("beyond", "mode"), [(0.5, "mode safe"), (-0.2, "mode (13)")])
def test_a_wall_before_the_stop_is_danger_and_one_beyond_is_not(beyond: float, mode: str) -> None:
    history = single_robot(np.array([[0.0, 0.0], [13.0, 0.0]]), 9.0)
    ((robot,),) = history.moments
    robot = dataclasses.replace(robot, stop_station=9.4)
    x = 9.4 + 0.3 + beyond
    wall = [np.array([[x, -20.0], [x, 20.0]])]
    history = dataclasses.replace(history, walls=[wall], moments=[[robot]])
    settings = ModeSwitchingSettings(safe_distance=0.1)
    tally = hold_against_oracle([(history, settings)])
    assert tally.faults == []
    assert tally.met[mode] > 0
