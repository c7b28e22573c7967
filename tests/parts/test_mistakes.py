"""Mistakes in users' parts: one line that names the part, the time, and the file and line."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import physim
from physim import Column, Decision, Decisions, Mode, Rule, Sensed, Simulation, simulate
from physim.errors import ControllerError, Fault, WorldError
from physim.world import World
from physim.world.file import load_world
from tests.analysis.validation.runs import LANE
from tests.helpers import facts, inside, said

CONTROLLER, find_part = inside("physim.parts", "CONTROLLER", "find_part")
STANDARD_COLUMNS, Declared = inside("physim.parts", "STANDARD_COLUMNS", "Declared")

KINDS = {"sensing": "sensing stage", "filters": "filter", "disturbances": "disturbance"}
CALLS = {
    "sensing": "sense(scene, truth, sensed, state)",
    "filters": "filter(scene, sensed, nominal, state)",
    "disturbances": "disturb(scene, truth, filtered, state)",
}


def world(name: str = "three_robots") -> World:
    return load_world(name, overrides=["time.duration=3.0", "expect=null"])


class Answers:
    """A part of any stage; by default it changes nothing."""

    def __init__(self, answer: Callable[[Any], Any] = lambda given: (given, None)) -> None:
        self.answer = answer

    def start(self, scene: Any) -> Any:
        return self.answer(scene) if self.answer is at_start else None

    def sense(self, scene: Any, truth: Any, sensed: Any, state: Any) -> Any:
        return self.answer(sensed)

    def filter(self, scene: Any, sensed: Any, nominal: Any, state: Any) -> Any:
        return self.answer(nominal)

    def disturb(self, scene: Any, truth: Any, filtered: Any, state: Any) -> Any:
        return self.answer(filtered)


def at_start(given: Any) -> Any:
    raise KeyError("lost")


def in_a_step(given: Any) -> Any:
    return {}["lost"]


def leaves(given: Any) -> Any:
    raise SystemExit(3)


class MuteError(Exception):
    def __str__(self) -> str:
        raise RuntimeError("no text")


def mute(given: Any) -> Any:
    raise MuteError


def writes(given: Any) -> Any:
    array = given.pose if isinstance(given, Sensed) else given
    array[0] = 0.0
    return given, None


def failure(name: str = "three_robots", **parts: Any) -> str:
    """What is said of a run of a world with some parts: one line."""
    with pytest.raises(ControllerError) as caught:
        Simulation(world(name), **parts).step()
    assert "\n" not in str(caught.value)
    return str(caught.value)


def line_of(written: Any) -> str:
    """How a message ends that tells where something is written."""
    return f"({__file__}:{inspect.getsourcelines(written)[1]})"


@pytest.mark.parametrize(
    ("answer", "line", "told"),
    [
        (at_start, 1, "KeyError: 'lost'"),
        (in_a_step, 1, "KeyError: 'lost'"),
        (leaves, 1, "SystemExit: 3"),
        (mute, 1, "MuteError"),
        (writes, 2, "ValueError: .*read-only"),
        (lambda given: given, None, r"(Sensed|array).*\(.*, state"),
        (lambda given: None, None, r"\w+ .*None.*\(.*, state\)"),
        (lambda given: ("x", None), None, r" str\b.*(Sensed|\(3, 2)"),
        (lambda given: ([[1.0], [1.0, 2.0]], None), None, r" list .*(Sensed|\(3, 2)"),
    ],
)
@pytest.mark.parametrize("kind", KINDS)
def test_a_stage_that_fails_is_named_with_time_and_line(
    kind: str, answer: Any, line: int | None, told: str
) -> None:
    """The line of the mistake; of what is returned wrongly, that of the method."""
    message = failure(**{kind: [Answers(answer)]})
    assert re.match(f"{KINDS[kind]} Answers at 0 s: .*{told}", message), message
    method = getattr(Answers, CALLS[kind].partition("(")[0])
    code = method.__code__ if line is None else answer.__code__
    assert message.endswith(f"({__file__}:{code.co_firstlineno + (line or 0)})")


class Short:
    """Its methods take other arguments than they are given."""

    def start(self, scene: Any) -> None:
        return None

    def sense(self, scene: Any, sensed: Any, state: Any) -> Any:
        return sensed, state

    filter = disturb = sense

    def decide(self, observation: Any) -> Any:
        return None


def test_a_method_with_other_arguments_is_told_what_it_is_given() -> None:
    for kind, call in CALLS.items():
        message = failure(**{kind: [Short()]})
        assert call in message
        assert message.endswith(line_of(Short.sense))
    message = failure(controller=Short())
    assert "decide(observation, memory)" in message
    assert message.endswith(line_of(Short.decide))


def test_one_part_without_a_list_is_told() -> None:
    for kind in (*KINDS, "observers"):
        with pytest.raises(ControllerError, match=rf"^{kind} must be a list.*Answers.*{kind}=\["):
            simulate(world(), **{kind: Answers()})  # type: ignore[arg-type]


# Values that cannot be used


@pytest.mark.parametrize(
    ("nonsense", "told"),
    [
        ([[1.0, 2.0]], ("(3, 2)",)),
        (np.array([[0.0, 0.0], [0.0, np.inf], [0.0, 0.0]]), ("r2", "omega", "inf rad/s")),
        (np.full((3, 2), np.nan), ("r1", "v", "nan m/s")),
        (np.zeros((3, 2), complex), ()),
        (np.full((3, 2), "0.5"), ()),
        (np.full((3, 2), None), ()),
        (np.ma.zeros((3, 2)), ()),
    ],
)
@pytest.mark.parametrize("kind", ["filters", "disturbances"])
def test_commands_of_no_use_are_refused(kind: str, nonsense: Any, told: Any) -> None:
    message = failure(**{kind: [Answers(lambda given: (nonsense, None))]})
    assert re.search(facts(f"{KINDS[kind]} Answers", "0 s", *told), message), message


TWICE = {
    "robot": np.array([0, 1, 2, 2]), "pose": np.zeros((4, 3)), "command": np.zeros((4, 2)),
    "velocity": np.zeros((4, 3)),
    "reference_station": np.zeros(4), "age": np.zeros(4), "end": np.array([4, 3, 3]),
}  # fmt: skip
"""Rows of which the first robot has two of the third: compiled code counts on one"""


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"pose": np.zeros((2, 3))}, ("pose", "(2, 3)", "(3, 3)")),
        ({"pose": np.full((3, 3), np.nan)}, ("pose", "finite")),
        ({"robot": np.array([0, 1, 1])}, ("r1", "several rows", "r2")),
        ({"end": np.array([3, 1, 3])}, ("r2", "exactly one row of its own")),
        ({"robot": np.array([0.0, 1.0, 2.0])}, ("robot", "float64", "whole numbers")),
        ({"command": [[0.0, 0.0]] * 3}, ("command", "list", "numbers")),
        ({"age": np.ma.zeros(3)}, ("age", "MaskedArray", "numbers")),
        ({"robot": np.zeros((), np.int64)}, ("robot", "shape")),
        ({"step": 7}, ("step", "7", "0", "age")),
        (TWICE, ("r1", "several rows", "r3")),
        ({"robot": np.array([0, 1, 7])}, ("robot", "0 to 2")),
        ({"end": np.array([3, 3, 9])}, ("r3", "9", "3")),
    ],
)
def test_rows_of_no_use_are_refused(change: dict[str, Any], told: tuple[str, ...]) -> None:
    message = failure(sensing=[Answers(lambda sensed: (sensed._replace(**change), None))])
    assert re.search(facts("sensing stage Answers", "0 s", *told), message), message


# Controllers


class Telling:
    modes = (Mode("going", "#112233", "goes"), Mode("waiting", "#445566"))
    rules = (Rule("ahead"),)
    columns = (Column("effort", "J"), *STANDARD_COLUMNS)

    def __init__(self, v: Any = 0.0, hold: Any = 0.1, **told: Any) -> None:
        self.v, self.hold, self.told = v, hold, told

    def decide(self, observation: Any, memory: Any) -> Decision:
        return Decision(v=self.v, omega=0.0, hold=self.hold, **self.told)


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        ({"v": float("nan")}, ("v", "nan m/s")),
        ({"v": 9.0}, ("v", "9 m/s")),
        ({"hold": float("nan")}, ("hold", "nan")),
        ({"hold": -1.0}, ("hold", "-1 s")),
        ({"hold": 10**400}, ("hold", "number")),
        ({"mode": "waitng"}, ("mode", "'waitng'", "going", "waiting")),
        ({"mode": Mode("going", "#000000")}, ("mode", "Mode", "going", "waiting")),
        ({"rule": "ahaed"}, ("rule", "'ahaed'", "ahead")),
        ({"considered": [1.5]}, ("considered", "[1.5]", "list", "index")),
        ({"considered": [0, 9]}, ("considered", "[0, 9]", "0 to 1")),
        ({"considered": [1, 1]}, ("considered", "[1, 1]", "once")),
        ({"considered": [1, 0]}, ("considered is [1, 0]", "itself", "others")),
        ({"report": None}, ("report", "None", "mapping")),
        ({"report": {"efort": 1.0}}, ("report", "'efort'", "effort")),
        ({"report": {"effort": "near"}}, ("report", "effort", "'near'", "number")),
    ],
)
def test_a_decision_of_no_use_names_robot_time_and_field(
    answer: dict[str, Any], told: tuple[str, ...]
) -> None:
    where = ("controller Telling", "slow", "0 s")
    with pytest.raises(ControllerError, match=facts(*where, *told)) as error:
        simulate(physim.parse_world(LANE), controller=Telling(**answer))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("declared", "told"),
    [
        ({"modes": "safe"}, ("modes", "'safe'", "tuple")),
        ({"modes": (Rule("safe"),)}, ("modes.0", "Rule(", "Mode")),
        ({"modes": (Mode("Safe!", "#000000"),)}, ("modes.0.name", "'Safe!'", "a-z0-9_")),
        ({"modes": (Mode("a", "red"),)}, ("modes.0.colour", "'red'", "0-9a-fA-F")),
        ({"rules": (Rule("a"), Rule("a"))}, ("rules", '"a"', "2 times")),
        ({"rules": (Rule("a", "x\x1b[2J"),)}, ("rules.0.words", "plain text")),
        ({"columns": (Column("step"),)}, ("columns", '"step"')),
        ({"columns": (Column("distance", "cm"),)}, ("columns", '"distance"', "'cm'", "'m'")),
    ],
)
def test_declarations_that_cannot_be_are_refused(
    declared: dict[str, Any], told: tuple[str, ...]
) -> None:
    with pytest.raises(ControllerError, match=facts(*told)):
        Declared.of(SimpleNamespace(**declared))


class NoModel:
    Settings = dict

    def decide(self, observation: Any, memory: Any) -> Any: ...


class TwoModes(NoModel):
    modes = (Mode("a", "#000000"), Mode("a", "#000000"))


class Empty:
    pass


class Text:
    def decide(self, observation: Any, memory: Any) -> Any:
        return "forward"


class Together(Text):
    """It answers no number for a command."""

    def decide_all(self, view: Any, due: Any, memory: Any) -> Decisions:
        many = len(due)
        none, counts = np.full(many, -1), np.zeros(many + 1, dtype=np.int64)
        wrong, report = np.full((many, 2), np.nan), np.zeros((many, 0))
        return Decisions(due, wrong, np.full(many, 0.1), none, none, report, counts[:0], counts)


class Few(Together):
    """Its memory has a row too many."""

    def start(self, scene: Any) -> Any:
        return {"count": np.zeros(scene.robots + 1)}


class Remembers(Together):
    """It puts a row into its memory that it did not begin with."""

    def decide_all(self, view: Any, due: Any, memory: Any) -> Decisions:
        memory["waited"] = np.zeros(view.scene.robots)
        return super().decide_all(view, due, memory)


class NoMemories(Text):
    def start(self, scene: Any) -> Any:
        return {"r1": 0}


class OldBatch(Text):
    def batch(self, scene: Any) -> Any:
        return None


def a_function() -> None: ...


@pytest.mark.parametrize(
    ("given", "named"),
    [
        (Together(), Together.decide_all),
        (Few(), Few.start),
        (Remembers(), Remembers.decide_all),
        (NoMemories(), NoMemories.start),
        (OldBatch(), OldBatch),
        (f"{__name__}:a_function", a_function),
        (f"{__name__}:NoModel", NoModel),
        (f"{__name__}:Empty", Empty),
        (TwoModes(), TwoModes),
        (Empty(), Empty),
        (Text, Text),
        (Text(), Text.decide),
    ],
)
def test_a_fault_of_a_class_names_its_line(given: Any, named: Any) -> None:
    assert failure("straight", controller=given).endswith(line_of(named))


def test_a_class_that_is_not_in_its_module_names_the_file() -> None:
    with pytest.raises(ControllerError, match=re.escape(f" ({__file__})") + "$"):
        find_part(CONTROLLER, f"{__name__}:Lost", trusted=True)


# Faults that a part finds in a world


class Picky(Answers):
    def __init__(self, faults: Any) -> None:
        super().__init__()
        self.faults = faults

    def world_faults(self, world: World, where: Any) -> Any:
        return self.faults(where) if callable(self.faults) else self.faults


def test_what_is_no_list_of_faults_is_told() -> None:
    for answer, given in ((None, "None"), (5, "an int"), ("no", "a str"), (["no"], "a list of 1")):
        message = failure(sensing=[Picky(answer)])
        assert f"Picky.world_faults: returned {given}" in message
        assert "Fault(location, message)" in message
        assert message.endswith(line_of(Picky.world_faults))


def test_a_part_may_object_to_a_world_that_was_made_in_python() -> None:
    picky = Picky(lambda where: [Fault((*where, "x"), "not with 3 robots")])
    with pytest.raises(WorldError, match=facts("sensing.stages[1].x", "not with 3 robots")):
        Simulation(world(), sensing=[Answers(), picky])


AWAY = """\
import os, physim
class Away:
    def decide(self, observation, memory):
        os.chdir({folder!r})
        return physim.Decision(v=0.0, omega=0.0, hold=0.1)
"""


def test_code_that_goes_to_another_folder_takes_no_output_along(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Such as to its weights: record and summary are written where the command was given."""
    for folder in ("model", "work"):
        (tmp_path / folder).mkdir()
    (tmp_path / "model" / "away.py").write_text(AWAY.format(folder=str(tmp_path / "model")))
    monkeypatch.chdir(tmp_path / "work")
    monkeypatch.syspath_prepend(tmp_path / "model")
    done = said(
        "run", "straight", "--controller", "away:Away", "-o", "out", "--no-video", "--quiet",
        "--set", "time.duration=0.2", "--set", "expect=null",
    )  # fmt: skip
    assert done.code == 0, done.err
    assert (tmp_path / "work" / "out" / "record.h5").is_file()
    assert {one.suffix for one in (tmp_path / "model").iterdir()} <= {".py", ""}
