"""Grids: every combination once, every fault before anything is run."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import chain
from pathlib import Path

import pytest

from physim.errors import PhysimError, WorldError
from tests.helpers import facts, inside

Shard, make_grid, settings_of = inside("physim.campaigns", "Shard", "make_grid", "settings_of")
simulation_of = inside("physim.campaigns", "simulation_of")
CONTROLLER, find_part = inside("physim.parts", "CONTROLLER", "find_part")
settings_model = inside("physim.parts", "settings_model")


def settings_of_part(name: str) -> list[str]:
    return list(settings_model(find_part(CONTROLLER, name)).model_fields)


@pytest.mark.parametrize(
    ("axis", "values"),
    [
        ("a.b=1,2", ["a.b=1", "a.b=2"]),
        ("a=1, 1 ,2", ["a=1", "a=2"]),
        ("a=[1, 2],{x: 1, y: 2}", ["a=[1, 2]", "a={x: 1, y: 2}"]),
        ("a='1,2',\"3,4\"", ["a='1,2'", 'a="3,4"']),
        ("a=null,0.5", ["a=null", "a=0.5"]),
    ],
)
def test_values_of_an_axis(axis: str, values: list[str]) -> None:
    assert settings_of(axis) == values


def test_every_combination_once(here: Path) -> None:
    grid = make_grid(
        ["small.yaml", "fixed.yaml"], range(3, 6), ["time.duration=1.0,2.0"],
        ["constant", "path_following"],
    )  # fmt: skip
    found = [(one.world, one.settings, one.controller, one.seed) for one in grid]
    assert len(grid) == len(found) == len(set(found)) == 4 * 3 + 4  # nothing in fixed is random
    assert len({one.key for one in grid}) == len(found)
    assert {seed for world, *_, seed in found if world == "fixed"} == {1}
    assert {seed for world, *_, seed in found if world == "small"} == {3, 4, 5}
    assert {settings for _, settings, *_ in found} == {"time.duration=1.0", "time.duration=2.0"}


def test_without_seeds_each_world_has_its_own(here: Path) -> None:
    assert [one.seed for one in make_grid(["small.yaml"], None)] == [1]


def test_shards_are_the_whole_without_overlap(here: Path) -> None:
    worlds = (["small.yaml", "fixed.yaml"], range(10))
    shards = [make_grid(*worlds, shard=Shard(k, 3)) for k in (1, 2, 3)]
    keys = [[one.key for one in shard] for shard in shards]
    assert [len(shard) for shard in shards] == [len(mine) for mine in keys]
    assert sorted(chain(*keys)) == sorted(one.key for one in make_grid(*worlds))


def test_a_world_that_a_value_makes_impossible_is_told_with_the_value() -> None:
    """Its file as it stands is right."""
    with pytest.raises(
        WorldError, match=facts("r1", "over the edge", "corridor.width=1.8", "seed")
    ):
        make_grid(["straight"], range(1, 3), ["corridor.width=8,1.8"])


def test_two_files_of_one_name_are_told_apart(here: Path) -> None:
    (here / "other").mkdir()
    (here / "other/small.yaml").write_text((here / "small.yaml").read_text().replace("1.8", "1.7"))
    grid = make_grid(["small.yaml", "other/small.yaml"], range(2))
    assert {one.world for one in grid} == {"small.yaml", "other/small.yaml"}


def test_a_world_with_another_comment_is_no_other_world(here: Path) -> None:
    (here / "again.yaml").write_text("# the same\n" + (here / "small.yaml").read_text())
    with pytest.raises(PhysimError, match=facts("small", "again", "same world")):
        make_grid(["small.yaml", "again.yaml"], range(2))
    assert len(make_grid(["small.yaml"], None, ["seed=1,2"])) == 2


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ((["small.yaml"], range(2), ["time.stop=1"]), "stop"),
        ((["small.yaml"], range(2), ["time.duration="]), "no value"),
        ((["small.yaml"], range(2), ["time.duration"]), "KEY=VALUE"),
        ((["small.yaml"], range(2), ["time.step=0.02", "time.step=0.1"]), "given twice"),
        ((["small.yaml"], range(2), ["time.duration=-1"]), "time.duration"),
        ((["small.yaml"], range(2), ["seed=7"]), "--set seed: --seeds"),
        ((["small.yaml"], range(2), ["robots.0.name=a,b", "robots[0].name=c"]), "given twice"),
        (
            (["small.yaml"], range(2), ["time.step=0.02,0.020"]),
            "step=0.02, .* and .*0.020, .* are the same",
        ),
        ((["small.yaml", "./small.yaml"], range(2)), "are the same world"),
        (
            (["small.yaml"], range(2), ["controller.type=mode_switching"], ["path_following"]),
            "place of --controller",
        ),
        ((["small.yaml"], range(0)), "nothing to run"),
        ((["small.yaml"], range(1_000_001)), "1,000,001 runs; --yes"),
        ((["smal"], range(2)), "smal"),
        ((["small.yaml"], range(2), [], ["awkward:Nobody"]), "Nobody"),
        ((["small.yaml"], range(2), ["robots.0.pose=[50, 0, random]"]), "robots"),
    ],
)
def test_faults_are_told_before_anything_is_run(here: Path, arguments, text: str) -> None:
    with pytest.raises(PhysimError, match=text):
        make_grid(*arguments)


def test_a_setting_goes_to_the_controllers_that_have_it(here: Path) -> None:
    controllers = ["mode_switching", "path_following"]
    only = next(
        key
        for key in settings_of_part("mode_switching")
        if key not in settings_of_part(controllers[1])
    )
    axes = [f"controller.{only}=0.3,0.5"]
    grid = make_grid(["small.yaml"], range(2), axes, controllers)
    assert [(one.controller, one.settings) for one in grid.cells] == [
        ("mode_switching", f"controller.{only}=0.3"), ("path_following", ""),
        ("mode_switching", f"controller.{only}=0.5"),
    ]  # fmt: skip
    (told,) = (one for one in grid.warnings if "--set" in one)
    assert re.search(facts(f"controller.{only}", "path_following"), told)
    with pytest.raises(PhysimError, match=facts("controller", "nothing")):
        make_grid(["small.yaml"], range(2), ["controller.nothing=1"], controllers)


def test_too_many_are_counted_and_not_made(here: Path) -> None:
    with pytest.raises(PhysimError, match=facts("99,999,999,999", "days", "10,000,000")):
        make_grid(["small.yaml"], range(99_999_999_999), most=None)
    axes = [f"robots.{k}.pose={','.join(map(str, range(100)))}" for k in range(9)]
    with pytest.raises(PhysimError, match="10,000,000"):
        make_grid(["small.yaml"], None, axes, most=None)
    with pytest.raises(PhysimError, match="10,000"):
        make_grid(["small.yaml"], None, axes[:3], most=None)


def test_a_run_is_known_to_be_one_of_them(here: Path) -> None:
    whole = make_grid(
        ["small.yaml", "fixed.yaml"], range(3, 9), [f"time.duration={','.join('123456789')}"],
        ["constant", "path_following"],
    )  # fmt: skip
    assert len(whole.cells) > 16  # of which keys are made together
    for shard in (Shard(1, 1), Shard(2, 5)):
        grid = replace(whole, shard=shard)
        runs = list(grid)
        assert len(runs) == len(grid)
        assert all(grid.has(one.label, one.seed, one.key) for one in runs)
        mine = {one.key for one in runs}
        assert [one for one in whole if one in grid] == [one for one in whole if one.key in mine]
    *_, one = whole
    assert not whole.has(one.label, 9, one.key)
    assert not whole.has(one.label, one.seed, "0" * 20)
    assert not whole.has(("other", "", ""), one.seed, one.key)


DRAWING = '''
import numpy as np
from physim.parts.controller import Decisions
from physim.randomness import stream

class Drawing:
    """Decides for all at once, by what the seed draws, as a controller that samples plans does."""

    def start(self, scene):
        return {"speed": stream(scene.seed, "drawing", 0).uniform(0.1, 0.2, scene.robots)}

    def decide_all(self, view, due, memory):
        command = np.column_stack((memory["speed"][due], np.zeros(len(due))))
        return Decisions.of(due, command, 0.1)
'''


def test_a_controller_that_is_given_the_scene_may_draw(here: Path) -> None:
    (here / "drawing.py").write_text(DRAWING)
    world = ["fixed.yaml"]
    grid = make_grid(world, range(3), [], ["drawing:Drawing"])
    assert [one.seed for one in grid] == [0, 1, 2]
    assert any(re.search(facts("drawing:Drawing", "may draw"), line) for line in grid.warnings)
    ends = []
    for spec in grid:
        simulation = simulation_of(spec)
        for _ in range(20):
            simulation.step()
        ends.append(tuple(simulation.pose[0]))
    assert len(set(ends)) == 3
    assert len(make_grid(world, range(3), [], ["path_following"])) == 1
