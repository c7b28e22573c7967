"""Lanes beside a path, and robots filled in on them: laps, crossings, loops, hairpins."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from physim.authoring.importing import Options, import_world
from physim.world.checks import check_world
from tests.helpers import inside
from tests.importing.drawn import LOOP, box, paths_of, ways_of
from tests.importing.plans import check_says, only
from tests.importing.test_joining import geojson
from tests.importing.test_places import free_area, refusal

without_loops = inside("physim.authoring.importing", "without_loops")


@pytest.mark.parametrize("corners", [
    [(0, 0), (40, 0), (40, 26), (0, 26)], [(0, 0), (0, 26), (40, 26), (40, 0)],
    [(0, 0), (40, 0), (20, 30)],
], ids=["left about", "right about", "triangle"])  # fmt: skip
@pytest.mark.parametrize("lanes", [2, 3])
def test_lanes_of_a_lap_from_a_corner_go_round(
    tmp_path: Path, corners: list[tuple[float, float]], lanes: int
) -> None:
    parts = [("boundary", shapely.box(-16, -26, 76, 46)),
             ("path", shapely.LineString([*corners, corners[0]]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts), Options(robots=2 * lanes, lanes=lanes))
    lap = shapely.LineString([*corners, corners[0]]).length
    lengths = [shapely.LineString(path).length for path in paths_of(made)]
    assert min(lengths) > 0.8 * lap
    if lanes == 2:  # all begin at the beginning, so that they end in order
        assert not [one for one in made.changes if "shortened" in one]


def test_a_lane_goes_round_where_its_path_crosses_itself(tmp_path: Path) -> None:
    way = [(0, 0), (60, 0), (60, 20), (30, 20), (30, -20)]
    parts = [("boundary", shapely.box(-10, -40, 80, 40)), ("path", shapely.LineString(way))]
    made = import_world(geojson(tmp_path, parts), Options(robots=4, lanes=2))
    lengths = [shapely.LineString(path).length for path in paths_of(made)]
    assert min(lengths) > shapely.LineString(way).length - 10.0


def test_lines_given_are_not_changed() -> None:
    line = np.array([(0.0, 0.0), (10, 0), (10, 5), (5, 5), (5, -5)])
    before = line.copy()
    without_loops(line, float("inf"))
    assert (line == before).all()


def _turned(points: Any, angle: float) -> list[tuple[float, float]]:
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return [tuple(point) for point in (np.asarray(points) @ turn).tolist()]


MIDDLE = [(12, 0), (24, 0), (24, 16), (0, 16), (0, 0), (12, 0)]
DODECAGON = [(14 * np.cos(k * np.pi / 6), 14 * np.sin(k * np.pi / 6)) for k in (*range(12), 0)]


@pytest.mark.parametrize("lap", [MIDDLE, DODECAGON, LOOP], ids=["box", "round", "corner"])
@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize(("robots", "lanes"), [(2, 2), (3, 3), (4, 4)])
def test_robots_filled_in_on_a_lap_drive_it(
    tmp_path: Path, lap: list[Any], back: bool, robots: int, lanes: int
) -> None:
    """None starts at the joint, where rounding decides whether it is at the end already."""
    hall = shapely.buffer(shapely.Polygon(lap), 9, join_style="mitre")
    for angle in (0.3, 1.1, 2.2, 4.0):
        way = _turned(lap[::-1] if back else lap, angle)
        place = shapely.Polygon(_turned(hall.exterior.coords, angle))
        plan = geojson(tmp_path, [("boundary", place), ("path", shapely.LineString(way))])
        made = import_world(plan, Options(robots=robots, lanes=lanes))
        free_area(made, tmp_path)
        reference = shapely.LineString(np.asarray(made.world.reference_path))
        starts = [reference.project(shapely.Point(one.pose[:2])) for one in made.world.robots]
        assert max(starts) < 0.3 * reference.length
        assert min(ways_of(made)) > 0.6 * reference.length
        said = check_world(tmp_path / "made.yaml").warnings
        assert not [one for one in said if "against" in str(one)]


@pytest.mark.parametrize("begin", [0, 7, 20, 33])
@pytest.mark.parametrize("is_whole", [True, False])
def test_lanes_of_a_figure_of_eight_go_round(tmp_path: Path, begin: int, is_whole: bool) -> None:
    at = np.linspace(0.0, 2.0 * np.pi, 81)[:-1]
    eight = np.roll(np.stack([18 * np.sin(at), 12 * np.sin(2 * at)], axis=1), -begin, axis=0)
    lap = shapely.LineString([*eight.round(3), eight[0].round(3)][: None if is_whole else -1])
    parts = [("boundary", shapely.box(-40, -30, 40, 30)), ("path", lap)]
    made = import_world(geojson(tmp_path, parts), Options(robots=4, lanes=2))
    assert min(shapely.LineString(path).length for path in paths_of(made)) > 0.9 * lap.length


def test_lanes_end_where_their_path_does_beside_a_loop_at_its_end(tmp_path: Path) -> None:
    """The place nearest to its end lies on another leg."""
    turns = np.linspace(-np.pi / 2.0, np.pi * 1.05, 40)
    loop = np.array([(40.0 + 3.0 * np.cos(t), 3.0 + 3.0 * np.sin(t)) for t in turns])
    way = shapely.LineString([(0, 0), *loop, loop[-1] + np.array([0.32, -1.98])])
    parts = [("boundary", shapely.buffer(way, 2.2)), ("path", way)]
    made = import_world(geojson(tmp_path, parts), Options(robots=4, lanes=2))
    reference = shapely.LineString(np.asarray(made.world.reference_path))
    assert min(shapely.LineString(one).length for one in paths_of(made)) > 0.85 * reference.length


@pytest.mark.parametrize("far", [40, 60])
def test_robots_filled_in_count_where_they_stand(tmp_path: Path, far: int) -> None:
    """Beside a small loop at the beginning of a long path, not on its other leg."""
    turns = np.linspace(-np.pi / 2.0, 3.0 * np.pi / 2.0, 40)[1:]
    loop = [(14.0 + 4.0 * np.cos(t), 4.0 + 4.0 * np.sin(t)) for t in turns]
    way = shapely.LineString([(0, 0), (14, 0), *loop, (16, -2), (16, -far)])
    parts = [("boundary", shapely.box(-8, -far - 8, 34, 20)), ("path", way)]
    made = import_world(geojson(tmp_path, parts), Options(robots=6, lanes=2))
    reference = shapely.LineString(np.asarray(made.world.reference_path))
    starts = [reference.project(shapely.Point(one.pose[:2])) for one in made.world.robots]
    assert (np.diff(starts) < 0.0).all()
    assert starts[0] < 20.0


@pytest.mark.parametrize("gap", [2.0, 3.0])
@pytest.mark.parametrize("back", [0.0, -6.0])
def test_a_lane_keeps_the_hairpins_of_its_path(tmp_path: Path, gap: float, back: float) -> None:
    """Whose legs are nearer to each other than twice as far as it is beside them."""
    way = shapely.LineString([(-30, 0), (26, 0), (26, gap), (back, gap), (back, 20), (60, 20)])
    parts = [("boundary", shapely.box(-60, -60, 120, 60)), ("path", way),
             ("robot a", box(-28, 0)), ("robot b", box(-25, 1.8))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert min(ways_of(made)) > way.length - 15.0
    reference = shapely.LineString(np.asarray(made.world.reference_path))
    path = shapely.LineString(paths_of(made)[1])
    at = [reference.project(path.interpolate(x)) for x in np.arange(0.0, path.length, 1.0)]
    assert np.abs(np.diff(at)).max() < 8.0
    assert not check_world(tmp_path / "made.yaml").warnings


@pytest.mark.parametrize("way", [
    [(-80, 0), (40, 0), (40, 3.5), (-20, 3.5)],
    [(-80, 0), (26, 0), (26, 3), (-86, 3), (-86, -20), (80, -20)],
    [(-80, 0), (40, 0), (40, 1.5), (-20, 6)],
    [(-110, 0), (100, 0), (100, 10), (-20, 1.5), (-60, 1.5)],
], ids=["ends in it", "begins beside it", "opens", "widens to its tip"])  # fmt: skip
def test_lanes_stay_beside_their_leg_of_a_hairpin(tmp_path: Path, way: list[Any]) -> None:
    """Also where they do not cross at its open end: a run would take robots for elsewhere."""
    parts = [("boundary", shapely.box(-120, -60, 120, 60)), ("path", shapely.LineString(way))]
    made = import_world(geojson(tmp_path, parts), Options(robots=6, lanes=3))
    free_area(made, tmp_path)
    assert not check_world(tmp_path / "made.yaml").warnings
    reference = shapely.LineString(np.asarray(made.world.reference_path))
    starts = [reference.project(shapely.Point(one.pose[:2])) for one in made.world.robots]
    assert np.diff(starts) == pytest.approx([-3.2] * 5, abs=0.5)
    for path in paths_of(made):
        line = shapely.LineString(path)
        at = [reference.project(line.interpolate(x)) for x in np.arange(0.0, line.length, 1.0)]
        assert np.abs(np.diff(at)).max() < 8.0


CROSSED = [(0, 0), (40, 0), (40, 3), (0, 3), (0, 30), (20, 30), (20, -30), (60, -30)]


@pytest.mark.parametrize(("robots", "lanes"), [(6, 3), (4, 2)])
def test_a_group_that_would_lose_its_path_is_refused(
    tmp_path: Path, robots: int, lanes: int
) -> None:
    """Whose lanes leave out a hairpin that the path crosses later; in single file it goes."""
    parts = [("boundary", shapely.box(-20, -50, 80, 50)), ("path", shapely.LineString(CROSSED))]
    said = refusal(geojson(tmp_path, parts), Options(robots=robots, lanes=lanes))
    check_says(said, "would leave out a part … and the formation would be lost; fewer --lanes")
    made = import_world(geojson(tmp_path, parts), Options(robots=robots))
    free_area(made, tmp_path)
    assert min(ways_of(made)) > 200.0


AISLE = [(0, 0), (10, 0), (10, -25), (11, -25), (11, 0), (25, 0), (25, 20), (45, 20), (45, 0),
         (70, 0), (70, 30)]  # fmt: skip


@pytest.mark.parametrize(("robots", "lanes"), [(4, 2), (2, 2)])
def test_a_group_that_leaves_out_most_of_a_path_it_crosses_is_refused(
    tmp_path: Path, robots: int, lanes: int
) -> None:
    """All its lanes do so alike: as a formation nothing is lost."""
    way = [(0, 0), (30, 0), (30, 3), (0, 3), (0, 12), (15, 12), (15, -10)]
    parts = [("boundary", shapely.box(-20, -30, 60, 40)), ("path", shapely.LineString(way))]
    said = refusal(geojson(tmp_path, parts), Options(robots=robots, lanes=lanes))
    check_says(said, "would leave out a part")


@pytest.mark.parametrize("hook", [[], [(40, 0), (40.002, 0.001), (40, 0.002)]], ids=["", "hook"])
def test_a_group_that_leaves_out_aisles_is_refused_whatever_corner_is_elsewhere(
    tmp_path: Path, hook: list[tuple[float, float]]
) -> None:
    """A lane is far from a sharp corner, but not from what is far from that."""
    aisles = [(10, 0), (10, 7), (11, 7), (11, 0), (20, 0), (20, 7), (21, 7), (21, 0)]
    way = [(0, 0), *aisles, *hook, (50, 0)]
    parts = [("boundary", shapely.box(-10, -10, 60, 60)), ("path", shapely.LineString(way))]
    said = refusal(geojson(tmp_path, parts), Options(robots=6, lanes=4))
    check_says(said, "r4 would leave out a part")


@pytest.mark.parametrize("ring", [[(6, 0), (12, 0), (12, 10), (0, 10), (0, 0), (6, 0)]])
def test_a_group_on_a_small_lap_is_not_refused(
    tmp_path: Path, ring: list[tuple[float, float]]
) -> None:
    """Its inner lane is a good deal shorter, within the corners."""
    parts = [("boundary", shapely.box(-6, -6, 18, 16)), ("path", shapely.LineString(ring))]
    made = import_world(geojson(tmp_path, parts), Options(robots=4, lanes=3))
    assert len(made.world.robots) == 4


@pytest.mark.parametrize(("way", "is_lost"), [
    (CROSSED, True), ([*LOOP[:-1], (-4, 14), (-4, -2), (20, -2)], False), (LOOP, False),
    ([(0, 0), (40, 0), (5, 6)], False), ([(0, 0), (40, 0), (40, 30)], False),
], ids=["hairpin", "spiral", "lap", "sharp", "corner"])  # fmt: skip
@pytest.mark.parametrize("beside", [1.8, -1.8])
def test_a_lane_that_leaves_out_a_part_of_its_path_is_told(
    tmp_path: Path, way: list[Any], is_lost: bool, beside: float
) -> None:
    """Not one that is merely shorter within bends, or longer outside them."""
    parts = [("boundary", shapely.box(-20, -50, 80, 50)), ("path", shapely.LineString(way)),
             ("robot b", box(3, beside, 1.2, 0.7))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    told = [one for one in made.changes if "it leaves out" in one]
    assert bool(told) == is_lost
    for one in told:
        check_says(one, f"WARNING: path of b … {shapely.LineString(way).length:.2f} m … named b")
    length = shapely.LineString(way).length
    assert is_lost or abs(shapely.LineString(paths_of(made)[0]).length - length) < 16.0


def test_a_lane_that_leaves_out_an_aisle_is_told_however_many_bends_there_are(
    tmp_path: Path,
) -> None:
    """By how far it is from the aisle, where it may be as much shorter for the bends."""
    parts = [("boundary", shapely.box(-20, -50, 90, 50)), ("path", shapely.LineString(AISLE)),
             ("robot b", box(3, 3, 1.2, 0.7))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    check_says(only(made, "WARNING"), "path of b, +3.00 m beside … it leaves out a part")
