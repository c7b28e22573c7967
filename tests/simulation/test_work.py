"""Work is counted, not timed: what a robot costs must not grow with how many others there are.

Robots drive in lanes along a corridor at a fixed density, so that everyone has about as many
others within range, whether they are a hundred or a thousand.
"""

from __future__ import annotations

import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

from physim import Decision, Observation, Simulation
from physim.world import World
from tests.helpers import inside

record_run = inside("physim.simulation", "record_run")

PAPER = {
    "type": "mode_switching", "look_ahead": 1.0, "safe_distance": 0.3, "longest_interval": 0.1,
    "distance_low": 0.15, "distance_high": 0.25, "time_low": 0.5, "time_high": 1.0,
    "boundary_low": 0.05,
}  # fmt: skip
DANGER = {**PAPER, "distance_low": 1e3, "distance_high": 2e3, "boundary_low": 1e3}


def corridor(robots: int, controller: dict[str, Any] = PAPER, steps: int = 1000) -> World:
    """Eight lanes of boxes, 1.2 m apart and behind each other, in a corridor of 10 m.

    A little off their places, by a pattern that is there again after 30 m.
    """
    off = np.resize(np.random.default_rng(0).normal(0.0, 0.05, (200, 3)), (robots, 3))
    lane = [(i % 8 - 3.5) * 1.2 for i in range(robots)]
    return World(
        name="corridor",
        time={"step": 0.05, "duration": 0.05 * steps},
        corridor={"centreline": [[0.0, 0.0], [0.15 * robots + 67.0, 0.0]], "width": 10.0},
        robots=[
            {
                "name": f"a{i}",
                "footprint": {"length": 0.5, "width": 0.3},
                "pose": [3.0 + i // 8 * 1.2 + off[i, 0], lane[i] + off[i, 1], off[i, 2]],
                "path": {"offset": lane[i]},
                "limits": {"v": 1.0, "omega": 1.6},
            }
            for i in range(robots)
        ],
        formation={"gain": 0.005, "speed": 0.8, "spacing": "initial", "range": 10.0},
        controller=controller,
    )


class Looks:
    """Asks for everything that an observation holds."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        o = observation
        assert all((o.walls, o.footprint, o.others, o.neighbours))
        return Decision(0.8, 0.0 * o.path.target(o.station, 2.0)[0], hold=0.1)


def python_calls(run: Callable[[], object]) -> int:
    """Calls of Python functions, and from them of compiled ones."""
    count = 0

    def counted(frame: FrameType, event: str, argument: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(counted)
    try:
        run()
    finally:
        sys.setprofile(before)
    return count


def most_memory(run: Callable[[], object]) -> int:
    """[bytes] that were in use at one time, more than before; of numpy and Python."""
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        tracemalloc.reset_peak()
        run()
        return tracemalloc.get_traced_memory()[1] - before
    finally:
        tracemalloc.stop()


def steps(robots: int, controller: Any = PAPER, commands: Any = None) -> Callable[[], None]:
    """Some steps of a simulation on its way, in which all that is made once is made."""
    if isinstance(controller, dict):
        simulation = Simulation(corridor(robots, controller))
    else:
        simulation = Simulation(corridor(robots), controller=controller)

    def some() -> None:
        for _ in range(4):
            simulation.step(commands)

    some()
    some()
    return some


@pytest.mark.parametrize("is_driven", [True, False])
def test_a_step_takes_as_many_calls_for_hundreds_of_robots_as_for_ten(is_driven: bool) -> None:
    """With commands from outside, and with the paper's controller in its batch form."""
    few, many = (
        python_calls(steps(n, commands=np.tile([0.8, 0.0], (n, 1)) if is_driven else None))
        for n in (10, 300)
    )
    assert 0 < many <= 1.2 * few


@pytest.mark.deep
def test_a_plain_controller_costs_as_much_a_robot_among_a_thousand_as_among_two_hundred() -> None:
    each = {n: python_calls(steps(n, Looks())) / n for n in (200, 1000)}
    assert each[1000] <= 1.2 * each[200]


@pytest.mark.deep
def test_a_recorded_step_takes_no_call_for_every_robot(tmp_path: Path) -> None:
    """What is written of each robot once, at the start and the end, is not counted."""

    def calls(robots: int) -> int:
        """Of 30 steps in the middle of a run."""
        asked, count = 0, 0

        def counted(frame: FrameType, event: str, argument: object) -> None:
            nonlocal count
            count += event in ("call", "c_call")

        def stop() -> bool:  # asked before each step
            nonlocal asked
            asked += 1
            if asked in (10, 40):
                sys.setprofile(counted if asked == 10 else None)
            return False

        simulation = Simulation(corridor(robots, steps=50))
        record_run(simulation, path=tmp_path / f"{robots}.h5", stop=stop)
        return count

    few, many = calls(10), calls(1000)
    assert few > 30
    assert many <= 2 * few  # 1.34: more blocks are written


@pytest.mark.deep
@pytest.mark.parametrize("controller", [PAPER, DANGER, Looks()], ids=["paper", "danger", "plain"])
def test_memory_of_a_step_is_linear_in_the_robots(controller: Any) -> None:
    each = {n: most_memory(steps(n, controller)) / n for n in (100, 1000)}
    assert each[1000] <= 1.5 * each[100]
