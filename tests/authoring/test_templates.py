"""Every template, with one robot up to as many as fit, is a sound world that keeps its promise."""

from __future__ import annotations

import re

import pytest
import shapely
import yaml
from jsonschema import Draft7Validator

from physim import build_scene, simulate
from physim.authoring.templates import ROADS, fitted, most_robots, world_text
from physim.world import Formation
from physim.world.file import parse_world
from tests.helpers import inside

summarise = inside("physim.analysis", "summarise")
TEMPLATES = inside("physim.cli", "TEMPLATES")
ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")
world_schema = inside("physim.world.file", "world_schema")
lay_out = inside("physim.world.layout", "lay_out")

deep = pytest.mark.deep
every_template = pytest.mark.parametrize("template", ROADS)


def test_the_command_offers_what_there_is() -> None:
    assert tuple(ROADS) == TEMPLATES
    assert {name: most_robots(name) for name in ROADS} == {
        "corridor": 22, "bend": 22, "doorway": 9, "s_bend": 22, "roundabout": 15, "warehouse": 15,
        "random": 15,
    }  # fmt: skip


@every_template
@pytest.mark.parametrize(
    "robots", [3, *(pytest.param(n, marks=pytest.mark.deep) for n in (1, 8, 99))]
)
def test_runs_contact_free_to_what_it_promises(template: str, robots: int) -> None:
    count = min(robots, most_robots(template))
    world = parse_world(world_text("a new one", template, count))
    assert (world.name, len(world.robots)) == ("a new one", count)
    with simulate(world) as record:
        assert [one for one in summarise(record).expectations if not one.held] == []
        assert record.ended == "finished"
        assert record.boundary_clearance.min() > 0.3
        assert record.clearance.min() > 0.5  # never in danger mode for distance, so never close
    assert world.expect is not None
    assert (world.expect.contacts, world.expect.finished) == (0, True)


@every_template
def test_robots_stand_apart_on_a_sound_road(template: str) -> None:
    schema = Draft7Validator(world_schema())
    for robots in (1, 4, most_robots(template)):
        text = world_text("w", template, robots)
        scene = build_scene(parse_world(text))
        assert list(schema.iter_errors(yaml.safe_load(text))) == []
        assert all(len(stretches) == 0 for stretches in scene.outside)
        assert scene.start[0, 0] > scene.start[1:, 0].max(initial=-1.0)
        safe = scene.area.polygon.buffer(-1.0)
        places = shapely.points(scene.start[:, :2])
        assert shapely.covers(safe.buffer(1e-6), places).all()


def test_another_seed_draws_another_road_that_runs_as_well() -> None:
    text = world_text("w", "random", 4)
    roads = set()
    for seed in (2, 3):
        world = parse_world(text.replace("seed: 1 ", f"seed: {seed} "))
        laid = lay_out(world)
        assert len(laid.obstacles) > 0
        roads.add(laid.reference.tobytes())
        with simulate(world) as record:
            assert [one for one in summarise(record).expectations if not one.held] == []
    assert len(roads) == 2


@every_template
def test_one_more_than_fit_are_refused(template: str) -> None:
    most = most_robots(template)
    with pytest.raises(ValueError, match=f"{most} do"):
        fitted(template, most + 1)


@every_template
def test_values_written_out_are_the_defaults(template: str) -> None:
    """So that a key taken out of the file changes nothing."""
    world = parse_world(world_text("w", template, 4))
    assert world.formation == Formation()
    settings = ModeSwitchingSettings()
    for key, value in world.controller.settings.items():
        assert getattr(settings, key) == value


@every_template
def test_the_start_region_that_is_offered_holds_the_robots(template: str) -> None:
    """Taken out of its comment, in the place of the poses."""
    for robots in (1, 4, most_robots(template)):
        text = world_text("w", template, robots)
        text = re.sub(r"\n    start: .*", "", text)
        (offered,) = re.findall(r"^#   (start: .*)$", text, flags=re.MULTILINE)
        world = parse_world(f"{text}{offered}\n")
        first, second = build_scene(world, 1).start, build_scene(world, 2).start
        assert (first != second).all()
