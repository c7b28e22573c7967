"""Shrinking: what it returns fails, is accepted, and is as small as it can be."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice
from math import pi
from pathlib import Path
from types import SimpleNamespace

import pytest

from benchmarks.planted import MIDDLE, planted_world
from physim import Simulation
from physim.analysis.validation import validate
from physim.world import World
from physim.world.file import load_world
from tests.campaigns.falsify.worlds import (
    ACCEPTS,
    EVALUATE,
    five_robots,
    into_the_wall,
    judge,
    past_a_corner,
    robot,
)
from tests.helpers import inside

accepted = inside("physim.campaigns.falsify", "accepted")
made_controller = inside("physim.parts", "made_controller")
later = inside("physim.campaigns.falsify", "later")
fewer_things, rounder = inside("physim.campaigns.falsify", "fewer_things", "rounder")
straighter, tree_of = inside("physim.campaigns.falsify", "straighter", "tree_of")
with_robots, ROBOTS, WALL = inside("physim.campaigns.falsify", "with_robots", "ROBOTS", "WALL")
Judged, Moment, Touched = inside("physim.campaigns.falsify", "Judged", "Moment", "Touched")
Shrunk, shrink, size_of = inside("physim.campaigns.falsify", "Shrunk", "shrink", "size_of")
record_run = inside("physim.simulation", "record_run")
shipped_worlds = inside("physim.world.file", "shipped_worlds")


def in_band() -> World:
    """The planted fault, of which only a heading within the band is an example."""
    world = planted_world()
    poses = ((4.123, -0.417, MIDDLE + 0.00031), (7.234, 0.8217, 0.131))
    robots = tuple(
        one.model_copy(update={"pose": pose}) for one, pose in zip(world.robots, poses, strict=True)
    )
    return world.changed(robots=robots)


FAILING = {
    "robots": (five_robots, None),
    "wall": (into_the_wall, None),
    "between samples": (past_a_corner, None),
    "planted": (in_band, "benchmarks.planted:Planted"),
}


@pytest.mark.filterwarnings("ignore:.*not used by.*")
@pytest.mark.parametrize("name", FAILING)
def test_what_is_returned_fails_when_it_is_run_afresh(name: str, tmp_path: Path) -> None:
    """Judged by the validation of a fresh run of the written file, not by what shrank it."""
    make, controller = FAILING[name]
    world, accepts = make(), accepted(controller)
    result = judge(world)
    assert result.touched is not None
    found = shrink(world, result, EVALUATE, accepts, most_runs=60)
    file = tmp_path / "shrunk.yaml"
    found.world.save(file)
    assert accepts(load_world(file, controller=controller)) == ""
    again = load_world(file, controller=controller)
    with record_run(Simulation(again, controller=made_controller(again, trusted=True))) as record:
        report = validate(record)
        touches = [*report.contacts, *report.grazes]
        first = min(touches, key=lambda one: (round(one.time / record.dt), one.a, one.b))
    assert report.code == 1
    kind = ROBOTS if first.b < len(again.robots) else WALL
    assert kind == result.touched.kind
    assert found.judged == judge(again)
    before, after = size_of(world), size_of(found.world)
    assert all(after[key] <= before[key] for key in before)


def test_the_known_least_is_reached() -> None:
    """Two robots of five, to the sample of their contact, between walls of two points."""
    found = shrink(five_robots(), judge(five_robots()), EVALUATE, ACCEPTS)
    assert found.is_least
    assert found.judged.touched is not None
    assert size_of(found.world) == {
        "robots": 2, "duration": found.judged.touched.time, "wall_points": 2, "obstacles": 0,
        "path_points": 0,
    }  # fmt: skip
    assert [one.name for one in found.world.robots] == ["r2", "r4"]
    assert found.world.corridor is not None
    assert found.world.corridor.width == 12.0
    assert dict(found.world.controller.settings) == {"commands": ((1.0, 0.0), (0.0, 0.0))}


def test_robots_keep_their_formation_in_a_run_that_starts_later() -> None:
    """Their wanted distances are those of the first start, not of where they are later."""
    robots = [robot(name, 2.0 + 3.0 * k, 0.0, 0.0) for k, name in enumerate("abc")]
    world = five_robots(
        robots=robots, obstacles=[], controller={"type": "path_following"}, formation={}
    )
    tree = tree_of(world)
    poses = ((3.0, 0.0, 0.0), (7.0, 0.0, 0.0), (9.5, 0.0, 7.0))
    touched = Touched(ROBOTS, ("a", "b"), 4.0, ("", ""))
    result = Judged(-0.1, ("a", "b"), 4.0, touched, before=(Moment(3.0, poses),))
    (proposed,) = later(Shrunk(world, result, tree))
    assert proposed["formation"]["spacing"] == pytest.approx([0.0, 3.0, 6.0], abs=1e-3)
    assert [one["pose"][:2] for one in proposed["robots"]] == [[3.0, 0.0], [7.0, 0.0], [9.5, 0.0]]
    assert proposed["robots"][2]["pose"][2] == pytest.approx(7.0 - 2.0 * pi)
    assert 1.0 < proposed["time"]["duration"] < 4.0
    assert tree == tree_of(world)


def test_numbers_become_round() -> None:
    found = shrink(into_the_wall(), judge(into_the_wall()), EVALUATE, ACCEPTS)
    (one,) = found.world.robots
    assert one.pose is not None
    assert all(number == round(number, 1) for number in one.pose)
    assert one.pose[2] == 1.0
    assert found.world.corridor is not None
    assert found.world.corridor.width == 7.3  # in 7 m it would start too near to the wall
    assert one.footprint == into_the_wall().robots[0].footprint


@pytest.mark.deep
def test_it_is_the_same_every_time_and_within_its_runs() -> None:
    world = five_robots()
    whole = shrink(world, judge(world), EVALUATE, ACCEPTS)
    assert shrink(world, judge(world), EVALUATE, ACCEPTS) == whole
    for most in (0, 1, 3):
        asked: list[World] = []

        def counted(worlds: Sequence[World], asked: list[World] = asked) -> Iterator[Judged]:
            asked.extend(worlds)
            return iter(EVALUATE(worlds))

        part = shrink(world, judge(world), counted, ACCEPTS, most_runs=most)
        assert part.runs == len(asked) == most
        assert not part.is_least
        assert judge(part.world).failed


def test_another_kind_of_failure_is_not_taken() -> None:
    """r2 reaches r4 and an obstacle beside it at once: without r4 it is the obstacle alone."""
    tree = tree_of(five_robots())
    tree["robots"][3]["pose"] = [8.0, 0.3, 0.0]
    tree["obstacles"] = [[[7.49, -1.0], [8.5, -1.0], [8.5, -0.35], [7.49, -0.35]]]
    world = World(**tree)
    before = judge(world)
    alone = judge(World(**with_robots(tree, [1])))
    assert before.touched is not None
    assert alone.touched is not None
    assert (before.touched.kind, alone.touched.kind) == (ROBOTS, WALL)
    assert alone.touched.time == before.touched.time
    found = shrink(world, before, EVALUATE, ACCEPTS)
    assert found.judged.touched is not None
    assert found.judged.touched.kind == ROBOTS
    assert len(found.world.robots) == 2


def test_a_robot_in_another_mode_is_another_failure() -> None:
    """As where its path is cut so that it has arrived, and stands in the way for that reason."""
    world = five_robots()

    def moody(worlds: Sequence[World]) -> Iterator[Judged]:
        """The robot that is hit is in danger mode while there are obstacles."""
        for one, result in zip(worlds, EVALUATE(worlds), strict=True):
            modes = ("safe", "danger" if one.obstacles else "arrived")
            touched = result.touched
            yield replace(result, touched=touched and touched._replace(modes=modes))

    before = next(moody([world]))
    found = shrink(world, before, moody, ACCEPTS)
    assert len(found.world.robots) == 2
    assert found.world.obstacles
    assert found.judged.touched is not None
    assert found.judged.touched.modes == ("safe", "danger")


@pytest.mark.parametrize("name", shipped_worlds())
def test_every_pass_takes_every_shipped_world(name: str) -> None:
    """Also one whose road the seed draws: what was found there was lost with a traceback."""
    judged = SimpleNamespace(touched=SimpleNamespace(time=1.0, robots=(0,)))
    state = SimpleNamespace(tree=tree_of(load_world(name)), judged=judged)
    proposed = [list(islice(propose(state), 20)) for propose in (fewer_things, straighter, rounder)]
    assert any(proposed)
