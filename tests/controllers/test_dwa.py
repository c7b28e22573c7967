"""The dynamic window: what is chosen is reachable, admissible and the best; brakes hold."""

from __future__ import annotations

import math

import numpy as np
import pytest

from physim import Simulation, build_scene
from physim.testing import check_controller
from physim.world.file import parse_world
from tests.helpers import inside

Dwa, DwaSettings, Window, goodness, can_stop = inside(
    "physim.controllers", "Dwa", "DwaSettings", "Window", "goodness", "can_stop"
)

GATE_AHEAD = """
name: towards a closed gate
time: {step: 0.02, duration: 12.0}
corridor: {centreline: [[0, 0], [20, 0]], width: 6}
robots:
  - {name: a, footprint: {length: 1, width: 0.6}, pose: [2, 0, 0], path: [[2, 0], [18, 0]]}
movers:
  - name: gate
    footprint: {length: 1, width: 5.6}
    waypoints: [[9.5, 0], [9.5, 0.01]]
    speed: 0.001
"""


def test_what_it_weighs_is_heading_way_and_speed() -> None:
    window = Window(0.5, math.pi / 3.0, 2.0, 0.2, 0.2, 3.0, 3, 11, 5.0)
    straight = goodness(window, 0.1, 1.0, 0.0, 1.0, 0.0, 3.0)
    assert straight == pytest.approx(2.0 + 0.2 + 0.2)
    assert goodness(window, 0.1, 1.0, 0.0, 0.5, 0.0, 1.5) == pytest.approx(2.0 + 0.1 + 0.1)
    # a turn that comes to its end at the target, once braked, is as good as no error
    omega, braked = 0.5, 0.05 + 0.5**2 / (2.0 * math.pi / 3.0)
    assert goodness(window, 0.1, 1.0, braked, 1.0, omega, 3.0) == pytest.approx(straight)
    assert goodness(window, 0.1, 1.0, -math.pi, 1.0, 0.0, 3.0) == pytest.approx(0.4)


def test_admissible_is_what_brakes_in_time() -> None:
    window = Window(0.5, math.pi / 3.0, 2.0, 0.2, 0.2, 3.0, 3, 11, 5.0)
    rng = np.random.default_rng(1)
    seen = set()
    for v, time in zip(rng.uniform(0.01, 1.5, 400), rng.uniform(0.1, 5.0, 400), strict=True):
        way = v * 0.1  # marched: held for a period, then slower by a little each moment
        speed, step = v, 1e-3
        while speed > 0.0:
            way += speed * step
            speed -= 0.5 * step
        if abs(way + 0.05 - v * time) < 0.005:
            continue
        stops = can_stop(window, 0.1, 0.05, v, 0.0, time)
        assert stops == (way + 0.05 <= v * time)
        seen.add(stops)
    assert seen == {True, False}


def test_it_comes_to_a_stand_before_a_gate_within_its_accelerations() -> None:
    assert check_controller(Dwa(), worlds=["three_robots"], seconds=0.5) == []
    simulation = Simulation(build_scene(parse_world(GATE_AHEAD)), controller=Dwa())
    held, front = [np.zeros(2)], 0.0
    while simulation.step_number < 600:
        simulation.step(steps=5)
        held.append(simulation.command[0].copy())
        front = max(front, float(simulation.pose[0, 0]) + 0.5)
    change = np.abs(np.diff(np.array(held), axis=0)).max(axis=0)
    assert change[0] <= 0.5 * 0.1 + 1e-9
    assert change[1] <= math.pi / 3.0 * 0.1 + 1e-9
    assert max(one[0] for one in held) > 0.9
    assert 8.5 < front <= 9.0 - DwaSettings().margin
    assert held[-1] == pytest.approx(0.0)


def test_one_that_comes_past_and_beside_its_stop_goes_back_to_it_slowly() -> None:
    text = GATE_AHEAD.replace("pose: [2, 0, 0]", "pose: [6.5, 0.9, 0]").replace("[18, 0]", "[6, 0]")
    world = parse_world(
        text.replace("time: {step: 0.02, duration: 12.0}", "time: {step: 0.02, duration: 30.0}")
    )
    simulation = Simulation(build_scene(world), controller=Dwa())
    fastest = 0.0
    while simulation.step_number < 1500 and not simulation.finished:
        simulation.step(steps=5)
        fastest = max(fastest, float(simulation.command[0, 0]))
    assert 0.0 < fastest < 1.0
