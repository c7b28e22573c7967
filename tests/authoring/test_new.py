"""Worlds to begin with: a shipped one, with every key explained."""

from __future__ import annotations

import re

import pytest

from physim.errors import PhysimError, WorldError
from physim.world import World
from physim.world.file import load_world, parse_world
from tests.helpers import facts, inside

new_text = inside("physim.authoring", "new_text")
shipped_worlds = inside("physim.world.file", "shipped_worlds")


@pytest.mark.parametrize("like", shipped_worlds())
def test_a_new_world_is_the_shipped_one_with_every_key_explained(like: str) -> None:
    text = new_text("a new one", like)
    world = load_world(like)
    assert parse_world(text) == world.changed(name="a new one")
    assert all(f"# {key}: " in text or f"\n{key}:" in text for key in World.model_fields)
    told = set()
    lines = text.partition("# Left out here")[0].splitlines()
    for above, line in zip(lines, lines[1:], strict=False):
        key = re.match(r" *(?:- )?(\w+):", line)
        if key and key[1] not in told:
            told.add(key[1])
            assert re.search("#.*[a-z]{3}", line) or "#" in above, line


def test_examples_of_keys_that_are_left_out_are_valid() -> None:
    text = re.sub(r"^#(?=\w)", "", new_text("w", "ten_robots"), flags=re.MULTILINE)
    world = parse_world(text)
    assert [one.type for one in world.sensing.stages] == ["noise", "messages"]
    assert [one.type for one in world.disturbances] == ["actuation"]
    assert [one.name for one in world.movers] == ["cart"]


def test_a_group_may_have_another_count() -> None:
    assert parse_world(new_text("w", "hundred_robots", 20)).robot_count == 20
    for like, robots, *parts in (
        ("straight", 3, "--robots 3", "straight", "one by one"),
        ("jam", 0, "--robots 0", "1 to 20000"),
    ):
        with pytest.raises(PhysimError, match=facts(*parts)):
            new_text("w", like, robots)
    with pytest.raises(WorldError, match=facts("start.region", "10000")):
        new_text("w", "jam", 10_000)
