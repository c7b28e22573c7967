from __future__ import annotations

import pytest

from physim.errors import WorldError
from physim.world import Limits
from physim.world.file import apply_overrides, parse_world, read_document
from tests.worlds_by_hand import STRAIGHT


def message(*overrides: str) -> str:
    with pytest.raises(WorldError) as caught:
        parse_world(STRAIGHT, "w.yaml", overrides=overrides)
    return str(caught.value)


def test_values_are_replaced_and_made():
    world = parse_world(
        STRAIGHT,
        overrides=[
            "time.step=0.02",
            "robots.1.pose=[4, -1, 0.5]",
            "robots[0].limits.v=1.2",
            "controller.look_ahead=3",
            "name=a=b",
            "expect={finished: true}",
            "physics.friction=0.5",
            "physics.elasticity=0.25",
        ],
    )
    assert world.time.step == 0.02
    assert world.robots[1].pose == (4.0, -1.0, 0.5)
    assert world.robots[0].limits.v == 1.2
    assert world.robots[1].limits.v == 1.5
    assert world.controller.settings == {"look_ahead": 3}
    assert world.name == "a=b"
    assert (world.expect.contacts, world.expect.finished) == (None, True)
    assert (world.physics.friction, world.physics.elasticity) == (0.5, 0.25)


def test_the_document_itself_stays():
    document = read_document(STRAIGHT)
    before = document.values()
    apply_overrides(document, ["robots.0.pose.0=9", "seed=9"])
    assert document.values() == before


def test_one_alias_is_replaced_alone():
    text = STRAIGHT.replace("{length: 1.8, width: 1.0}  # [m]", "&b {length: 1.8, width: 1.0}")
    text = text.replace("footprint: {length: 1.8, width: 1.0}\n", "footprint: *b\n")
    world = parse_world(text, overrides=["robots.0.footprint.width=0.5"])
    assert [robot.footprint.width for robot in world.robots] == [0.5, 1.0]


def test_null_leaves_a_key_out():
    text = STRAIGHT.replace("seed: 3", "seed: 1e3")
    overrides = [
        "formation=null",
        "seed=NULL",
        "robots.1.limits= null",
        "expect=null",
        "obstacles=null",
    ]
    world = parse_world(text, overrides=overrides)
    assert parse_world(STRAIGHT).formation is not None
    assert (world.formation, world.expect, world.seed, world.obstacles) == (None, None, 0, ())
    assert world.robots[1].limits == Limits()
    assert "formation" not in world.to_yaml()
    again = parse_world(STRAIGHT, overrides=["formation=null", "formation.gain=0.1"])
    assert again.formation is not None
    assert again.formation.gain == 0.1


def test_null_for_a_setting_of_the_controller():
    assert parse_world(STRAIGHT).controller.settings == {"look_ahead": 2.0}
    assert parse_world(STRAIGHT, overrides=["controller.look_ahead=null"]).controller.settings == {}


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("time.stp=0.02", "--set time.stp: unknown key"),
        ("tiem.step=0.02", "--set tiem.step: tiem: unknown key"),
        ("time.step=-1", "--set time.step: must be greater than 0; given -1"),
        ("time.step=1e-3", "--set time.step: 1e-3 is a text"),
        ("time.step=", "--set time.step: no value"),
        ("time.step=[1,", "--set time.step: not valid YAML"),
        ("robots.2.pose=[1,2,3]", "--set robots.2.pose: robots: there is no entry 2"),
        ("seed.x=1", '--set seed.x: seed: there is no "x" in it'),
        ("robots.0.pose=[1, 2, up]", "--set robots.0.pose: robots[0].pose[2]: must be"),
        ("controller.look_ahed=1", "--set controller.look_ahed: unknown"),
        ("fromation=null", "--set fromation: unknown key"),
        ("fromation=null", 'did you mean "formation"?'),
        ("robots.0.limit=null", "--set robots.0.limit: robots[0].limit: unknown key"),
        ("controller.look_ahed=null", "--set controller.look_ahed: unknown"),
        ("time=null", "--set time: null leaves optional keys out; this one is needed: step and"),
        ("robots.1.path=null", "--set robots.1.path: robots[1].path: null leaves optional"),
        ("robots.1=null", "--set robots.1: robots[1]: null leaves a key out, not an entry"),
        ("expect={contacts: null}", "--set expect: expect.contacts: empty value"),
        ("seed", '--set seed: "seed" is not KEY=VALUE'),
        ("=3", "is not KEY=VALUE"),
        ("a..b=3", "is not KEY=VALUE"),
    ],
)
def test_wrong_overrides_are_told_as_such(override, expected):
    assert expected in message(override)


def test_an_override_mends_a_fault_of_the_file():
    text = STRAIGHT.replace("seed: 3", "seed: 1e3")
    assert parse_world(text, overrides=["seed=5"]).seed == 5
