"""Robots stop apart: a path whose end has them too near each other in a bend is shortened."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from physim import Simulation, build_scene
from physim.authoring.importing import Imported, Options, import_world, lanes, robots
from tests.helpers import inside
from tests.importing.plans import check_says, svg
from tests.importing.test_joining import geojson

Placed, least_stop_gap = inside("physim.authoring.importing", "Placed", "least_stop_gap")
stop_stations = inside("physim.authoring.importing", "stop_stations")
CONTROLLER, make_part = inside("physim.parts", "CONTROLLER", "make_part")

BOX = (1.8, 1.0)
CORNER = np.array([(0.0, 0.0), (30.0, 0.0), (30.0, 10.0)])


def track(folder: Path, points: np.ndarray, half: float) -> Path:
    path = folder / "t.csv"
    path.write_text("".join(f"{x},{y},{half},{half}\n" for x, y in points))
    return path


def test_stops_are_those_of_the_scene(tmp_path: Path) -> None:
    path = track(tmp_path, CORNER * 2.0, 3.0)
    world = import_world(path, Options(robots=4, lanes=2)).world
    scene = build_scene(world)
    paths = scene.paths
    lines = [paths.points[a:b] for a, b in zip(paths.start[:-1], paths.start[1:], strict=True)]
    poses = [tuple(pose) for pose in scene.start]
    stops = stop_stations(scene.reference.points, lines, poses)
    assert stops == pytest.approx(scene.stop_station, abs=1e-6)


def test_the_gap_at_the_stops() -> None:
    """Two boxes on the same leg, and one far behind, before the corner."""
    poses = [(19.4, 0.0, 0.0), (3.0, 0.0, 0.0), (17.0, 0.0, 0.0)]
    robots = [Placed("r", BOX, pose, CORNER, 0.0) for pose in poses]
    assert least_stop_gap(CORNER, robots, 1.0) == (pytest.approx(0.6), 0, 2)
    same = [robots[0], robots[1], robots[0]]
    assert least_stop_gap(CORNER, same, 1.0) == (0.0, 0, 2)
    first, other = shapely.box(29.5, 9.1, 30.5, 10.9), shapely.box(22.7, -0.5, 24.5, 0.5)
    far = first.distance(other)
    assert least_stop_gap(CORNER, robots[:2], 1.0) == (pytest.approx(far), 0, 1)
    assert least_stop_gap(CORNER, robots[:1], 1.0)[0] == np.inf


def finishes(imported: Imported) -> bool:
    choice = imported.world.controller
    controller = make_part(CONTROLLER, choice.type, choice.settings)
    simulation = Simulation(build_scene(imported.world), controller=controller)
    for _ in range(4000):
        if simulation.finished:
            return True
        simulation.step()
    return False


def test_a_path_that_ends_after_a_bend_is_shortened_until_all_arrive(tmp_path: Path) -> None:
    imported = import_world(track(tmp_path, CORNER, 3.0), Options(robots=4))
    told = [change for change in imported.changes if "more at its end" in change]
    assert len(told) == 1
    check_says(told[0], "1.20 m more … bend … 0.28 m … 1.20 m")
    assert finishes(imported)


def test_who_stops_just_behind_a_corner_still_heads_as_it_came(tmp_path: Path) -> None:
    """A corner is cut, and who stops half a metre behind it lies across it: the next one waits."""
    aisles = [(16.59, 0), (0, 0), (0, 3.53), (13.29, 3.53), (13.29, 3.93), (0, 3.93), (0, 11.4),
              (16.59, 11.4), (16.59, 7.87), (3.29, 7.87), (3.29, 7.47), (16.59, 7.47)]  # fmt: skip
    way = [(1.65, 1.77), (14.94, 1.77), (14.94, 5.7), (1.65, 5.7), (1.65, 9.64), (14.94, 9.64)]
    parts = [("boundary", shapely.Polygon(aisles)), ("path", shapely.LineString(way))]
    imported = import_world(geojson(tmp_path, parts), Options(robots=6))
    assert [change for change in imported.changes if "more at its end" in change]
    assert finishes(imported)


def test_robots_are_spread_where_no_end_of_the_path_will_do(tmp_path: Path) -> None:
    """Legs of 10 m, shorter than the group: a corner is among its stops wherever that ends."""
    points = [(0, 0), (10, 0), (20, 0), (20, 10), (20, 20), (30, 20), (40, 20), (40, 10), (40, 0),
              (50, 0)]  # fmt: skip
    imported = import_world(
        track(tmp_path, np.array(points, dtype=float), 3.0), Options(robots=4, lanes=2)
    )
    told = [change for change in imported.changes if "more at its end" in change]
    assert len(told) == 1
    check_says(told[0], "1.25 times as far apart … bend")
    along = [robot.pose[0] for robot in imported.world.robots]
    assert np.diff(along) == pytest.approx([-4.0] * 3, abs=0.3)


def test_lanes_are_made_once_and_end_beside_the_shortened_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They cost far more than to try where the path may end."""
    made = []

    def counted(*given: Any) -> Any:
        made.append(lanes.lane(*given))
        return made[-1]

    monkeypatch.setattr(robots, "lane", counted)
    found = import_world(track(tmp_path, CORNER * 2.0, 3.0), Options(robots=6, lanes=3))
    assert [one for one in found.changes if "shortened" in one]
    assert len(made) == 3
    reference = np.asarray(found.world.reference_path)
    for robot in found.world.robots:
        if isinstance(robot.path, tuple | list):
            leg = reference[-1] - reference[-2]
            beyond = np.asarray(robot.path)[-1] - reference[-1]
            assert abs(beyond @ leg) < 0.3 * np.hypot(*leg)


