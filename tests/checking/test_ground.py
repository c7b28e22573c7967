"""Boundaries, obstacles and the area between them."""

from __future__ import annotations

import numpy as np
import pytest

from physim.world.checks import boundaries
from tests.checking.worlds import (
    CORRIDOR,
    DRAWN,
    changed,
    check,
    check_finding,
    lines,
    with_facts,
)
from tests.helpers import inside

self_overlap = inside("physim.world.layout", "self_overlap")

SECOND = "  - [[33, 4], [-3, 4], [-3, -4]]\n"


@pytest.mark.parametrize("text", [CORRIDOR, DRAWN])
def test_good_worlds_have_no_finding(tmp_path, text):
    found = check(tmp_path, text)
    assert lines(found) == ([], [])
    assert found.ok
    assert found.world is not None
    assert [profile.robot for profile in found.clearance] == ["a", "b"]


@pytest.mark.parametrize(
    "drawn",
    [
        "[[-3, -4], [33, -4], [33, 4], [-3, 4], [-3, -4]]",
        "[[-3, -4], [33, -4], [33, 4], [-3, 4], [-3, -3.9], [0, -4]]",
    ],
)
def test_a_polyline_may_close_even_onto_its_own_middle(tmp_path, drawn):
    start = DRAWN.index("  - [[-3")
    end = DRAWN.index("reference_path")
    text = DRAWN[:start] + f"  - {drawn}\n" + DRAWN[end:]
    assert lines(check(tmp_path, text)) == ([], [])


@pytest.mark.parametrize(
    ("y", "is_told"), [(4.5, True), (4.0, False), (3.5, False), (0.0, False), (-9.0, True)]
)
@pytest.mark.parametrize("world", [CORRIDOR, DRAWN])
def test_an_obstacle_that_no_robot_can_meet_is_a_warning(tmp_path, world, y, is_told):
    """Beyond a wall at 4 m; one that lies on it or leads through it stands in the way."""
    ring = [[20.0, y], [21.0, y], [21.0, y + 1.0], [20.0, y + 1.0]]
    _, warnings = lines(check(tmp_path, world + f"obstacles:\n  - {ring}\n"))
    told = with_facts(warnings, "outside the accessible area")
    assert len(told) == is_told
    for one in told:
        line = world.count("\n") + 2
        check_finding(one, f"{line}:5 obstacles[0]", "outside", f"(20, {y:g})")


def test_boundaries_may_touch(tmp_path):
    text = changed(DRAWN, (SECOND, SECOND + "  - [[10, 4], [10, 3]]\n"))
    assert lines(check(tmp_path, text)) == ([], [])


@pytest.mark.parametrize("value", [".nan", "nan", "NaN"])
def test_nan_is_refused_at_its_place(tmp_path, value):
    errors, _ = lines(check(tmp_path, changed(DRAWN, ("[-3, 4], [-3", f"[{value}, 4], [-3"))))
    assert [error.split(" ")[:2] for error in errors] == [["5:16", "boundaries[1][1][0]"]]
    assert "finite" in errors[0]


def test_a_repeated_neighbour_is_reported_and_the_rest_still_looked_at(tmp_path):
    text = changed(DRAWN, ("[33, 4], [-3, 4]", "[33, 4], [33, 4], [-3, 4]"), ("[6.0,", "[3.0,"))
    text = changed(text, ("pose: [3.0, -1.0", "pose: [3.0, 0.5"))
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 2
    check_finding(errors[0], "5:15 boundaries[1][1]", "repeats", "before")
    check_finding(errors[1], "14:11 robots[1].pose", '"b"', "overlaps", '"a"', "0.5 m")


def test_a_boundary_that_crosses_itself_is_reported_where(tmp_path):
    text = changed(DRAWN, (SECOND, SECOND + "  - [[10, 2], [12, 3], [12, 2], [10, 3], [10, 2]]\n"))
    errors, warnings = lines(check(tmp_path, text))
    assert len(errors) == 1
    check_finding(errors[0], "6:5 boundaries[2]", "crosses itself", "(11, 2.5)")
    assert warnings == []


def test_a_boundary_that_turns_back_on_itself_is_reported(tmp_path):
    text = changed(DRAWN, (SECOND, SECOND + "  - [[10, 2], [12, 2], [11, 2]]\n"))
    errors, warnings = lines(check(tmp_path, text))
    assert errors == []
    assert len(warnings) == 1
    check_finding(warnings[0], "6:5 boundaries[2]", "crosses itself", "(12, 2)")


