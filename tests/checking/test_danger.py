"""Rooms in which a robot would be in danger mode for good."""

from __future__ import annotations

import pytest

from tests.checking.worlds import CORRIDOR, changed, check, lines


def test_a_threshold_beyond_the_room_beside_the_path_is_told(tmp_path):
    _, warnings = lines(check(tmp_path, CORRIDOR + "controller: {boundary_low: 3.5}\n"))
    assert warnings == [
        "14:28 controller.boundary_low below 3.5 m from a boundary a robot is in danger mode, and "
        '"a" has at most 2.5 m beside it on its path, 1 other robot no more: it would not '
        "leave danger mode and may never arrive; set boundary_low below that, or widen the road"
    ]


def test_a_threshold_within_the_room_is_not_told(tmp_path):
    assert lines(check(tmp_path, CORRIDOR + "controller: {boundary_low: 2.4}\n")) == ([], [])


def test_room_counts_from_the_safe_distance_where_the_path_lies_along_a_wall(tmp_path):
    text = changed(
        CORRIDOR, ("{offset: 1.0}", "{offset: 3.4}"), ("{offset: -1.0}", "{offset: -3.4}")
    )
    assert lines(check(tmp_path, text)) == ([], [])


@pytest.mark.parametrize(("width", "told"), [(3.2, True), (4.2, False), (8.0, False)])
def test_a_path_all_in_danger_without_room_to_turn_is_told(tmp_path, width, told):
    side = width / 2.0 - 0.6
    text = changed(CORRIDOR, ("width: 8.0", f"width: {width}"))
    text = changed(text, ("offset: 1.0", f"offset: {side:.3f}"), ("-1.0}", f"-{side:.3f}}}"))
    _, warnings = lines(check(tmp_path, text))
    assert [warning.split(" the path")[0] for warning in warnings] == (
        ["8:20 robots[0].path.offset"] if told else []
    )
    if told:
        assert 'the path of "a" (of 1 more robot too) lies in the danger area' in warnings[0]
        assert "no place is more than 1.6 m from the walls, too little to turn" in warnings[0]
