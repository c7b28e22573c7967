"""The update interval (14), and decisions at a fixed period to compare with."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from physim import parse_world, simulate
from tests.controllers.agreement import hold_against_oracle
from tests.controllers.scenes import single_robot
from tests.helpers import inside
from tests.oracles import timing as oracle

ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")
update_interval = inside("physim.controllers", "update_interval")
IntArray = inside("physim.geometry", "IntArray")

FACING_A_WALL = """
name: facing a wall
time: {step: 0.01, duration: 3.0}
corridor: {centreline: [[0.0, 0.0], [30.0, 0.0]], width: 6.0}
robots:
  - {name: r1, footprint: {length: 1.0, width: 1.0}, pose: [5.0, 1.9, 1.5], path: {offset: 0.0}}
formation: {}
controller:
  {beta: 0.05, distance_low: 0, distance_high: 0, time_low: 0, time_high: 0, boundary_low: 0}
"""
FAR = float("inf")


def test_update_interval_agrees_with_the_oracle() -> None:
    for k in range(300):
        rng = np.random.default_rng([60, k])
        period, beta = rng.uniform(0.01, 0.5), rng.uniform(0.01, 0.99)
        time = FAR if rng.random() < 0.2 else rng.uniform(0.0, 1.0)
        assert update_interval(period, beta, time) == oracle.interval(period, beta, time, True)


def test_near_the_stop_the_next_decision_is_when_the_robot_comes_to_it() -> None:
    """Robots on their own, 0.05 to 0.35 m before their stops, against the oracle."""
    cases = []
    for k in range(20):
        rng = np.random.default_rng([61, k])
        history = single_robot(np.array([[0.0, 0.0], [13.0, 0.0]]), 9.0)
        ((robot,),) = history.moments
        robot = dataclasses.replace(robot, stop_station=9.0 + float(rng.uniform(0.05, 0.35)))
        history = dataclasses.replace(history, moments=[[robot]])
        longest = float(rng.choice([0.1, 0.2, 0.3]))
        settings = ModeSwitchingSettings(arrival_tolerance=0.01, longest_interval=longest)
        cases.append((history, settings))
    tally = hold_against_oracle(cases)
    assert tally.faults == []
    assert tally.met["shortened by the stop"] >= 7
    assert tally.met["decided"] - tally.met["shortened by the stop"] >= 5


def intervals(*overrides: str) -> IntArray:
    """Steps from every decision to the next."""
    world = parse_world(FACING_A_WALL, overrides=overrides)
    with simulate(world) as record:
        return np.asarray(record.updates["next_step"] - record.updates["step"])


def test_near_a_wall_decisions_come_earlier() -> None:
    found = intervals()
    assert found.min() < 10
    assert found.max() < 20


@pytest.mark.parametrize(
    ("key", "steps"),
    [
        ("longest_interval=0.1", 10),
        ("longest_interval=0.03", 3),
        ("longest_interval=0.01", 1),
        ("update_period=0.1", 20),
    ],
)
def test_without_events_every_decision_holds_for_the_longest_interval(key: str, steps: int) -> None:
    found = intervals("controller.event_triggered=false", f"controller.{key}")
    assert set(found.tolist()) == {steps}


def test_a_plan_of_several_pairs_is_stretched_to_the_longest_interval() -> None:
    found = intervals(
        "controller.event_triggered=false",
        "controller.dwell_times=[0.03, 0.07]",
        "controller.longest_interval=0.3",
        "robots.0.pose=[5.0, 0.0, 0.0]",
    )
    assert set(found[:-1].tolist()) == {9, 21}