def test_boundaries_that_cross_each_other_are_reported_where(tmp_path):
    ring = "  - [[10, 3], [12, 3], [12, 5], [10, 5], [10, 3]]\n"
    errors, _ = lines(check(tmp_path, changed(DRAWN, (SECOND, SECOND + ring))))
    assert len(errors) == 1
    check_finding(errors[0], "6:5 boundaries[2]", "crosses", "boundaries[1]", "(10, 4)")


def test_an_end_beyond_a_corner_is_only_a_warning(tmp_path):
    text = changed(DRAWN, ("[33, -4], [33, 4]]", "[33, -4], [33, 4.5]]"))
    text = changed(text, ("[[33, 4], [-3, 4]", "[[33.5, 4], [-3, 4]"))
    errors, warnings = lines(check(tmp_path, text))
    assert errors == []
    assert len(warnings) == 1
    parts = ("crosses", "boundaries[0]", "(33, 4)", "beyond")
    check_finding(warnings[0], "5:5 boundaries[1]", *parts)


def test_a_wall_drawn_twice_does_no_harm(tmp_path):
    text = changed(DRAWN, (SECOND, SECOND + "  - [[10, 4], [5, 4]]\n"))
    assert lines(check(tmp_path, text)) == ([], [])


def test_gaps_are_reported_with_their_size_and_place(tmp_path):
    errors, _ = lines(
        check(tmp_path, changed(DRAWN, ("[[33, 4], [-3, 4]", "[[33, 3.75], [-3, 4]")))
    )
    assert lines(check(tmp_path, DRAWN)) == ([], [])
    assert errors == []  # its end lies on the other boundary
    errors, _ = lines(check(tmp_path, changed(DRAWN, ("[[33, 4], [-3, 4]", "[[32, 4], [-3, 4]"))))
    assert len(errors) == 1
    parts = ("no area", "ends", "boundaries[0]", "(33, 4)", "1 m from boundaries[1]")
    check_finding(errors[0], "4:3 boundaries", *parts)


def test_obstacles_are_polygons(tmp_path):
    text = DRAWN + "obstacles: [[[10, 3], [12, 3], [10, 3.5], [12, 3.5]]]\n"
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 1
    check_finding(errors[0], "17:13 obstacles[0]", "itself", "(11, 3.25)")


def test_obstacles_that_fill_the_road_are_reported(tmp_path):
    text = DRAWN + "obstacles: [[[-9, -9], [50, -9], [50, 9], [-9, 9]]]\n"
    errors, _ = lines(check(tmp_path, text))
    check_finding(errors[0], "4:3 boundaries", "obstacles", "nothing", "reference path")


@pytest.mark.parametrize("world", [CORRIDOR, DRAWN])
@pytest.mark.parametrize(("x", "low", "high"), [(1, -5, 5), (15, -4, 4), (15, -4.5, 9)])
def test_an_obstacle_right_across_the_way_is_named_and_nothing_that_follows(
    tmp_path, world, x, low, high
):
    """Robots and paths beyond it stand right."""
    ring = f"[[{x}, {low}], [{x}.2, {low}], [{x}.2, {high}], [{x}, {high}]]"
    errors, _ = lines(check(tmp_path, f"{world}obstacles: [{ring}]\n"))
    assert len(errors) == 1
    place = f"{len(world.splitlines()) + 1}:13 obstacles[0]"
    check_finding(errors[0], place, f"({x}, 0)", f"{x:.2f} m", "right across the way")


def test_obstacles_that_cut_the_way_together_are_named(tmp_path):
    low, high = ("[[{0}, {1}], [{0}.5, {1}], [{0}.5, {2}], [{0}, {2}]]".format(15, *ends)
                 for ends in ((-5, 0), (0, 5)))  # fmt: skip
    bent = CORRIDOR.replace("[[0, 0], [30, 0]]", "[[0, 0], [15, -0.1], [15.5, 0.1], [30, 0]]")
    errors, _ = lines(check(tmp_path, f"{bent}obstacles: [{low}, {high}]\n"))
    assert len(errors) == 2
    for k, error in enumerate(errors):
        check_finding(
            error.partition(" ")[2],
            f"obstacles[{k}]",
            f"with obstacles[{1 - k}]",
            "right across the way",
        )


def box(x0, y0, x1, y1):
    return f"[[{x0}, {y0}], [{x1}, {y0}], [{x1}, {y1}], [{x0}, {y1}]]"


