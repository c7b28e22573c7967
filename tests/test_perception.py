"""What robots know: stations, formation errors, and who and what is within range."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import shapely
from numpy.typing import ArrayLike

from physim import Decision, Scene, Simulation, build_scene, simulate
from physim.world import World
from tests.helpers import Says, inside, road

FloatArray = inside("physim.geometry", "FloatArray")

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


def test_a_robot_sees_robots_and_walls_within_its_range_only() -> None:
    """Robots by their places, walls by their nearest points, in the plane."""
    posts = [[[x, y], [x + 1.0, y], [x, y + 1.0]] for x in (10.0, 30.0) for y in (-5.0, 3.0)]
    for reach in (4.0, 6.8, 7.5, 25.0):
        world = cluster(range=reach).changed(obstacles=posts)
        simulation = Simulation(world, controller=STAND)
        place = simulation.pose[:, :2]
        for i in range(3):
            o = simulation.observe(i)
            gaps = np.hypot(*(place - place[i]).T)
            assert [one.index for one in o.others] == [
                j for j in range(3) if j != i and gaps[j] <= reach
            ]
            every = [*posts, *_pieces(simulation.scene)]
            here = shapely.Point(place[i])
            near = [wall for wall in every if here.distance(_shape(wall)) <= reach]
            assert {_shape(wall).wkb for wall in o.walls} == {_shape(wall).wkb for wall in near}
            assert len(o.walls) == len(near)


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


def _pieces(scene: Scene) -> list[FloatArray]:
    """Segments of all boundaries, as they are drawn."""
    ends = scene.walls.part_start
    parts = [scene.walls.vertices[a:b] for a, b in pairwise(ends)]
    return [part for part in parts if len(part) == 2]


def _shape(wall: ArrayLike) -> shapely.Geometry:
    wall = np.asarray(wall)
    return shapely.LineString(wall) if len(wall) == 2 else shapely.Polygon(wall)


def test_stations_that_are_seen_are_along_the_reference_path() -> None:
    simulation = Simulation(cluster(range=50.0), controller=STAND)
    own = simulation.observe(1)
    assert (own.station, own.reference_station) == pytest.approx((23.0, 18.0))
    assert [one.station for one in own.others] == pytest.approx([15.0, 24.0])
    assert build_scene(cluster()).paths.station[1] == pytest.approx(200.0)


def test_stations_go_with_the_robots() -> None:
    simulation = Simulation(cluster(), controller=STAND)
    for _ in range(50):
        simulation.step(np.array([[1.0, 0.0], [0.0, 0.0], [-0.5, 0.0]]))
    now = simulation.now
    assert now.station == pytest.approx([20.5, 23.0, 28.75])
    assert now.reference_station == pytest.approx([15.5, 18.0, 23.75])
