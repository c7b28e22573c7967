"""Controllers that fail in ways of their own: one line that names them, and their line."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physim import Decision, Decisions, Simulation, simulate
from physim.errors import ControllerError
from physim.record import Record
from tests.helpers import THREE, Says, facts, inside, road

Declared = inside("physim.parts", "Declared")


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
    "a group": (lambda o: raised(BaseExceptionGroup("two", [OddError()])), ("two",)),
    "a number": (lambda o: decided(v=Fails()), ("OddError", "not a number")),
    "a robot": (lambda o: decided(considered=[Fails()]), ("OddError", "not a robot")),
    "a mode": (lambda o: decided(mode=Fails()), ("OddError", "no text")),
    "robots without end": (lambda o: decided(considered=endless()), ("considered", "each once")),
}


@pytest.mark.parametrize("answer", ANSWERS)
def test_whatever_it_raises_is_one_line_that_names_it(answer: str, tmp_path: Path) -> None:
    decide, said = ANSWERS[answer]
    with pytest.raises(ControllerError, match=facts("r1", "0 s", *said)) as caught:
        simulate(road(THREE), controller=Says(decide), path=tmp_path / "r.h5")
    assert "\n" not in str(caught.value)
    assert "test_evil_controllers.py:" in str(caught.value) or "worlds.py:" in str(caught.value)
    with Record.load(tmp_path / "r.h5") as record:
        assert record.ended == "error"


def test_ctrl_c_within_it_is_no_error_of_its_own() -> None:
    with pytest.raises(KeyboardInterrupt):
        Simulation(road(THREE), controller=Says(lambda o: raised(KeyboardInterrupt()))).step()
    part = type("Hidden", (), {"modes": property(lambda self: raised(KeyboardInterrupt()))})()
    with pytest.raises(KeyboardInterrupt):
        Declared.of(part)


class Together:
    """Decides for all at once, and fails where it is told to."""

    def __init__(self, fails: str, answer: Any = None) -> None:
        self.fails, self.answer = fails, answer

    def start(self, scene: Any) -> Any:
        return self._at("start", {})

    def decide_all(self, view: Any, due: Any, memory: Any) -> Any:
        return self._at("decide_all", self.answer)

    def _at(self, place: str, answer: Any) -> Any:
        if self.fails == place:
            raise OddError(place)
        return answer


@pytest.mark.parametrize("place", ["start", "decide_all"])
def test_one_for_all_that_fails_is_one_line(place: str) -> None:
    with pytest.raises(ControllerError, match=facts("Together", "OddError", place)) as caught:
        Simulation(road(THREE), controller=Together(place)).step()
    assert "test_evil_controllers.py:" in str(caught.value)
    assert "\n" not in str(caught.value)


def answer(**changed: Any) -> Decisions:
    """What robots 0, 1 and 2, who stand, may be told."""
    return Decisions.of(np.arange(3), np.zeros((3, 2)), 0.1)._replace(**changed)


WRONG = {
    "something else": ({}, ("int", "Decisions")),
    "others": ({"robot": np.array([1, 2, 3])}, ("[1, 2, 3]", "[0, 1, 2]")),
    "fewer": ({"robot": np.array([0, 1])}, ("[0, 1]", "[0, 1, 2]")),
    "half a mode": ({"mode": np.full(3, 0.5)}, ("mode", "whole numbers")),
    "a list": ({"hold": [0.1, 0.1, 0.1]}, ("hold", "array")),
}


@pytest.mark.parametrize("how", WRONG)
def test_one_for_all_that_answers_for_others_or_by_halves_is_refused(how: str) -> None:
    """Rows of `/updates` would be of other robots, and modes others than were given."""
    changed, said = WRONG[how]
    given = answer(**changed) if changed else 5
    with pytest.raises(ControllerError, match=facts("Together", *said)) as caught:
        Simulation(road(THREE), controller=Together("", given)).step()
    assert "test_evil_controllers.py:" in str(caught.value)


class Reusing(Together):
    """Decides into arrays of its own, the same each time."""

    def decide_all(self, view: Any, due: Any, memory: Any) -> Any:
        self.answer.command[:, 0] = 0.01 * view.sensed.step
        return self.answer


def test_what_is_written_into_an_answer_later_changes_no_record() -> None:
    """`validate` alone found it: `/updates` had the last command in every row."""
    record = simulate(road(THREE).changed(time={"duration": 0.5}), controller=Reusing("", answer()))
    updates = record.updates
    assert len(set(updates["step"].tolist())) > 3
    assert updates["nominal_v"] == pytest.approx(0.01 * updates["step"])


def test_a_fault_of_a_shipped_controller_is_not_told_as_the_users(monkeypatch: Any) -> None:
    simulation = Simulation(road(THREE))

    def broken(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(type(simulation.parts.controller), "decide_all", broken)
    with pytest.raises(ZeroDivisionError):
        simulation.step()


@pytest.mark.parametrize("key", ["modes", "rules", "columns"])
@pytest.mark.parametrize("error", [OddError("odd"), SystemExit(0)])
def test_declarations_that_cannot_be_read_are_one_line(key: str, error: BaseException) -> None:
    part = type("Hidden", (), {key: property(lambda self: raised(error))})()
    with pytest.raises(ControllerError, match=facts("Hidden", type(error).__name__)) as caught:
        Declared.of(part)
    assert "test_evil_controllers.py:" in str(caught.value)
    assert "\n" not in str(caught.value)
