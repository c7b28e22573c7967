"""Walls ahead keep nobody from its stop: end walls, slanted ones, those beside and behind."""

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
@pytest.mark.parametrize("start", [2.0, 2.06])
def test_arrival_does_not_depend_on_the_phase_of_decisions(margin: float, start: float) -> None:
    """The gap at the stop, 0.3 or 0.7 m, is well below time_low at 1 m/s."""
    record = physim.simulate(parse_world(dead_end(margin, [start], width=2.4)))
    assert record.ended == "finished"
    assert len(record.contacts) == 0


@pytest.mark.parametrize("heading", [-0.213, 0.25])
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


AISLES = """\
name: aisles
time: {step: 0.01, duration: 80.0}
boundaries: [[[0, 0], [21.2, 0], [21.2, 8.8], [0, 8.8], [0, 0]]]
obstacles: [[[3.6, 4.0], [17.6, 4.0], [17.6, 4.8], [3.6, 4.8]]]
reference_path: [[1.8, 2.0], [19.4, 2.0], [19.4, 6.8], [2.28, 6.8]]
robots:
  - {name: a, footprint: &box {length: 1.8, width: 1.0}, pose: [8.2, 2.0, 0.0], path: {offset: 0.0}}
  - {name: b, footprint: *box, pose: [5.0, 2.0, 0.0], path: {offset: 0.0}}
  - {name: c, footprint: *box, pose: [1.8, 2.0, 0.0], path: {offset: 0.0}}
formation: {gain: 0.05, range: 10.0}
"""


def test_a_wall_behind_a_corner_keeps_nobody_standing_who_had_to_stop() -> None:
    """With one threshold for robots and walls (13) likes standing best, for ever."""
    with physim.simulate(parse_world(AISLES)) as record:
        assert record.ended == "duration"
        assert {record.modes[mode].name for mode in record.updates["mode"][-30:]} >= {"danger_time"}
    for high in (1.0, 1.4):
        text = AISLES + f"controller: {{type: mode_switching, boundary_time_high: {high}}}\n"
        with physim.simulate(parse_world(text)) as record:
            assert (record.ended, len(record.contacts)) == ("finished", 0)
