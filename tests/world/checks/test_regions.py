"""Robots that the seed places in a region."""

from __future__ import annotations

from physim import build_scene
from tests.world.worlds import REGION, changed, check, check_finding, lines


def test_a_region_with_room_has_no_finding(tmp_path):
    found = check(tmp_path, REGION)
    assert lines(found) == ([], [])
    assert found.layout is not None
    build_scene(found.layout.world)


def test_a_region_without_room_is_reported_as_a_run_reports_it(tmp_path):
    small = changed(REGION, ("[12, -3.5], [12, 3.5]", "[2, -3.5], [2, 3.5]"), ("-3.5]", "-0.8]"))
    errors, _ = lines(check(tmp_path, changed(small, (" 3.5]", " 0.8]"))))
    assert len(errors) == 1
    free = ("1 of 2 robots", "0.4 m", '"b"', "3.2 m²", "6.09 m²")
    check_finding(errors[0], "5:17 start.region", *free)


def test_a_region_that_crosses_itself_is_reported(tmp_path):
    text = changed(REGION, ("[12, -3.5], [12, 3.5]", "[12, 3.5], [12, -3.5]"))
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 1
    check_finding(errors[0], "5:17 start.region", "itself", "(6, 0)")


def test_a_region_outside_the_road_is_reported(tmp_path):
    text = changed(REGION, ("3.5]", "93.5]"), ("-93.5]", "91.5]"))
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 1
    check_finding(errors[0], "5:17 start.region", "none", "accessible area")
