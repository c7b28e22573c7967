"""Robots whose paths end in one place, or in each other's way: they stop one behind the other."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim import simulate
from physim.authoring.importing import import_world
from tests.importing.drawn import HALL, WAY, box, paths_of
from tests.importing.plans import check_says, only
from tests.importing.test_joining import geojson
from tests.importing.test_places import free_area


@pytest.mark.parametrize("order", [(9, 6, 3), (3, 6, 9), (6, 3, 9)])
def test_a_queue_of_robots_with_paths_of_their_own_drives_all_of_them(
    tmp_path: Path, order: tuple[int, ...]
) -> None:
    """They end as far apart again as they begin: it would be off, measured on one of them."""
    parts: list[tuple[str, Any]] = [("boundary", shapely.box(0, 0, 50, 10))]
    for x in order:
        parts += [(f"robot r{x}", shapely.box(x - 0.9, 4.5, x + 0.9, 5.5)),
                  (f"path r{x}", shapely.LineString([(x, 5), (x + 25, 5)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    free_area(made, tmp_path)
    assert made.world.formation is None
    assert [path[-1][0] - path[0][0] for path in paths_of(made)] == pytest.approx([25.0] * 3)


def test_those_on_a_path_with_a_name_stop_one_behind_the_other(tmp_path: Path) -> None:
    """Where another robot goes another way, and there is no formation."""
    parts = [HALL, ("robot a", box(9, 5)), ("path a", shapely.LineString([(9, 5), (47, 5)])),
             ("robot b", box(5, 5)), ("robot c", box(46, 15)),
             ("path c", shapely.LineString([(46, 15), (25, 15)]))]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    ends = {one.name: path[-1] for one, path in zip(made.world.robots, paths_of(made), strict=True)}
    assert ends["a"][0] - ends["b"][0] == pytest.approx(4.0, abs=0.01)


@pytest.mark.parametrize(("ahead", "is_one"), [(2.5, False), (9.0, True)])
def test_robots_whose_paths_meet_stop_in_the_order_in_which_they_come(
    tmp_path: Path, ahead: float, is_one: bool
) -> None:
    """In a formation b, measured at the junction, would stop before a, which is there first."""
    hall = shapely.box(-30, -3, 30, 3).union(shapely.box(-3, 0, 3, 25))
    parts = [
        ("boundary", hall), ("path", shapely.LineString([(-25, 0), (25, 0)])),
        ("path b", shapely.LineString([(0, 20), (0, 0), (25, 0)])),
        ("robot a", box(-ahead, 0, 1.2, 0.7)), ("robot b", box(0, 6, 0.7, 1.2)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert (made.world.formation is not None) == is_one
    told = [one for one in made.facts if "a would stop in the way of b" in one]
    assert bool(told) != is_one
    behind = [one for one in made.facts if "start behind b" in one]
    assert len(behind) == is_one
    if is_one:
        check_says(behind[0], "a 9.00 m")
    assert simulate(made.world).ended == "finished"
    ends = [shapely.LineString(path).length for path in paths_of(made)]
    assert is_one or ends == pytest.approx([50.0, 45.0 - (1.2 + 1.1 * 0.67)], abs=0.01)
    behind = [one for one in made.facts if "behind others" in one]
    assert len(behind) == (not is_one)


@pytest.mark.parametrize("farther", [0.5, 1.5, 3.0, 14.0])
def test_robots_that_come_to_one_end_stop_behind_one_another_and_nowhere_else(
    tmp_path: Path, farther: float
) -> None:
    """However much farther one has to go; of two that come at a time the order is not known."""
    hall = shapely.box(-30, -3, 30, 3).union(shapely.box(-3, 0, 3, 30))
    parts = [
        ("boundary", hall), ("path z", shapely.LineString([(20, 2), (-25, 2)])),
        ("path a", shapely.LineString([(-25, -1), (25, -1)])),
        ("path b", shapely.LineString([(0, 20), (0, -1), (25, -1)])),
        ("robot a", box(-21, -1, 1.2, 0.7)), ("robot b", box(0, 20 - farther, 0.7, 1.2)),
        ("robot z", box(16, 2, 1.2, 0.7)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    ends = [shapely.LineString(path).length for path in paths_of(made)]
    gap = 1.2 + 1.1 * 0.67
    assert ends == pytest.approx([50.0 - gap, 46.0, 45.0], abs=0.01)
    (behind,) = (one for one in made.facts if "behind others" in one)
    check_says(behind, f"a {gap:.2f} m")
    told = [one for one in made.facts if "come in the other order" in one]
    assert len(told) == (farther < 1.5 * gap)
    if told:
        check_says(told[0], f"b and a have {46.0 - farther:.2f} and 46.00 m")
    else:
        assert simulate(made.world).ended == "finished"


@pytest.mark.parametrize("count", [4, 7])
def test_each_robot_of_which_it_is_not_known_when_it_comes_is_told(
    tmp_path: Path, count: int
) -> None:
    """A tie of the farther two of four was not, and they alone stood before one another."""
    parts = [("boundary", shapely.box(0, 0, 50, 40))]
    for k in range(count):
        y = 20 + 5 * (k - (count - 1) / 2)
        parts.append((f"path p{k}", shapely.LineString([(3, y), (24, 20), (46, 20)])))
        parts.append((f"robot p{k}", box(3, y, 1.2, 0.7)))
    made = import_world(geojson(tmp_path, parts))
    told = [one for one in made.facts if "come in the other order" in one]
    order = sorted(range(count), key=lambda k: (abs(k - (count - 1) / 2), k))
    assert len(told) == min(count - 1, 3)
    for (first, then), line in zip(pairwise(order), told, strict=False):
        check_says(line, f"p{first} and p{then} have")
    more = [one for one in made.facts if "more pair" in one]
    assert len(more) == (count > 4)
    if more:
        check_says(more[0], f"{count - 4} more pairs")


@pytest.mark.parametrize(("beyond", "aside", "gap"), [
    (0.6, 0.0, 2.537), (1.15, 0.0, 3.087), (-0.6, 0.0, 1.337), (-1.9, 0.0, 0.037),
    (0.0, 1.2, 0.0), (0.0, 0.9, 1.707), (3.0, 0.0, 0.0), (-3.0, 0.0, 0.0),
])  # fmt: skip
def test_robots_stop_behind_those_in_their_way_wherever_their_paths_end(
    tmp_path: Path, beyond: float, aside: float, gap: float
) -> None:
    """Ends that are drawn by hand are not one point; places side by side are nobody's way."""
    hall = shapely.box(-30, -3, 32, 3).union(shapely.box(-3, 0, 3, 30))
    parts = [
        ("boundary", hall), ("path z", shapely.LineString([(20, 2.2), (-25, 2.2)])),
        ("path a", shapely.LineString([(-25, -1), (25, -1)])),
        ("path b", shapely.LineString([(0, 20), (0, aside - 1), (25 + beyond, aside - 1)])),
        ("robot a", box(-3, -1, 1.2, 0.7)), ("robot b", box(0, 12, 0.7, 1.2)),
        ("robot z", box(16, 2.2, 3.0, 0.7)),
    ]  # fmt: skip
    made = import_world(geojson(tmp_path, parts))
    ends = [shapely.LineString(path).length for path in paths_of(made)]
    whole = 20.0 + 1.0 - aside + 25.0 + beyond
    assert ends[:2] == pytest.approx([50.0, whole - gap], abs=0.01)


