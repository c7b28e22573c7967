"""Whole decisions against the oracle's."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from tests.controllers.agreement import Tally, hold_against_oracle
from tests.controllers.equal_scenes import equal_case
from tests.controllers.random_scenes import random_history, random_settings
from tests.controllers.scenes import decisions, single_robot
from tests.helpers import inside

ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")

SELDOM = {
    "shortened by the stop", "target unseen", "a wall beyond boundary_time_high",
    "settled by |omega|", "too near to tell",
}  # fmt: skip
"""Branches that random scenes need not meet: others do, below and beside."""
MOST_UNSURE = 0.02
"""Share of decisions that turn on a graze, where nothing can be demanded."""


def in_random_scenes(seeds: range) -> Tally:
    draws = [np.random.default_rng([1, seed]) for seed in seeds]
    tally = hold_against_oracle([(random_history(rng), random_settings(rng)) for rng in draws])
    assert tally.faults == []
    return tally


@pytest.mark.parametrize("first", range(0, 100, 10))
def test_every_decision_agrees_with_the_oracle(first: int) -> None:
    assert in_random_scenes(range(first, first + 10)).met["decided"] > 25


@pytest.mark.deep
def test_every_branch_agrees_with_the_oracle() -> None:
    tally = in_random_scenes(range(100, 320))
    unsure = tally.met["unsure"] + tally.met["too near to tell"]
    assert unsure <= MOST_UNSURE * tally.met["decided"]
    assert {name for name, met in tally.met.items() if met < 5} <= SELDOM


def test_a_wall_beyond_its_threshold_keeps_nobody_in_danger() -> None:
    """In danger before, and a wall within ``time_high`` ahead, but not ``boundary_time_high``."""
    cases = []
    for seed in range(70):
        rng = np.random.default_rng([5, seed])
        history, drawn = random_history(rng, moments=4), random_settings(rng).model_dump()
        drawn |= {"time_low": 1.5, "time_high": 8.0, "horizon": 10.0, "avoidance": "time_first"}
        drawn |= {"boundary_time_high": 1.5 + rng.uniform(0.0, 0.5), "boundary_low": 0.0}
        drawn |= {"distance_low": 0.1, "distance_high": 0.1}
        cases.append((history, ModeSwitchingSettings.model_validate(drawn)))
    tally = hold_against_oracle(cases)
    assert tally.faults == []
    assert tally.met["a wall beyond boundary_time_high"] >= 4


def test_candidates_that_are_equally_good() -> None:
    """Heading, then |omega|, then the order of the sets."""
    tally = hold_against_oracle([equal_case(np.random.default_rng([2, k])) for k in range(150)])
    assert tally.faults == []
    assert tally.met["too near to tell"] == 0
    assert tally.met["settled by |omega|"] >= 20
    assert tally.met["settled by order"] >= 50


def test_a_last_waypoint_beyond_a_wall_is_moved_inside() -> None:
    """The path ends beyond a wall, and the look-ahead reaches past its end."""
    history = single_robot(np.array([[0.0, 0.0], [11.5, 0.0]]), 8.0)
    ((robot,),) = history.moments
    robot = dataclasses.replace(robot, outside=np.array([[10.0, 11.5]]))
    wall = [np.array([[10.0, -20.0], [10.0, 20.0]])]
    history = dataclasses.replace(history, walls=[wall], moments=[[robot]])
    settings = ModeSwitchingSettings(look_ahead=6.0, safe_distance=1.0)
    tally = hold_against_oracle([(history, settings)])
    assert tally.faults == []
    assert tally.met["target moved"] == tally.met["target past a wall"] == 1
    (made,) = decisions(history, settings)
    assert made.report[0, :2] == pytest.approx([9.0, 0.0])


def test_arrival_is_judged_along_the_path_within_the_tolerance() -> None:
    modes = []
    for short in (-0.5, 0.0, 0.04, 0.06, 0.2):
        history = single_robot(np.array([[0.0, 0.0], [13.0, 0.0]]), 9.0)
        ((robot,),) = history.moments
        robot = dataclasses.replace(robot, stop_station=9.0 + short)
        history = dataclasses.replace(history, moments=[[robot]])
        tally = hold_against_oracle([(history, ModeSwitchingSettings(arrival_tolerance=0.05))])
        assert tally.faults == []
        modes.append("arrived" if tally.met["arrived"] else "on the way")
    assert modes == ["arrived"] * 3 + ["on the way"] * 2
