"""Stages, observers and controllers that fail: one line that names them, the time and the place."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physim import Decision, Sensed, Simulation, simulate
from physim.errors import ControllerError, Fault, WorldError
from physim.record import Record
from physim.world import World
from physim.world.file import load_world
from tests.helpers import facts, inside

broken_by = inside("physim.parts", "broken_by")
record_run = inside("physim.simulation", "record_run")


def world(*overrides: str) -> World:
    return load_world("three_robots", overrides=["time.duration=3.0", "expect=null", *overrides])


class Passes:
    """A part of every stage that changes nothing."""

    def start(self, scene: Any) -> None:
        return None

    def sense(self, scene: Any, truth: Any, sensed: Any, state: Any) -> Any:
        return sensed, state

    def filter(self, scene: Any, sensed: Any, nominal: Any, state: Any) -> Any:
        return nominal, state


# What fails


class Fails:
    """Answers in every wrong way."""

    def __init__(self, answer: Any) -> None:
        self.answer = answer

    def start(self, scene: Any) -> Any:
        return self.answer() if self.answer is at_start else None

    def sense(self, scene: Any, truth: Any, sensed: Any, state: Any) -> Any:
        return self.answer(sensed)

    def filter(self, scene: Any, sensed: Any, nominal: Any, state: Any) -> Any:
        return self.answer(nominal)

    def disturb(self, scene: Any, truth: Any, filtered: Any, state: Any) -> Any:
        return self.answer(filtered)


def at_start() -> Any:
    raise KeyError("lost")


def in_a_step(given: Any) -> Any:
    return {}["lost"]


def leaves(given: Any) -> Any:
    raise SystemExit(3)


def writes(given: Any) -> Any:
    array = given.pose if isinstance(given, Sensed) else given
    array[0] = 0.0
    return given, None


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (at_start, r"KeyError: 'lost' \(.*test_stage_errors\.py:\d+\)"),
        (in_a_step, r"KeyError: 'lost' \(.*test_stage_errors\.py:\d+\)"),
        (leaves, "SystemExit: 3"),
        (writes, "ValueError: .*read-only"),
        (
            lambda given: given,
            r"(Sensed|array).*\(.*, state",
        ),
        (
            lambda given: None,
            r"\w+ .*None.*\(.*, state\)",
        ),
        (lambda given: (given, 1, 2), r"tuple of 3.*\(.*, state\)"),
        (lambda given: ("x", None), r" str .*(Sensed|\(3, 2)"),
        (lambda given: ([[1.0], [1.0, 2.0]], None), r" list .*(Sensed|\(3, 2)"),
    ],
)
@pytest.mark.parametrize("kind", ["sensing", "filters", "disturbances"])
def test_errors_in_a_stage_are_one_line_that_names_it(kind: str, answer: Any, said: str) -> None:
    words = {"sensing": "sensing stage", "filters": "filter", "disturbances": "disturbance"}
    with pytest.raises(ControllerError) as caught:
        Simulation(world(), **{kind: [Fails(answer)]}).step()  # type: ignore[arg-type]
    message = str(caught.value)
    assert re.match(f"{words[kind]} Fails at 0 s: ", message), message
    assert re.search(said, message), message
    assert "\n" not in message


@pytest.mark.parametrize("kind", ["sensing", "filters", "disturbances"])
def test_what_is_returned_wrongly_is_told_with_the_line_of_the_method(kind: str) -> None:
    method = {"sensing": Fails.sense, "filters": Fails.filter, "disturbances": Fails.disturb}[kind]
    here = re.escape(f"({__file__}:{method.__code__.co_firstlineno})")
    with pytest.raises(ControllerError, match=f"{here}$"):
        Simulation(world(), **{kind: [Fails(lambda given: None)]}).step()  # type: ignore[arg-type]


class Short:
    """Its methods take other arguments than they are given."""

    def start(self, scene: Any) -> None:
        return None

    def sense(self, scene: Any, sensed: Any, state: Any) -> Any:
        return sensed, state

    filter = disturb = sense


@pytest.mark.parametrize(
    ("kind", "called"),
    [
        ("sensing", "sense(scene, truth, sensed, state)"),
        ("filters", "filter(scene, sensed, nominal, state)"),
        ("disturbances", "disturb(scene, truth, filtered, state)"),
    ],
)
def test_a_method_with_other_arguments_is_told_what_it_is_given(kind: str, called: str) -> None:
    part: Any = Short()
    with pytest.raises(ControllerError) as caught:
        Simulation(world(), **{kind: [part]}).step()  # type: ignore[arg-type]
    message = str(caught.value)
    assert called in message
    assert message.endswith(f"({__file__}:{Short.sense.__code__.co_firstlineno})")


def test_start_and_decide_with_other_arguments_are_told_too() -> None:
    class NoStart(Short):
        def start(self) -> None:  # type: ignore[override]
            return None

    class Odd:
        def decide(self, observation: Any) -> Any:
            return None

    part: Any = NoStart()
    with pytest.raises(ControllerError, match=r"start\(scene\).*test_stage_errors.py:\d+\)$"):
        Simulation(world(), filters=[part])
    odd: Any = Odd()
    with pytest.raises(
        ControllerError, match=r"^controller Odd, r1 at 0 s: .*decide\(observation, memory\).*py:\d"
    ):
        Simulation(world(), controller=odd).step()


def test_a_type_error_within_a_method_points_at_its_own_line() -> None:
    def adds(given: Any) -> Any:
        return 1 + "x"  # type: ignore[operator]

    line = adds.__code__.co_firstlineno + 1
    with pytest.raises(ControllerError, match=rf"TypeError: .*test_stage_errors.py:{line}\)$"):
        Simulation(world(), filters=[Fails(adds)]).step()


@pytest.mark.parametrize(
    ("answer", "given"), [(None, "None"), (5, "an int"), ("no", "a str"), (["no"], "a str among")]
)
def test_what_is_no_list_of_faults_is_told(answer: Any, given: str) -> None:
    class Picky(Passes):
        def world_faults(self, world: World, where: Any) -> Any:
            return answer

    line = Picky.world_faults.__code__.co_firstlineno
    with pytest.raises(ControllerError) as caught:
        Simulation(world(), sensing=[Picky()])
    message = str(caught.value)
    assert f"world_faults returned {given}" in message
    assert "Fault(location, message)" in message
    assert message.endswith(f"({__file__}:{line})")


def test_one_stage_without_a_list_is_told() -> None:
    one: Any = Passes()
    for kind in ("sensing", "filters", "disturbances", "observers"):
        with pytest.raises(ControllerError, match=rf"^{kind} must be a list.*Passes.*{kind}=\["):
            simulate(world(), **{kind: one})  # type: ignore[arg-type]
    with pytest.raises(ControllerError, match=r"^observers must be a list.*Passes"):
        Simulation(world(), observers=one)
    assert Simulation(world(), filters=(f for f in [one])).parts.filters == (one,)  # type: ignore[arg-type]


@pytest.mark.parametrize(("value", "told"), [(np.inf, "inf"), (-2e6, "-2e+06")])
def test_a_disturbance_that_is_not_finite_names_robot_and_value(value: float, told: str) -> None:
    bad = np.zeros((3, 2))
    bad[1, 1] = value
    part: Any = Fails(lambda given: (bad, None))
    said = facts("disturbance Fails", "r2", "0 s", "omega", f"{told} rad/s", "finite", "10000")
    with pytest.raises(ControllerError, match=said):
        Simulation(world(), disturbances=[part]).step()


def test_commands_and_holds_that_cannot_be_name_the_controller() -> None:
    class Fast:
        def __init__(self, v: float, hold: float) -> None:
            self.v, self.hold = v, hold

        def decide(self, observation: Any, memory: Any) -> Any:
            return Decision(self.v, 0.0, self.hold)

    for v, hold, said in ((9.0, 0.1, ("v", "9 m/s")), (0.0, -1.0, ("hold", "-1 s"))):
        with pytest.raises(ControllerError, match=facts("controller Fast", "r1", "0 s", *said)):
            Simulation(world(), controller=Fast(v, hold)).step()


def frozen(array: Any) -> Any:
    """Read-only, as arrays of other libraries and files are."""
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    "nonsense",
    [[[1.0, 2.0]], np.full((3, 2), np.nan), frozen(np.zeros((3, 2), complex)),
     frozen(np.full((3, 2), "0.5")), frozen(np.zeros((3, 2), "datetime64[s]")),
     frozen(np.full((3, 2), None)), np.ma.zeros((3, 2))],
)  # fmt: skip
def test_commands_of_no_use_are_refused(nonsense: Any) -> None:
    for kind, word in (("filters", "filter Fails"), ("disturbances", "disturbance Fails")):
        part: Any = Fails(lambda given: (nonsense, None))
        with pytest.raises(ControllerError, match=word):
            Simulation(world(), **{kind: [part]}).step()  # type: ignore[arg-type]


TWICE = {
    "robot": np.array([0, 1, 2, 2]), "pose": np.zeros((4, 3)), "command": np.zeros((4, 2)),
    "reference_station": np.zeros(4), "age": np.zeros(4), "end": np.array([4, 3, 3]),
}  # fmt: skip
"""Rows of which the first robot has two of the third: compiled code counts on one"""


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"pose": np.zeros((2, 3))}, ("pose", "(2, 3)", "(3, 3)")),
        ({"pose": np.full((3, 3), np.nan)}, ("pose", "finite")),
        ({"robot": np.array([0, 1, 1])}, ("r2", "one row")),
        ({"end": np.array([3, 1, 3])}, ("r2", "exactly one row of its own")),
        ({"robot": np.array([0.0, 1.0, 2.0])}, ("robot", "float64", "whole numbers")),
        ({"pose": np.zeros((3, 3), complex)}, ("pose", "complex128", "numbers")),
        ({"age": np.zeros(3, "m8[s]")}, ("age", "timedelta64", "numbers")),
        ({"command": [[0.0, 0.0]] * 3}, ("command", "list", "numbers")),
        ({"age": np.ma.zeros(3)}, ("age", "MaskedArray", "numbers")),
        ({"robot": np.zeros((), np.int64)}, ("robot", "shape")),
        ({"step": 7}, ("step", "7", "0", "age")),
        ({"step": 0.0}, ("step", "0.0", "0")),
        ({"step": None}, ("step", "None", "0")),
        (TWICE, ("r1", "2 rows", "r3")),
        ({"robot": np.array([0, 1, 7])}, ("robot", "0 to 2")),
        ({"first": [0, 0, 0]}, ("first", "list", "array")),
        ({"end": np.array([3, 3, 9])}, ("r3", "9", "3")),
    ],
)
def test_rows_of_no_use_are_refused(change: dict[str, Any], said: tuple[str, ...]) -> None:
    part = Fails(lambda sensed: (sensed._replace(**change), None))
    with pytest.raises(ControllerError, match=facts("sensing stage Fails", "0 s", *said)):
        Simulation(world(), sensing=[part]).step()


def test_stage_errors_may_object_to_a_world_that_was_made_in_python() -> None:
    class Picky(Passes):
        def world_faults(self, world: World, where: Any) -> Any:
            return [Fault((*where, "x"), f"not with {len(world.robots)} robots")]

    with pytest.raises(WorldError, match=facts("sensing.stages[1].x", "not with 3 robots")):
        Simulation(world(), sensing=[Passes(), Picky()])


# Observers


class Watches:
    """Takes down what it is told; fails where it is asked to."""

    def __init__(self, fails: str = "") -> None:
        self.fails, self.told = fails, list[str]()

    def _note(self, what: str) -> None:
        self.told.append(what)
        if what == self.fails:
            raise ZeroDivisionError("out of patience")

    def start(self, simulation: Simulation) -> None:
        self._note("start")

    def after_step(self, step: Any) -> None:
        self._note(f"step {step.truth.step}")

    def close(self, ended: str) -> None:
        self._note(f"close {ended}")


@pytest.mark.parametrize(
    ("fails", "at", "ended", "steps"),
    [("start", "0 s", "error", 0), ("step 4", "0.05 s", "error", 5),
     ("close duration", "0.1 s", "duration", 10)],
)  # fmt: skip
def test_an_observer_that_fails_ends_the_run_and_the_record_is_kept(
    tmp_path: Path, fails: str, at: str, ended: str, steps: int
) -> None:
    first, bad, last = Watches(), Watches(fails), Watches()
    simulation = Simulation(world("time.duration=0.1"))
    with pytest.raises(ControllerError, match=facts("observer Watches", at, "ZeroDivisionError")):
        record_run(simulation, observers=[first, bad, last], path=tmp_path / "record.h5")
    with Record.load(tmp_path / "record.h5") as record:
        assert (record.ended, len(record.pose)) == (ended, steps + 1)
    assert (bad.told == ["start"]) is (fails == "start")
    assert first.told[-1] == f"close {ended}"
    assert first.told.count("start") == 1
    assert last.told[-1:] == ([] if fails == "start" else [f"close {ended}"])
    assert simulation.observers == []


def test_what_is_no_observer_is_refused_before_the_run(tmp_path: Path) -> None:
    with pytest.raises(ControllerError, match=facts("observer object", "start")):
        record_run(Simulation(world()), observers=[object()])  # type: ignore[list-item]


def test_an_error_whose_text_cannot_be_had_is_told_by_its_type():
    class MuteError(Exception):
        def __str__(self) -> str:
            raise RuntimeError("no text")

    assert broken_by(MuteError()).startswith("MuteError: (")
