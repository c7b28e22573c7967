"""Robots that the seed places in a region."""

from __future__ import annotations

import pytest

from physim import build_scene
from tests.world.worlds import REGION, changed, check, check_finding, lines, with_facts


def test_a_region_with_room_has_no_finding(tmp_path):
    found = check(tmp_path, REGION)
    assert lines(found) == ([], [])
    assert found.world is not None
    build_scene(found.world)


def test_a_region_without_room_is_reported_as_a_run_reports_it(tmp_path):
    small = changed(REGION, ("[12, -3.5], [12, 3.5]", "[2, -3.5], [2, 3.5]"), ("-3.5]", "-0.8]"))
    errors, _ = lines(check(tmp_path, changed(small, (" 3.5]", " 0.8]"))))
    assert len(errors) == 1
    free = ("1 of 2 robots", "0.4 m", '"b"', "3.2 m²", "6.09 m²", "16 m²")
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


def test_other_faults_are_reported_beside_a_region(tmp_path):
    text = changed(REGION, ("name: b", "nam: b"), ("width: 8.0", "width: 2.5"))
    errors, warnings = lines(check(tmp_path, text))
    assert len(errors) == 1
    check_finding(errors[0], "8:6 robots[1].nam", "unknown key", '"name"')
    assert with_facts(warnings, "7:68 robots[0].path.offset", '"a"', "not fit", "0.25 m", "0.5 m")


def test_a_formation_that_overlaps_as_the_seed_placed_it_points_to_the_start(tmp_path):
    text = changed(REGION, ("offset: -1.0", "offset: 1.0")) + "formation: {}\n"
    for seed in range(40):  # one that places them side by side
        errors, _ = lines(check(tmp_path, changed(text, ("seed: 3", f"seed: {seed}"))))
        if errors:
            break
    assert len(errors) == 1
    parts = ('"a"', '"b"', "overlap", "initial", "seed", "min_gap", "abreast", "formation.spacing")
    check_finding(errors[0], "9:12 formation", *parts)


@pytest.mark.parametrize("length", [12, 28])
def test_robots_abreast_are_told_the_width_that_they_need(tmp_path, length):
    """No region along a road 8 m wide is enough for them, however long it is."""
    text = changed(REGION, ("min_gap: 0.4", "min_gap: 2.5, abreast: 3, heading: along"))
    text = changed(text, ("[12, -3.5], [12, 3.5]", f"[{length}, -3.5], [{length}, 3.5]"))
    text += "  - {name: c, footprint: {length: 1.8, width: 1.0}, path: {offset: 0.0}}\n"
    errors, _ = lines(check(tmp_path, text))
    assert len(errors) == 1
    parts = (
        "3 abreast",
        "need 8 m across",
        "13 m from wall to wall",
        "3 m of it",
        "2.5 m from all",
    )
    check_finding(errors[0], "5:17 start.region", *parts)
    assert "are enough" not in errors[0]
