"""Observations: who and what is in range, stations and errors; made later, yet as of then."""

from __future__ import annotations

import copy
import pickle
import re
from dataclasses import fields, replace
from typing import Any, cast

import numpy as np
import pytest

from physim import Decision, Observation, Sensed, Simulation, View, for_each, simulate
from physim.errors import PhysimError
from physim.world import World
from physim.world.file import parse_world
from tests.helpers import Says, facts, inside, road
from tests.oracles.observation import observe as observed_at_once

FloatArray = inside("physim.geometry", "FloatArray")
contents, difference = inside("physim.testing", "contents", "difference")
own = inside("physim.testing", "own_arrays")
describe = inside("physim.world", "describe")

REACH = 10.0


def crowd(robots: int, **more: Any) -> Simulation:
    """Robots on a wide road, with obstacles between them; nobody is asked yet."""
    rng = np.random.default_rng(robots)
    place = 3.0 * np.stack(np.divmod(np.arange(robots), 9), axis=1) + [20.0, -13.0]
    place[:, :2] += rng.uniform(-0.4, 0.4, (robots, 2))
    posts = [[[x, 14.0], [x + 1.0, 14.0], [x, 15.0]] for x in range(20, 60, 8)]
    world = road(
        np.c_[place, rng.uniform(-3.0, 3.0, robots)].tolist(),
        obstacles=posts,
        formation={"spacing": "initial", **more},
        sensing={"range": REACH},
    )
    simulation = Simulation(world, controller=Says(lambda o: Decision(0.3, 0.2, hold=0.02)))
    for _ in range(3):
        simulation.step()
    return simulation


def sensed_before(simulation: Simulation) -> Sensed:
    """What was sensed at the sample at which the last step began."""
    assert simulation.last is not None
    return simulation.last.sensed


def shared(simulation: Simulation) -> Sensed:
    """Rows that all share, in an order that is not that of the robots, behind rows of nobody."""
    sensed, robots = sensed_before(simulation), simulation.scene.robots
    shuffled = np.random.default_rng(5).permutation(robots)
    taken = np.concatenate((np.resize(shuffled, 7), shuffled))
    first, end = np.full(robots, 7), np.full(robots, 7 + robots)
    rows = (
        sensed.robot,
        sensed.pose,
        sensed.command,
        sensed.velocity,
        sensed.reference_station,
        sensed.age,
    )
    age, heard = np.multiply.outer((0.001, 0.002), np.arange(len(taken)))
    seven = Sensed(sensed.step, *(one[taken] for one in rows), first, end, sensed.station, heard)
    return own(seven._replace(age=age))


def apart(simulation: Simulation) -> Sensed:
    """Rows of its own for everybody, in which others are elsewhere and some are missing."""
    sensed = for_each(shared(simulation))
    rng = np.random.default_rng(3)
    pose = sensed.pose + rng.normal(0.0, 0.3, sensed.pose.shape)
    end = sensed.end.copy()
    for i in range(len(end)):  # as many as can be, with one of itself still there
        while end[i] > sensed.first[i] + 1 and sensed.robot[end[i] - 1] != i and rng.random() < 0.8:
            end[i] -= 1
    return own(sensed._replace(pose=pose, end=end))


@pytest.mark.parametrize("robots", [1, 9, pytest.param(80, marks=pytest.mark.deep)])
@pytest.mark.parametrize("rows", [shared, apart])
@pytest.mark.parametrize("plan", [{"range": 4.0}, {"neighbours": "all"}])
def test_observations_are_those_of_the_oracle(robots: int, rows: Any, plan: dict[str, Any]) -> None:
    simulation = crowd(robots, **plan)
    scene, sensed = simulation.scene, rows(simulation)
    due = np.arange(robots)[:: 2 if robots > 1 else 1]
    view = View(scene, sensed)
    seen = walls = 0
    for i in due.tolist():
        made, wanted = view.observation(i), observed_at_once(scene, sensed, i)
        assert type(made) is Observation
        assert difference(contents(wanted, "o"), contents(made, "o")) is None
        seen, walls = seen + len(made.others), walls + len(made.walls)
    assert (seen > 0) == (robots > 1)
    assert walls > 0


