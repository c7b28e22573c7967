"""Groups: one entry of ``robots`` that stands for many."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physim import build_scene
from physim.errors import WorldError
from physim.randomness import stream
from physim.world import Box, Offset, Robot, RobotGroup, World, each_robot
from physim.world.checks import check_world
from physim.world.file import load_world, parse_world
from tests.helpers import facts, inside

MOST_ROBOTS = inside("physim.world", "MOST_ROBOTS")
is_random, reseeded = inside("physim.world.layout", "is_random", "reseeded")

TEXT = """\
name: fleet
seed: 3
time: {step: 0.02, duration: 1.0}
corridor: {centreline: [[0, 0], [60, 0]], width: 10.0}
start: {region: [[1, -4.8], [20, -4.8], [20, 4.8], [1, 4.8]], heading: along, abreast: 4}
robots:
  - count: 20
    footprints: [{length: 0.6, width: 0.4}, [[0.3, 0.0], [-0.2, 0.3], [-0.2, -0.3]]]
    paths: [{offset: -3.0}, {offset: -1.0}, {offset: 1.0}, {offset: 3.0}]
    limits: {v: 1.0}
  - {name: boss, footprint: {length: 1.0, width: 0.5}, pose: [25.0, 0.0, 0.0], path: {offset: 0.0}}
  - count: 2
    name: "late {number}"
    start: {region: [[30, 1], [36, 1], [36, 4.8], [30, 4.8]], abreast: 1}
    footprint: {length: 0.6, width: 0.4}
    path: {offset: 3.0}
    mass: 40.0
