"""What controllers tell of a decision: what no record may hold is refused."""

from __future__ import annotations

import numpy as np
import pytest

import physim
from physim import Decision, Report
from physim.errors import ControllerError
from tests.validation.runs import LANE


class Telling:
    def __init__(self, hold=0.1, **told) -> None:
        self.hold, self.told = hold, told

    def decide(self, observation, memory):
        return Decision(v=0.0, omega=0.0, hold=self.hold, report=Report(**self.told))


@pytest.mark.parametrize("considered", [-1, 1000, np.nan])
def test_impossible_numbers_of_robots_considered(considered):
    with pytest.raises(ControllerError, match=r"slow at 0 s: report: considered = .*; allowed: 0"):
        physim.simulate(physim.parse_world(LANE), controller=Telling(considered=considered))


PAIR = r"it must be two numbers, x and y \[m\]"
NUMBER = "it must be a number"


@pytest.mark.parametrize(
    ("told", "said"),
    [
        ({"target": None}, f"report.target is None; {PAIR}"),
        ({"target": (1, 2, 3)}, rf"report.target is \(1, 2, 3\); {PAIR}"),
        ({"target": (1, 2, 3), "considered": 1}, rf"report.target is \(1, 2, 3\); {PAIR}"),
        ({"target": ("1", 2.0)}, rf"report.target is \('1', 2.0\); {PAIR}"),
        ({"distance": "near"}, f"report.distance is 'near'; {NUMBER}"),
        ({"boundary_distance": "0.4"}, f"report.boundary_distance is '0.4'; {NUMBER}"),
        (
            {"collision_time": np.arange(100.0)},
            rf"report.collision_time is array\(\[.{{50}}\.\.\.; {NUMBER}",
        ),
        ({"considered": None}, f"report.considered is None; {NUMBER}"),
        ({"evaluations": "x"}, f"report.evaluations is 'x'; {NUMBER}"),
        ({"hold": 10**5000}, f"hold is of type int; {NUMBER}"),
        ({"hold": 10**400}, rf"hold is 1000*\.\.\.; {NUMBER}"),
    ],
)
def test_wrong_types_are_told_with_the_field(told, said):
    whole = f"^controller Telling, slow at 0 s: {said}$"
    with pytest.raises(ControllerError, match=whole) as error:
        physim.simulate(physim.parse_world(LANE), controller=Telling(**told))
    assert "\n" not in str(error.value)


def test_numbers_of_any_kind_are_taken():
    told = {
        "target": np.array([1.0, 2.0]), "distance": None, "boundary_distance": np.float32(0.5),
        "collision_time": np.array(2), "considered": np.int64(1), "evaluations": True,
    }  # fmt: skip
    world = physim.parse_world(LANE, overrides=["time.duration=0.1"])
    row = physim.simulate(world, controller=Telling(**told)).updates[0]
    names = ("target_x", "target_y", "distance", "boundary_distance", "collision_time",
             "considered", "evaluations")  # fmt: skip
    assert np.array_equal([row[n] for n in names], [1, 2, np.nan, 0.5, 2, 1, 1], equal_nan=True)


class Remembering:
    """Counts its own decisions for each robot, and tells the count by its command."""

    def decide(self, observation, memory):
        count = 1 if memory is None else memory[observation.name] + 1
        return Decision(v=0.1 * count, omega=0.0, hold=0.1, memory={observation.name: count})


def test_what_a_controller_remembers_comes_back_to_it():
    world = physim.parse_world(LANE, overrides=["time.duration=0.5"])
    rows = physim.simulate(world, controller=Remembering()).updates
    for robot in (0, 1):
        assert rows["wanted_v"][rows["robot"] == robot] == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5])
