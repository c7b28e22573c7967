"""What is dropped or repaired is listed with its place and size, and the rest stays as it was."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import shapely
from PIL import Image

from physim import check_world
from physim.authoring.importing import (
    Imported,
    ImportSourceError,
    Options,
    import_world,
)
from physim.authoring.importing import (
    robots as group,
)
from tests.helpers import inside
from tests.importing.plans import (
    CELL,
    SAMPLES,
    check_says,
    free_cells,
    map_yaml,
    office,
    only,
    pgm,
    svg,
    write_map,
)
from tests.importing.test_joining import geojson

CrossingError = inside("physim.authoring.importing", "CrossingError")
without_loops = inside("physim.authoring.importing", "without_loops")

ONE = Options(scale=1.0)
ROOM = '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'


def drawn(folder: Path, body: str, options: Options = ONE) -> Imported:
    path = folder / "d.svg"
    path.write_text(svg(body))
    return import_world(path, options)


def test_walls_that_cross_themselves_in_a_tight_bend_are_cut_clean(tmp_path: Path) -> None:
    """A right angle within a metre, in a road whose inner half is 3 m wide."""
    path = tmp_path / "bend.csv"
    sharp = np.array([(0.0, 0.0), (20.0, 0.0), (20.5, 0.1), (20.8, 0.4), (20.9, 0.9), (20.9, 20.0)])
    rows = [f"{x},{y},3.0,3.0" for x, y in sharp]
    path.write_text("x_m,y_m,w_tr_right_m,w_tr_left_m\n" + "\n".join(rows))
    imported = import_world(path)
    told = only(imported, "crossed itself in a tight bend")
    check_says(told, "left wall … tight bend … (17.91, 2.99) … loop")
    left = shapely.LineString((imported.world.boundaries or ())[0])
    assert left.is_simple
    line = shapely.LineString(sharp)
    near = line.offset_curve(3.0, join_style="mitre")
    assert left.hausdorff_distance(near) < 0.4


def aisles(
    folder: Path, half: float, noise: float = 0.0, apart: float = 6.0, turn: float = 0.0
) -> Path:
    """Three legs one beside another with square ends, a point a metre, to the millimetre."""
    corners = np.array([(0, 0), (40, 0), (40, apart), (0, apart), (0, 2 * apart), (40, 2 * apart)])
    points = shapely.get_coordinates(shapely.segmentize(shapely.LineString(corners), 1.0))
    points += np.random.default_rng(3).normal(0.0, 1.0, points.shape) * noise
    points = points @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    path = folder / "aisles.csv"
    path.write_text("".join(f"{x:.3f},{y:.3f},{half},{half}\n" for x, y in points))
    return path


@pytest.mark.parametrize(("half", "thick"), [(3.0, 0.004), (2.95, 0.1)])
def test_aisles_keep_the_wall_that_they_share(tmp_path: Path, half: float, thick: float) -> None:
    """It was cut off, 18 m at a time, as loops of a bend: the aisles became a hall."""
    imported = import_world(aisles(tmp_path, half))
    walls = shapely.union_all([shapely.LineString(one) for one in imported.world.boundaries or ()])
    for x, y in product((5.0, 20.0, 35.0), (0.0, 6.0, 12.0)):
        middle = shapely.Point(x, y)
        assert walls.distance(middle) == pytest.approx(3.0 - 0.5 * thick, abs=1e-3)
    for x, y in product((5.0, 20.0, 35.0), (3.0, 9.0)):
        across = shapely.LineString([(x, y - 1.0), (x, y + 1.0)]).intersection(walls)
        assert len(shapely.get_parts(across)) == 2
    assert (half == 3.0) == any("share a wall" in one for one in imported.changes)
    assert not check_world(written(tmp_path, imported)).warnings


@pytest.mark.parametrize("apart", [6.0, 5.999])
def test_aisles_keep_their_wall_where_points_are_rounded(tmp_path: Path, apart: float) -> None:
    """Turned, the widths add up only to the millimetre that points are rounded to."""
    imported = import_world(aisles(tmp_path, 3.0, apart=apart, turn=0.7))
    walls = shapely.union_all([shapely.LineString(one) for one in imported.world.boundaries or ()])
    c, s = np.cos(0.7), np.sin(0.7)
    for x, y in product((5.0, 20.0, 35.0), (0.0, apart, 2.0 * apart)):
        middle = shapely.Point(c * x - s * y, s * x + c * y)
        assert walls.distance(middle) == pytest.approx(3.0, abs=5e-3)
    assert any("share a wall" in one for one in imported.changes)


@pytest.mark.parametrize(("noise", "apart"), [(0.02, 6.0), (0.0, 5.9)])
def test_aisles_that_run_into_each_other_are_refused(
    tmp_path: Path, noise: float, apart: float
) -> None:
    with pytest.raises(ImportSourceError) as caught:
        import_world(aisles(tmp_path, 3.0, noise, apart))
    check_says(str(caught.value), "edge crosses itself at … overlap … noisy")


def written(folder: Path, imported: Imported) -> Path:
    path = folder / "w.yaml"
    path.write_text(imported.text)
    return path


def test_a_closed_track_that_begins_in_a_tight_corner_may_be_cut_open_elsewhere(
    tmp_path: Path,
) -> None:
    ring = shapely.LineString([(0, 0), (60, 0), (60, 40), (0, 40), (0, 1)])
    points = shapely.get_coordinates(shapely.segmentize(ring, 1.0))
    path = tmp_path / "ring.csv"
    path.write_text("".join(f"{x},{y},3,3\n" for x, y in points))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path)
    check_says(str(caught.value), "edge crosses itself at (3.00, 3.00) … tight corner … --start")
    assert import_world(path, Options(start=10.0)).world.boundaries


def test_which_tracks_are_closed(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    for degrees, closed in ((360, True), (345, True), (240, False)):
        angle = np.radians(np.arange(0, degrees, 15))
        rows = [f"{20 * x},{20 * y},2,2" for x, y in zip(np.cos(angle), np.sin(angle), strict=True)]
        path.write_text("\n".join(rows))
        imported = import_world(path)
        assert any("cut open" in change for change in imported.changes) == closed
    path.write_text("0,0,2,2\n20,0,2,2\n20,20,2,2\n0,20,2,2")
    assert not any("cut open" in change for change in import_world(path).changes)
    only(import_world(path, Options(start=10.0)), "cut open at station 10 m, (10.00, 0.00)")
    path.write_text("0,0,2,2\n20,0,2,2\n40,0,2,2")
    with pytest.raises(ImportSourceError, match="this one is open"):
        import_world(path, Options(start=10.0))


def test_a_track_is_open_where_that_is_said(tmp_path: Path) -> None:
    """A hairpin of long legs: its ends are as near to each other as points are to the next."""
    path = tmp_path / "t.csv"
    path.write_text("0,0,2,2\n40,0,2,2\n50,4,2,2\n40,8,2,2\n0,8,2,2")
    assert any("cut open" in change for change in import_world(path).changes)
    imported = import_world(path, Options(open=True))
    assert not any("cut open" in change for change in imported.changes)
    assert any("open" in fact for fact in imported.facts)
    ends = np.array(imported.world.reference_path)[[0, -1]]
    assert np.allclose(ends, [(0, 0), (0, 8)], atol=3.1)  # [m] cut short before the walls there
    with pytest.raises(ImportSourceError, match="this one is open"):
        import_world(path, Options(open=True, gap=3.0))


def hairpin(folder: Path, start: tuple[float, float]) -> Path:
    """A hairpin of radius 2 m with an inner half of 3 m, and legs from and to some place."""
    turn = np.linspace(-np.pi / 2, np.pi / 2, 40)
    bend = 2.0 * np.stack([np.cos(turn), np.sin(turn)], axis=1) + (30.0, 2.0)
    (x, y), path = start, folder / "hairpin.csv"
    points = np.vstack([[(x, y), (15.0, 0.5 * y)], bend, [(15.0, 4.0 - 0.5 * y), (x, 4.0 - y)]])
    rows = [f"{x},{y},1.9,3.0" for x, y in points]
    path.write_text("x_m,y_m,w_tr_right_m,w_tr_left_m\n" + "\n".join(rows))
    return path


def test_a_road_that_folds_onto_itself_is_told(tmp_path: Path) -> None:
    """Its legs part behind the bend."""
    imported = import_world(hairpin(tmp_path, (0.0, -30.0)), Options(robot=(0.6, 0.3)))
    check_says(only(imported, "folds"), "left wall … 3.00 m … stated")


def test_legs_that_lie_in_each_others_road_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ImportSourceError) as caught:
        import_world(hairpin(tmp_path, (0.0, 0.0)), Options(robot=(0.6, 0.3)))
    check_says(str(caught.value), "runs into itself at … 0.0 m and … less than … widths")


def test_a_road_that_narrows_abruptly_does_not_fold(tmp_path: Path) -> None:
    path = tmp_path / "neck.csv"
    rows = [f"{x},0,{half},{half}" for x in range(60) for half in [0.9 if 26 <= x < 35 else 4.0]]
    path.write_text("\n".join(rows))
    imported = import_world(path, Options(robot=(0.6, 0.3)))
    told = [change for change in imported.changes if "stated" in change]
    assert len(told) == 2
    assert all("narrows" in change and "folds" not in change for change in told)


def test_the_width_as_made_is_told_where_it_is_less_than_stated(tmp_path: Path) -> None:
    """At a right angle the walls keep 3 m along its bisector, 3 sin 45° = 2.12 m from a leg."""
    path = tmp_path / "corner.csv"
    path.write_text("0,0,3,3\n15,0,3,3\n30,0,3,3\n30,15,3,3\n30,30,3,3\n")
    facts = import_world(path).facts
    check_says(facts[0], "6.00 to 6.00 m … stated")
    assert facts[1].startswith("walls 4.")
    left, right = (
        shapely.LineString(line) for line in (import_world(path).world.boundaries or ())[:2]
    )
    along = shapely.points([(x, 0.0) for x in np.arange(3.0, 30.0, 0.01)])
    least = (left.distance(along) + right.distance(along)).min()
    assert float(facts[1].split()[1]) == pytest.approx(least, abs=0.02)
    path.write_text("0,0,3,3\n15,0,3,3\n30,0,3,3\n")
    assert not any(fact.startswith("walls") for fact in import_world(path).facts)


def test_loops_up_to_a_length_are_cut_and_longer_ones_refused() -> None:
    line = np.array([(0, 0), (4, 0), (4, 1), (3, 1), (3, -1), (8, -1)], dtype=float)
    clean, cut = without_loops(line, 5.0)
    assert clean.tolist() == [[0, 0], [3, 0], [3, -1], [8, -1]]
    assert [(point.tolist(), length) for point, length in cut] == [([3, 0], 4.0)]
    with pytest.raises(CrossingError):
        without_loops(line, 3.9)
    straight, none = without_loops(line[:3], 5.0)
    assert straight is line[:3] or (straight == line[:3]).all()
    assert none == []


def test_repeated_points_and_further_columns_of_a_track(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text(
        "y_m;bank;x_m;w_tr_left_m;w_tr_right_m\n0;9;0;3;2\n0;9;0;3;2\n0;9;20;3;2\n0;9;40;3;2\n"
    )
    imported = import_world(path)
    check_says(only(imported, "line 3"), "repeats … dropped")
    check_says(only(imported, "columns"), "left out … bank")
    left, right = (imported.world.boundaries or ())[:2]
    assert {y for _, y in left} == {3.0}
    assert {y for _, y in right} == {-2.0}


COMMENTS = (
    "# a road by hand\n",
    "# Monza, smoothed, in metres of the local frame, by hand\n",
    "# 52c11ac8-1f\n# x_m,y_m,w_tr_right_m,w_tr_left_m\n",
    "# 2,3,4,5\n",
    "",
)


@pytest.mark.parametrize("comment", COMMENTS)
def test_a_comment_that_lists_no_names_stays_a_comment(comment: str, tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text(comment + "0,0,2,3\n20,0,2,3\n40,0,2,3\n")
    left, right = (import_world(path).world.boundaries or ())[:2]
    assert ({y for _, y in left}, {y for _, y in right}) == ({3.0}, {-2.0})


def test_specks_regions_and_doors_of_a_map(tmp_path: Path) -> None:
    plan = shapely.box(0, 0, 12, 8)
    free, corner = free_cells(plan, margin=30)
    free[60, 60:62] = False  # two cells: left out
    free[80:83, 80] = False  # three: kept
    free[2:5, 2:6] = True  # outside: another region
    imported = import_world(write_map(tmp_path, free, corner))
    rows = len(free)
    x, y = corner[0] + 61.0 * CELL, corner[1] + (rows - 60.5) * CELL
    check_says(only(imported, "speck"), f"0.02 m² … ({x:.2f}, {y:.2f}) … left out … --specks")
    check_says(only(imported, "region"), "0.12 m² … (-2.60, … left out")
    assert [len(ring) for ring in imported.world.obstacles] == [4]
    kept = import_world(tmp_path / "map.yaml", Options(specks=1e-6))
    assert len(kept.world.obstacles) == 2
    there = import_world(tmp_path / "map.yaml", Options(specks=0.031))
    assert len(there.world.obstacles) == 0


def test_cells_that_meet_at_a_corner_are_no_passage(tmp_path: Path) -> None:
    free = np.zeros((80, 120), dtype=bool)
    free[5:40, 5:60] = True
    free[40:75, 60:115] = True
    free[40:70, 5:60] = False
    imported = import_world(write_map(tmp_path, free, (0.0, 0.0)))
    boundaries = imported.world.boundaries or ()
    assert shapely.Polygon(boundaries[0]).area == pytest.approx(5.5 * 3.5)
    check_says(only(imported, "region"), "not connected … left out")


GREY = np.array([254, 205, 128, 100, 10, 0])
"""Free, unknown to map_server, between the thresholds, ..., occupied"""


@pytest.mark.parametrize(
    ("more", "free"),
    [
        ({}, [1, 0, 0, 0, 0, 0]),
        ({"free_thresh": 0.25}, [1, 1, 0, 0, 0, 0]),
        ({"negate": 1}, [0, 0, 0, 0, 1, 1]),
        ({"mode": "scale"}, [1, 0, 0, 0, 0, 0]),
        ({"mode": "raw"}, [0, 0, 0, 0, 1, 1]),
        ({"mode": "raw", "free_thresh": 0.05}, [0, 0, 0, 0, 0, 1]),
    ],
)
@pytest.mark.parametrize("kind", ["P5", "P2", "png", "png16", "colour"])
def test_thresholds_and_modes(
    tmp_path: Path, more: dict[str, Any], free: list[int], kind: str
) -> None:
    """Bands of grey, 20 cells each: the free ones are the world."""
    pixels = np.repeat(np.repeat(GREY[None], 40, axis=0), 20, axis=1)
    if kind in ("P5", "P2"):
        data = pgm(pixels, kind == "P2")
    else:
        image = pixels.astype(np.uint8)
        if kind == "png16":
            image = image.astype(np.uint16) * 257
        elif kind == "colour":
            image = np.stack([image, image, image, np.full_like(image, 255)], axis=2)
        data = cv2.imencode(".png", image)[1].tobytes()
    (tmp_path / "map.img").write_bytes(data)
    (tmp_path / "map.yaml").write_text(map_yaml("map.img", 0.5, (0, 0), **more))
    imported = import_world(tmp_path / "map.yaml", Options(tolerance=0.1))
    x0, y0, x1, y1 = shapely.LineString((imported.world.boundaries or ())[0]).bounds
    bands = np.flatnonzero(free)
    assert (x0, x1) == (10.0 * bands[0], 10.0 * (bands[-1] + 1))
    assert (y0, y1) == (0.0, 20.0)


def test_transparent_cells_are_unknown(tmp_path: Path) -> None:
    image = np.full((40, 80, 4), 255, dtype=np.uint8)
    image[:, 40:, 3] = 0
    cv2.imwrite(str(tmp_path / "map.png"), image)
    for mode, width in (("scale", 20.0), ("trinary", 20.0), ("raw", None)):
        (tmp_path / "map.yaml").write_text(map_yaml("map.png", 0.5, (0, 0), mode=mode))
        if width is None:  # 255 is unknown in percent
            with pytest.raises(ImportSourceError, match="no cell"):
                import_world(tmp_path / "map.yaml")
            continue
        line = shapely.LineString((import_world(tmp_path / "map.yaml").world.boundaries or ())[0])
        assert line.bounds == (0.0, 0.0, width, 20.0)


@pytest.mark.parametrize("mode", ["L", "1", "I;16", "RGB", "P", "LA"])
def test_one_colour_of_a_picture_may_be_transparent(tmp_path: Path, mode: str) -> None:
    """White of the right half, as each kind of picture says it; the left half is nearly white."""
    grey = np.full((40, 80), 254, dtype=np.uint8)
    grey[:, 40:] = 255
    image, one = Image.fromarray(grey), {"transparency": 255}
    if mode == "1":  # and here black is the right half, and free
        image, one = Image.fromarray(grey == 254), {"transparency": 0}
    elif mode == "I;16":
        image, one = Image.fromarray(grey.astype(np.uint16) * 257), {"transparency": 65535}
    elif mode == "RGB":
        image, one = image.convert("RGB"), {"transparency": (255, 255, 255)}
    elif mode == "P":
        image, one = image.convert("P"), {"transparency": 255}
    elif mode == "LA":
        image, one = (
            Image.merge(
                "LA", (image, Image.fromarray(np.where(grey == 254, 255, 0).astype(np.uint8)))
            ),
            {},
        )
    image.save(tmp_path / "map.png", **one)
    more = {"negate": 1} if mode == "1" else {}
    text = map_yaml("map.png", 0.5, (0, 0), **more)
    (tmp_path / "map.yaml").write_text(text)
    if mode == "1":  # what is not transparent is white, and with negate not free
        with pytest.raises(ImportSourceError, match="no cell"):
            import_world(tmp_path / "map.yaml")
        return
    line = shapely.LineString((import_world(tmp_path / "map.yaml").world.boundaries or ())[0])
    assert line.bounds == (0.0, 0.0, 20.0, 20.0)


def test_hidden_and_nameless_lines_of_a_drawing(tmp_path: Path) -> None:
    imported = drawn(
        tmp_path,
        ROOM
        + '\n<g inkscape:label="boundary" style="display:none"><path d="M 3,3 5,5"/></g>'
        + '\n<path id="path17" d="M 1,1 2,2"/>\n<text x="1" y="2">Hall 7</text>',
    )
    check_says(only(imported, "hidden"), "line 3: … <g> boundary … left out")
    check_says(only(imported, "path17"), "boundary … obstacle … path … robot … left out")
    check_says(only(imported, "text"), "line 5: … <text> … left out")
    assert len(imported.world.boundaries or ()) == 1


@pytest.mark.parametrize(
    "transform",
    ["", "none", "translate(2-3)", "translate(1.5,.5) scale(1e0)", "rotate (0 5,5), skewX(0)",
     " matrix(1 0 0 1 2 -3)\n"],
)  # fmt: skip
def test_transforms_as_they_may_be_written(transform: str, tmp_path: Path) -> None:
    obstacle = f'<rect id="obstacle" x="5" y="6" width="2" height="1" transform="{transform}"/>'
    assert len(drawn(tmp_path, ROOM + obstacle).world.obstacles) == 1


def test_ends_that_nearly_meet_are_joined(tmp_path: Path) -> None:
    imported = drawn(tmp_path, '<path id="walls" d="M 0,0 24,0 24,14 0,14 0,0.05"/>')
    check_says(only(imported, "apart"), "0.050 m … (0.00, 14.00) … joined")


def test_two_open_walls_get_caps(tmp_path: Path) -> None:
    imported = drawn(
        tmp_path, '<g id="boundary" stroke="red"><path d="M 0,0 24,0"/><path d="M 24,8 0,8"/></g>'
    )
    check_says(imported.changes[0], "cap … (0.00, 14.00) … (0.00, 6.00)")
    assert len(imported.world.boundaries or ()) == 4


def test_lines_away_from_the_area_are_dropped(tmp_path: Path) -> None:
    imported = drawn(
        tmp_path,
        ROOM + '<path id="wall-2" d="M 30,1 33,1 33,5"/>'
        '<rect id="obstacle" x="30" width="2" height="1"/>',
    )
    check_says(only(imported, "boundary of"), "7.00 m … (30.00, 13.00) … (33.00, 9.00) … dropped")
    check_says(only(imported, "obstacle of"), "2.000 m² … (31.00, 13.50) … dropped")


@pytest.mark.parametrize("quote", ['"', ""])
def test_values_of_a_track_may_be_quoted(tmp_path: Path, quote: str) -> None:
    path = tmp_path / "track.csv"
    rows = "\n".join(",".join(f"{quote}{v}{quote}" for v in (9 * k, 2, 4, 5)) for k in range(6))
    path.write_text(f"x_m,y_m,w_tr_right_m,w_tr_left_m\n{rows}\n")
    (first, *_), *_ = import_world(path).world.boundaries or ()
    assert len(import_world(path).world.robots) > 0
    assert len(first) == 2


def test_of_several_polygons_that_with_the_robots_is_taken(tmp_path: Path) -> None:
    """Though another one is larger."""
    shapes = {"boundary": ((0, 0, 40, 20), (50, 0, 74, 9)), "robot": ((53, 4, 54.8, 5),)}
    features = [
        {
            "type": "Feature",
            "properties": {"role": role},
            "geometry": shapely.geometry.mapping(shapely.box(*corners)),
        }
        for role, boxes in shapes.items()
        for corners in boxes
    ]
    path = tmp_path / "p.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    imported = import_world(path)
    check_says(only(imported, "polygon of"), "800.000 m² … left out")
    assert [robot.pose[:2] for robot in imported.world.robots] == [(53.9, 4.5)]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("2 5, 40 5", "leaves … (30.00, 5.00) … 10.00 m after … left out"),
        ("-5 5, 28 5", "enters … (0.00, 5.00) … 5.00 m before … left out"),
    ],
)
def test_a_path_that_leaves_the_area_is_cut_before_robots_are_sized(
    line: str, told: str, tmp_path: Path
) -> None:
    path = tmp_path / "p.wkt"
    path.write_text(f"POLYGON ((0 0, 30 0, 30 10, 0 10, 0 0))\nLINESTRING ({line})\n")
    imported = import_world(path, Options(robots=3))
    check_says(only(imported, "the area at"), told)
    footprint: Any = imported.world.robots[0].footprint
    assert (footprint.length, footprint.width) == (1.8, 1.0)
    path.write_text("POLYGON ((0 0, 30 0, 30 10, 0 10, 0 0))\nLINESTRING (2 5, 60 5)\n")
    with pytest.raises(
        ImportSourceError, match=r"the path leaves the area at \(30\.[01]\d, 5\.00\)"
    ):
        import_world(path)


@pytest.mark.parametrize("name", ["track.csv", "office.wkt", "office.geojson"])
def test_a_tolerance_without_effect_is_told(name: str) -> None:
    """Lines of few points are taken as they are, unless they are made from curves or cells."""
    asked, plain = (import_world(SAMPLES / name, Options(tolerance=value)) for value in (3.0, None))
    assert asked.world == plain.world
    assert [one for one in asked.facts if "--tolerance 3" in one]
    assert not [one for one in plain.facts if "--tolerance" in one]


def test_a_layer_of_another_name_is_no_role(tmp_path: Path) -> None:
    path = tmp_path / "p.geojson"
    ring = [[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]
    shape = {"type": "Polygon", "coordinates": [ring]}
    about = {"layer": "ground floor", "role": None}
    path.write_text(json.dumps({"type": "Feature", "properties": about, "geometry": shape}))
    assert len(import_world(path).world.boundaries or ()) == 1


def test_the_size_of_a_robot_drawn_is_told(tmp_path: Path) -> None:
    imported = drawn(
        tmp_path,
        ROOM + '<rect id="robot" x="3" y="6" width="2.2" height="1.1"/>',
        Options(scale=1.0, robots=2),
    )
    check_says(imported.facts[-1], "2 robots in 1 lane … 2.2 x 1.1 m … the robot drawn … --robot")


def test_lanes_are_drawn_in_where_the_corridor_is_narrow(tmp_path: Path) -> None:
    """Two lanes of boxes of 1 m through a door of 2.4 m: side by side before and after it."""
    plan = shapely.box(0, 0, 40, 8).difference(
        shapely.MultiPolygon([shapely.box(19, 0, 21, 2.8), shapely.box(19, 5.2, 21, 8)])
    )
    path = tmp_path / "p.wkt"
    path.write_text(f"{plan.wkt}\nLINESTRING (1 4, 39 4)\n")
    imported = import_world(path, Options(robots=4, lanes=2, robot=(1.0, 0.6)))
    assert sum("drawn in" in change for change in imported.changes) == 2
    lines = [np.array(robot.path) for robot in imported.world.robots[:2]]
    for line in lines:
        points = shapely.points(line)
        assert shapely.distance(plan.boundary, points).min() > 0.3
        assert 0.5 < np.abs(line[:, 1] - 4.0).max() < 1.2
        close = shapely.get_coordinates(shapely.segmentize(shapely.LineString(line), 0.1))
        inside = close[(close[:, 0] > 19) & (close[:, 0] < 21)]
        assert np.abs(inside[:, 1] - 4.0).max() < 0.7


def test_robots_are_counted_from_the_front_and_stop_apart(tmp_path: Path) -> None:
    path = tmp_path / "p.wkt"
    path.write_text("POLYGON ((0 0, 80 0, 80 9, 0 9, 0 0))\nLINESTRING (1 4.5, 79 4.5)")
    world = import_world(path, Options(robots=5, lanes=2)).world
    along = [robot.pose[0] for robot in world.robots]
    assert [robot.name for robot in world.robots] == ["r1", "r2", "r3", "r4", "r5"]
    assert along == sorted(along, reverse=True)
    assert np.diff(along).max() <= -1.5  # none stops abreast of another
    assert {robot.pose[1] for robot in world.robots} == {3.5, 5.5}
    assert {robot.pose[2] for robot in world.robots} == {0.0}


@pytest.mark.parametrize(("narrowest", "told"), [(0.6, False), (0.598, False), (0.5, True)])
def test_a_lane_is_told_only_where_it_is_drawn_in(
    narrowest: float, told: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not one that is bent otherwise, nor by less than the digits that are told."""
    plain = group.lane

    def bent(*arguments: Any) -> Any:
        one = plain(*arguments)
        offset = math.copysign(0.6, one.offset)
        return replace(one, offset=offset, is_plain=False, narrowest=narrowest)

    monkeypatch.setattr(group, "lane", bent)
    path = tmp_path / "p.wkt"
    path.write_text("POLYGON ((0 0, 80 0, 80 9, 0 9, 0 0))\nLINESTRING (1 4.5, 79 4.5)")
    imported = import_world(path, Options(robots=2, lanes=2))
    assert any("drawn in" in change for change in imported.changes) == told