def test_only_those_that_cut_the_way_are_named(tmp_path):
    """Two from the walls that meet beside the path; it leads through a third that does not."""
    boxes = [box(20, -1, 21, 1), box(12, -5, 13, 0.5), box(12, 0.4, 13, 5)]
    errors, _ = lines(check(tmp_path, f"{CORRIDOR}obstacles: [{', '.join(boxes)}]\n"))
    named = [error.split("obstacles[")[1][0] for error in errors]
    assert named == ["1", "2"]


def test_a_pocket_in_the_way_does_not_cut_it(tmp_path):
    """The path runs into a place closed off by obstacles, and out of it; the way is beside it."""
    arch = "[[8, -5], [8, 1], [14, 1], [14, -5], [13.5, -5], [13.5, 0.5], [8.5, 0.5], [8.5, -5]]"
    errors, _ = lines(check(tmp_path, f"{CORRIDOR}obstacles: [{arch}]\n"))
    assert errors
    assert "across the way" not in " ".join(errors)


@pytest.mark.parametrize("second", [10.5, 10.4])
def test_a_path_through_obstacles_that_touch_is_no_error(tmp_path, second):
    """There is a way around both, as around one as large."""
    boxes = [box(10, 0.5, 10.5, 2), box(second, 0.5, 12.5, 2)]
    errors, warnings = lines(check(tmp_path, f"{DRAWN}obstacles: [{', '.join(boxes)}]\n"))
    assert not errors
    assert with_facts(warnings, "robots[0].path", "through obstacles[0]", "way around")


def test_a_reference_path_through_an_obstacle_names_it(tmp_path):
    text = CORRIDOR + "obstacles: [[[15, -1], [16, -1], [16, 1.5], [15, 1.5]]]\n"
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 1
    check_finding(
        errors[0], "3:24 corridor.centreline", "through obstacles[0]", "15.00 m", "16.00 m"
    )


def test_a_path_that_an_obstacle_cuts_off_names_it(tmp_path):
    """The reference path ends before it; the area is what lies on this side."""
    text = changed(
        DRAWN, ("reference_path: [[0, 0], [30, 0]]", "reference_path: [[0, 0], [20, 0]]")
    )
    text += "obstacles: [[[24, -5], [25, -5], [25, 5], [24, 5]]]\n"
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 1
    check_finding(errors[0], "11:11 robots[0].path", '"a"', "24.00 m", "obstacles[0] cuts off")


def test_a_centreline_that_crosses_itself_is_reported(tmp_path):
    text = changed(
        CORRIDOR, ("[[0, 0], [30, 0]]", "[[0, 0], [40, 0], [40, 30], [20, 30], [20, -30]]")
    )
    errors, _ = lines(check(tmp_path, text))
    assert with_facts(errors, "3:24 corridor.centreline", "crosses itself", "(20, 0)")


def test_a_bend_tighter_than_the_width_is_a_warning(tmp_path):
    bend = "[[0, 0], [20, 0], [21, 0.5], [21.5, 1.5], [21.5, 20]]"
    errors, warnings = lines(check(tmp_path, changed(CORRIDOR, ("[[0, 0], [30, 0]]", bend))))
    assert errors == []
    assert with_facts(warnings, "3:11 corridor", "left wall", "crosses itself")


def test_a_centreline_that_turns_back_is_reported(tmp_path):
    text = changed(CORRIDOR, ("[[0, 0], [30, 0]]", "[[0, 0], [30, 0], [0, 1]]"))
    errors, _ = lines(check(tmp_path, text))
    parts = ("178 degrees", "[1] (30, 0)", "at most 149 degrees")
    check_finding(errors[0], "3:24 corridor.centreline", *parts)


def test_walls_that_touch_leave_no_way(tmp_path):
    text = changed(
        DRAWN,
        ("[[-3, -4], [33, -4], [33, 4]]", "[[-3, -4], [15, 0], [33, -4], [33, 4]]"),
        ("[[33, 4], [-3, 4], [-3, -4]]", "[[33, 4], [15, 0], [-3, 4], [-3, -4]]"),
    )
    errors, _ = lines(check(tmp_path, text))
    assert with_facts(errors, "5:5 boundaries[1]", "crosses", "boundaries[0]", "(15, 0)")
    assert with_facts(errors, "6:17 reference_path", "accessible area", "15.00 m", "30.00 m")


def test_a_corridor_narrower_than_the_safe_distance_has_no_safe_area(tmp_path):
    narrow = changed(CORRIDOR, ("width: 8.0", "width: 1.9"), ("1.0, 0.0]", "0.0, 0.0]"))
    narrow = changed(narrow, ("-0.0, 0.0]", "0.0, 0.0]"), ("offset: 1.0", "offset: 0.0"))
    narrow = changed(narrow, ("offset: -1.0", "offset: 0.0"))
    errors, warnings = lines(check(tmp_path, narrow))
    assert errors == []
    assert len(warnings) == 1
    check_finding(warnings[0], "1:1 controller.safe_distance", "1 m", "no safe area", "0.95 m")
    mended = narrow + "controller: {type: mode_switching, safe_distance: 0.6}\n"
    assert lines(check(tmp_path, mended)) == ([], [])


