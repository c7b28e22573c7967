"""World and seed to scene: what its author wrote, resolved into lengths, masses and numbers."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from physim import build_scene
from physim.world import World
from tests.helpers import BOX, inside, road

is_neighbour = inside("physim.controllers", "is_neighbour")
outline_distance, Part = inside("physim.geometry", "outline_distance", "Part")
parts_within = inside("physim.geometry", "parts_within")
DENSITY = inside("physim.world", "DENSITY")

PLACES = [[20.0, -10.0, 0.3], [30.0, 0.0, -2.0], [40.0, 10.0, 0.0]]


def in_formation(**plan: Any) -> World:
    """Three robots, led by the last one."""
    return road(PLACES, formation={"spacing": [0.0, -4.0, 6.0], **plan})


def test_stop_stations_are_staggered_as_the_formation_is() -> None:
    """The one that leads stops at the end of its path, the others as far before it as they lag."""
    assert build_scene(in_formation()).stop_station == pytest.approx([194.0, 190.0, 200.0])
    alone = build_scene(road(PLACES))
    assert alone.stop_station == pytest.approx([200.0] * 3)
    short = [
        {"name": "r1", "footprint": BOX, "pose": PLACES[0], "path": [[18.0, 0.0], [23.0, 0.0]]}
    ]
    world = in_formation().changed(robots=[*short, *in_formation().robots[1:]])
    assert build_scene(world).stop_station[0] == 0.0  # none before the beginning


def test_leads_are_those_of_the_world_or_of_the_places() -> None:
    assert build_scene(in_formation()).formation.lead.tolist() == [0.0, -4.0, 6.0]
    initial = road(PLACES, formation={"spacing": "initial"})
    assert build_scene(initial).formation.lead == pytest.approx([0.0, 10.0, 20.0])


def test_listed_neighbours_are_mutual() -> None:
    listed = in_formation(neighbours=[["r1", "r3"], ["r3", "r2"]])
    adjacency = build_scene(listed).formation.adjacency
    assert adjacency.tolist() == [[0, 0, 1], [0, 0, 1], [1, 1, 0]]
    assert build_scene(in_formation()).formation.adjacency.size == 0


def test_all_are_neighbours_however_far_apart_and_no_table_says_so() -> None:
    """What a table of all pairs would say, without N x N numbers."""
    plan = build_scene(in_formation(neighbours="all", range=1.0)).formation
    for i, j in itertools.permutations(range(3), 2):
        assert is_neighbour(i, j, -1e6 * i, 1e6 * j, plan.adjacency, 0, plan.range)
        assert not is_neighbour(i, j, -1e6 * i, 1e6 * j, plan.adjacency, 0, 1.0)
    assert plan.adjacency.size == 0


def test_a_mass_is_as_given_or_of_the_area() -> None:
    robots = [robot.model_dump() for robot in road(PLACES).robots]
    robots[1]["mass"] = 7.0
    robots[2]["footprint"] = [[0.5, -0.5], [0.5, 0.5], [-0.5, -0.5]]  # clockwise, half a square
    mass = build_scene(road(PLACES).changed(robots=robots)).mass
    assert mass == pytest.approx([DENSITY * 1.8, 7.0, DENSITY * 0.5])


def test_every_wall_within_range_is_looked_up() -> None:
    """The look-up by places holds whatever a plain search through all walls finds."""
    rng = np.random.default_rng(3)
    posts = [
        [[x, y], [x + 0.5, y], [x, y + 0.5]]
        for x in np.arange(5.0, 195.0, 9.0)
        for y in (-12.0, 4.0, 15.0)
    ]
    for reach in (3.0, 12.0):
        world = in_formation(range=reach).changed(obstacles=posts)
        scene = build_scene(world)
        corners, start = scene.walls.vertices, scene.walls.part_start
        every = [Part(corners, *part) for part in itertools.pairwise(start)]
        for x, y in rng.uniform((0.0, -19.0), (200.0, 19.0), (200, 2)):
            near = [k for k, part in enumerate(every) if outline_distance(part, x, y) <= reach]
            assert parts_within(scene.wall_tree, x, y, reach).tolist() == near