def test_what_is_asked_for_later_is_what_was_true_then() -> None:
    simulation = crowd(40)
    kept = [simulation.observe(i) for i in range(40)]
    simulation.step()
    sensed = sensed_before(simulation)
    wanted = [contents(observed_at_once(simulation.scene, sensed, i), "o") for i in range(40)]
    for _ in range(20):
        simulation.step()
    assert simulation.observe(0).others[0].pose[0] != kept[0].others[0].pose[0]
    for one, then in zip(kept, wanted, strict=True):
        assert difference(then, contents(one, "o")) is None


def test_an_observation_is_a_value_though_nothing_of_it_was_asked_for() -> None:
    simulation = crowd(12)  # the ninth sees a wall
    ahead = copy.deepcopy(simulation)
    ahead.step()
    wanted = contents(observed_at_once(ahead.scene, sensed_before(ahead), 8), "o")
    for form in (
        lambda o: pickle.loads(pickle.dumps(o)),
        copy.copy,
        copy.deepcopy,
        replace,
        lambda o: Observation(**{f.name: getattr(o, f.name) for f in fields(o)}),
    ):
        assert difference(wanted, contents(form(simulation.observe(8)), "o")) is None
    changed = replace(simulation.observe(8), others=(), v=0.25)
    assert (changed.others, changed.v) == ((), 0.25)
    assert changed.walls
    seen = simulation.observe(8)
    assert re.search(facts("Observation 8", seen.name, f"{seen.station:.3f}"), repr(seen))
    assert len(repr(seen)) < 200
    assert "walls" not in vars(seen)  # not made for that
    for array in (*seen.path.lines, seen.path.outside):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 1
    with pytest.raises(AttributeError):
        simulation.observe(8).other  # type: ignore[attr-defined]  # noqa: B018


@pytest.mark.parametrize("i", ["r1", 12, -1, 1.0, None])
def test_robots_are_observed_by_number(i: Any) -> None:
    with pytest.raises(PhysimError, match=re.escape(f"robot {describe(i)}; allowed: 0 to")):
        crowd(12).observe(i)
    assert crowd(12).observe(cast(int, np.int64(3))).index == 3


# Stations, formation errors and neighbours

STAND = Says(lambda o: Decision(0.0, 0.0, hold=0.1))
PLACES = [[20.0, -6.0, 0.0], [23.0, 0.0, 0.0], [29.0, 6.0, 0.0]]


def cluster(**plan: Any) -> World:
    """Three robots; the reference path begins 5 m later than their own paths."""
    return road(
        PLACES,
        duration=0.1,
        reference_path=[[5.0, 0.0], [195.0, 0.0]],
        formation={"spacing": [0.0, 2.0, 12.0], "range": 8.0, **plan},
    )


def test_a_robot_behind_its_place_has_a_positive_formation_error() -> None:
    """(10): its distance to the mean place of all robots, less the desired one."""
    record = simulate(cluster(), controller=STAND)
    rows = record.updates[record.updates["step"] == 0]
    assert rows["reference_station"] == pytest.approx([15.0, 18.0, 24.0])
    # on average the robots are at 19 m and should lead the first by 14/3 m
    wanted = np.array([0.0, 2.0, 12.0]) - 14.0 / 3.0
    assert rows["formation_error"] == pytest.approx(19.0 + wanted - [15.0, 18.0, 24.0])
    assert rows["formation_error"][2] > 0.0  # it should lead by 12 m, and leads by 9 m


def test_deviations_in_the_record_are_positive_on_the_left() -> None:
    robots = [robot.model_dump() for robot in cluster().robots]
    for robot, aside in zip(robots, (0.5, -1.5, 0.0), strict=True):
        robot["path"] = [[0.0, robot["pose"][1] - aside], [200.0, robot["pose"][1] - aside]]
    record = simulate(cluster().changed(robots=robots), controller=STAND)
    rows = record.updates[record.updates["step"] == 0]
    assert rows["deviation"] == pytest.approx([0.5, -1.5, 0.0])
    assert rows["station"] == pytest.approx([20.0, 23.0, 29.0])


