"""Robots that the seed places in a region."""

from __future__ import annotations

from physim.scene_builder import build_scene
from tests.checking.worlds import REGION, changed, check, lines


def test_a_region_with_room_has_no_finding(tmp_path):
    found = check(tmp_path, REGION)
    assert lines(found) == ([], [])
    assert found.world is not None
    build_scene(found.world)


def test_a_region_without_room_is_told_as_a_run_tells_it(tmp_path):
    small = changed(REGION, ("[12, -3.5], [12, 3.5]", "[2, -3.5], [2, 3.5]"), ("-3.5]", "-0.8]"))
    errors, _ = lines(check(tmp_path, changed(small, (" 3.5]", " 0.8]"))))
    assert len(errors) == 1
    assert errors[0].startswith("5:17 start.region ")


def test_a_region_that_crosses_itself_is_told(tmp_path):
    text = changed(REGION, ("[12, -3.5], [12, 3.5]", "[12, 3.5], [12, -3.5]"))
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 1
    assert errors[0].startswith("5:17 start.region crosses or touches itself at (6, 0)")


def test_a_region_outside_the_road_is_told(tmp_path):
    text = changed(REGION, ("3.5]", "93.5]"), ("-93.5]", "91.5]"))
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 1
    assert "none of it lies in the accessible area" in errors[0]


def test_other_faults_are_told_beside_a_region(tmp_path):
    text = changed(REGION, ("name: b", "nam: b"), ("width: 8.0", "width: 2.5"))
    errors, warnings = lines(check(tmp_path, text))
    assert [error[:28] for error in errors] == ["8:6 robots[1].nam unknown ke"]
    assert '"a" does not fit at station' in " ".join(warnings)


def test_a_region_that_no_robot_uses_is_a_warning(tmp_path):
    posed = changed(REGION, ("name: a,", "name: a, pose: [6, 1, 0],"))
    assert lines(check(tmp_path, posed)) == ([], [])
    posed = changed(posed, ("name: b,", "name: b, pose: [2, -1, 0],"))
    errors, warnings = lines(check(tmp_path, posed))
    assert errors == []
    assert len(warnings) == 1
    assert "start no robot starts in this region" in warnings[0]
