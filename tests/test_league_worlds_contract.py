"""What worlds of the league and those for tuning keep to; the gallery has another test."""

from __future__ import annotations

import json

import numpy as np
import pytest
import yaml

from physim import build_scene, check_world, simulate
from physim.world.file import load_world
from tests.helpers import inside

find_world, shipped_worlds, GROUPS = inside(
    "physim.world.file", "find_world", "shipped_worlds", "GROUPS"
)
CONTROLLER, part_names = inside("physim.parts", "CONTROLLER", "part_names")
shipped_folder = inside("physim.world.file", "shipped_folder")
NAMES = [name for group in GROUPS for name in shipped_worlds(group)]


@pytest.mark.parametrize("name", NAMES)
def test_a_world_is_sound_and_its_seeds_differ(name: str) -> None:
    """Its first steps are run with its own controller; how it ends is what the league is for."""
    found = check_world(name)
    assert (found.errors, found.warnings) == ((), ())
    world = load_world(name)
    assert find_world(name).stem == world.name.replace(" ", "_")
    assert find_world(name).read_text("utf-8").splitlines()[1].startswith("# ")
    a, b = build_scene(world, 1), build_scene(world, 2)
    assert (a.start != b.start).any(axis=1).all(), "every robot starts otherwise with another seed"
    step = world.time.step
    with simulate(world.changed(time={"step": step, "duration": 20 * step})) as record:
        assert np.abs(np.diff(record.pose, axis=0)).max() > 0.0


def test_the_programme_names_every_world_and_registered_controllers() -> None:
    text = (shipped_folder() / "league" / "league.yaml").read_text("utf-8")
    programme = yaml.safe_load(text)
    worlds = [name for group in programme["groups"] for name in group["worlds"]]
    assert len(worlds) == len(set(worlds))
    assert {name for name in worlds if "/" in name} == set(shipped_worlds("league"))
    assert {name for name in worlds if "/" not in name} <= set(shipped_worlds())
    names = [one["name"] for one in programme["entrants"]]
    assert len(names) == len(set(names))
    assert {programme["null"], programme["reference"]} <= set(names)
    assert {one["controller"] for one in programme["entrants"]} <= set(part_names(CONTROLLER))


def test_tuned_entrants_have_the_settings_that_tuning_found() -> None:
    folder = shipped_folder() / "league"
    entrants = yaml.safe_load((folder / "league.yaml").read_text("utf-8"))["entrants"]
    tuned = json.loads((folder / "tuned.json").read_text("utf-8"))
    settings = {name: one["settings"] for name, one in tuned.items()}
    told = [one for one in entrants if one["name"].endswith(" tuned")]
    assert {one["controller"]: one["settings"] for one in told} == settings


def test_a_name_that_no_world_has_is_refused_with_the_nearest() -> None:
    with pytest.raises(Exception, match=r'did you mean "league/lanes_10"'):
        load_world("league/lanes_1O")
