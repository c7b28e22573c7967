"""`check_controller` finds what is broken, by the rule that is, and nothing else."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import physim
from physim import ControllerError, PhysimError, WorldError, load_world
from physim.testing import Finding, Rule, check_controller, situations
from tests.helpers import check_error, facts, inside
from tests.testing import broken

candidate, check_worlds = inside("physim.testing", "candidate", "check_worlds")

SHORT = 0.5
"""[s]"""


def found_on_straight(controller: Any) -> tuple[Finding, ...]:
    """Findings in the smallest world alone: two robots, r1 and r2."""
    part = next(check_worlds(candidate(controller, None), ["straight"], SHORT))
    assert part.world == "straight"
    assert part.decisions == 10
    return part.findings


def only(controller: Any, rule: Rule, robot: str = "r1", time: float = 0.0) -> str:
    """Text of the one finding, which is of this rule and first seen at this decision."""
    (finding,) = found_on_straight(controller)
    assert (finding.rule, finding.world) == (rule, "straight")
    assert (finding.robot, round(finding.time, 6)) == (robot, time)
    assert str(finding).startswith(f"{rule}: straight, {robot} at {time:g} s: {finding.text}")
    assert "\n" not in str(finding)
    file, line = re.search(r"\(([^() ]+\.py):(\d+)\)", str(finding)).groups()
    assert file in (broken.__file__, __file__)
    assert bool(finding.place) != (".py:" in finding.text)
    assert 0 < int(line) <= len(Path(file).read_text().splitlines())
    if finding.place:
        assert finding.place == f"{file}:{line}"
        assert "def decide" in Path(file).read_text().splitlines()[int(line) - 1]
    return finding.text


def check_difference(text: str, field: str, *values: str) -> None:
    """The text names the field and, after it, the values in this order."""
    whole = [rf"(?<![\w.]){re.escape(part)}(?![\w\[]|\.\w)" for part in (field, *values)]
    assert re.search(".*?".join(whole), text), f"{field}: {', '.join(values)}: {text}"


@pytest.mark.parametrize(
    "controller",
    [
        broken.Sound,
        broken.WorksOutOnce,
        broken.Twofold,
        broken.Choosy,
        broken.Together,
        broken.Nearly,
        broken.CountsTogether,
    ],
)
def test_sound_controllers_have_no_finding(controller: type) -> None:
    assert check_controller(controller, worlds=["straight", "merging"], seconds=SHORT) == []


@pytest.mark.parametrize(
    ("controller", "situation", "error"),
    [
        (broken.NeedsOthers, "nobody in sight", "ValueError"),
        (broken.NeedsAWayOn, "at the end of the path", "ZeroDivisionError"),
    ],
)
def test_what_fails_in_a_situation(controller: type, situation: str, error: str) -> None:
    assert found_on_straight(controller) == ()
    found = check_controller(controller, worlds=[], seconds=SHORT)
    assert {finding.rule for finding in found} == {Rule.RAISES}
    (finding,) = (one for one in found if one.world == situation)
    assert finding.text.startswith(error)
    others = {finding.world for finding in found} - {situation}
    assert others <= ({"no wall in sight"} if controller is broken.NeedsOthers else set())


@pytest.mark.parametrize("what", broken.UNFIT)
def test_what_a_run_would_refuse(what: str) -> None:
    controller = broken.Says(broken.UNFIT[what])
    text = only(controller, Rule.DECISION)
    with pytest.raises(ControllerError) as refused:
        physim.Simulation(load_world("straight"), controller=controller).step()
    told, _, place = str(refused.value).rpartition(" (")
    assert told.endswith(f"r1 at 0 s: {text.removesuffix(' (and 9 more)')}")
    assert place.startswith(f"{broken.__file__}:")


ONE_RULE = [
    (broken.RaisesLate, Rule.RAISES, "r1", 0.3, ("KeyError: 'four'", "3 more"), ()),
    (broken.Throws, Rule.REPEATS, "r1", 0.0, ("same observation", "memory", "v"), ()),
    (broken.RemembersAtRandom, Rule.REPEATS, "r1", 0.0, ("memory['drawn']",), ()),
    *((one, Rule.STATE, "r1", 0.0, ("in its memory", place), ())
      for one, place in broken.STATE.items()),
    (broken.FirstComeFirstServed, Rule.ORDER, "r2", 0.0, ("reverse order",), ("v", "0.75", "0.0")),
    (broken.LooksAround, Rule.ORDER, "r1", 0.2, ("alone",), ("v", "0.5", "0.375")),
    (broken.WritesItsMemory, Rule.MEMORY, "r1", 0.1, (), ("memory['count']", "1", "2")),
    (broken.CannotBePickled, Rule.COPIES, "r1", 0.1, ("cannot be pickled:",), ()),
    (broken.LosesItsMemory, Rule.COPIES, "r1", 0.1, ("pickled", "unpickled", "v", "0.75"), ()),
    (broken.BendsThePath, Rule.OBSERVATION, "r1", 0.0, (),
     ("observation.path.lines.row[1, 0]", "30.0", "31.0")),
    (broken.OverridesTheFreeze, Rule.OBSERVATION, "r1", 0.0, (), ("observation.v", "0.0", "0.3")),
    *((broken.Twofold(one), Rule.FORMS, robot, time, (), values)
      for one, (robot, time, values) in broken.FORMS.items()),
    *((broken.Together(one), Rule.RAISES if one is broken.fails else Rule.DECISION, "r1", 0.0, (),
       ()) for one in (broken.says_nothing, broken.fails)),
    (broken.Slower, Rule.FORMS, "r1", 0.0, ("decide_all", "v", "0.0"), ()),
    (broken.FirstRobotGoes, Rule.PORTIONS, "r2", 0.0, ("robot by robot",), ("v", "0.75", "0.0")),
    (broken.Together(broken.first_row_goes), Rule.PORTIONS, "r2", 0.0, ("alone",), ()),
    (broken.Twofold(broken.moves_the_robots), Rule.OBSERVATION, "r1", 0.0,
     ("decide_all", "sensed"), ()),
]  # fmt: skip


@pytest.mark.parametrize(("controller", "rule", "robot", "time", "parts", "values"), ONE_RULE)
def test_what_breaks_one_rule_is_told_by_it(
    controller: Any, rule: Rule, robot: str, time: float, parts: Any, values: Any
) -> None:
    text = only(controller, rule, robot, time)
    assert all(part in text for part in parts), text
    if values:
        check_difference(text, *values)


def test_every_finding_is_returned_and_told_as_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    found = check_controller(broken.CountsOnItself, worlds=["straight", "merging"], seconds=0.1)
    told = capsys.readouterr().out.splitlines()
    assert told == [str(finding) for finding in found]
    assert [finding.world for finding in found] == ["straight", "merging", *situations()]
    lines: list[str] = []
    check_controller(broken.CountsOnItself, worlds=["straight"], seconds=0.1, report=lines.append)
    assert lines == [line for line in told if ": merging," not in line]
    assert capsys.readouterr().out == ""


def test_worlds_whose_robots_are_refused_are_told_and_left_out() -> None:
    lines: list[str] = []
    worlds = [load_world("straight"), "merging"]
    choosy = broken.Choosy("m1", "m2")
    assert check_controller(choosy, worlds=worlds, seconds=0.1, report=lines.append) == []
    (line,) = lines
    check_error(f"{line}\n", "skipped: merging: robots[0].name:", "m1", "1 more")
    with pytest.raises(ControllerError, match=facts("Choosy", "none", "1 world")):
        check_controller(choosy, worlds="merging", report=lines.append)


def test_settings_are_checked_as_in_a_world() -> None:
    told: list[str] = []
    worlds: Any = {"worlds": ["straight"], "seconds": 0.1, "report": told.append}
    assert check_controller(broken.Adjustable, settings={"share": 0.9}, **worlds) == []
    fast = check_controller(broken.Adjustable, settings={"share": 1.5}, **worlds)
    assert {finding.rule for finding in fast} == {Rule.DECISION}
    for key, given, *parts in (("shares", 1, "unknown"), ("share", "1", "number", '"1"')):
        with pytest.raises(WorldError, match=facts(f"controller.{key}:", *parts)):
            check_controller(broken.Adjustable, settings={key: given}, **worlds)
    with pytest.raises(ControllerError, match=facts("settings", "class", "name")):
        check_controller(broken.Sound(), settings={}, **worlds)
    world = load_world("straight", overrides=["controller.look_ahead=3.5"])
    chosen = candidate("mode_switching", None)
    assert chosen.maker(world)().settings.look_ahead == 3.5
    assert chosen.maker()().settings.look_ahead == 2.0


def test_the_object_given_is_never_asked() -> None:
    given = broken.CountsOnItself()
    assert check_controller(given, worlds=["straight"], seconds=0.1, report=str)
    assert given.count == 0


@pytest.mark.parametrize("given", ["nosuch", "tests.testing.broken:UNFIT", object, object()])
def test_what_is_no_controller(given: Any) -> None:
    with pytest.raises(ControllerError):
        check_controller(given)


@pytest.mark.parametrize("seconds", [0.0, float("nan")])
def test_seconds_are_a_time(seconds: float) -> None:
    with pytest.raises(PhysimError, match=facts("time", "greater than 0 s")):
        check_controller("constant", seconds=seconds)


def test_a_situation_is_what_its_name_says() -> None:
    seen = {
        name: [physim.Simulation(scene, controller="constant").observe(i) for i in range(3)]
        for name, scene in situations().items()
        if scene.robots == 3
    }
    assert set(situations()) == {*seen, "nobody in sight"}
    alone = physim.Simulation(situations()["nobody in sight"], controller="constant")
    assert all(alone.observe(i).others == () != alone.observe(i).walls for i in range(2))
    assert all(o.walls == () for o in seen["no wall in sight"])
    assert [len(o.others) for o in seen["no wall in sight"]] == [1, 1, 0]
    at, past, before = seen["at the end of the path"]
    assert at.station == at.path.length == past.station
    assert before.stop_station - 1.0 < before.station < before.stop_station
    assert all(abs(o.pose[2]) > 1.5 for o in seen["facing backwards"])
    simulation = physim.Simulation(situations()["overlapping"], controller="constant")
    simulation.step()
    names = [body.name for body in simulation.scene.bodies]
    touching = {(names[row["a"]], names[row["b"]]) for row in simulation.contacts}
    assert {("a", "b")} | {("in_wall", "left wall")} == touching
