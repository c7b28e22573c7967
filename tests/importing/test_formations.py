"""Which drawn robots are a formation: those that can be measured along the reference path."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim import simulate
from physim.authoring.importing import import_world
from physim.world.checks import check_world
from tests.importing.drawn import HALL, LOOP, WAY, box, paths_of, ways_of
from tests.importing.plans import check_says, only
from tests.importing.test_joining import geojson
from tests.importing.test_places import free_area


@pytest.mark.parametrize(
    "other", [[(45, 9), (5, 9)], [(25, 11), (25, 1)]], ids=["against", "across"]
)
def test_robots_that_go_another_way_are_no_formation(
    tmp_path: Path, other: list[tuple[float, float]]
) -> None:
    """It would have those behind stop as far before their ends, after a step."""
    x, y = other[0]
    parts = [
        ("boundary", shapely.box(0, -4, 50, 16)), ("path", shapely.LineString([(3, 4), (47, 4)])),
        ("path east", shapely.LineString(other)),
        *(("robot", shapely.box(a, 3.5, a + 1.6, 4.5)) for a in (8, 4)),
        ("robot east", shapely.box(x - 0.8, y - 0.5, x + 0.8, y + 0.5)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    front, rear, east = paths_of(made)
    assert rear[-1, 0] == pytest.approx(front[-1, 0] - 4.0, abs=0.01)
    assert [tuple(point) for point in east] == other
    assert [one for one in made.facts if "no formation" in one]
    along = import_world(geojson(tmp_path, [*parts[:2], *parts[3:5]]))
    assert along.world.formation is not None


RING = [(12, 11), (20, 11), (20, 3), (4, 3), (4, 11), (12, 11)]
U = [(0, 0), (20, 0), (20, 14), (0, 14)]


@pytest.mark.parametrize(("reference", "own", "is_along"), [
    (LOOP, RING, False), (LOOP, RING[::-1], False), (U, [(12, 4), (12, 13)], False),
    (U, [(3, 2), (18, 2), (18, 12), (3, 12)], True), (U, [(3, -2), (22, -2), (22, 16)], False),
    (U, [(3, -2), (22, -2), (22, 16), (2, 16)], True),
    (U, [(2, -1), (10, -1), (10, 13), (2, 13)], False), (U, [(2, 2), (14, 7), (2, 12)], False),
    ([(0, 0), (24, 0)], [(1, 2), (18, 2), (18, 4), (12, 4), (12, 6), (23, 6)], False),
], ids=["against", "another lap", "across", "inside", "without an end", "outside", "short cut",
        "tip", "to and fro"])  # fmt: skip
def test_a_formation_goes_where_it_can_be_measured(
    tmp_path: Path, reference: list[Any], own: list[Any], is_along: bool
) -> None:
    """A robot's own path along the reference path has a like length on it, part by part."""
    ahead = np.array(own[1]) - own[0]
    turn = float(np.arctan2(ahead[1], ahead[0]))
    b = shapely.affinity.rotate(box(0, 0, 1.2, 0.6), turn, (0, 0), use_radians=True)
    parts = [("boundary", shapely.box(-6, -6, 30, 20)), ("path", shapely.LineString(reference)),
             ("robot a", box(0.9, 0, 1.2, 0.6)), ("path b", shapely.LineString(own)),
             ("robot b", shapely.affinity.translate(b, *own[0]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert (made.world.formation is not None) == is_along
    assert bool([one for one in made.facts if "no formation" in one]) != is_along


def test_robots_that_would_stop_in_one_place_are_no_formation(tmp_path: Path) -> None:
    """Measured along the reference path, which theirs joins ahead of both, b and c are abreast."""
    hall = shapely.box(-5, 15, 25, 25).union(shapely.box(15, -5, 25, 65))
    way, side = [(-3, 20), (20, 20), (20, 60)], shapely.LineString([(20, 0), (20, 60)])
    parts = [
        ("boundary", hall), ("path", shapely.LineString(way)), ("path b", side), ("path c", side),
        ("robot a", box(0, 20, 1.2, 0.7)), ("robot b", box(20, 5, 0.7, 1.2)),
        ("robot c", box(20, 2, 0.7, 1.2)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    assert [one for one in made.facts if "b and c would stop in one place" in one]
    assert simulate(made.world).ended == "finished"


@pytest.mark.parametrize("visitor", [False, True])
def test_a_robot_far_behind_one_near_the_end_stays_behind_it(tmp_path: Path, visitor: bool) -> None:
    """However little way is left to it then; in a formation, too, which a queue is."""
    parts = [HALL, WAY, ("robot a", box(46.9, 5, 0.6, 0.4)), ("robot b", box(3.1, 5, 0.6, 0.4))]
    if visitor:
        parts += [("path x", shapely.LineString([(40, 15), (5, 15)])), ("robot x", box(40, 15))]
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert (made.world.formation is None) == visitor
    if visitor:
        assert ways_of(made)[1] < 1.0
    check_says(only(made, "WARNING"), "b goes … behind a")


def test_a_formation_leaves_every_robot_most_of_its_way(tmp_path: Path) -> None:
    """One whose own path begins far ahead would hold back all others."""
    parts = [HALL, WAY, ("robot a", box(4, 5)), ("robot b", box(41, 8)),
             ("path b", shapely.LineString([(41, 8), (48, 8)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    check_says("; ".join(made.facts), "no formation … a would go … m of its way")
    assert ways_of(made)[0] > 40.0


@pytest.mark.parametrize(("far", "reach"), [(9.0, 10.0), (16.0, 17.6)])
def test_robots_that_start_far_apart_are_neighbours_all_the_same(
    tmp_path: Path, far: float, reach: float
) -> None:
    parts = [HALL, WAY, ("robot a", box(4, 5)), ("robot b", box(4 + far, 5))]
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is not None
    assert made.world.formation.range == pytest.approx(reach)
    told = [fact for fact in made.facts if "formation.range" in fact]
    assert len(told) == (reach > 10.0)
    (tmp_path / "made.yaml").write_text(made.text)
    assert not check_world(tmp_path / "made.yaml").warnings
