"""Controllers and stages that a world names are checked like its own keys when it is read."""

from __future__ import annotations

import importlib
import json

import pytest
from jsonschema import Draft7Validator

from physim.errors import ControllerError, WorldError
from physim.parts import registry
from physim.parts.registry import CONTROLLER, FILTER, find_part, part_names
from physim.world import Choice
from physim.world.checks import check_world
from physim.world.file import parse_world
from physim.world.file.schema import shipped_schema_text, world_schema
from tests.worlds_by_hand import STRAIGHT

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
    assert faults(text + "arrival: {gian: 1}\n") == [
        '4:20: sensing.stages[0].sdd: unknown key; allowed: sd; did you mean "sd"?',
        "5:24: sensing.stages[1].sd: must be at least 0; given -1",
        '7:26: filters[0].margin: must be a number; given "far"',
        "7:42: filters[0].names[1]: must be a text; given 1; put it in quotes to make it a text",
        '8:23: disturbances[0].type: no disturbance is called "gain"; registered: gains; did you '
        'mean "gains"?',
        "9:11: arrival.gian: unknown key; allowed: tolerance",
    ]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("side=up", 'must be left or right; given "up"'),
        ("side=rigth", 'must be left or right; given "rigth"; did you mean "right"?'),
        ("gear=3", "must be 1 or 2; given 3"),
    ],
)
def test_a_setting_of_a_few_words_names_those_alone(change: str, told: str) -> None:
    (line,) = faults(STAGES, overrides=[f"disturbances.0.{change}"])
    assert line.endswith(told)


def test_a_filter_that_no_world_has_is_told_how_to_be_given() -> None:
    for key, whole in (("filters", "filters"), ("sensing.stages", "sensing.stages")):
        with pytest.raises(WorldError) as caught:
            parse_world(STRAIGHT, "w", overrides=[f"{key}.0.margin=3"])
        line = str(caught.value)
        assert f"the world has no {whole}" in line
        assert f"{whole}=[{{type: NAME" in line
        assert f"--set {key}.0.margin" in line


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("filters: [{typ: slow}]", 'did you mean "type"'),
        ("disturbances: [{margin: 1, Type: gains}]", 'did you mean "type"'),
    ],
)
def test_a_misspelt_type_is_told(text: str, said: str) -> None:
    (line,) = faults(text + "\n")
    assert ".type: missing" in line
    assert said in line


def test_an_unknown_name_says_how_one_is_registered_or_what_else_it_is() -> None:
    (line,) = faults("filters: [{type: xyz}]\n")
    assert '"physim.filters"' in line
    assert "pip install" in line
    (line,) = faults("filters: [{type: haze}]\n")
    assert '"haze" is a sensing stage' in line
    assert "sensing.stages" in line


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("filters: slow",
         '1:10: filters: must be a list, as [{type: NAME, KEY: VALUE}]; given "slow"'),
        ("filters: {type: slow}",
         "1:10: filters: must be a list, as [{type: NAME, KEY: VALUE}]; given a mapping"),
        ("filters: [slow]",
         '1:11: filters[0]: must be a mapping of type and settings, as {type: slow}; given "slow"'),
        ("filters: [[slow]]",
         "1:11: filters[0]: must be a mapping of type and settings, as {type: NAME}; given a list "
         "of 1"),
        ("filters: [{margin: 1.0}]",
         "1:11: filters[0].type: missing; needed: name under which it is registered"),
        ("filters: [{type: 5}]", "1:18: filters[0].type: must be a text; given 5; put it in quotes "
         "to make it a text"),
        ("filters: [{type: slow}]", "1:11: filters[0].margin: missing; needed: [m] kept"),
        ("filters: [{type: slow, margin: 1e3}]",
         "1:32: filters[0].margin: 1e3 is a text to many YAML readers; write 1.0e+3 or 1000"),
        ("filters: [{type: broken}]", '1:18: filters[0].type: filter "broken": no module '
         '"no_such_module_here" in the current folder or on the Python path'),
        ("sensing: haze", '1:10: sensing: must be a mapping of keys to values; given "haze"'),
        ("sensing: {stages: haze}", "1:19: sensing.stages: must be a list, as "
         '[{type: NAME, KEY: VALUE}]; given "haze"'),
        ("sensing: {rnage: 3}",
         '1:11: sensing.rnage: unknown key; allowed: range, stages; did you mean "range"?'),
        ("disturbances: [{type: gains, gains: [1]}]",
         "1:37: disturbances[0].gains: 1 gains for 2 robots"),
    ],
)  # fmt: skip
def test_each_mistake_is_one_clear_line(text: str, told: str) -> None:
    assert faults(text + "\n") == [told]


