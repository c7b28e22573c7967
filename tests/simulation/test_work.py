"""Work is counted, not timed: what a robot costs must not grow with how many others there are.

Robots drive in lanes along a corridor at a fixed density, so that everyone has about as many
others within range, whether they are a hundred or a thousand.
"""

from __future__ import annotations

import sys
import tracemalloc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

import physim
import physim.controllers as controllers
from physim import Decision, Observation, Simulation
from physim.compiled import Kernel
from physim.simulation import observation
from physim.world import World
from tests.helpers import inside

decide_all = inside("physim.controllers", "decide_all")
record_run = inside("physim.simulation", "record_run")

OWN = tuple(str(Path(module.__file__).parent) for module in (physim, controllers))
PAPER = {
    "type": "mode_switching", "look_ahead": 1.0, "safe_distance": 0.3, "longest_interval": 0.1,
    "distance_low": 0.15, "distance_high": 0.25, "time_low": 0.5, "time_high": 1.0,
    "boundary_low": 0.05,
}  # fmt: skip
DANGER = {**PAPER, "distance_low": 1e3, "distance_high": 2e3, "boundary_low": 1e3}
IN_TIME = {**DANGER, "avoidance": "time"}


def corridor(robots: int, controller: dict[str, Any] = PAPER, steps: int = 1000) -> World:
    """Eight lanes of boxes, 1.2 m apart and behind each other, in a corridor of 10 m.

    A little off their places, by a pattern that is there again after 30 m.
    """
    columns = (robots - 1) // 8 + 1
    rng = np.random.default_rng(0)
    off = np.resize(rng.normal(0.0, 0.05, (200, 3)), (robots, 3))
    lane = [(i % 8 - 3.5) * 1.2 for i in range(robots)]
    return World(
        name="corridor",
        time={"step": 0.05, "duration": 0.05 * steps},
        corridor={"centreline": [[0.0, 0.0], [1.2 * columns + 65.0, 0.0]], "width": 10.0},
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


def started(robots: int, controller: dict[str, Any] | Any = PAPER) -> Simulation:
    """Some steps on their way; all that is made once is made."""
    if isinstance(controller, dict):
        simulation = Simulation(corridor(robots, controller))
    else:
        simulation = Simulation(corridor(robots), controller=controller)
    for _ in range(4):
        simulation.step()
    return simulation


def steps(simulation: Simulation, commands: Any = None) -> Callable[[], None]:
    def some() -> None:
        for _ in range(4):
            simulation.step(commands)

    return some


# The loop


def test_a_step_takes_as_many_calls_for_hundreds_of_robots_as_for_ten() -> None:
    """With commands from outside, and with the paper's controller in its batch form."""
    for is_driven in (True, False):
        counts = []
        for robots in (10, 300):
            simulation = started(robots)
            commands = np.tile([0.8, 0.0], (robots, 1)) if is_driven else None
            some = steps(simulation, commands)
            some()  # what is made at the first call is made
            counts.append(python_calls(some))
        assert counts[0] > 0
        assert max(counts) <= 1.2 * min(counts)


@pytest.mark.deep
def test_a_recorded_step_takes_no_call_for_every_robot(
    tmp_path: Path,
) -> None:
    """What is written of each robot once, at the start and the end, is not counted."""
    counts = []
    for robots in (10, 1000):
        record_run(Simulation(corridor(robots, steps=40)), path=tmp_path / f"{robots}.h5")
        both = []
        for number in (10, 40):
            simulation = Simulation(corridor(robots, steps=number))
            file = tmp_path / f"{robots}-{number}.h5"
            both.append(python_calls(lambda s=simulation, f=file: record_run(s, path=f)))
        counts.append(both[1] - both[0])
    assert counts[0] > 30
    assert counts[1] <= 4 * counts[0]  # 2.6: more blocks are written
    assert counts[1] <= 0.6 * 30 * 1000


@pytest.mark.deep
@pytest.mark.parametrize("controller", [PAPER, DANGER, Looks()], ids=["paper", "danger", "plain"])
def test_memory_of_a_step_is_linear_in_the_robots(controller: Any) -> None:
    each = {n: most_memory(steps(started(n, controller))) / n for n in (100, 1000)}
    assert each[1000] <= 1.5 * each[100]


def test_everybody_is_made_once_a_step_however_many_see_it(monkeypatch: Any) -> None:
    made: list[int] = []
    real = observation.ObservedRobot

    def counted(index: int, *values: Any) -> Any:
        made.append(index)
        return real(index, *values)

    monkeypatch.setattr(observation, "ObservedRobot", counted)
    simulation = Simulation(corridor(200), controller=Looks())
    simulation.step()
    assert sorted(made) == list(range(200))


# Kernels


@contextmanager
def interpreted(count: Callable[[str], None]) -> Iterator[None]:
    """Run kernels line by line, and count the lines of physim's own by their function."""

    def traced(frame: FrameType, event: str, argument: object) -> Any:
        if not frame.f_code.co_filename.startswith(OWN):
            return None
        name = frame.f_code.co_name

        def line(inner: FrameType, what: str, given: object) -> Any:
            if what == "line":
                count(name)
            return line

        return line

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Kernel, "__call__", lambda self, *a, **named: self.py_func(*a, **named))
        before = sys.gettrace()
        sys.settrace(traced)
        try:
            yield
        finally:
            sys.settrace(before)


def lines_of_a_decision(robots: int, settings: dict[str, Any]) -> tuple[float, dict[str, float]]:
    """Lines that one more decision in the middle of the cluster takes, and of which functions.

    What is done once a step does not count.
    """
    simulation = started(robots, settings)
    vars(simulation._batch)["_decide"] = decide_all  # the kernel in place of its machine code
    sensed, middle = simulation._sense()[0], robots // 2
    found = []
    for due in (8, 24):
        lines: dict[str, int] = {}
        memory = {name: array.copy() for name, array in simulation.memory.items()}
        asked = np.arange(middle, middle + due)
        with interpreted(lambda name, lines=lines: lines.update({name: lines.get(name, 0) + 1})):
            simulation._batch.decide_due(sensed, asked, memory)
        found.append(lines)
    few, many = found
    each = {name: (many[name] - few.get(name, 0)) / 16 for name in many}
    return sum(each.values()), each


@pytest.mark.parametrize(
    "settings",
    [
        pytest.param(PAPER, id="free"),
        pytest.param(DANGER, id="danger", marks=pytest.mark.deep),
        pytest.param(IN_TIME, id="in time", marks=pytest.mark.deep),
    ],
)
def test_a_decision_takes_as_many_lines_among_many_as_among_few(settings: dict[str, Any]) -> None:
    """Those in the middle have the same about them, 30 m to either end or 120 m."""
    few, by_few = lines_of_a_decision(400, settings)
    many, by_many = lines_of_a_decision(1600, settings)
    grown = {name: (by_few.get(name, 0.0), lines) for name, lines in by_many.items()
             if lines > 1.1 * by_few.get(name, 0.0) + 40.0}  # fmt: skip
    assert few > 100.0
    assert not grown
    assert many <= 1.05 * few
