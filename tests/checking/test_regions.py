"""Robots that the seed places in a region."""

from __future__ import annotations

from physim.world.layout.scene_builder import build_scene
from tests.checking.worlds import CORRIDOR, REGION, changed, check, lines


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


def test_a_formation_that_overlaps_as_the_seed_placed_it_points_to_the_start(tmp_path):
    text = changed(REGION, ("offset: -1.0", "offset: 1.0")) + "formation: {}\n"
    for seed in range(40):  # one that places them side by side
        errors, _ = lines(check(tmp_path, changed(text, ("seed: 3", f"seed: {seed}"))))
        if errors:
            break
    assert len(errors) == 1
    assert "would overlap in formation; spacing is initial, and the seed places them" in errors[0]
    assert "another seed, a larger min_gap or another abreast in start" in errors[0]
    assert errors[0].endswith("or list the leads in formation.spacing")


def test_a_formation_of_poses_that_overlaps_points_to_the_poses(tmp_path):
    text = changed(CORRIDOR, ("{spacing: [0.0, -3.0]}", "{}"), ("[3.0, -1.0, 0.0]", "[6, -1, 0]"))
    errors, _ = lines(check(tmp_path, changed(text, ("offset: -1.0", "offset: 1.0"))))
    assert len(errors) == 1
    assert (
        "spacing is initial, so they start this close along the road; move their poses" in errors[0]
    )