def test_a_straight_end_is_left_as_it_is(tmp_path: Path) -> None:
    line = np.array([(0.0, 0.0), (15.0, 0.0), (15.0, 40.0)])
    imported = import_world(track(tmp_path, line, 3.0), Options(robots=4, lanes=2))
    assert not any("more at its end" in change for change in imported.changes)
    assert not any(fact.startswith("mind") for fact in imported.facts)


@pytest.mark.parametrize(("apart", "told"), [
    (0.8, ("may touch where their paths meet", "a and b", "15.18 and 15.18 m")),
    (1.8, ("--to", "a and b", "0.68 m")), (2.2, ()),
])  # fmt: skip
def test_drawn_robots_that_stop_near_each_other_are_told(
    tmp_path: Path, apart: float, told: tuple[str, ...]
) -> None:
    """Two abreast, on paths that end in the same place, beside each other, or well apart."""
    low, high = 7.0 - 0.5 * apart, 7.0 + 0.5 * apart
    path = tmp_path / "d.svg"
    path.write_text(
        svg(
            '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/><path id="path" d="M 2,7 H 20"/>'
            '<rect id="robot_a" x="4" y="4.5" width="1.8" height="1"/>'
            '<rect id="robot_b" x="4" y="8.5" width="1.8" height="1"/>'
            f'<path id="path_a" d="M 4,5 L 20,{low}"/><path id="path_b" d="M 4,9 L 20,{high}"/>'
        )
    )
    imported = import_world(path, Options(scale=1.0))
    found = [fact for fact in imported.facts if fact.startswith("note: ")]
    assert len(found) == bool(told)
    for part in told:
        assert part in found[0]


@pytest.mark.parametrize("wider", [0.0, 0.2, 0.4, 1.5])
def test_a_path_ends_clear_of_a_wall_where_its_corridor_widens(
    tmp_path: Path, wider: float
) -> None:
    """However much more room there is beside it near the wall."""
    hall = shapely.Polygon([(0, -1.2), (40, -1.2 - wider), (40, 1.2 + wider), (0, 1.2)])
    parts = [("boundary", hall), ("path", shapely.LineString([(3, 0), (39.5, 0)])),
             ("robot", shapely.box(3.2, -0.4, 4.8, 0.4))]  # fmt: skip
    (x, _) = import_world(geojson(tmp_path, parts)).world.reference_path[-1]
    assert 37.0 < x < 40.0 - 0.8 - 1.0


@pytest.mark.parametrize("funnel", [3.0, 7.0, 10.0, 12.0])
def test_a_funnel_at_an_end_makes_no_robots_smaller(tmp_path: Path, funnel: float) -> None:
    """Which have the room but for its last few metres; a long neck does."""
    x = 20.0 + funnel
    hall = shapely.Polygon([(0, -5), (20, -5), (x, -0.5), (x, 0.5), (20, 5), (0, 5)])
    parts = [("boundary", hall), ("path", shapely.LineString([(0.5, 0), (x - 0.5, 0)]))]
    made = import_world(geojson(tmp_path, parts))
    assert any("1.8 x 1.0 m, as large as fits" in fact for fact in made.facts)
    neck = hall.union(shapely.box(x - 1.0, -1.2, x + 14.0, 1.2))
    parts = [("boundary", neck), ("path", shapely.LineString([(0.5, 0), (x + 13, 0)]))]
    made = import_world(geojson(tmp_path, parts))
    assert not any("1.8 x 1.0 m, as large as fits" in fact for fact in made.facts)


@pytest.mark.parametrize("wide", [3.0, 4.2, 6.0, 8.4, 9.0])
def test_a_bulge_in_a_corridor_makes_no_robots_smaller(tmp_path: Path, wide: float) -> None:
    """Though it would be a roomy place to end, at both ends."""
    bulge = shapely.box(6.0 - wide / 2, -4.0, 6.0 + wide / 2, 4.0)
    hall = shapely.box(-4, -1.85, 16, 1.85).union(bulge)
    parts = [("boundary", hall), ("path", shapely.LineString([(1, 0), (11, 0)]))]
    made = import_world(geojson(tmp_path, parts))
    assert any("1.8 x 1.0 m, as large as fits" in fact for fact in made.facts)
