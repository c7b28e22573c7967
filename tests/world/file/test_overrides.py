from __future__ import annotations

import pytest

from physim.errors import WorldError
from physim.world import Limits
from physim.world.file import parse_world
from tests.helpers import STRAIGHT, check_error


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


def test_one_alias_is_replaced_alone():
    text = STRAIGHT.replace("{length: 1.8, width: 1.0}  # [m]", "&b {length: 1.8, width: 1.0}")
    text = text.replace("footprint: {length: 1.8, width: 1.0}\n", "footprint: *b\n")
    world = parse_world(text, overrides=["robots.0.footprint.width=0.5"])
    assert [robot.footprint.width for robot in world.robots] == [0.5, 1.0]


def test_null_leaves_a_key_out():
    overrides = [
        "formation=null",
        "seed=NULL",
        "robots.1.limits= null",
        "expect=null",
        "obstacles=null",
    ]
    world = parse_world(STRAIGHT, overrides=overrides)
    assert parse_world(STRAIGHT).formation is not None
    assert (world.formation, world.expect, world.seed, world.obstacles) == (None, None, 0, ())
    assert world.robots[1].limits == Limits()
    assert "formation" not in world.to_yaml()
    again = parse_world(STRAIGHT, overrides=["formation=null", "formation.gain=0.1"])
    assert again.formation is not None
    assert again.formation.gain == 0.1


@pytest.mark.parametrize(
    ("override", "place", "parts"),
    [
        ("time.stp=0.02", "--set time.stp:", ("unknown", '"step"')),
        ("tiem.step=0.02", "--set tiem.step: tiem:", ("unknown", '"time"')),
        ("time.step=-1", "--set time.step:", ("at least 1e-06", "given -1")),
        ("time.step=1e-3", "--set time.step:", ("1e-3", "text", "1.0e-3")),
        ("time.step=", "--set time.step:", ("no value",)),
        ("time.step=[1,", "--set time.step:", ("not valid YAML",)),
        ("robots.2.pose=[1,2,3]", "--set robots.2.pose: robots:", ("no entry 2", "0 to 1")),
        ("seed.x=1", "--set seed.x: seed:", ("no", '"x"')),
        ("robots.0.pose=[1, 2, up]", "--set robots.0.pose: robots[0].pose[2]:", ('"up"',)),
        ("controller.look_ahed=1", "--set controller.look_ahed:", ("unknown", '"look_ahead"')),
        ("fromation=null", "--set fromation:", ("unknown", '"formation"')),
        ("robots.0.limit=null", "--set robots.0.limit: robots[0].limit:",
         ("unknown", '"limits"')),
        ("controller.look_ahed=null", "--set controller.look_ahed:", ("unknown", '"look_ahead"')),
        ("time=null", "--set time:", ("missing", "needed", "step")),
        ("robots.1.path=null", "--set robots.1.path: robots[1].path:", ("missing", "needed")),
        ("robots.1=null", "--set robots.1: robots[1]:", ("null", "key", "entry")),
        ("expect={contacts: null}", "--set expect: expect.contacts:", ("empty",)),
        ("seed", "--set seed:", ('"seed"', "KEY=VALUE")),
        ("=3", "--set :", ('"=3"', "KEY=VALUE",)),
        ("a..b=3", "--set a..b:", ('"a..b=3"', "KEY=VALUE",)),
    ],
)  # fmt: skip
def test_wrong_overrides_are_told_as_such(override, place, parts):
    check_error(f"{message(override)}\n", place, *parts)


def test_keys_within_very_many_keys_are_refused():
    for key in ("a" + ".a" * 3000, "robots" + "[0]" * 3000):
        for value in ("1", "null"):
            with pytest.raises(WorldError, match=r"3001 keys within each other.* 50"):
                parse_world(STRAIGHT, overrides=[f"{key}={value}"])


@pytest.mark.parametrize("key", ["controller.type=mode_switching", "controller={type: constant}"])
def test_one_controller_is_given(key: str) -> None:
    with pytest.raises(WorldError) as caught:
        parse_world(STRAIGHT, "w.yaml", overrides=[key], controller="path_following")
    place = f"--set {key.partition('=')[0]}"
    check_error(f"{caught.value}\n", place, "--controller", "path_following", "one of them")