def test_many_stages_are_one_fault() -> None:
    (line,) = faults(f"filters: [{', '.join(['{type: slow, margin: 1}'] * 21)}]\n")
    assert "at most 20" in line


@pytest.mark.parametrize(
    ("text", "advice"),
    [
        ("filters: [{type: 'os:system'}]\n", 'entry point in the group "physim.filters"'),
        ("sensing: {stages: [{type: 'os:system'}]}\n", '"physim.sensing"'),
        ("disturbances: [{type: 'os:system'}]\n", '"physim.disturbances"'),
    ],
)
def test_a_world_cannot_name_a_class(text: str, advice: str) -> None:
    (line,) = faults(text, controller="plain", overrides=["controller={type: plain}"])
    assert "names a class; a world may name registered" in line
    assert advice in line


def test_overrides_reach_into_stages_and_are_checked() -> None:
    changed = ["filters.0.margin=3", "sensing.stages.1={type: haze, sd: 1}", "disturbances=null"]
    world = parse_world(STRAIGHT + STAGES, overrides=changed)
    assert world.filters[0].settings["margin"] == 3
    assert world.sensing.stages[1].settings == {"sd": 1}
    assert world.disturbances == ()
    assert parse_world(STRAIGHT, overrides=["filters=[{type: slow, margin: 1}]"]).filters
    for override, told in (
        (
            "filters.0.margin=-3",
            "--set filters.0.margin: filters[0].margin: must be greater than 0",
        ),
        ("filters.0.magrin=3", '"margin"?'),
        ("filters.0.margin=null", "filters[0].margin: missing"),
        ("filters.1.margin=3", "filters: there is no entry 1; this list has entries 0 to 0"),
        ("filters.0.type=null", "this one is needed: name under which it is registered"),
        ("filters.0.type=slwo", 'did you mean "slow"?'),
        ("sensing.stages.0.sd=x", "--set sensing.stages.0.sd: sensing.stages[0].sd: must be a num"),
    ):
        (line,) = faults(STAGES, overrides=[override])
        assert told in line


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


def test_check_tells_what_parts_doubt(tmp_path) -> None:
    (tmp_path / "w.yaml").write_text(STRAIGHT + STAGES)
    found = check_world(tmp_path / "w.yaml", overrides=["disturbances.0.gains=[1, 3]"])
    assert found.ok
    told = {finding.key: finding.message for finding in found.warnings}
    assert told["disturbances[0].gains[1]"] == "3 is a lot"
    usual = check_world(tmp_path / "w.yaml")
    assert "disturbances[0].gains[1]" not in {finding.key for finding in usual.warnings}


def test_schema_shows_registered_parts_with_their_settings() -> None:
    schema = world_schema()
    Draft7Validator.check_schema(schema)
    validator = Draft7Validator(schema["properties"]["filters"])
    assert validator.is_valid([{"type": "slow", "margin": 1.0}, {"type": "broken", "x": 1}])
    assert not validator.is_valid([{"type": "slow", "magrin": 1.0}])
    assert not validator.is_valid([{"type": "slow", "margin": 0.0}])
    assert not validator.is_valid([{"type": "haze"}])
    assert not validator.is_valid([{"margin": 1.0}])
    text = json.dumps(schema["properties"]["sensing"])
    assert "[m] how much. Default: 0.1" in text
    assert "haze" not in shipped_schema_text()


def test_a_name_that_two_packages_register_is_told_not_guessed(monkeypatch) -> None:
    twice = {"slow": ("a_package:Slow", "b_package:Slow")}
    monkeypatch.setattr(registry, "_entries", lambda kind: twice)
    with pytest.raises(ControllerError, match="several packages, as a_package:Slow, b_package:Sl"):
        find_part(FILTER, "slow")
    assert "several packages" in part_names(CONTROLLER)["slow"]
