"""Rooms in which a robot would be in danger mode for good."""

from __future__ import annotations

import pytest

from tests.checking.worlds import CORRIDOR, changed, check, check_finding, lines


def test_a_threshold_beyond_the_room_beside_the_path_is_told(tmp_path):
    _, warnings = lines(check(tmp_path, CORRIDOR + "controller: {boundary_low: 3.5}\n"))
    assert len(warnings) == 1
    figures = ("below 3.5 m", '"a"', "at most 2.5 m", "1 other robot", "danger mode")
    check_finding(warnings[0], "14:28 controller.boundary_low", *figures)


def test_a_threshold_within_the_room_is_not_told(tmp_path):
    text = changed(CORRIDOR, ("width: 8.0", "width: 8.0, end_margin: 4.0"))
    assert lines(check(tmp_path, text + "controller: {boundary_low: 2.4}\n")) == ([], [])


def test_room_counts_from_the_safe_distance_where_the_path_lies_along_a_wall(tmp_path):
    text = changed(
        CORRIDOR, ("{offset: 1.0}", "{offset: 3.4}"), ("{offset: -1.0}", "{offset: -3.4}")
    )
    assert lines(check(tmp_path, text)) == ([], [])


@pytest.mark.parametrize(("width", "warned"), [(3.2, True), (4.2, False), (8.0, False)])
def test_a_path_all_in_danger_without_room_to_turn_is_told(tmp_path, width, warned):
    side = width / 2.0 - 0.6
    text = changed(CORRIDOR, ("width: 8.0", f"width: {width}"))
    text = changed(text, ("offset: 1.0", f"offset: {side:.3f}"), ("-1.0}", f"-{side:.3f}}}"))
    _, warnings = lines(check(tmp_path, text))
    assert [" ".join(warning.split()[:2]) for warning in warnings] == (
        ["8:20 robots[0].path.offset"] if warned else []
    )
    if warned:
        figures = ('"a"', "1 more robot", "danger area", "less than 1 m", "1.6 m", "1.03 m")
        check_finding(warnings[0], "8:20 robots[0].path.offset", *figures)
