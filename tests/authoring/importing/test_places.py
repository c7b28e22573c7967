"""Which area of a drawing is the place of the robots, and how its lines and paths are joined."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from physim.authoring.importing import Options, import_world
from tests.authoring.importing.plans import METRES, check_says, free_area, geojson, only, refusal

ROOM = ("boundary", shapely.LineString([(0, 0.1), (0, 40), (40, 40), (40, 0), (0, 0)]))
CLOSET = ("boundary", shapely.LineString([(30, 40), (30, 30), (40, 30)]))
WAY = ("path", shapely.LineString([(5, 5), (25, 5)]))


def test_an_open_room_is_refused_with_its_loose_ends_and_closed_on_request(tmp_path: Path) -> None:
    path = geojson(tmp_path, [ROOM, WAY])
    said = refusal(path)
    check_says(said, "no closed area … (0.00, 0.10) and (0.00, 0.00), 0.1 m apart … --close 0.1")
    made = import_world(path, Options(scale=1.0, close=0.1))
    check_says(only(made, "joined"), "0.100 m apart at (0.00, 0.10)")
    assert free_area(made, tmp_path) == pytest.approx(1600.0)


def test_an_end_before_a_wall_is_joined_to_it_on_request(tmp_path: Path) -> None:
    """Of the two halves of the hall the one with the path is the place."""
    wall = ("boundary", shapely.LineString([(20, 0), (20, 39.95)]))
    way = ("path", shapely.LineString([(5, 5), (15, 5)]))
    parts = [("boundary", shapely.box(0, 0, 40, 40)), wall, way]
    whole = import_world(geojson(tmp_path, parts), METRES)
    assert free_area(whole, tmp_path) == pytest.approx(1600.0, abs=0.1)
    half = import_world(tmp_path / "plan.geojson", Options(scale=1.0, close=0.05))
    assert free_area(half, tmp_path) == pytest.approx(800.0)


@pytest.mark.parametrize(
    ("more", "parts"),
    [
        ([], "which area … 100 m² … --from X,Y … (0.00, 0.10)"),
        (
            [("boundary", shapely.box(60, 0, 70, 9))],
            "which area … 100 m² about … 90 m² about … --from",
        ),
        ([WAY], "the path is in no closed area"),
        ([("robot", shapely.box(5, 5, 6.8, 6))], "the robot is in no closed area"),
    ],
    ids=["closet", "another", "path", "robot"],
)
def test_a_place_that_is_not_said_is_asked_for(tmp_path: Path, more: Any, parts: str) -> None:
    path = geojson(tmp_path, [ROOM, CLOSET, *more])
    check_says(refusal(path), parts)
    inside = Options(scale=1.0, origin=(35.0, 35.0), robots=1, robot="fit")
    assert free_area(import_world(path, inside), tmp_path) == pytest.approx(100.0)
    check_says(refusal(path, inside.changed(origin=(5.0, 5.0))), "--from (5.00, 5.00): is in no")


THICK = ((0, 0, 40, 1), (0, 19, 40, 1), (0, 0, 1, 20), (39, 0, 1, 20), (20, 0, 1, 5))


@pytest.mark.parametrize("angle", [0.0, 3.0, 45.0, 87.0])
def test_thick_walls_enclose_the_room_between_them_at_any_angle(
    tmp_path: Path, angle: float
) -> None:
    """Obstacles that lie over each other are one; what they fill is no place."""
    parts = [("obstacle", shapely.box(x, y, x + w, y + h)) for x, y, w, h in THICK]
    parts.append(("path", shapely.LineString([(4, 10), (36, 10)])))
    turned = [(role, shapely.affinity.rotate(one, angle, origin=(20, 10))) for role, one in parts]
    made = import_world(geojson(tmp_path, turned), METRES)
    assert free_area(made, tmp_path) == pytest.approx(38.0 * 18.0 - 4.0, abs=0.1)
    assert len(made.world.boundaries or ()) == 1


@pytest.mark.parametrize("angle", [3.0, 17.0, 45.0])
def test_walls_that_end_at_the_side_of_others_meet_them_at_any_angle(
    tmp_path: Path, angle: float
) -> None:
    """Drawn without a gap; rounded to the millimetre they would leave one, or cross."""
    ends = [[(0, 10), (40, 10)], [(0, 30), (40, 30)], [(4, 10), (4, 30)], [(30, 10), (30, 30)]]
    parts = [*(("boundary", shapely.LineString(one)) for one in ends),
             ("path", shapely.LineString([(8, 20), (26, 20)]))]  # fmt: skip
    turned = [(role, shapely.affinity.rotate(one, angle, origin=(20, 20))) for role, one in parts]
    made = import_world(geojson(tmp_path, turned), METRES)
    assert free_area(made, tmp_path) == pytest.approx(26.0 * 20.0, abs=0.1)


def test_a_wall_between_two_rooms_is_kept_clear_of(tmp_path: Path) -> None:
    """It ends at a door, encloses nothing, and stays in the world."""
    line = shapely.LineString([(10, 11), (10, 4)])
    parts = [("boundary", shapely.box(0, 0, 26, 11)), ("boundary", line)]
    ends = Options(scale=1.0, origin=(3.0, 9.0), goal=(23.0, 9.0), robot="fit")
    made = import_world(geojson(tmp_path, parts), ends)
    assert shapely.LineString(made.world.reference_path).distance(line) > 0.5
    assert any(shapely.LineString(one).equals(line) for one in made.world.boundaries or ())
    through = ("path", shapely.LineString([(3, 9), (23, 9)]))
    said = refusal(geojson(tmp_path, [*parts, through]))
    check_says(said, "leaves the area at (10.00, 9.00), or leads through a wall")


def test_what_lies_away_from_the_place_is_left_out_and_listed(tmp_path: Path) -> None:
    boxes = [("obstacle", shapely.box(x, 1, x + 2, 3)) for x in (50, 10)]
    way = ("path", shapely.LineString([(3, 7), (26, 7)]))
    parts = [("boundary", shapely.box(0, 0, 30, 14)), way, *boxes]
    made = import_world(geojson(tmp_path, parts))
    assert len(made.world.obstacles) == 1
    check_says(only(made, "away from the place"), "obstacle … (52.00, 1.00)")


PIECES: dict[str, list[Any]] = {
    "in turn": [(2, 8), (8, 14), (14, 20)],
    "in another order": [(2, 8), (14, 20), (8, 14)],
    "drawn against it": [(2, 8), (20, 14), (14, 8)],
    "nearly met": [(2, 8), (8.05, 14), (14.05, 20)],
}


@pytest.mark.parametrize("name", PIECES)
def test_pieces_of_a_path_are_joined_where_they_meet(tmp_path: Path, name: str) -> None:
    """In the direction of the first; where they do not, only as far as is said."""
    pieces = [("path", shapely.LineString([(a, 7), (b, 7)])) for a, b in PIECES[name]]
    path = geojson(tmp_path, [("boundary", shapely.box(0, 0, 24, 14)), *pieces])
    options = METRES
    if name == "nearly met":
        check_says(refusal(path), "do not meet … (2.00, 7.00) to (8.00, 7.00) … --close")
        options = Options(scale=1.0, close=0.06)
    line = np.asarray(import_world(path, options).world.reference_path)
    assert shapely.LineString(line).length == pytest.approx(18.0)
    assert (np.diff(line[:, 0]) > 0.0).all()


def test_paths_are_told_apart_by_their_names(tmp_path: Path) -> None:
    """A fork is refused, and so is a path of nobody; without robots the only one is the path."""
    hall = ("boundary", shapely.box(0, 0, 24, 14))
    a = ("path a", shapely.LineString([(3, 7), (20, 7)]))
    b = ("path b", shapely.LineString([(3, 7), (3, 11)]))
    assert import_world(geojson(tmp_path, [hall, a])).world.reference_path == ((3, 7), (20, 7))
    check_says(refusal(geojson(tmp_path, [hall, a, b])), 'there is no robot "a"; draw … "robot a"')
    fork = [("path", one) for _, one in (a, b)] + [("path", shapely.LineString([(3, 7), (3, 3)]))]
    check_says(refusal(geojson(tmp_path, [hall, *fork])), "do not meet in one line")
    robots = [("robot Fork", shapely.box(4, 6.5, 5.8, 7.5)), ("path fork", a[1])]
    check_says(refusal(geojson(tmp_path, [hall, *robots])), 'no robot "fork" … "Fork"')