@pytest.mark.parametrize(
    ("neighbours", "reach", "expected"),
    [
        ("range", 8.0, [[1], [0, 2], [1]]),
        ("range", 2.9, [[], [], []]),
        ("range", 9.0, [[1, 2], [0, 2], [0, 1]]),  # just within counts
        ("all", 2.9, [[1, 2], [0, 2], [0, 1]]),
        ([["r3", "r1"]], 2.9, [[2], [], [0]]),
    ],
)
def test_neighbours_are_within_range_along_the_reference_path(
    neighbours: Any, reach: float, expected: list[list[int]]
) -> None:
    """Along s*, however far aside; and their stations and leads are told."""
    simulation = Simulation(cluster(neighbours=neighbours, range=reach), controller=STAND)
    for i, others in enumerate(expected):
        seen = simulation.observe(i).neighbours
        assert [one.index for one in seen] == others
        assert [one.station for one in seen] == pytest.approx(
            [(15.0, 18.0, 24.0)[j] for j in others]
        )
        assert [one.lead for one in seen] == [(0.0, 2.0, 12.0)[j] for j in others]


def test_the_range_of_sensing_is_its_own() -> None:
    """Neighbours of the formation are told of however short the sight is; and the other way."""
    short = cluster(range=50.0).changed(sensing={"range": 4.0})
    simulation = Simulation(short, controller=STAND)
    assert simulation.observe(0).range == 4.0
    assert simulation.observe(0).others == ()
    assert [one.index for one in simulation.observe(0).neighbours] == [1, 2]
    far = cluster(range=1.0).changed(sensing={"range": 60.0})
    simulation = Simulation(far, controller=STAND)
    assert [one.index for one in simulation.observe(0).others] == [1, 2]
    assert simulation.observe(0).neighbours == ()
    alone = road(PLACES, sensing={"range": 7.0})
    assert [one.index for one in Simulation(alone, controller=STAND).observe(0).others] == [1]
    assert Simulation(road(PLACES), controller=STAND).observe(0).range == 10.0


def test_stations_go_with_the_robots() -> None:
    simulation = Simulation(cluster(), controller=STAND)
    for _ in range(50):
        simulation.step(np.array([[1.0, 0.0], [0.0, 0.0], [-0.5, 0.0]]))
    now = simulation.now
    assert now.station == pytest.approx([20.5, 23.0, 28.75])
    assert now.reference_station == pytest.approx([15.5, 18.0, 23.75])


WALLED = """
name: walled
time: {step: 0.02, duration: 1.0}
boundaries:
  - [[0, 0], [10, 0], [10, 6], [0, 6], [0, 0]]
  - [[4, 6], [4, 4], [5, 4]]
obstacles: [[[7, 1], [8, 1], [8, 2], [7, 2]]]
robots: [{name: a, footprint: {length: 0.6, width: 0.4}, pose: [2, 3, 0], path: [[2, 3], [9, 3]]}]
reference_path: [[2, 3], [9, 3]]
controller: {type: constant}
"""


@pytest.mark.parametrize("turned", [False, True])
def test_walls_know_what_joins_them_and_where_robots_may_be(turned: bool) -> None:
    text = WALLED
    if turned:  # the other way round
        text = text.replace("[10, 0], [10, 6], [0, 6]", "[0, 6], [10, 6], [10, 0]")
    walls = Simulation(parse_world(text)).observe(0).walls
    ring, inner, solid = walls[:4], walls[4:6], walls[6]
    assert [wall.index for wall in walls] == list(range(7))
    assert [(wall.before, wall.after) for wall in ring] == [(3, 1), (0, 2), (1, 3), (2, 0)]
    assert {wall.free for wall in ring} == {"right" if turned else "left"}
    assert [(wall.before, wall.after) for wall in inner] == [(None, 5), (4, None)]
    assert {wall.free for wall in inner} == {None}
    assert (solid.before, solid.after, solid.free) == (None, None, "outside")
