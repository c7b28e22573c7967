"""Distances and collision times (11), and the choices by (12) and (13), against slow oracles.

The scenes of `test_mode_switching` meet all of it among everything else; here every robot is in
danger.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from tests.controllers.agreement import hold_against_oracle
from tests.controllers.random_scenes import random_history
from tests.controllers.scenes import single_robot
from tests.helpers import inside

ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")

BY_DISTANCE = {
    "distance_low": 50.0, "distance_high": 50.0, "time_low": 0.0, "time_high": 0.0,
    "update_period": 0.4, "dwell_times": [0.4],
}  # fmt: skip
BY_TIME = {**BY_DISTANCE, "avoidance": "time", "update_period": 0.1, "dwell_times": [0.1]}


@pytest.mark.parametrize(
    ("seed", "mode", "given"),
    [
        (10, "(12)", BY_DISTANCE),
        (11, "(13)", BY_TIME),
        (12, "(13)", {**BY_TIME, "collision_motion": "translation"}),
    ],
    ids=["(12)", "(13)", "(13) in translation"],
)
def test_choice_in_danger(seed: int, mode: str, given: dict[str, object]) -> None:
    cases = []
    for k in range(25):
        rng = np.random.default_rng([seed, k])
        drawn = {"horizon": rng.choice([4.0, 10.0]), "safe_distance": rng.choice([0.2, 1.0])}
        settings = {**given, **{name: float(value) for name, value in drawn.items()}}
        history = random_history(rng, moments=1)
        cases.append((history, ModeSwitchingSettings.model_validate(settings)))
    tally = hold_against_oracle(cases)
    assert tally.faults == []
    assert tally.met[f"mode {mode}"] >= 20
    assert tally.met[f"{mode} with others"] >= 10


@pytest.mark.parametrize("judge_ahead", [0.0, 1.0])
def test_where_no_distance_counts_the_choice_by_12_is_that_of_5(judge_ahead: float) -> None:
    """In danger for a boundary, but no footprint within L of one, and nobody to consider."""
    given = {**BY_DISTANCE, "distance_low": 0.0, "distance_high": 0.0, "boundary_low": 6.0}
    settings = ModeSwitchingSettings.model_validate(
        {**given, "safe_distance": 0.05, "judge_ahead": judge_ahead, "look_ahead": 0.6}
    )
    cases = []
    for k in range(25):
        history = random_history(np.random.default_rng([16, k]), moments=1)
        cases.append((history, settings))
    tally = hold_against_oracle(cases)
    assert tally.faults == []
    assert tally.met["(12) settled by (5)"] >= 10


@pytest.mark.parametrize("speed", [-4.0, 3.0, 6.0])
def test_the_choice_by_12_looks_at_a_fast_robot_farther_than_another(speed: float) -> None:
    """One stands 1 m behind; another, now farther ahead, is nearer than that after the period."""
    history = single_robot(np.array([[0.0, 0.0], [30.0, 0.0]]), 10.0)
    ((robot,),) = history.moments
    settings = ModeSwitchingSettings.model_validate(BY_DISTANCE)
    comes = abs(speed) * settings.update_period
    behind, ahead = robot.pose - [1.6, 0.0, 0.0], robot.pose + [1.1 + comes, 0.0, 0.0]
    ahead[2] = np.pi if speed > 0.0 else 0.0
    others = [
        dataclasses.replace(robot, pose=behind, reference_station=12.0),
        dataclasses.replace(robot, pose=ahead, command=(speed, 0.0), reference_station=12.0),
    ]
    history = dataclasses.replace(history, moments=[[robot, *others]])
    tally = hold_against_oracle([(history, settings)])
    assert tally.faults == []
    assert tally.met["(12) with others"] >= 1