def test_an_open_line_that_is_taken_for_a_robot_is_told(tmp_path: Path) -> None:
    """``robot_lane_2`` may have been meant as something else."""
    lane = '<polyline id="robot_lane_2" points="4,4 5,4 5,5 4,5"/>'
    imported = drawn(tmp_path, ROOM + f"\n{lane}")
    check_says(only(imported, "robot_lane_2"), "line 3: … robot at … not closed")
    closed = lane.replace("polyline", "polygon")
    assert not any("closed" in one for one in drawn(tmp_path, ROOM + closed).changes)


def test_rounding_at_the_end_of_a_path_is_not_told(tmp_path: Path) -> None:
    imported = drawn(tmp_path, f'{ROOM}<path id="path" d="M 2,7 H 24.004"/>')
    assert not any("leaves" in change for change in imported.changes)


def test_a_path_that_ends_far_from_where_it_was_asked_to_is_told_first(tmp_path: Path) -> None:
    """A room of 12 m with a bay of 3 m, not deep, where robots that fit elsewhere have no room.

    For a deep one they are smaller.
    """
    plan = shapely.union(shapely.box(0.0, 0.0, 30.0, 12.0), shapely.box(30.0, 4.5, 34.0, 7.5))
    there = write_map(tmp_path, *free_cells(plan))
    asked = Options(origin=(4.0, 6.0), goal=(33.0, 6.0))
    far = import_world(there, asked)
    end = np.array((far.world.reference_path or ())[-1])
    away = float(np.hypot(*(end - (33.0, 6.0))))
    assert away > 3.6
    check_says(far.changes[0], f"{away:.2f} m … --to (33.00, 6.00) … --robot")
    assert only(far, "--to") == far.changes[0]
    near = import_world(there, Options(origin=(4.0, 6.0), goal=(33.0, 6.0), robot=(0.6, 0.4)))
    assert not any("--to" in change for change in near.changes)
    back = import_world(there, Options(origin=(33.0, 6.0), goal=(4.0, 6.0)))
    check_says(only(back, "--from"), "--from (33.00, 6.00)")
    deep = shapely.union(shapely.box(0.0, 0.0, 30.0, 12.0), shapely.box(30.0, 4.5, 40.0, 7.5))
    small = import_world(
        write_map(tmp_path, *free_cells(deep)), Options(origin=(4.0, 6.0), goal=(38.0, 6.0))
    )
    assert not any("--to" in change for change in small.changes)
    assert max(np.hypot(*np.ptp(one.outline, axis=0)) for one in small.world.robots) < 2.0


@pytest.mark.parametrize("aside", [0.0, 0.01])
def test_a_path_may_leave_where_it_enters(tmp_path: Path, aside: float) -> None:
    """Through the very same point of a wall, as by the door of a dock."""
    way = [(10, -2), (10, 13), (15, 13), (15, 5), (10 + aside, 5), (10 + aside, -2.5)]
    parts = [("boundary", shapely.box(0, 0, 20, 16)), ("path", shapely.LineString(way))]
    made = import_world(geojson(tmp_path, parts), Options(robots=1))
    told = [one for one in made.changes if "that left out" in one]
    check_says(told[0], "enters … (10.00, 0.00) … 2.00 m")
    check_says(told[1], "leaves … 2.50 m")


@pytest.mark.parametrize(("cell", "is_doubted"), [(5.0, True), (0.5, False)])
def test_a_resolution_that_is_hardly_in_metres_is_doubted(
    tmp_path: Path, cell: float, is_doubted: bool
) -> None:
    free, corner = free_cells(office(), 0.5)
    path = write_map(tmp_path, free, corner, cell)
    told = [one for one in import_world(path).changes if "check the scale" in one]
    assert bool(told) == is_doubted
    assert not told or "5 m" in told[0]