"""
LINES = TEXT.splitlines()


def fleet(**keys: Any) -> World:
    return parse_world(TEXT).changed(**keys)


def test_a_group_stands_for_robots_one_by_one() -> None:
    world = fleet()
    robots, entries = each_robot(world.robots, world.seed)
    assert entries == (0,) * 20 + (1, 2, 2)
    assert [robot.name for robot in robots] == [
        *(f"r{k}" for k in range(1, 21)), "boss", "late 22", "late 23",
    ]  # fmt: skip
    first, late = robots[:20], robots[21:]
    assert [robot.path.offset for robot in first] == [-3.0, -1.0, 1.0, 3.0] * 5
    assert all(isinstance(robot, Robot) and robot.limits.v == 1.0 for robot in first)
    assert all(robot.footprint == Box(length=0.6, width=0.4) for robot in late)
    assert [world.start_of(robots[i]) for i in (0, 20, 22)] == [world.start, None, late[1].start]
    second = RobotGroup(count=3, name="s{number}", footprint=Box(length=1, width=1), paths=LANES)
    moved, _ = each_robot([robots[20], second], 0)
    assert [robot.path.offset for robot in moved[1:]] == [-1.0, 1.0, -1.0]
    assert [robot.name for robot in moved[1:]] == ["s2", "s3", "s4"]


LANES = (Offset(offset=-1.0), Offset(offset=1.0))


def test_a_scene_of_a_group_is_that_of_its_robots_written_out() -> None:
    world = fleet()
    by_hand = fleet(robots=each_robot(world.robots, world.seed)[0])
    assert (len(world.robots), len(by_hand.robots)) == (3, world.robot_count) == (3, 23)
    one, other = build_scene(world), build_scene(by_hand)
    assert one.names == other.names
    for key in ("start", "mass", "limits", "stop_station"):
        assert np.array_equal(getattr(one, key), getattr(other, key)), key
    for a, b in zip((*one.shapes, *one.paths), (*other.shapes, *other.paths), strict=True):
        assert np.array_equal(a, b)
    assert one.mass[21:].tolist() == [40.0, 40.0]


def test_footprints_are_drawn_by_the_seed_each_from_its_own_stream() -> None:
    world = fleet()
    group, *others = world.robots
    robots, _ = each_robot(world.robots, 3)
    drawn = [group.footprints.index(robot.footprint) for robot in robots[:20]]
    assert drawn == [int(stream(3, "footprint", i).integers(2)) for i in range(20)]
    assert set(drawn) == {0, 1}
    fewer, _ = each_robot([group.model_copy(update={"count": 7}), *others], 3)
    assert [robot.footprint for robot in fewer[:7]] == [robot.footprint for robot in robots[:7]]


def test_another_seed_draws_anew() -> None:
    world = fleet()
    other = world.changed(seed=4)
    assert other.changed(seed=3) == world
    scene = build_scene(world)
    assert is_random(world)
    for made in (build_scene(world, 4), reseeded(scene, 4)):
        assert made.world == other
        assert np.array_equal(made.start, build_scene(other).start)
        assert np.array_equal(made.shapes.vertices, build_scene(other).shapes.vertices)
    assert not np.array_equal(scene.shapes.part_start, build_scene(other).shapes.part_start)


def test_a_saved_group_stays_a_group_and_means_the_same() -> None:
    world = fleet()
    text = world.to_yaml()
    again = parse_world(text)
    assert again == world
    assert hash(again) == hash(world)
    assert again.to_yaml() == text
    assert len(text) < 1500
    assert np.array_equal(build_scene(again).start, build_scene(world).start)


def test_the_command_line_reaches_into_a_group(tmp_path: Path) -> None:
    file = tmp_path / "fleet.yaml"
    file.write_text(TEXT, "utf-8")
    given = ["robots.0.count=8", "robots.0.paths.1.offset=-1.5", 'robots.2.name="t{number}"']
    world = load_world(file, overrides=given)
    robots, _ = each_robot(world.robots, world.seed)
    assert [robot.name for robot in robots[7:]] == ["r8", "boss", "t10", "t11"]
    assert robots[1].path == Offset(offset=-1.5)
    assert check_world(file).errors == ()


@pytest.mark.parametrize(
    ("line", "old", "new", "place", "said"),
    [
        (7, "20", "0", ("robots[0].count", 7, 12), ("at least 1",)),
        (7, "count", "cuont", ("robots[0].cuont", 7, 5), ("count",)),
        (7, "20", "99999", ("robots[0].count", 7, 12), (str(MOST_ROBOTS),)),
        (8, "footprints", "footprint", ("robots[0].footprint[0]", 8, 17), ()),
        (8, "footprints", "pose", ("robots[0].pose", 8, 5), ("footprints", "count")),
        (8, "[0.3, 0.0]", "[-0.2, 0.0]", ("robots[0].footprints[1]", 8, 45), ()),
        (9, "3.0}]", "x}]", ("robots[0].paths[3].offset", 9, 69), ("number",)),
        (9, "3.0}]", "6.0}]", ("robots[0].paths[3].offset", 9, 69), ('"r4"', "0.00 m")),
        (9, "{offset: 1.0}", "[[1, 1], [1, 1]]", ("robots[0].paths[2][1]", 9, 0), ()),
        (10, "v: 1.0", "v: -1.0", ("robots[0].limits.v", 10, 17), ("greater than 0",)),
        (11, "boss", "r5", ("robots[1].name", 11, 12), ('"r5"', "robots[0]")),
        (13, "late {number}", "late", ("robots[2].name", 13, 11), ("{number}",)),
        (13, "late {number}", "{number:0100000}", ("robots[2].name", 13, 11), ("{number}",)),
        (13, "late {number}", "boundary {number}", ("robots[2].name", 13, 11), ("wall",)),
        (14, "[36, 1], [36, 4.8]", "[30, 1], [30.4, 4.8]", ("robots[2].start.region", 14, 21), ()),
        (15, "footprint:", "footprints: []\n    footprint:", ("robots[2].footprints", 15, 17), ()),
        (16, "path:", "speeds: [1.0]  #", ("robots[2].path", 0, 0), ("path",)),
    ],
)  # fmt: skip
def test_each_fault_of_a_group_has_its_place(
    line: int,
    old: str,
    new: str,
    place: tuple[str, int, int],
    said: tuple[str, ...],
    tmp_path: Path,
) -> None:
    lines = list(LINES)
    assert old in lines[line - 1]
    lines[line - 1] = lines[line - 1].replace(old, new)
    file = tmp_path / "fleet.yaml"
    file.write_text("\n".join(lines), "utf-8")
    key, row, column = place
    found = [one for one in check_world(file).errors if one.key == key]
    assert found, check_world(file).errors
    assert not row or found[0].line == row
    assert not column or found[0].column == column
    assert all(word in found[0].message for word in said)


def test_groups_stand_for_no_more_robots_than_a_world_holds() -> None:
    """Nothing is made of them before: a short text cannot fill the memory."""
    group = {"count": MOST_ROBOTS, "footprint": Box(length=1, width=1), "path": Offset(offset=0.0)}
    other = {**group, "name": "s{number}"}
    with pytest.raises(WorldError, match=facts("robots", str(MOST_ROBOTS), str(2 * MOST_ROBOTS))):
        fleet(robots=[group, other])
    with pytest.raises(WorldError, match=facts("robots[0].count", str(MOST_ROBOTS))):
        fleet(robots=[{**group, "count": 10**15}])


def test_leads_and_neighbours_of_a_formation_count_and_name_the_robots_of_groups() -> None:
    leads = tuple(-0.5 * k for k in range(23))
    plan = {"spacing": leads, "neighbours": [["r1", "late 23"]]}
    scene = build_scene(fleet(formation=plan))
    assert scene.formation.lead.tolist() == list(leads)
    assert np.transpose(np.nonzero(scene.formation.adjacency)).tolist() == [[0, 22], [22, 0]]
    with pytest.raises(WorldError, match=facts("formation.spacing", "3", "23")):
        fleet(formation={"spacing": [0.0, 1.0, 2.0]})
    with pytest.raises(WorldError, match=facts("formation.neighbours[0][0]", '"r99"')):
        fleet(formation={"neighbours": [["r99", "r1"]]})


def test_rows_are_even_with_a_spread_of_nothing() -> None:
    start = {**fleet().start.model_dump(), "spread": 0.0}
    place = build_scene(fleet(start=start)).start[:20, :2].reshape(5, 4, 2)
    assert np.diff(place[:, :, 0], axis=0) == pytest.approx(-19.0 / 5, abs=0.2)
    assert np.diff(place[:, :, 1], axis=1) == pytest.approx(9.6 / 4, abs=0.2)
    half = build_scene(fleet(start={**start, "spread": 0.5})).start[:20, :2].reshape(5, 4, 2)
    assert np.abs(half - place).max() > 0.5
    assert (np.abs(half - place) <= 0.25 * np.array([19.0 / 5, 9.6 / 4]) + 0.2).all()
    with pytest.raises(WorldError, match=facts("start.spread", "abreast")):
        fleet(start={**start, "abreast": None})
