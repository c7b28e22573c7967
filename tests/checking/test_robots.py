"""Robots at the start, their paths, and the formation."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from physim.world.checks.room import ALIGNED, ANY, NOT, verdict
from tests.checking.worlds import CORRIDOR, DRAWN, changed, check, lines

A = "    pose: [6.0, 1.0, 0.0]"
BOX = "    footprint: {length: 1.8, width: 1.0}\n    pose: [6.0, 1.0, 0.0]"


def only_error(tmp_path, text):
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 1, errors
    return errors[0]


def only_warning(tmp_path, text):
    errors, warnings = lines(check(tmp_path, text))
    assert errors == []
    assert len(warnings) == 1, warnings
    return warnings[0]


@pytest.mark.parametrize(
    ("outline", "told"),
    [
        ("[[0, 0], [1, 1], [1, 0], [0, 1]]", "crosses or touches itself at (0.5, 0.5)"),
        ("[[0, 0], [1, 0], [2, 0]]", "encloses no area"),
        ("[[0, 0], [1, 0]]", "must have at least 3 entries"),
        ("{length: 0, width: 1}", "must be greater than 0"),
    ],
)
def test_footprints_are_simple_and_have_an_area(tmp_path, outline, told):
    text = changed(CORRIDOR, (BOX, f"    footprint: {outline}\n{A}"))
    error = only_error(tmp_path, text)
    assert error.startswith("6:")
    assert told in error


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
    assert "lies 2 m outside the footprint" in only_warning(tmp_path, text)


@pytest.mark.parametrize(
    ("pose", "told"),
    [
        ("[6.0, 3.5, 0.0]", '"a" touches the edge of the corridor at the start'),
        ("[6.0, 3.7, 0.0]", '"a" reaches 0.2 m over the edge of the corridor at the start'),
        ("[6.0, 40.0, 0.0]", '"a" starts outside the accessible area, 35.5 m from it'),
        ("[3.0, 0.0, 0.0]", '"b" touches "a" at the start; move them apart'),
        ("[3.0, -0.3, 0.0]", '"b" overlaps "a" by 0.3 m at the start; move them apart'),
    ],
)
def test_robots_start_inside_and_apart_by_more_than_touching(tmp_path, pose, told):
    assert told in only_error(tmp_path, changed(CORRIDOR, ("[6.0, 1.0, 0.0]", pose)))


def test_robots_start_apart_from_obstacles(tmp_path):
    text = CORRIDOR + "obstacles: [[[6.9, 0.9], [8, 0.9], [8, 1.1], [6.9, 1.1]]]\n"
    errors, warnings = lines(check(tmp_path, text))
    assert len(errors) == 1
    assert '"a" touches obstacles[0] at the start; move it away' in errors[0]
    assert 'the path of "a" leads through obstacles[0]' in warnings[0]


def test_starts_are_looked_at_though_no_boundary_can_be_read(tmp_path):
    text = changed(CORRIDOR, ("width: 8.0", "width: wide"), ("[6.0, 1.0", "[3.0, -1.0"))
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 2
    assert "corridor.width must be: [m] full width" in errors[0]
    assert '"b" overlaps "a" by 1 m' in errors[1]


def test_a_heading_in_degrees_is_a_warning_with_its_radians(tmp_path):
    warning = only_warning(tmp_path, changed(CORRIDOR, ("1.0, 0.0]\n    path: {offset: 1.0}",
                                             "1.0, 90]\n    path: {offset: 1.0}")))  # fmt: skip
    assert warning.startswith("7:22 robots[0].pose[2] 90 rad ")
    assert warning.endswith(" 1.5708")  # what to write


def test_a_start_with_the_back_to_the_path_is_a_warning(tmp_path):
    text = changed(CORRIDOR, ("[6.0, 1.0, 0.0]", "[6.0, 1.0, 3.14159]"))
    assert '"a" starts facing 180 degrees away from its path' in only_warning(tmp_path, text)


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
        assert errors or "with another it may touch the edge of the corridor" in warnings[0]


def test_a_path_through_a_wall_is_told_with_the_stretch(tmp_path):
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
    figures = ('"a"', "15.00 m", "(15, 1)", "0.2 m to boundaries[1]", "0.5 m from the reference")
    assert all(figure in error for figure in figures)
    warning = only_warning(tmp_path, text)
    assert all(figure in warning for figure in (*figures, "1 m from the boundaries"))
    shared = changed(text, ("{offset: -1.0}", "[[0, 1], [30, 1]]"), ("[0.0, -3.0]", "[0.0, -4.0]"))
    assert "of its path, shared with 1 more, at (15, 1)" in only_warning(tmp_path, shared)


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
    assert any('"a" does not fit at station' in warning for warning in warnings)
    assert len(errors) == 2
    assert 'no route leads "a" from its start to the end of its path' in errors[0]


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
    assert len([w for w in warnings if "leads through obstacles[0] from 15.00 m" in w]) == 2
    assert [error.split(" ")[1] for error in errors] == (
        [] if is_way else ["robots[0].path", "robots[1].path"]
    )
    if not is_way:
        assert 'no route leads "a" from its start to the end of its path' in errors[0]
        assert "narrower than 1 m" in errors[0]


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


@pytest.mark.parametrize(
    ("spacing", "gap"), [("[0.0, 0.0]", "0 m"), ("[0.0, -1.8]", "1.8 m"), ("[0.0, -1.0]", "1 m")]
)
def test_spacing_is_longer_than_the_footprints(tmp_path, spacing, gap):
    text = changed(CORRIDOR, ("[0.0, -3.0]", spacing), ("offset: -1.0", "offset: 1.0"))
    error = only_error(tmp_path, text)
    column = 12 + len("{spacing: [0.0, ")
    assert error.startswith(f'13:{column} formation.spacing[1] {gap} between "a" and "b" along')
    abreast = changed(CORRIDOR, ("[0.0, -3.0]", spacing))
    assert lines(check(tmp_path, abreast)) == ([], [])


def test_initial_spacing_counts_too(tmp_path):
    text = changed(CORRIDOR, ("[0.0, -3.0]", "initial"), ("offset: -1.0", "offset: 1.0"))
    assert lines(check(tmp_path, text)) == ([], [])
    text = changed(text, ("[3.0, -1.0", "[5.0, -1.0"))
    assert '1 m between "a" and "b"' in only_error(tmp_path, text)


def test_the_reference_path_is_longer_than_the_formation(tmp_path):
    error = only_error(tmp_path, changed(CORRIDOR, ("-3.0]", "-31.0]")))
    assert "the reference path is 30 m long and the formation 31 m" in error
    warning = only_warning(tmp_path, changed(CORRIDOR, ("-3.0]", "-28.0]")))
    assert (
        '"b" starts at station 3.00 m of its path, at or past its stop station, 2.00 m' in warning
    )


def test_robots_start_beside_the_reference_path(tmp_path):
    text = changed(CORRIDOR, ("[3.0, -1.0", "[-1.1, -1.0"))
    assert '"b" starts before the reference path begins' in only_warning(tmp_path, text)
    text = changed(CORRIDOR, ("[3.0, -1.0", "[-1.0, -1.0"))  # within its own radius, 1.03 m
    assert lines(check(tmp_path, text)) == ([], [])


def test_the_reference_path_is_in_order(tmp_path):
    text = changed(DRAWN, ("[[0, 0], [30, 0]]", "[[0, 0], [20, 0], [10, 0.5], [30, 0]]"))
    text = changed(text, ("{offset: -1.0}", "[[0, -1], [30, -1]]"))
    warnings = lines(check(tmp_path, text))[1]
    assert len([w for w in warnings if "reference_path the reference path turns back by" in w]) == 2


def test_a_reference_path_that_crosses_itself_is_a_warning(tmp_path):
    loop = "[[0, 0], [20, 0], [20, 3], [15, 3], [15, -3], [25, -3], [30, 0]]"
    text = changed(DRAWN, ("[[0, 0], [30, 0]]", loop), ("{offset: -1.0}", "[[0, -1], [30, -1]]"))
    warnings = lines(check(tmp_path, text))[1]
    assert any("the reference path crosses or touches itself" in warning for warning in warnings)


def test_a_path_against_the_reference_path_is_a_warning(tmp_path):
    text = changed(DRAWN, ("[[0, 1], [30, 1]]", "[[30, 1], [0, 1]]"))
    warnings = lines(check(tmp_path, text))[1]
    assert any("runs against the reference path, from station 30.00 m back" in w for w in warnings)


def test_a_short_reference_path_is_a_warning(tmp_path):
    text = changed(
        DRAWN, ("reference_path: [[0, 0], [30, 0]]", "reference_path: [[6, 0], [6.9, 0]]")
    )
    text = changed(
        text, ("formation: {spacing: [0.0, -3.0]}\n", ""), ("{offset: -1.0}", "[[0, -1], [30, -1]]")
    )
    assert "the reference path is only 0.9 m long" in only_warning(tmp_path, text)


def test_a_run_too_short_to_finish_is_a_warning(tmp_path):
    text = changed(CORRIDOR, ("duration: 60.0", "duration: 20.0")) + "expect: {finished: true}\n"
    warning = only_warning(tmp_path, text)
    assert warning.startswith("2:30 time.duration the run is too short to finish: ")
    assert lines(check(tmp_path, text.replace("finished: true", "contacts: 0"))) == ([], [])


def test_a_steady_speed_outside_its_limits_is_a_warning(tmp_path):
    text = changed(CORRIDOR, ("{spacing", "{speed: 1.5, spacing"))
    assert only_warning(tmp_path, text).startswith(
        "13:20 formation.speed the steady speed, 1.5 m/s, lies outside the limits, 0.8 to 1.3 m/s"
    )
    slow = changed(CORRIDOR, ("{spacing", "{limits: [1.1, 1.3], spacing"))
    assert "holds every robot at 1.1 m/s" in only_warning(tmp_path, slow)


@pytest.mark.parametrize(
    ("spacing", "bound"),
    [
        ("[0.0, -3.0]", 4.0),  # 0.2 m/s over 1 neighbour x 0.5 m/s x 0.1 s
        ("[0.0, -5.0]", 1.0),  # both 2 m from their places: 0.2 m/s over a tenth of that
        ("initial", 4.0),
    ],
)
@pytest.mark.parametrize("neighbours", ["range", "all", "[[a, b]]"])
def test_a_gain_that_saturates_the_cluster_is_a_warning_with_its_bound(
    tmp_path, spacing, bound, neighbours
):
    def text(gain: float) -> str:
        plan = f"{{gain: {gain}, neighbours: {neighbours}, spacing: {spacing}}}"
        return changed(CORRIDOR, ("{spacing: [0.0, -3.0]}", plan))

    assert lines(check(tmp_path, text(0.99 * bound))) == ([], [])
    warning = only_warning(tmp_path, text(1.01 * bound))
    assert "formation.gain" in warning
    assert f"use at most {bound:.3g} 1/s (0.2 m/s to the nearer limit" in warning


@pytest.mark.parametrize(
    ("width", "where"), [("0.9", "3:50 corridor.width "), ("[8.0, 0.9]", "3:56 corridor.width[1] ")]
)
def test_a_corridor_too_narrow_for_its_robots_is_told_at_its_width(tmp_path, width, where):
    errors, _ = lines(check(tmp_path, changed(CORRIDOR, ("width: 8.0", f"width: {width}"))))
    assert errors[0].startswith(where)
    assert "needs more than 1 m however it is turned, and 1 more do not fit either" in errors[0]
    assert not any("there is no way" in error for error in errors)
    wide, _ = lines(check(tmp_path, changed(CORRIDOR, ("width: 8.0", "width: 1.01"))))
    assert not any("corridor.width" in error for error in wide)


def test_lengths_beyond_their_bounds_may_be_in_millimetres(tmp_path):
    box = (
        "{length: 1.8, width: 1.0}\n    pose: [6.0",
        "{length: 1800, width: 1.0}\n    pose: [6.0",
    )
    error = only_error(tmp_path, changed(CORRIDOR, box))
    assert error.endswith("must be at most 1000; given 1800; in millimetres? Then write 1.8")
    fast = changed(CORRIDOR, ("path: {offset: 1.0}", "path: {offset: 1.0}\n    limits: {v: 1500}"))
    assert "millimetres?" not in only_error(tmp_path, fast)


def test_a_step_that_would_tunnel_is_refused(tmp_path):
    limits = "    limits: {v: 0.1, omega: 0.1}\n    omegas: [-0.1, 0, 0.1]\n    pose: [3.0"
    text = changed(CORRIDOR, ("step: 0.01", "step: 0.1"), ("    pose: [3.0", limits))
    error = only_error(tmp_path, text)
    assert '"a" could move 0.3147 m in one step of 0.1 s' in error
    assert "use a step of at most 0.0794 s" in error
    both = only_error(tmp_path, changed(CORRIDOR, ("step: 0.01", "step: 0.1")))
    assert both.startswith("2:14 time.step ")
    assert "and 1 more" in both


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("{length: 1.8, width: 1.0}\n    pose: [6.0", "{length: 180, width: 100}\n    pose: [6.0"),
         "is 180 m long; lengths are in metres; if millimetres are meant, write 0.18"),
        (("width: 8.0", "width: 8000"), "8000 m is very wide for a corridor"),
        (("width: 8.0", "width: 8000"), "if millimetres are meant, write 8"),
        (("[30, 0]]", "[300000, 0]]"), "it spans 300000 m; lengths are in metres"),
        (("duration: 60.0", "duration: 330000"), "330000 s is 91.67 hours"),
        (("path: {offset: 1.0}", "path: {offset: 1.0}\n    limits: {v: 1500}"), ""),
    ],
)  # fmt: skip
def test_numbers_out_of_scale_are_told(tmp_path, change, told):
    errors, warnings = lines(check(tmp_path, changed(CORRIDOR, change)))
    if told:
        assert any(told in warning for warning in warnings), warnings
    else:
        assert errors


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("limits: {v: 60.0}", "60 m/s is very fast; speeds are in metres per second"),
        ("limits: {omega: 90.0}", "if degrees per second are meant, write 1.5708"),
        ("speeds: [-0.5]", "no speed above 0: there is no way forward"),
        ("omegas: [-1.0, 1.0]", "0 is not among them: there is no way straight on"),
        ("omegas: [0.0, 1.0]", "only turns to the left; give turns to both sides"),
    ],
)
def test_speeds_that_are_seldom_meant_are_told(tmp_path, given, told):
    text = changed(CORRIDOR, ("path: {offset: 1.0}", f"path: {{offset: 1.0}}\n    {given}"))
    text = changed(text, ("step: 0.01", "step: 0.002"))
    assert told in only_warning(tmp_path, text)


def test_speeds_are_multiples_of_nu(tmp_path):
    given = "path: {offset: 1.0}\n    speeds: [0, 1.2]"
    error = only_error(tmp_path, changed(CORRIDOR, ("path: {offset: 1.0}", given)))
    assert "speeds[1] must be at most 1; given 1.2" in error


def test_an_offset_path_that_folds_in_a_bend_is_a_warning(tmp_path):
    bend = "[[0, 0], [20, 0], [21, 0.5], [21.5, 1.5], [21.5, 20]]"
    text = changed(CORRIDOR, ("[[0, 0], [30, 0]]", bend), ("offset: 1.0", "offset: 2.5"))
    warnings = lines(check(tmp_path, text))[1]
    assert any('2.5 m to the side, the path of "a" runs backwards near' in w for w in warnings)


@pytest.mark.parametrize(("least", "warned"), [("50", True), ("0.05", False)])
def test_a_least_distance_that_the_start_breaks_is_a_warning(tmp_path, least, warned):
    text = CORRIDOR + f"expect: {{min_distance: {least}}}\n"
    errors, warnings = lines(check(tmp_path, text))
    assert errors == []
    told = [line for line in warnings if "expect.min_distance" in line]
    assert len(told) == warned
    assert all(
        '"a" and "b" are 1.562 m apart at the start, which is less than 50 m' in one for one in told
    )


@pytest.mark.parametrize(("step", "warned"), [("1.0e-6", True), ("0.01", False)])
def test_a_run_of_very_many_steps_is_a_warning(tmp_path, step, warned):
    text = changed(CORRIDOR, ("step: 0.01, duration: 60.0", f"step: {step}, duration: 40.0"))
    errors, warnings = lines(check(tmp_path, text))
    assert errors == []
    assert any("40,000,000 steps" in line and "time.step" in line for line in warnings) == warned


def test_a_robot_slower_than_the_formation_cannot_keep_up(tmp_path):
    slow = ("path: {offset: -1.0}", "path: {offset: -1.0}\n    limits: {v: 0.5}")
    _, warnings = lines(check(tmp_path, changed(CORRIDOR, slow)))
    assert warnings == [
        '13:17 robots[1].limits.v "b" drives at most 0.5 m/s and cannot keep up: by '
        "formation.limits the others drive at least 0.8 m/s; raise this limit, or lower the least "
        "speed of the formation"
    ]
    fast = (slow[0], slow[1].replace("0.5", "0.8"))
    assert lines(check(tmp_path, changed(CORRIDOR, fast))) == ([], [])


def test_the_time_to_finish_is_counted_at_the_limit_of_the_robot(tmp_path):
    slow = ("path: {offset: -1.0}", "path: {offset: -1.0}\n    limits: {v: 0.5}")
    text = changed(CORRIDOR, slow, ("duration: 60.0", "duration: 40.0"))
    _, warnings = lines(check(tmp_path, text + "expect: {finished: true}\n"))
    assert len(warnings) == 2
    assert '"b" has 24 m to go, 48 s at 0.5 m/s, and the run lasts 40 s' in warnings[0]