@pytest.mark.parametrize(
    ("places", "counted"), [(1, "(0, 0):"), (2, "1 more place"), (3, "2 more places")]
)
def test_places_are_counted_in_words(tmp_path, monkeypatch, places, counted):
    crossings = [(0.0, 0.0)] * places
    monkeypatch.setattr(boundaries, "self_crossings", lambda wall: crossings)
    _, warnings = lines(check(tmp_path, CORRIDOR))
    assert with_facts(warnings, "left wall", "(0, 0)", counted)


@pytest.mark.parametrize(("times", "counted"), [(2, "1 more stretch"), (3, "2 more stretches")])
def test_stretches_are_counted_in_words(tmp_path, times, counted):
    out = [f"[{x}, 1], [{x}, 6], [{x + 2}, 6], [{x + 2}, 1]" for x in (10, 16, 22)[:times]]
    text = changed(DRAWN, ("[[0, 1], [30, 1]]", f"[[0, 1], {', '.join(out)}, [30, 1]]"))
    errors, _ = lines(check(tmp_path, text))
    assert with_facts(errors, "11:11 robots[0].path", "13.00 m", "19.00 m", counted)


def test_a_wall_that_folds_over_is_reported(tmp_path):
    """Its legs, 120 degrees apart, leave each other too soon to run into each other."""
    line = "[[0, 0], [30, 0], [30.5, 1], [20, 18]]"
    _, warnings = lines(check(tmp_path, changed(CORRIDOR, ("[[0, 0], [30, 0]]", line))))
    (told,) = with_facts(warnings, "corridor", "tighter")
    check_finding(told, "3:11 corridor", "left wall", "crosses itself")


@pytest.mark.parametrize("across", [8, 12])
def test_a_bend_that_leaves_the_width_is_not_reported(tmp_path, across):
    line = f"[[0, 0], [30, 0], [30, {across}], [0, {across}]]"
    _, warnings = lines(check(tmp_path, changed(CORRIDOR, ("[[0, 0], [30, 0]]", line))))
    assert "folds" not in "".join(warnings)


@pytest.mark.parametrize(
    ("line", "place"),
    [
        ("[[0, 0], [20, 0], [20, 20], [0, 20], [0, 0]]", "(-1.5, 2)"),
        ("[[0, 0], [50, 0], [50, 40], [30, 40], [30, 3]]", "(30, 3.5)"),
    ],
)
def test_legs_that_run_into_each_other_are_reported_instead_of_what_follows(tmp_path, line, place):
    errors, warnings = lines(check(tmp_path, changed(CORRIDOR, ("[[0, 0], [30, 0]]", line))))
    parts = ("into itself", place, "[0] to [1]", "[3] to [4]")
    check_finding(errors[0], "3:24 corridor.centreline", *parts)
    assert "accessible area" not in "".join(errors)
    assert "tighter" not in "".join(warnings)


@pytest.mark.parametrize(
    ("line", "legs"),
    [
        ("[[0, 0], [60, 0], [60, 20], [30, 20], [30, 4], [44, 4]]", "[0] … [4]"),  # side walls
        ("[[0, 0], [40, 0], [40, 30], [-2, 30], [-2, 3]]", "[0] … [3]"),  # caps
        ("[[0, 0], [40, 0], [40, 30], [20, 30], [20, 4], [30, 4]]", "[0] … [4]"),
    ],
)
def test_legs_that_run_into_each_other_beside_their_centrelines(tmp_path, line, legs):
    """Every path lies in the area all the same; the road is narrower than it is written."""
    text = changed(CORRIDOR, ("[[0, 0], [30, 0]], width: 8.0", f"{line}, width: 6.0"))
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 1
    check_finding(errors[0], "3:24 corridor.centreline", "into itself", *legs.split(" … "))


