"""Controllers and stages that a world names are checked like its own keys when it is read."""

from __future__ import annotations

import importlib
import sys

import pytest

from physim.errors import ControllerError, WorldError
from physim.world import Choice
from physim.world.file import parse_world
from tests.helpers import STRAIGHT, check_error, facts, inside

CONTROLLER, FILTER, find_part = inside("physim.parts", "CONTROLLER", "FILTER", "find_part")
part_names = inside("physim.parts", "part_names")
REGISTRY = sys.modules[find_part.__module__]
LINES = len(STRAIGHT.splitlines())
STAGES = """\
sensing:
  range: 8.0  # [m]
  stages:
    - {type: haze, sd: 0.2}
    - {type: haze}
filters:
  - {type: slow, margin: 2, names: [a, b]}
disturbances: [{type: gains, gains: [0.9, 1]}]
"""


def faults(text: str, **options) -> list[str]:
    """Faults of the world with ``text`` after it; lines count from those of ``text``."""
    with pytest.raises(WorldError) as caught:
        parse_world(STRAIGHT + text, "w", **options)
    lines = str(caught.value).splitlines()
    return [
        line.replace(f"w:{p.line}:", f"{p.line - LINES}:", 1)
        for line, p in zip(lines, caught.value.positions, strict=True)
    ]


def test_stages_are_read_and_written_back_equal() -> None:
    world = parse_world(STRAIGHT + STAGES)
    assert world.sensing.range == 8.0
    assert world.sensing_range == 8.0
    assert world.sensing.stages == (Choice(type="haze", settings={"sd": 0.2}), Choice(type="haze"))
    assert world.filters[0].settings == {"margin": 2, "names": ("a", "b")}
    assert world.disturbances[0].settings["gains"] == (0.9, 1)
    assert parse_world(world.to_yaml()) == world
    assert "sensing" not in parse_world(STRAIGHT).to_yaml()


def test_every_fault_of_every_part_comes_at_once_with_its_place() -> None:
    text = STAGES.replace("sd: 0.2", "sdd: 0.2").replace("{type: haze}", "{type: haze, sd: -1}")
    text = text.replace("margin: 2", "margin: far").replace("[a, b]", "[a, 1]")
    text = text.replace("gains, gains", "gain, gains")
    expected = [
        ("4:20: sensing.stages[0].sdd:", "unknown", "allowed: type, sd", '"sd"'),
        ("5:24: sensing.stages[1].sd:", "at least 0", "given -1"),
        ("7:26: filters[0].margin:", "number", '"far"'),
        ("7:42: filters[0].names[1]:", "text", "given 1", "quotes"),
        ("8:23: disturbances[0].type:", "disturbance", '"gain"', "registered: gains", '"gains"'),
    ]
    for line, (place, *parts) in zip(faults(text), expected, strict=True):
        check_error(f"{line}\n", place, *parts)


@pytest.mark.parametrize(
    ("text", "place", "parts"),
    [
        ("filters: slow", "1:10: filters:", ("list", "[{type: NAME, KEY: VALUE}]", '"slow"')),
        ("filters: {type: slow}", "1:10: filters:",
         ("list", "[{type: NAME, KEY: VALUE}]", "given a mapping")),
        ("filters: [slow]", "1:11: filters[0]:", ("mapping", "{type: NAME}", '"slow"')),
        ("filters: [[slow]]", "1:11: filters[0]:", ("mapping", "{type: NAME}", "list of 1")),
        ("filters: [{margin: 1.0}]", "1:11: filters[0].type:", ("missing", "name", "registered")),
        ("filters: [{type: 5}]", "1:18: filters[0].type:", ("text", "given 5", "quotes")),
        ("filters: [{type: slow}]", "1:11: filters[0].margin:", ("missing", "[m] kept")),
        ("filters: [{type: slow, margin: 1e3}]", "1:32: filters[0].margin:",
         ("1e3", "text", "1.0e+3", "1000")),
        ("filters: [{type: broken}]", "1:18: filters[0].type:",
         ('"broken"', '"no_such_module_here"', "current folder", "Python path")),
        ("sensing: haze", "1:10: sensing:", ("mapping", '"haze"')),
        ("sensing: {stages: haze}", "1:19: sensing.stages:",
         ("list", "[{type: NAME, KEY: VALUE}]", '"haze"')),
        ("sensing: {rnage: 3}", "1:11: sensing.rnage:", ("unknown", "range, stages", '"range"')),
        ("disturbances: [{type: gains, gains: [1]}]", "1:37: disturbances[0].gains:",
         ("1 gains", "2 robots")),
    ],
)  # fmt: skip
def test_each_mistake_is_one_clear_line(text: str, place: str, parts: tuple[str, ...]) -> None:
    (line,) = faults(text + "\n")
    check_error(f"{line}\n", place, *parts)


def test_overrides_reach_into_stages_and_are_checked() -> None:
    changed = ["filters.0.margin=3", "sensing.stages.1={type: haze, sd: 1}", "disturbances=null"]
    world = parse_world(STRAIGHT + STAGES, overrides=changed)
    assert world.filters[0].settings["margin"] == 3
    assert world.sensing.stages[1].settings == {"sd": 1}
    assert world.disturbances == ()
    assert parse_world(STRAIGHT, overrides=["filters=[{type: slow, margin: 1}]"]).filters
    for override, key, *parts in (
        ("filters.0.margin=-3", "filters[0].margin:", "greater than 0", "given -3"),
        ("filters.0.magrin=3", "filters[0].magrin:", '"margin"'),
        ("filters.0.margin=null", "filters[0].margin:", "missing", "[m]"),
        ("filters.1.margin=3", "filters:", "no entry 1", "0 to 0"),
        ("filters.0.type=null", "filters[0].type:", "needed", "registered"),
        ("filters.0.type=slwo", "filters[0].type:", '"slwo"', '"slow"'),
        ("sensing.stages.0.sd=x", "sensing.stages[0].sd:", "number", '"x"'),
    ):
        (line,) = faults(STAGES, overrides=[override])
        check_error(f"{line}\n", f"--set {override.split('=')[0]}: {key}", *parts)


def test_nothing_is_imported_for_a_world_that_is_only_to_be_read(monkeypatch) -> None:
    def imported(name: str) -> None:
        raise AssertionError(f"imports {name}")

    monkeypatch.setattr(importlib, "import_module", imported)
    assert parse_world(STRAIGHT + STAGES, check_controller=False).filters[0].type == "slow"
    with pytest.raises(WorldError, match="imports tests") as caught:
        parse_world(STRAIGHT + STAGES)
    assert len(caught.value.faults) == 5
    odd = STAGES.replace("type: ", "type: evil:").replace("sd:", "ds:")
    assert parse_world(STRAIGHT + odd, check_controller=False).sensing.stages[0].settings["ds"]


def test_a_name_that_two_packages_register_is_told_not_guessed(monkeypatch) -> None:
    twice = {"slow": ("a_package:Slow", "b_package:Slow")}
    monkeypatch.setattr(REGISTRY, "registered", lambda group: twice)
    with pytest.raises(ControllerError, match=facts("slow", "a_package:Slow", "b_package:Slow")):
        find_part(FILTER, "slow")
    assert "several packages" in part_names(CONTROLLER)["slow"]
