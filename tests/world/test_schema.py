"""The schema that editors read says what the models say."""

from __future__ import annotations

import json
from copy import deepcopy

import pytest
import yaml
from hypothesis import given
from jsonschema import Draft202012Validator

from physim.errors import WorldError
from physim.world import World
from physim.world.file import parse_world
from tests.cli.commands import physim
from tests.helpers import check_error, examples, inside
from tests.world.strategies import worlds

CONTROLLER, find_part = inside("physim.parts", "CONTROLLER", "find_part")
settings_model, shipped_parts = inside("physim.parts", "settings_model", "shipped_parts")
shipped_folder, shipped_worlds = inside("physim.world.file", "shipped_folder", "shipped_worlds")
FILE, schema_text = inside("physim.world.file", "FILE", "schema_text")

SHIPPED = json.loads((shipped_folder() / FILE).read_text(encoding="utf-8"))
VALIDATOR = Draft202012Validator(SHIPPED)

FULL = """\
name: full
description: every key there is
seed: 1
time: {step: 0.01, duration: 1.0, record_every: 2}
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0, end_margin: 2.0}
reference_path: [[0, 0], [30, 0]]
start: {region: [[1, 1], [9, 1], [9, 3]], heading: along, min_gap: 0.2, abreast: 2, spread: 1.0}
robots:
  - name: r1
    footprint: {length: 1.8, width: 1.0}
    pose: [15.0, 0.0, random]
    path: {offset: 0.0}
    limits: {v: 1.0, omega: 1.6}
    mass: 90.0
    speeds: [0.0, 1.0]
    omegas: [-1.0, 0.0, 1.0]
    drive: unicycle
  - name: r2
    footprint: [[0.9, 0.0], [-0.5, 0.5], [-0.5, -0.5]]
    start: {region: [[1, -1], [9, -1], [9, -3]]}
    path: [[0, 0], [30, 0]]
    controller: {type: constant, v: 0.3}
  - count: 2
    name: "s{number}"
    footprints: [{length: 1.0, width: 0.5}, [[0.5, 0.0], [-0.5, 0.5], [-0.5, -0.5]]]
    paths: [{offset: 1.0}, [[0, 0], [30, 0]]]
    mass: 90.0
    speeds: [0.0, 1.0]
    omegas: [-1.0, 0.0, 1.0]
    drive: unicycle
  - count: 1
    footprint: {length: 1.0, width: 0.5}
    start: {region: [[1, -1], [9, -1], [9, -3]]}
    path: {offset: 1.0}
    limits: {v: 1.0, omega: 1.6}
    controller: {type: mode_switching, look_ahead: 3.0}
formation:
  {gain: 0.1, speed: 1.0, limits: [0.8, 1.3], spacing: initial, range: 9.0, neighbours: all}
controller: {type: mode_switching, look_ahead: 2.0}
sensing: {range: 9.0, stages: []}
filters: []
disturbances: []
arrival: {tolerance: 0.2}
obstacles: [[[20, 2], [21, 2], [21, 3]], {corners: [[22, 2], [23, 2], [23, 3]], mass: 20}]
movers:
  - name: cart
    footprint: {length: 1.0, width: 0.5}
    waypoints: [[5, 1], [5, 2]]
    times: [0, 2]
    repeat: once
  - {name: door, footprint: {length: 1.0, width: 0.5}, waypoints: [[8, 1, 0], [9, 1, 1]], speed: 1}
expect:
  contacts: 0
  min_distance: 0.1
  min_boundary_distance: 0.1
  max_distance: 30.0
  finished: true
physics: {friction: 0.1, elasticity: 0.1}
"""
DRAWN = """\
name: drawn
time: {step: 0.01, duration: 1.0}
corridor:
  random:
    {length: 90.0, bends: [1, 2], turns: [0.3, 1.0], radii: [8.0, 9.0], width: [5.0, 8.0],
     clutter: 5.0, sizes: [0.5, 1.0], shapes: [box, bar, round, triangle], passage: 3.0, ends: 9.0}
  end_margin: 2.0
robots:
  - {name: a, footprint: {length: 1.0, width: 0.5}, pose: [1.0, 0.0, 0.0], path: {offset: 0.0}}
"""


def test_the_shipped_file_is_made_from_the_models() -> None:
    """Else: ``physim schema -o worlds/world.schema.json --force``."""
    text = (shipped_folder() / FILE).read_text(encoding="utf-8")
    assert text == schema_text(shipped_parts)
    Draft202012Validator.check_schema(SHIPPED)


@pytest.mark.parametrize("name", shipped_worlds())
def test_every_shipped_world_fits_and_names_the_schema(name: str) -> None:
    text = (shipped_folder() / f"{name}.yaml").read_text(encoding="utf-8")
    assert text.startswith(f"# yaml-language-server: $schema={FILE}\n")
    assert list(VALIDATOR.iter_errors(yaml.safe_load(text))) == []


@examples(25, deep=100)
@given(worlds())
def test_whatever_the_model_takes_the_schema_takes(world) -> None:
    values = yaml.safe_load(world.to_yaml())
    values["controller"] = {"type": "mode_switching"}
    values.get("sensing", {}).pop("stages", None)  # whatever is registered, nothing is shipped
    values.pop("filters", None)
    values.pop("disturbances", None)
    assert list(VALIDATOR.iter_errors(values)) == []


