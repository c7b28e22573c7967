"""Robots at the start and their paths."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from physim import build_scene
from physim.world.file import parse_world
from tests.checking.worlds import (
    CORRIDOR,
    DRAWN,
    changed,
    check,
    check_finding,
    lines,
    only_error,
    only_warning,
    with_facts,
)
from tests.helpers import inside

ALIGNED, ANY, NOT, verdict = inside("physim.world.checks", "ALIGNED", "ANY", "NOT", "verdict")

A = "    pose: [6.0, 1.0, 0.0]"
BOX = "    footprint: {length: 1.8, width: 1.0}\n    pose: [6.0, 1.0, 0.0]"


@pytest.mark.parametrize(
    ("outline", "place", "parts"),
    [
        ("[[0, 0], [1, 1], [1, 0], [0, 1]]", "6:16 robots[0].footprint", ["itself", "(0.5, 0.5)"]),
        ("[[0, 0], [1, 0], [2, 0]]", "6:16 robots[0].footprint", ["no area"]),
        ("[[0, 0], [1, 0]]", "6:16 robots[0].footprint", ["at least 3", "2"]),
        ("{length: 0, width: 1}", "6:25 robots[0].footprint.length", ["greater than 0"]),
    ],
)
def test_footprints_are_simple_and_have_an_area(tmp_path, outline, place, parts):
    text = changed(CORRIDOR, (BOX, f"    footprint: {outline}\n{A}"))
    check_finding(only_error(tmp_path, text), place, *parts)


@pytest.mark.parametrize(
    "outline",
    [
        "[[-0.9, -0.6], [0.9, -0.6], [0.9, 0.6], [0.0, 0.0], [-0.9, 0.6]]",
        "[[-0.9, -0.6], [0.9, -0.6], [0.9, 0.6], [-0.9, 0.6], [-0.9, -0.6]]",
    ],
)
def test_nonconvex_and_closed_footprints_are_fine(tmp_path, outline):
    text = changed(CORRIDOR, (BOX, f"    footprint: {outline}\n{A}"))
    assert lines(check(tmp_path, text)) == ([], [])


def test_a_reference_point_outside_the_footprint_is_a_warning(tmp_path):
    outline = "[[2, -0.5], [3, -0.5], [3, 0.5], [2, 0.5]]"
    step = ("step: 0.01", "step: 0.005")
    text = changed(CORRIDOR, step, (BOX, f"    footprint: {outline}\n    pose: [6.0, 2.0, 0.0]"))
    check_finding(only_warning(tmp_path, text), "6:16 robots[0].footprint", "2 m", "outside")


@pytest.mark.parametrize(
    ("pose", "place", "parts"),
    [
        ("[6.0, 3.5, 0.0]", "7:11 robots[0].pose", ['"a"', "touches", "corridor"]),
        ("[6.0, 3.7, 0.0]", "7:11 robots[0].pose", ['"a"', "0.2 m over", "corridor"]),
        ("[6.0, 40.0, 0.0]", "7:11 robots[0].pose", ['"a"', "outside", "35.5 m"]),
        ("[3.0, 0.0, 0.0]", "11:11 robots[1].pose", ['"b"', "touches", '"a"']),
        ("[3.0, -0.3, 0.0]", "11:11 robots[1].pose", ['"b"', "overlaps", '"a"', "0.3 m"]),
    ],
)
def test_robots_start_inside_and_apart_by_more_than_touching(tmp_path, pose, place, parts):
    error = only_error(tmp_path, changed(CORRIDOR, ("[6.0, 1.0, 0.0]", pose)))
    check_finding(error, place, *parts)


def test_robots_start_apart_from_obstacles(tmp_path):
    text = CORRIDOR + "obstacles: [[[6.9, 0.9], [8, 0.9], [8, 1.1], [6.9, 1.1]]]\n"
    errors, warnings = lines(check(tmp_path, text))
    assert len(errors) == 1
    check_finding(errors[0], "7:11 robots[0].pose", '"a"', "touches", "obstacles[0]")
    path = "8:20 robots[0].path.offset"
    check_finding(warnings[0], path, '"a"', "through obstacles[0]", "6.90 m", "8.00 m")


def test_starts_are_looked_at_though_no_boundary_can_be_read(tmp_path):
    text = changed(CORRIDOR, ("width: 8.0", "width: wide"), ("[6.0, 1.0", "[3.0, -1.0"))
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 2
    check_finding(errors[0], "3:50 corridor.width", "[m]", "number", '"wide"')
    check_finding(errors[1], "11:11 robots[1].pose", '"b"', "overlaps", '"a"', "1 m")


def test_a_heading_in_degrees_is_a_warning_with_its_radians(tmp_path):
    warning = only_warning(tmp_path, changed(CORRIDOR, ("1.0, 0.0]\n    path: {offset: 1.0}",
                                             "1.0, 90]\n    path: {offset: 1.0}")))  # fmt: skip
    assert warning.startswith("7:22 robots[0].pose[2] 90 rad ")
    assert warning.endswith(" 1.5708")  # what to write


def test_a_start_with_the_back_to_the_path_is_a_warning(tmp_path):
    text = changed(CORRIDOR, ("[6.0, 1.0, 0.0]", "[6.0, 1.0, 3.14159]"))
    warning = only_warning(tmp_path, text)
    check_finding(warning, "7:22 robots[0].pose[2]", '"a"', "180 degrees", "path", "0 rad")


def test_a_random_heading_needs_room_to_turn(tmp_path):
    free = changed(CORRIDOR, ("[6.0, 1.0, 0.0]", "[6.0, 1.0, random]"))
    assert lines(check(tmp_path, free)) == ([], [])
    tight = changed(
        CORRIDOR, ("[6.0, 1.0, 0.0]", "[6.0, 3.1, random]"), ("name: co", "seed: 1\nname: co")
    )
    found = [lines(check(tmp_path, tight.replace("seed: 1", f"seed: {k}"))) for k in range(6)]
    kinds = {bool(errors) for errors, _ in found}
    assert kinds == {True, False}
    for errors, warnings in found:
        if not errors:
            place = "8:22 robots[0].pose[2]"
            check_finding(warnings[0], place, "random", "seed", '"a"', "touch", "corridor")


def test_a_path_through_a_wall_is_reported_with_the_stretch(tmp_path):
    dent = "[[33, 4], [17, 4], [15, 0.5], [13, 4], [-3, 4], [-3, -4]]"
    text = changed(DRAWN, ("[[33, 4], [-3, 4], [-3, -4]]", dent))
    error = only_error(tmp_path, text)
    assert error.startswith("11:11 robots[0].path ")
    assert all(part in error for part in ('"a"', "leaves", "14.71 m", "15.29 m"))


def test_a_path_too_near_a_wall_is_refused_where_the_robot_would_follow_it(tmp_path):
    dent = "[[33, 4], [17, 4], [15, 1.2], [13, 4], [-3, 4], [-3, -4]]"
    text = changed(DRAWN, ("[[33, 4], [-3, 4], [-3, -4]]", dent))
    follower = "controller: {type: path_following}\n"
    error = only_error(tmp_path, text + follower)
    assert error.startswith("11:11 robots[0].path ")
    figures = ('"a"', "15.00 m", "(15, 1)", "0.2 m", "boundaries[1]", "0.5 m")
    assert all(figure in error for figure in figures)
    warning = only_warning(tmp_path, text)
    assert all(figure in warning for figure in (*figures, "safe area, 1 m"))
    shared = changed(text, ("{offset: -1.0}", "[[0, 1], [30, 1]]"), ("[0.0, -3.0]", "[0.0, -4.0]"))
    check_finding(only_warning(tmp_path, shared), "11:11 robots[0].path", "1 more", "(15, 1)")


def test_a_robot_wider_than_the_road_is_refused(tmp_path):
    dent = "[[33, 4], [17, 4], [15, -3.2], [13, 4], [-3, 4], [-3, -4]]"
    text = changed(
        DRAWN,
        ("[[33, 4], [-3, 4], [-3, -4]]", dent),
        ("[[0, 0], [30, 0]]", "[[0, 0], [13, 0], [15, -3.6], [17, 0], [30, 0]]"),
        ("[[0, 1], [30, 1]]", "[[0, 1], [13, 0], [15, -3.6], [17, 0], [30, 1]]"),
        ("offset: -1.0", "offset: 0.0"),
    )
    errors, warnings = lines(check(tmp_path, text))
    assert with_facts(warnings, "robots[0].path", '"a"', "not fit", "station", "boundaries[1]")
    assert len(errors) == 2
    check_finding(errors[0], "11:11 robots[0].path", "no route", '"a"', "1 m")


@pytest.mark.parametrize(("slot", "is_way"), [(0.8, False), (1.2, True)])
def test_a_slot_narrower_than_the_robot_is_no_way(tmp_path, slot, is_way):
    low = slot - 4.0
    text = changed(
        CORRIDOR,
        ("formation: {spacing: [0.0, -3.0]}\n", ""),
        ("path: {offset: 1.0}", "path: [[0, 2], [30, 2]]"),
        ("path: {offset: -1.0}", "path: [[0, -1], [30, -1]]"),
    )
    text += "reference_path: [[0, 0], [13, -3.6], [18, -3.6], [30, 0]]\n"
    text += f"obstacles: [[[15, {low}], [16, {low}], [16, 3.9], [15, 3.9]]]\n"
    errors, warnings = lines(check(tmp_path, text))
    assert len(with_facts(warnings, "through obstacles[0]", "15.00 m", "16.00 m")) == 2
    assert [error.split(" ")[1] for error in errors] == (
        [] if is_way else ["robots[0].path", "robots[1].path"]
    )
    if not is_way:
        check_finding(errors[0], "8:11 robots[0].path", "no route", '"a"', "narrower than 1 m")


def test_room_has_three_verdicts():
    assert verdict(1.2, 0.5, 1.1) == ANY
    assert verdict(1.1, 0.5, 1.1) == ALIGNED
    assert verdict(0.6, 0.5, 1.1) == ALIGNED
    assert verdict(0.5, 0.5, 1.1) == NOT


def test_the_profile_has_the_clearance_of_every_station(tmp_path):
    dent = "[[33, 4], [17, 4], [15, 1.9], [13, 4], [-3, 4], [-3, -4]]"
    found = check(tmp_path, changed(DRAWN, ("[[33, 4], [-3, 4], [-3, -4]]", dent)))
    assert found.ok
    a, b = found.clearance
    assert a.inscribed == pytest.approx(0.5)
    assert a.circumscribed == pytest.approx(math.hypot(0.9, 0.5))
    assert a.narrowest == pytest.approx((15.0, 15.0, 1.0, 0.9))
    assert a.station[0] == 0.0
    assert a.station[-1] == 30.0
    assert np.diff(a.station).max() <= 0.25 + 1e-9
    assert a.clearance.min() == pytest.approx(0.9)
    assert a.clearance[0] == pytest.approx(3.0)
    assert a.verdict == ALIGNED
    assert [part.verdict for part in a.stretches] == [ANY, ALIGNED, ANY]
    assert a.stretches[1].first < 15.0 < a.stretches[1].last
    assert a.stretches[1].last - a.stretches[1].first < 2.0
    assert 0.0 < a.danger_share < 0.1
    assert b.verdict == ANY
    assert b.danger_share == 0.0
    json.dumps(found.as_json(), allow_nan=False)


def test_the_profile_is_negative_outside(tmp_path):
    text = changed(DRAWN, ("[[0, 1], [30, 1]]", "[[0, 1], [15, 6], [30, 1]]"))
    found = check(tmp_path, text)
    assert len(found.errors) == 1
    assert found.clearance[0].verdict == NOT
    assert found.clearance[0].narrowest[3] == pytest.approx(-2.0, abs=0.1)


def test_robots_start_beside_the_reference_path(tmp_path):
    text = changed(CORRIDOR, ("[3.0, -1.0", "[-1.1, -1.0"))
    warning = only_warning(tmp_path, text)
    check_finding(warning, "11:11 robots[1].pose", '"b"', "before", "reference path")
    text = changed(CORRIDOR, ("[3.0, -1.0", "[-1.0, -1.0"))  # within its own radius, 1.03 m
    assert lines(check(tmp_path, text)) == ([], [])


def test_the_reference_path_is_in_order(tmp_path):
    text = changed(DRAWN, ("[[0, 0], [30, 0]]", "[[0, 0], [20, 0], [10, 0.5], [30, 0]]"))
    text = changed(text, ("{offset: -1.0}", "[[0, -1], [30, -1]]"))
    warnings = lines(check(tmp_path, text))[1]
    backwards = with_facts(warnings, "turns back")
    assert len(backwards) == 2
    check_finding(backwards[0], "6:17 reference_path", "177 degrees", "(20, 0)")
    check_finding(backwards[1], "6:17 reference_path", "179 degrees", "(10, 0.5)")


def test_a_path_of_its_own_is_in_order(tmp_path):
    """The robot stood for ever where its target came back to it."""
    text = changed(DRAWN, ("[[0, 1], [30, 1]]", "[[0, 1], [20, 1], [10, 1.2]]"))
    text = changed(text, ("{offset: -1.0}", "[[0, -1], [30, -1]]"))
    (backwards,) = with_facts(lines(check(tmp_path, text))[1], "turns back")
    check_finding(backwards, "11:11 robots[0].path", '"a"', "179 degrees", "(20, 1)")


def test_a_reference_path_that_crosses_itself_is_a_warning(tmp_path):
    loop = "[[0, 0], [20, 0], [20, 3], [15, 3], [15, -3], [25, -3], [30, 0]]"
    text = changed(DRAWN, ("[[0, 0], [30, 0]]", loop), ("{offset: -1.0}", "[[0, -1], [30, -1]]"))
    warnings = lines(check(tmp_path, text))[1]
    assert with_facts(warnings, "6:17 reference_path", "crosses", "itself")


def test_a_path_against_the_reference_path_is_a_warning(tmp_path):
    text = changed(DRAWN, ("[[0, 1], [30, 1]]", "[[30, 1], [0, 1]]"))
    warnings = lines(check(tmp_path, text))[1]
    against = with_facts(warnings, "against")
    assert len(against) == 1
    check_finding(against[0], "11:11 robots[0].path", '"a"', "station 30.00 m", "to 0.00 m")


@pytest.mark.parametrize(("start", "warned"), [(28.0, False), (6.0, True)])
def test_without_a_formation_a_path_against_it_is_doubted_at_its_end_alone(tmp_path, start, warned):
    """A robot that begins at the beginning of its path is meant to go the other way."""
    text = changed(
        CORRIDOR, ("formation: {spacing: [0.0, -3.0]}\n", ""),
        ("pose: [6.0, 1.0, 0.0]\n    path: {offset: 1.0}",
         f"pose: [{start}, 1.0, 3.1415]\n    path: [[29, 1], [2, 1]]"),
    )  # fmt: skip
    doubted = with_facts(lines(check(tmp_path, text))[1], "robots[0].path", "in order?")
    assert bool(doubted) == warned


def test_a_short_reference_path_is_a_warning(tmp_path):
    text = changed(
        DRAWN, ("reference_path: [[0, 0], [30, 0]]", "reference_path: [[6, 0], [6.9, 0]]")
    )
    text = changed(
        text, ("formation: {spacing: [0.0, -3.0]}\n", ""), ("{offset: -1.0}", "[[0, -1], [30, -1]]")
    )
    check_finding(only_warning(tmp_path, text), "6:17 reference_path", "0.9 m", "metres")


@pytest.mark.parametrize(
    ("width", "where"), [("0.9", "3:50 corridor.width"), ("[8.0, 0.9]", "3:56 corridor.width[1]")]
)
def test_a_corridor_too_narrow_for_its_robots_is_reported_at_its_width(tmp_path, width, where):
    errors, _ = lines(check(tmp_path, changed(CORRIDOR, ("width: 8.0", f"width: {width}"))))
    check_finding(errors[0], where, "0.9 m", '"a"', "more than 1 m", "1 more")
    assert with_facts(errors, "no route") == []
    wide, _ = lines(check(tmp_path, changed(CORRIDOR, ("width: 8.0", "width: 1.01"))))
    assert not any("corridor.width" in error for error in wide)


def test_lengths_beyond_their_bounds_may_be_in_millimetres(tmp_path):
    box = (
        "{length: 1.8, width: 1.0}\n    pose: [6.0",
        "{length: 1800, width: 1.0}\n    pose: [6.0",
    )
    error = only_error(tmp_path, changed(CORRIDOR, box))
    place = "6:25 robots[0].footprint.length"
    check_finding(error, place, "at most 1000", "given 1800", "write 18", "millimetres, 1.8")
    fast = changed(CORRIDOR, ("path: {offset: 1.0}", "path: {offset: 1.0}\n    limits: {v: 1500}"))
    assert "millimetres" not in only_error(tmp_path, fast)


def test_a_wrong_unit_is_told_once_and_not_what_follows_from_it(tmp_path):
    box = "{length: 180, width: 100}\n    pose: [6.0"
    errors, warnings = lines(
        check(tmp_path, changed(CORRIDOR, ("{length: 1.8, width: 1.0}\n    pose: [6.0", box)))
    )
    assert len(errors) == 1, errors
    check_finding(errors[0], "6:16 robots[0].footprint", "102.956 m", "centimetres")
    assert with_facts(warnings, "6:16 robots[0].footprint", "write 1.8")


def test_a_wrong_unit_hides_no_other_fault_of_the_file(tmp_path):
    box = "{length: 180, width: 100}\n    pose: [6.0"
    text = changed(CORRIDOR, ("{length: 1.8, width: 1.0}\n    pose: [6.0", box))
    errors, _ = lines(check(tmp_path, text + "controler: {type: mode_switching}\n"))
    assert len(errors) == 2, errors
    assert with_facts(errors, "controler", "controller")


@pytest.mark.parametrize("edge", [1.0, 1.001])
@pytest.mark.parametrize(("is_wall", "kind"), [(True, "errors"), (False, "warnings")])
def test_a_path_along_the_very_edge_of_a_wall_is_refused(tmp_path, edge, is_wall, kind):
    """It neither leaves the area nor crosses a wall, and no robot fits there."""
    dent = f"[[33, 4], [20, 4], [20, {edge}], [18, {edge}], [18, 4], [-3, 4], [-3, -4]]"
    upper = "[[33, 4], [-3, 4], [-3, -4]]"
    post = f"obstacles: [[[18, {edge}], [20, {edge}], [20, 2], [18, 2]]]\n"
    text = changed(DRAWN, (upper, dent)) if is_wall else DRAWN + post
    found = check(tmp_path, text + "controller: {type: path_following}\n")
    check_finding(
        with_facts(lines(found)[kind == "warnings"], "a", "does not fit")[0],
        "11:11 robots[0].path", f"{edge - 1.0:.4g} m to", "0.5 m",
    )  # fmt: skip


def test_a_width_in_centimetres_is_suspected(tmp_path):
    errors, warnings = lines(check(tmp_path, changed(CORRIDOR, ("width: 8.0", "width: 160"))))
    assert errors == []
    assert with_facts(warnings, "3:50 corridor.width", "160 m", "write 1.6"), warnings


@pytest.mark.parametrize(
    ("given", "meant"),
    [("6 m", "6 is meant"), ("600 cm", "6 is meant"), ("6000mm", "6 is meant"),
     ("6 parsecs", "each key has its own")],
)  # fmt: skip
def test_a_number_with_its_unit(tmp_path, given, meant):
    error = only_error(tmp_path, changed(CORRIDOR, ("width: 8.0", f"width: {given}")))
    check_finding(error, "3:50 corridor.width", f'"{given}"', meant)


@pytest.mark.parametrize(
    ("was", "given", "point"),
    [("width: 8.0", 'width: "6,5"', "6.5"), ("length: 1.8,", "length: 1,8,", "length: 1.8")],
)
def test_a_decimal_comma_alone_and_in_braces(tmp_path, was, given, point):
    errors, _ = lines(check(tmp_path, changed(CORRIDOR, (was, given))))
    assert any("decimals take a point" in error and point in error for error in errors), errors


@pytest.mark.parametrize("given", ["−1.5", "\N{EN DASH}1.5", "-１.5", "-1．5"])
def test_a_number_with_signs_that_look_alike_is_told_with_the_right_ones(tmp_path, given):
    """As a page of print has them."""
    text = changed(CORRIDOR, ("{offset: -1.0}", f"{{offset: {given}}}"))
    (error,) = with_facts(lines(check(tmp_path, text))[0], "robots[1].path.offset")
    assert error.endswith(": -1.5")


def test_a_pose_without_its_heading(tmp_path):
    error = only_error(tmp_path, changed(CORRIDOR, ("[6.0, 1.0, 0.0]", "[6.0, 1.0]")))
    check_finding(error, "7:5 robots[0].pose[2]", "missing", "heading")


def test_an_empty_value_that_is_needed_is_not_to_be_left_out(tmp_path):
    for change, needed in (
        (("width: 8.0", "width: "), True),
        (("{spacing: [0.0, -3.0]}", ""), False),
    ):
        error = only_error(tmp_path, changed(CORRIDOR, change))
        assert "empty value" in error
        assert ("leave the key out" in error) is not needed


def test_a_step_that_would_tunnel_is_refused(tmp_path):
    limits = "    limits: {v: 0.1, omega: 0.1}\n    omegas: [-0.1, 0, 0.1]\n    pose: [3.0"
    text = changed(CORRIDOR, ("step: 0.01", "step: 0.1"), ("    pose: [3.0", limits))
    error = only_error(tmp_path, text)
    figures = ("0.3147 m", "0.1 s", "at most 0.25 m", "at most 0.0794 s")
    check_finding(error, "2:14 time.step", '"a"', *figures)
    both = only_error(tmp_path, changed(CORRIDOR, ("step: 0.01", "step: 0.1")))
    check_finding(both, "2:14 time.step", "1 more", *figures)


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        (("{length: 1.8, width: 1.0}\n    pose: [6.0", "{length: 180, width: 100}\n    pose: [6.0"),
         ["6:16 robots[0].footprint", '"a"', "180 m", "write 1.8", "millimetres, 0.18"]),
        (("width: 8.0", "width: 8000"),
         ["3:50 corridor.width", "8000 m", "write 80", "millimetres, 8"]),
        (("[30, 0]]", "[300000, 0]]"),
         ["3:24 corridor.centreline", "300000 m", "write 3000", "millimetres, 300"]),
        (("duration: 60.0", "duration: 330000"),
         ["2:30 time.duration", "330000 s", "91.67 hours", "milliseconds", "write 330"]),
        (("path: {offset: 1.0}", "path: {offset: 1.0}\n    limits: {v: 1500}"), []),
    ],
)  # fmt: skip
def test_numbers_out_of_scale_are_reported(tmp_path, change, parts):
    errors, warnings = lines(check(tmp_path, changed(CORRIDOR, change)))
    if parts:
        assert with_facts(warnings, *parts), warnings
    else:
        assert errors


@pytest.mark.parametrize(
    ("given", "place", "parts"),
    [
        ("limits: {v: 60.0}", "9:17 robots[0].limits.v", ["60 m/s", "metres per second", "0.06"]),
        ("limits: {omega: 90.0}", "9:21 robots[0].limits.omega", ["90 rad/s", "write 1.5708"]),
        ("speeds: [-0.5]", "9:13 robots[0].speeds", ["above 0", "forward", "1.0"]),
        ("omegas: [-1.0, 1.0]", "9:13 robots[0].omegas", ["straight on", "add 0"]),
        ("omegas: [0.0, 1.0]", "9:13 robots[0].omegas", ["left", "both sides"]),
    ],
)
def test_speeds_that_are_seldom_meant_are_reported(tmp_path, given, place, parts):
    text = changed(CORRIDOR, ("path: {offset: 1.0}", f"path: {{offset: 1.0}}\n    {given}"))
    text = changed(text, ("step: 0.01", "step: 0.002"))
    check_finding(only_warning(tmp_path, text), place, *parts)


def test_speeds_are_multiples_of_nu(tmp_path):
    given = "path: {offset: 1.0}\n    speeds: [0, 1.2]"
    error = only_error(tmp_path, changed(CORRIDOR, ("path: {offset: 1.0}", given)))
    check_finding(error, "9:17 robots[0].speeds[1]", "at most 1", "given 1.2")


def test_an_offset_path_that_folds_in_a_bend_is_a_warning(tmp_path):
    bend = "[[0, 0], [20, 0], [21, 0.5], [21.5, 1.5], [21.5, 20]]"
    text = changed(CORRIDOR, ("[[0, 0], [30, 0]]", bend), ("offset: 1.0", "offset: 2.5"))
    warnings = lines(check(tmp_path, text))[1]
    folds = with_facts(warnings, "8:20 robots[0].path.offset", "backwards")
    assert len(folds) == 1
    check_finding(folds[0], "8:20 robots[0].path.offset", "2.5 m", '"a"', "2.5)")


@pytest.mark.parametrize("least", [-0.1, 2.4, 2.5, 2.6])
def test_a_least_distance_to_a_wall_that_the_start_breaks_is_a_warning(tmp_path, least):
    """b, 1 m wide, stands 1 m off the middle of a corridor of 8 m; so does a, on the other side."""
    text = CORRIDOR + f"expect: {{min_boundary_distance: {least}}}\n"
    _, warnings = lines(check(tmp_path, text))
    broken = with_facts(warnings, "expect.min_boundary_distance")
    assert len(broken) == (least > 2.5)
    for one in broken:
        parts = ('"a"', "2.5 m", "the edge of the corridor", "less than 2.6 m")
        check_finding(one, "14:33 expect.min_boundary_distance", *parts)
    _, warnings = lines(check(tmp_path, text + "obstacles: [[[5.8, 2], [6.2, 2], [6, 2.3]]]\n"))
    assert with_facts(warnings, '"a"', "0.5 m", "obstacles[0]") or least < 0.0


@pytest.mark.parametrize(("least", "warned"), [("50", True), ("0.05", False)])
def test_a_least_distance_that_the_start_breaks_is_a_warning(tmp_path, least, warned):
    text = CORRIDOR + f"expect: {{min_distance: {least}}}\n"
    errors, warnings = lines(check(tmp_path, text))
    assert errors == []
    broken = with_facts(warnings, "expect.min_distance")
    assert len(broken) == warned
    for one in broken:
        check_finding(one, "14:24 expect.min_distance", '"a"', '"b"', "1.562 m", "less than 50 m")


def test_robots_at_the_very_same_pose_are_no_distance_apart(tmp_path):
    """An entry copied, its pose forgotten."""
    copied = ("pose: [3.0, -1.0, 0.0]", "pose: [6.0, 1.0, 0.0]")
    text = changed(CORRIDOR, copied) + "expect: {min_distance: 0.1}\n"
    errors, warnings = lines(check(tmp_path, text))
    assert [one for one in errors if "overlaps" in one]
    (broken,) = with_facts(warnings, "expect.min_distance")
    assert "are 0 m apart" in broken


@pytest.mark.parametrize(("most", "warned"), [("2.5", True), ("2.51", False)])
def test_a_greatest_distance_that_the_start_breaks_is_a_warning(tmp_path, most, warned):
    """Of three robots the two that are farthest apart: 1.2 m along the road, 2.2 m across it."""
    size, path = "{length: 1.8, width: 1.0}", "{offset: 2.2}"
    third = f"  - {{name: c, footprint: {size}, pose: [6.0, 2.2, 0.0], path: {path}}}\n"
    formation = "formation: {spacing: [0.0, -3.0]}\n"
    text = changed(CORRIDOR, (formation, third + f"expect: {{max_distance: {most}}}\n"))
    errors, warnings = lines(check(tmp_path, text))
    assert errors == []
    broken = with_facts(warnings, "expect.max_distance")
    assert len(broken) == warned
    for one in broken:
        where = "14:24 expect.max_distance"
        check_finding(one, where, '"b"', '"c"', "2.506 m", "more than 2.5 m")


@pytest.mark.parametrize(("step", "warned"), [("1.0e-6", True), ("0.01", False)])
def test_a_run_of_very_many_steps_is_a_warning(tmp_path, step, warned):
    text = changed(CORRIDOR, ("step: 0.01, duration: 60.0", f"step: {step}, duration: 40.0"))
    errors, warnings = lines(check(tmp_path, text))
    assert errors == []
    assert any("40,000,000 steps" in line and "time.step" in line for line in warnings) == warned


def test_an_offset_by_which_a_leg_vanishes_is_a_path_without_it(tmp_path: Path) -> None:
    """The middle leg turns by 45 degrees at both ends: at 2 + sqrt 2 m its ends are one."""
    text = (
        "name: leg\ntime: {step: 0.02, duration: 60}\n"
        "boundaries: [[[-2, -20], [60, -20], [60, 30], [-2, 30], [-2, -20]]]\n"
        "reference_path: [[0, 0], [20, 0], [22, 2], [22, 22]]\nrobots:\n"
        f"  - {{name: a, footprint: {{length: 1, width: 0.6}}, pose: [8, {2 + 2**0.5}, 0], "
        f"path: {{offset: {2 + 2**0.5}}}}}\ncontroller: {{type: path_following}}\n"
    )
    assert lines(check(tmp_path, text)) == ([], [])
    scene = build_scene(parse_world(text))
    np.testing.assert_allclose(
        scene.paths[0], [[0, 2 + 2**0.5], [20 - 2**0.5, 2 + 2**0.5], [20 - 2**0.5, 22]]
    )
    assert np.isfinite(scene.stop_station).all()


@pytest.mark.parametrize("thin", [False, True])
def test_the_room_of_a_path_through_an_obstacle_is_its_depth(tmp_path, thin):
    """The distance to the outline; of two that overlap, to that of both together."""
    first, last = (14.05, 14.15) if thin else (14.0, 16.0)
    middle = (first + last) / 2.0
    halves = [
        f"[[{a}, 0], [{b}, 0], [{b}, 2], [{a}, 2]]" for a, b in ((first, middle), (middle, last))
    ]
    whole = f"[[{first}, 0], [{last}, 0], [{last}, 2], [{first}, 2]]"
    one = check(tmp_path, DRAWN + f"obstacles: [{whole}]\n").clearance[0]
    two = check(tmp_path, DRAWN + f"obstacles: [{', '.join((whole, *halves))}]\n").clearance[0]
    for found in (one, two):
        depth = min(1.0, (last - first) / 2.0)
        assert found.narrowest == pytest.approx((middle, middle, 1.0, -depth), abs=1e-3)
        assert found.narrowest[3] <= found.clearance.min()
        inside = (found.station > first) & (found.station < last)
        own = np.minimum(found.station - first, last - found.station)
        assert found.clearance[inside] == pytest.approx(-own[inside])
        assert inside.any() != thin
        assert found.verdict == NOT
        assert not np.signbit(found.clearance[found.clearance == 0.0]).any()
    told = json.loads(json.dumps(one.as_json()))
    assert told["narrowest"]["clearance"] == pytest.approx(-depth, abs=1e-3)
    assert min(told["clearance"]) >= told["narrowest"]["clearance"] - 1e-6


@pytest.mark.parametrize("own", [False, True])
def test_a_heading_of_a_start_region_may_be_in_degrees_too(tmp_path, own):
    region = "start: {region: [[2, -2], [9, -2], [9, 2], [2, 2]], heading: 90}"
    lines_of = CORRIDOR.split("\n")
    at = next(k for k, line in enumerate(lines_of) if "pose: " in line)
    if own:
        lines_of[at] = "    " + region
    else:
        lines_of[at : at + 1] = []
        lines_of.insert(next(k for k, one in enumerate(lines_of) if one == "robots:"), region)
    _, warnings = lines(check(tmp_path, "\n".join(lines_of)))
    (warning,) = [one for one in warnings if "full turn" in one]
    check_finding(
        warning, "7:66 robots[0].start.heading" if own else "4:62 start.heading", "90 rad", "1.5708"
    )


@pytest.mark.parametrize("start", ["[1, 2]", "5", "[]", "true", "{a: 1}", "{heading: null}"])
def test_a_start_that_cannot_be_read_has_no_heading(tmp_path, start):
    text = CORRIDOR.replace("robots:", f"start: {start}\nrobots:", 1)
    errors, _ = lines(check(tmp_path, text))
    assert "start" in errors[0]
