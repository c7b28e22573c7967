"""In which values two worlds differ."""

from __future__ import annotations

from physim.world.file import load_world, parse_world
from tests.helpers import STRAIGHT, inside

differences, key_in_words = inside("physim.world", "differences", "key_in_words")


def test_differences_are_told_by_key_with_both_values() -> None:
    world = parse_world(STRAIGHT)
    other = parse_world(
        STRAIGHT,
        overrides=[
            "seed=4",
            "robots.1.path.offset=-2",
            "controller={type: constant}",
            "expect=null",
        ],
        check_controller=False,
    )
    assert differences(world, world) == {}
    assert differences(world, other) == {
        "seed": ("3", "4"),
        "robots.1.path.offset": ("-1.0", "-2.0"),
        "controller.type": ("mode_switching", "constant"),
        "expect.contacts": ("0", "default"),
    }


def test_a_key_is_told_in_words() -> None:
    for key, words in (
        ("controller.type", "controller"),
        ("controller.time_low", "controller time low"),
        ("time.duration", "duration"),
        ("robots.1.controller.type", "robots entry 2 controller"),
        ("sensing.stages.0.deviation", "sensing stage 1 deviation"),
    ):
        assert key_in_words(key) == words


def test_what_only_one_world_has_is_none_in_the_other() -> None:
    one, two = load_world("single_robot"), load_world("three_robots")
    found = differences(one.changed(controller={}), two.changed(controller={}))
    assert found["robots.1.name"][0] == "none"