@pytest.mark.parametrize(("count", "spread"), [(3, 0.6), (5, 1.0)])
def test_robots_that_come_to_one_end_from_all_sides_stop_apart(
    tmp_path: Path, count: int, spread: float
) -> None:
    """Whoever comes later stops beside nobody nearer than robots keep from one another."""
    parts: list[tuple[str, Any]] = [
        ("boundary", shapely.box(-40, -40, 20, 40)),
        ("path z", shapely.LineString([(10, 30), (-30, 30)])), ("robot z", box(8, 30, 1.2, 0.7)),
    ]  # fmt: skip
    for k, turn in enumerate(np.linspace(-0.5, 0.5, count) * spread):
        way = shapely.LineString([(-30 * np.cos(turn), -30 * np.sin(turn)), (0, 0)])
        x, y = (-(6 + 4 * k) * np.cos(turn), -(6 + 4 * k) * np.sin(turn))
        robot = shapely.affinity.rotate(box(x, y, 1.2, 0.7), turn, use_radians=True)
        parts += [(f"path q{k}", way), (f"robot q{k}", robot)]
    made = import_world(geojson(tmp_path, parts))
    assert made.world.formation is None
    ends = []
    for path in paths_of(made)[1:]:
        (x0, y0), (x, y) = path[-2:]
        at = shapely.affinity.rotate(
            box(x, y, 1.2, 0.7), np.arctan2(y - y0, x - x0), use_radians=True
        )
        ends.append(at)
    gaps = [a.distance(b) for i, a in enumerate(ends) for b in ends[:i]]
    assert min(gaps) > 0.5 * 0.67 - 0.02
    assert simulate(made.world).ended == "finished"


def test_a_robot_that_stops_early_behind_another_is_told_so(tmp_path: Path) -> None:
    """Far behind it, at the beginning of its path; not that it is to be drawn the other way."""
    parts = [HALL, WAY, ("robot a", box(4, 5)), ("robot b", box(41, 5))]
    told = only(import_world(geojson(tmp_path, parts)), "WARNING")
    check_says(told, "a goes … behind b")
    assert "other way round" not in told
    bent = ("path", shapely.LineString([(3, 5), (43, 5), (46.5, 8.5)]))
    outside = [HALL, bent, ("robot a", box(4, 5)), ("robot b", box(39, 4.2))]  # goes farther
    told = only(import_world(geojson(tmp_path, outside)), "WARNING")
    check_says(told, "a goes … behind b farther … as it starts behind b")