def serpentine(width: float, gap: float, radius: float, step: float, last: float) -> str:
    """Three legs with so much between their walls, and rounded corners; the last one ends there."""
    across, points = width + gap, [(0.0, 0.0)]
    for k in range(2):
        x, y, side = (12.0, 0.0, 1.0) if k == 0 else (0.0, across, -1.0)
        for away, up in ((0.0, 0.0), (0.0, across)):  # two corners of a right angle
            turn = np.arange(0.0, 0.5 * np.pi + 1e-9, step)
            turn = turn[::-1] if up else turn
            lean = 1.0 - np.sin(turn)
            points += [
                (x - side * (radius * (lean_x + away)), y + abs(up - radius * lean_y))
                for lean_x, lean_y in zip(lean, 1.0 - np.cos(turn), strict=True)
            ]
    points.append((last, 2.0 * across))
    return str([[round(float(x), 6), round(float(y), 6)] for x, y in points])


@pytest.mark.parametrize("radius", [0.3, 0.6, 0.9])
@pytest.mark.parametrize(("gap", "is_clear"), [(1.2, True), (0.01, True), (-0.01, False)])
@pytest.mark.parametrize("last", [12.0, 9.0], ids=["even", "uneven"])
def test_legs_of_a_serpentine_with_tight_bends_are_clear_while_a_gap_is_between_them(
    tmp_path, radius, gap, is_clear, last
):
    """Walls fold over in the bends, nearer to the legs beside them than the ends are long."""
    line = serpentine(1.8, gap, radius, 0.4, last)
    text = changed(
        CORRIDOR,
        ("[[0, 0], [30, 0]], width: 8.0", f"{line}, width: 1.8"),
        ("1.8, width: 1.0", "0.4, width: 0.2"),
        ("6.0, 1.0, 0.0", "6.0, 0.2, 0.0"),
        ("3.0, -1.0, 0.0", "3.0, -0.2, 0.0"),
        ("offset: 1.0", "offset: 0.2"),
        ("offset: -1.0", "offset: -0.2"),
    )
    errors, _ = lines(check(tmp_path, text))
    into = with_facts(errors, "into itself")
    assert bool(into) != is_clear, errors


@pytest.mark.parametrize("across", [3.0, 3.99, 4.0])
def test_a_hairpin_is_clear_where_its_legs_are_a_width_apart(tmp_path, across):
    """Their inner walls are parallel, and their caps on one line: nothing crosses."""
    line = f"[[0, 0], [20, 0], [20, {across}], [0, {across}]]"
    text = changed(CORRIDOR, ("[[0, 0], [30, 0]], width: 8.0", f"{line}, width: 4.0"))
    errors, _ = lines(check(tmp_path, text))
    into = with_facts(errors, "into itself", "[0] to [1]", "[2] to [3]")
    assert bool(into) == (across < 4.0)


@pytest.mark.parametrize("turn", range(30, 150, 30))
@pytest.mark.parametrize("radius", [0.05, 1.0, 3.0])
@pytest.mark.parametrize("apart", [0.1, 1.0, 100.0])
def test_a_bend_is_no_leg_of_its_own_however_its_points_lie(turn, radius, apart):
    """What a single corner may do, a bend of many points may, on legs of many points too."""
    width, ahead = 4.0, np.radians(turn)
    bend = np.linspace(0.0, ahead, 12)
    legs = np.append(np.arange(0.0, 40.0, apart), 40.0)
    before = np.stack([legs, np.zeros_like(legs)], axis=1)
    corner = np.stack([40.0 + radius * np.sin(bend), radius * (1.0 - np.cos(bend))], axis=1)
    after = corner[-1] + legs[:, None] * [np.cos(ahead), np.sin(ahead)]
    line = np.vstack([before, corner[1:], after[1:]])
    assert self_overlap(line, np.full(len(line), width), 3.0) == ""


def test_a_wall_that_crosses_itself_a_long_way_round_is_of_two_legs(tmp_path):
    """The left wall of the way out and the left wall of the way back."""
    line = "[[0, 0], [30, 0], [50, 15], [30, 30], [10, {}], [0, {}]]"
    for at, count in ((5.0, 1), (7.0, 0)):
        text = changed(CORRIDOR, ("[[0, 0], [30, 0]], width: 8.0", f"{line}, width: 6.0"))
        errors, _ = lines(check(tmp_path, text.replace("{}", str(at))))
        assert len(errors) == count
        for error in errors:
            check_finding(error, "3:24 corridor.centreline", "into itself", "[0]")


def test_a_point_is_counted_as_the_file_counts_it_for_walls_and_paths_alike(tmp_path):
    text = changed(CORRIDOR, ("[[0, 0], [30, 0]]", "[[0, 0], [30, 0], [2, 0.5]]"))
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 2
    for error, place in zip(
        errors, ("3:24 corridor.centreline", "8:20 robots[0].path.offset"), strict=True
    ):
        check_finding(error, place, "179 degrees", "[1] (30, 0)")
