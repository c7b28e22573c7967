"""What a controller tells of a decision: checked, recorded, remembered."""

from __future__ import annotations

import math

import numpy as np
import pytest

import physim
from physim import Column, Decision, Decisions, Mode, Rule, build_scene
from physim.errors import ControllerError
from tests.analysis.validation.runs import LANE
from tests.helpers import facts, inside, road

STANDARD_COLUMNS, Declared = inside("physim.parts", "STANDARD_COLUMNS", "Declared")
next_steps = inside("physim.simulation", "next_steps")

SCENE = build_scene(road([[2.0, y, 0.0] for y in (-2.0, 0.0, 2.0)]))
DECLARED = Declared(
    modes=(Mode("a", "#000000"), Mode("b", "#ffffff")), rules=(Rule("r"),), columns=(Column("c"),)
)
NUMBERS = {
    "command": (0.0, -0.5, 0.3, 1.0, 1.0 + 1e-12, 1.7, math.nan, -math.inf),
    "hold": (0.0, 0.05, 0.1, 0.3, 1e9, math.inf, -1e-9, math.nan),
    "mode": (-1, 0, 1, 2, -2),
    "rule": (-1, 0, 1),
}
RIGHT = {"command": 5, "hold": 6, "mode": 3, "rule": 2}
"""how many of them are, at the front"""


def drawn(rng, due, wrong):
    """Decisions of the robots due; with numbers that are wrong now and then, or without."""
    many = len(due)

    def some(name, *shape):
        right = RIGHT[name]
        return rng.choice(NUMBERS[name] if rng.random() < wrong else NUMBERS[name][:right], shape)

    others = [rng.permutation(np.setdiff1d(range(3), [i]))[: rng.integers(0, 3)] for i in due]
    considered = np.concatenate((*others, np.zeros(0))).astype(np.int64)
    start = np.cumsum([0, *map(len, others)])
    if len(considered) and rng.random() < wrong:
        considered[rng.integers(0, len(considered))] = rng.choice([0, 1, 2, 3, -1])
    if rng.random() < wrong:
        start[rng.integers(0, len(start))] = rng.integers(-1, 7)
    return Decisions(
        due, some("command", many, 2), some("hold", many), some("mode", many), some("rule", many),
        np.zeros((many, 1)), considered, start,
    )  # fmt: skip


def written_out(step, d):
    """Steps of the next decisions by the rules, one by one; None where one is broken."""
    start, others = d.considered_start.tolist(), d.considered.tolist()
    if start[0] != 0 or start[-1] != len(others) or start != sorted(start):
        return None
    steps = []
    for k, robot in enumerate(d.robot.tolist()):
        seen = others[start[k] : start[k + 1]]
        fine = (
            (np.abs(d.command[k]) <= SCENE.limits[robot] * (1.0 + 1e-9)).all()
            and d.hold[k] >= 0.0
            and -1 <= d.mode[k] < 2
            and -1 <= d.rule[k] < 1
            and len(set(seen)) == len(seen)
            and set(seen) <= {0, 1, 2} - {robot}
        )
        if not fine:
            return None
        held = min(max(math.floor(min(d.hold[k], 1e9) / SCENE.dt + 1e-9), 1), 10**9)
        steps.append(step + held)
    return steps


def test_decisions_pass_by_the_rules() -> None:
    rng = np.random.default_rng(0)
    passed = refused = 0
    for _ in range(1500):
        due = np.flatnonzero(rng.random(3) < 0.6)
        if not len(due):
            continue
        step = int(rng.integers(0, 1000))
        decisions = drawn(rng, due, rng.choice([0.0, 0.2]))
        wanted = written_out(step, decisions)
        if wanted is None:
            with pytest.raises(ControllerError, match=facts("at", f"{step * SCENE.dt:g} s")):
                next_steps(SCENE, step, decisions, DECLARED)
            refused += 1
        else:
            assert next_steps(SCENE, step, decisions, DECLARED).tolist() == wanted
            passed += 1
    assert min(passed, refused) > 200


# What is recorded and remembered


class Telling:
    modes = (Mode("going", "#112233", "goes"), Mode("waiting", "#445566"))
    rules = (Rule("ahead"),)
    columns = (Column("effort", "J"), *STANDARD_COLUMNS)

    def __init__(self, hold=0.1, **told) -> None:
        self.hold, self.told = hold, told

    def decide(self, observation, memory):
        return Decision(v=0.0, omega=0.0, hold=self.hold, **self.told)


def test_what_was_declared_is_recorded():
    told = {
        "mode": "waiting", "rule": Telling.rules[0], "considered": np.array([1]),
        "report": {
            "effort": np.float32(0.5), "target_y": None, "distance": True,
            "collision_time": np.array(2),
        },
    }  # fmt: skip
    world = physim.parse_world(LANE, overrides=["time.duration=0.1"])
    with physim.simulate(world, controller=Only(0, Telling(**told))) as record:
        assert record.declared == Declared(Telling.modes, Telling.rules, Telling.columns)
        row = record.updates[record.updates["robot"] == 0][0]
        assert record.modes[row["mode"]].name == "waiting"
        assert (row["rule"], row["considered"]) == (0, 1)
        assert record.considered[["step", "robot", "other"]].tolist() == [(0, 0, 1)]
        names = ("effort", "target_x", "target_y", "distance", "collision_time")
        values = [row[name] for name in names]
        assert np.array_equal(values, [0.5, np.nan, np.nan, 1.0, 2.0], equal_nan=True)
        other = record.updates[record.updates["robot"] == 1][0]
        assert (other["mode"], other["rule"], other["considered"]) == (-1, -1, 0)
        assert np.isnan(record.column("none such", absent=np.nan)).all()


class Only:
    """Lets a controller speak for one robot; the others say as little as can be."""

    def __init__(self, index, inner) -> None:
        self.index, self.inner = index, inner
        self.modes, self.rules, self.columns = inner.modes, inner.rules, inner.columns

    def decide(self, observation, memory):
        if observation.index == self.index:
            return self.inner.decide(observation, memory)
        return Decision(0.0, 0.0, 0.1)


class Remembering:
    """Counts its own decisions for each robot, and tells the count by its command."""

    def decide(self, observation, memory):
        count = 1 if memory is None else memory[observation.name] + 1
        return Decision(v=0.1 * count, omega=0.0, hold=0.1, memory={observation.name: count})


def test_what_a_controller_remembers_comes_back_to_it():
    world = physim.parse_world(LANE, overrides=["time.duration=0.5"])
    rows = physim.simulate(world, controller=Remembering()).updates
    for robot in (0, 1):
        assert rows["nominal_v"][rows["robot"] == robot] == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5])
