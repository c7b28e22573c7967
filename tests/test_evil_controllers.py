"""Controllers that fail in ways of their own: one line that names them, and their line."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel, model_validator

from physim import Decision, Decisions, Simulation, simulate
from physim.errors import ControllerError
from physim.record import Record
from physim.testing import check_controller
from tests.helpers import THREE, Says, facts, inside, road

Declared, given_settings = inside("physim.parts", "Declared", "given_settings")
CONTROLLER, checked_settings = inside("physim.parts", "CONTROLLER", "checked_settings")
find_part, make_part = inside("physim.parts", "find_part", "make_part")
settings_model = inside("physim.parts", "settings_model")
decision_row = inside("physim.simulation", "decision_row")


class OddError(BaseException):
    """What is no Exception."""


class Fails:
    """A value that cannot be read."""

    def __float__(self) -> float:
        raise OddError("not a number")

    def __index__(self) -> int:
        raise OddError("not a robot")

    def __iter__(self) -> Iterator[int]:
        raise GeneratorExit

    def __repr__(self) -> str:
        raise OddError("no text")


def endless() -> Iterator[int]:
    while True:
        yield 0


def raised(error: BaseException) -> Decision:
    raise error


def decided(**fields: Any) -> Decision:
    return Decision(**{"v": 0.0, "omega": 0.0, "hold": 0.1, **fields})


ANSWERS = {
    "no exception": (lambda o: raised(OddError("odd")), ("OddError", "odd")),
    "an end of generators": (lambda o: raised(GeneratorExit()), ("GeneratorExit",)),
    "a group": (lambda o: raised(BaseExceptionGroup("two", [OddError()])), ("two",)),
    "a number": (lambda o: decided(v=Fails()), ("OddError", "not a number")),
    "robots": (lambda o: decided(considered=Fails()), ("GeneratorExit",)),
    "a robot": (lambda o: decided(considered=[Fails()]), ("OddError", "not a robot")),
    "a mode": (lambda o: decided(mode=Fails()), ("mode", "of type Fails")),
    "one too many": (lambda o: decided(considered=[0, 1, 2, 0]), ("considered", "each once")),
    "robots without end": (lambda o: decided(considered=endless()), ("considered", "each once")),
}


@pytest.mark.parametrize("answer", ANSWERS)
def test_whatever_it_raises_is_one_line_that_names_it(answer: str, tmp_path: Path) -> None:
    decide, said = ANSWERS[answer]
    with pytest.raises(ControllerError, match=facts("r1", "0 s", *said)) as caught:
        simulate(road(THREE), controller=Says(decide), path=tmp_path / "r.h5")
    assert "\n" not in str(caught.value)
    assert "test_evil_controllers.py:" in str(caught.value) or "says.py:" in str(caught.value)
    with Record.load(tmp_path / "r.h5") as record:
        assert record.ended == "error"


def test_ctrl_c_within_it_is_no_error_of_its_own() -> None:
    with pytest.raises(KeyboardInterrupt):
        Simulation(road(THREE), controller=Says(lambda o: raised(KeyboardInterrupt()))).step()
    with pytest.raises(KeyboardInterrupt):
        decision_row(decided(considered=interrupted()), Simulation(road(THREE)).declared, 3, 1)


def interrupted() -> Iterator[int]:
    yield 0
    raise KeyboardInterrupt


class Batched:
    """A batch form that fails where it is told to."""

    def __init__(self, fails: str, answer: Any = None) -> None:
        self.fails, self.answer = fails, answer

    def decide(self, observation: Any, memory: Any) -> Decision:
        return decided()

    def batch(self, scene: Any) -> Batched:
        return self._at("batch", self)

    def memory(self) -> Any:
        return self._at("memory", {})

    def decide_due(self, sensed: Any, due: Any, memory: Any) -> Any:
        return self._at("decide_due", self.answer)

    def _at(self, place: str, answer: Any) -> Any:
        if self.fails == place:
            raise OddError(place)
        return answer


@pytest.mark.parametrize("place", ["batch", "memory", "decide_due"])
def test_a_batch_form_that_fails_is_one_line(place: str) -> None:
    with pytest.raises(ControllerError, match=facts("Batched", "OddError", place)) as caught:
        Simulation(road(THREE), controller=Batched(place)).step()
    assert "test_evil_controllers.py:" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_batch_form_that_answers_something_else_is_told_what_it_must() -> None:
    with pytest.raises(ControllerError, match=facts("Batched", "int", "Decisions")) as caught:
        Simulation(road(THREE), controller=Batched("", 5)).step()
    assert "test_evil_controllers.py:" in str(caught.value)


def answer(**changed: Any) -> Decisions:
    """What robots 0, 1 and 2, who stand, may be told."""
    many, numbers = 3, np.zeros(3, dtype=np.int64)
    right = Decisions(
        np.arange(many), np.zeros((many, 2)), np.full(many, 0.1), numbers - 1, numbers - 1,
        np.zeros((many, 0)), np.zeros(0, dtype=np.int64), np.zeros(many + 1, dtype=np.int64),
    )  # fmt: skip
    return right._replace(**changed)


WRONG = {
    "others": ({"robot": np.array([1, 2, 3])}, ("[1, 2, 3]", "[0, 1, 2]")),
    "swapped": ({"robot": np.array([2, 1, 0])}, ("[2, 1, 0]", "[0, 1, 2]")),
    "fewer": ({"robot": np.array([0, 1])}, ("[0, 1]", "[0, 1, 2]")),
    "half a mode": ({"mode": np.full(3, 0.5)}, ("mode", "whole numbers")),
    "half a rule": ({"rule": np.full(3, 0.5)}, ("rule", "whole numbers")),
    "a list": ({"hold": [0.1, 0.1, 0.1]}, ("hold", "array")),
}


@pytest.mark.parametrize("how", WRONG)
def test_a_batch_form_that_answers_for_others_or_by_halves_is_refused(how: str) -> None:
    """Rows of `/updates` would be of other robots, and modes others than were given."""
    changed, said = WRONG[how]
    with pytest.raises(ControllerError, match=facts("Batched", *said)) as caught:
        Simulation(road(THREE), controller=Batched("", answer(**changed))).step()
    assert "test_evil_controllers.py:" in str(caught.value)


def test_a_batch_form_that_answers_right_is_taken() -> None:
    Simulation(road(THREE), controller=Batched("", answer())).step()


class Reusing(Batched):
    """Decides into arrays of its own, the same each time."""

    def decide_due(self, sensed: Any, due: Any, memory: Any) -> Any:
        self.answer.command[:, 0] = 0.01 * sensed.step
        return self.answer


def test_what_a_batch_form_writes_into_its_answer_later_changes_no_record() -> None:
    """`validate` alone found it: `/updates` had the last command in every row."""
    record = simulate(road(THREE).changed(time={"duration": 0.5}), controller=Reusing("", answer()))
    updates = record.updates
    assert len(set(updates["step"].tolist())) > 3
    assert updates["nominal_v"] == pytest.approx(0.01 * updates["step"])


def test_a_fault_of_a_shipped_controller_is_not_told_as_the_users(monkeypatch: Any) -> None:
    simulation = Simulation(road(THREE))

    def broken(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(type(simulation._batch), "decide_due", broken)
    with pytest.raises(ZeroDivisionError):
        simulation.step()


class Guarded(type):
    """A class that fails when it is asked for what it was not given; pytest asks for more."""

    def __getattr__(cls, name: str) -> Any:
        raise SystemExit(0) if name in ("Settings", "decide") else AttributeError(name)


class Unreadable(metaclass=Guarded):
    """A class whose ``Settings`` end the program with 0."""

    def decide(self, observation: Any, memory: Any) -> Decision:
        return decided()


class Unasked(metaclass=Guarded):
    """The same without the one method."""


class Validated:
    """A controller with a validator that fails in a way of its own."""

    class Settings(BaseModel):
        @model_validator(mode="after")
        def fail(self) -> Any:
            raise OddError("validator")


@pytest.mark.parametrize("key", ["modes", "rules", "columns"])
@pytest.mark.parametrize("error", [OddError("odd"), SystemExit(0), RuntimeError("odd")])
def test_declarations_that_cannot_be_read_are_one_line(key: str, error: BaseException) -> None:
    part = type("Hidden", (), {key: property(lambda self: raised(error))})()
    with pytest.raises(ControllerError, match=facts("Hidden", type(error).__name__)) as caught:
        Declared.of(part)
    assert "test_evil_controllers.py:" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_ctrl_c_within_declarations_is_no_error_of_theirs() -> None:
    part = type("Hidden", (), {"modes": property(lambda self: raised(KeyboardInterrupt()))})()
    with pytest.raises(KeyboardInterrupt):
        Declared.of(part)


def test_a_class_that_fails_when_it_is_asked_is_one_line() -> None:
    asked = {
        "Settings": lambda: settings_model(Unreadable),
        "decide": lambda: find_part(CONTROLLER, f"{__name__}:Unasked", trusted=True),
    }
    for key, ask in asked.items():
        with pytest.raises(ControllerError, match=facts(key, "SystemExit")) as caught:
            ask()
        assert "test_evil_controllers.py:" in str(caught.value)


def test_a_validator_that_fails_is_a_fault_of_the_settings() -> None:
    _, faults = checked_settings(Validated, {}, ("controller",))
    assert [fault.location for fault in faults] == [("controller",)]
    assert "OddError: validator" in faults[0].message
    assert "test_evil_controllers.py:" in faults[0].message


def test_a_property_that_ends_the_program_is_not_known() -> None:
    class Kept:
        def __init__(self, gain: float = 1.0) -> None:
            self._gain = gain

        @property
        def gain(self) -> float:
            raise SystemExit(0)

    assert given_settings(Kept()).not_known == ("gain",)


class Asked:
    """An object whose class answers by an error whether it has a method."""

    def __getattr__(self, name: str) -> Any:
        raise OddError(name)

    def decide(self, observation: Any, memory: Any) -> Decision:
        return decided()


def test_an_object_that_fails_when_it_is_asked_for_a_hook_is_one_line() -> None:
    with pytest.raises(ControllerError, match=facts("Asked.robot_faults", "OddError")) as caught:
        check_controller(Asked, worlds=["straight"])
    assert "test_evil_controllers.py:" in str(caught.value)


class Secretive(Asked):
    """An object that answers nothing, not even what it is."""

    def __getattribute__(self, name: str) -> Any:
        raise OddError(name)


def test_an_object_that_says_not_even_what_it_is_is_one_line() -> None:
    with pytest.raises(ControllerError, match=facts("Secretive.decide", "OddError")) as caught:
        make_part(CONTROLLER, f"{__name__}:Secretive", {}, trusted=True)
    assert "test_evil_controllers.py:" in str(caught.value)
    assert "\n" not in str(caught.value)


class Nothing:
    """What its class gives is no object of it."""

    def __new__(cls) -> Any:
        return None

    def decide(self, observation: Any, memory: Any) -> Decision:
        return decided()


def test_a_class_that_gives_something_else_is_told_what_it_lacks() -> None:
    """Not taken for no controller at all."""
    with pytest.raises(ControllerError, match=facts("Nothing", "None", "decide")) as caught:
        make_part(CONTROLLER, f"{__name__}:Nothing", {}, trusted=True)
    assert "test_evil_controllers.py:" in str(caught.value)