def mappings(value, path=()):
    """Every mapping of a tree, by its path."""
    if isinstance(value, dict):
        yield path
    pairs = value.items() if isinstance(value, dict) else enumerate(value)
    for key, item in pairs:
        if isinstance(item, dict | list):
            yield from mappings(item, (*path, key))


def at(value, path):
    for key in path:
        value = value[key]
    return value


def keys(model: str) -> set[str]:
    return set(SHIPPED["$defs"][model]["properties"])


def test_full_world_holds_every_key_of_every_model() -> None:
    values = yaml.safe_load(FULL)
    assert parse_world(FULL).name == "full"
    assert list(VALIDATOR.iter_errors(values)) == []
    assert set(World.model_fields) - {"boundaries"} == set(values)
    for name, robots in (
        ("Robot", [robot for robot in values["robots"] if "count" not in robot]),
        ("RobotGroup", [robot for robot in values["robots"] if "count" in robot]),
    ):
        assert keys(name) == {key for robot in robots for key in robot}
    assert keys("Mover") == {key for mover in values["movers"] for key in mover}
    assert keys("Obstacle") == set(values["obstacles"][1])
    for key in ("time", "start", "formation", "physics", "sensing", "arrival", "corridor"):
        assert keys(key.title()) == set(values[key])
    assert keys("Expectation") == set(values["expect"])
    random = yaml.safe_load(DRAWN)["corridor"]
    assert list(VALIDATOR.iter_errors(yaml.safe_load(DRAWN))) == []
    assert parse_world(DRAWN).is_road_random
    assert keys("RandomCorridor") == set(random)
    assert keys("RandomRoad") == set(random["random"])


@pytest.mark.parametrize(("text", "least"), [(FULL, 50), (DRAWN, 20)], ids=["full", "drawn"])
def test_every_typo_in_a_key_is_refused_by_schema_and_model_alike(text: str, least: int) -> None:
    values = yaml.safe_load(text)
    tried = 0
    for path in list(mappings(values)):
        for key in list(at(values, path)):
            broken = deepcopy(values)
            holder = at(broken, path)
            holder[f"{key[0]}x{key[1:]}"] = holder.pop(key)
            assert not VALIDATOR.is_valid(broken), (path, key)
            with pytest.raises(WorldError):
                parse_world(json.dumps(broken))
            tried += 1
    assert tried > least


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("time", "step"), 0),
        (("time", "step"), "0.01"),
        (("time", "record_every"), 1.5),
        (("seed",), -1),
        (("name",), ""),
        (("corridor", "width"), -1.0),
        (("corridor", "width"), [8.0]),
        (("corridor", "centreline"), [[0, 0]]),
        (("corridor", "centreline"), [[0, 0], [1, 2, 3]]),
        (("robots",), []),
        (("robots", 0, "pose"), [1, 2]),
        (("robots", 0, "pose"), [1, 2, "rndom"]),
        (("robots", 1, "footprint"), [[0, 0], [1, 1]]),
        (("start", "heading"), "alnog"),
        (("start", "min_gap"), -0.1),
        (("formation", "gain"), -1),
        (("formation", "spacing"), "inital"),
        (("formation", "limits"), [0.8]),
        (("controller", "type"), "mode_swiching"),
        (("controller", "look_ahead"), 0),
        (("expect", "finished"), "yes"),
        (("physics", "elasticity"), 2),
    ],
)  # fmt: skip
def test_wrong_values_are_refused_by_schema_and_model_alike(path, value) -> None:
    values = yaml.safe_load(FULL)
    at(values, path[:-1])[path[-1]] = value
    assert not VALIDATOR.is_valid(values)
    with pytest.raises(WorldError):
        parse_world(json.dumps(values))


def test_keys_of_each_controller_are_its_own() -> None:
    def fits(**controller) -> bool:
        return VALIDATOR.is_valid({**yaml.safe_load(FULL), "controller": controller})

    assert fits()
    assert fits(beta=0.3)
    assert fits(type="mode_switching", beta=0.3)
    assert not fits(type="path_following", beta=0.3)
    assert fits(type="constant", commands=[[1.0, 0.2]])
    assert not fits(type="constant", commands=[[1.0]])
    assert not fits(commands=[[1.0, 0.2]])
    text = json.dumps(SHIPPED["$defs"]["ControllerChoice"])
    assert len(shipped_parts(CONTROLLER)) >= 3
    for name in shipped_parts(CONTROLLER):
        model = settings_model(find_part(CONTROLLER, name))
        for field in model.model_fields.values() if model else ():
            assert json.dumps(field.description)[1:-1] in text


def test_command_prints_it_and_writes_it_where_asked(tmp_path, capsys) -> None:
    done = physim("schema", capture=capsys)
    assert (done.code, done.out) == (0, schema_text())
    file = tmp_path / "s.json"
    assert physim("schema", "-o", file, capture=capsys).code == 0
    assert file.read_text() == done.out
    refused = physim("schema", "-o", file, capture=capsys)
    assert refused.code == 2
    check_error(refused.err, f"{file}:", "--force", "-o")
    assert physim("schema", "-o", file, "--force", capture=capsys).code == 0
    assert physim("schema", "-o", tmp_path, capture=capsys).code == 2
