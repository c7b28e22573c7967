"""Edits of `physim.drawing.preview`."""

from __future__ import annotations

from tests.sabotage.edit import Edit

EDITS = (
    Edit(
        "preview",
        "physim/drawing/split_line.py",
        "_cut",
        "ends[back, ::-1]",
        "ends[back]",
        "parts of a path go as the path goes",
        "tests/test_scene_model.py::test_parts_go_as_the_line_goes_whatever_way_shapely_gives_them",
    ),
    Edit(
        "preview",
        "physim/drawing/split_line.py",
        "_cut",
        "(far.min(axis=1), which)",
        "(-far.min(axis=1), which)",
        "parts of a path stand in its order",
        "tests/test_scene_model.py::test_a_line_is_cut_as_shapely_cuts_it_as_a_whole",
    ),
    Edit(
        "preview",
        "physim/drawing/scene_model.py",
        "_stop_stations",
        "ends - (lead.max() - lead)",
        "ends",
        "stops are staggered as the formation is",
        "tests/preview/test_contents.py::test_starts_and_stops_are_those_of_the_run",
    ),
    Edit(
        "preview",
        "physim/drawing/scene_model.py",
        "SceneModel._nearly_safe",
        "self.safe_area.buffer(HAIR * self.safe_distance)",
        "self.safe_area.buffer(-HAIR * self.safe_distance)",
        "a path along the very edge of the safe area is safe",
        "tests/preview/test_contents.py::test_a_path_along_the_edge_of_the_safe_area_is_safe",
    ),
    Edit(
        "preview",
        "physim/drawing/preview/contents.py",
        "contents",
        "np.concatenate((others, rings))",
        "others",
        "obstacles narrow the width",
        "tests/preview/test_contents.py::"
        "test_obstacles_narrow_the_width_and_boundaries_alone_are_kept",
    ),
    Edit(
        "preview",
        "physim/drawing/preview/profile.py",
        "_levels",
        "max(least_width(outline) for",
        "max(2.0 * float(np.hypot(*outline.T).max()) for",
        "a robot that is aligned needs its least width",
        "tests/preview/test_picture.py::test_everything_is_at_its_place",
    ),
    Edit(
        "preview",
        "physim/drawing/preview/profile.py",
        "_levels",
        "2.0 * float(preview.scene.reach.max())",
        "float(preview.scene.reach.max())",
        "a robot that turns needs twice its reach",
        "tests/preview/test_picture.py::test_everything_is_at_its_place",
    ),
    Edit(
        "preview",
        "physim/drawing/preview/profile.py",
        "draw_profile",
        "width < needed",
        "width > needed",
        "the profile shows danger where the corridor is narrower than 2 L",
        "tests/preview/test_picture.py::test_danger_is_shown_where_the_corridor_is_narrow",
    ),
    Edit(
        "preview",
        "physim/drawing/preview/contents.py",
        "contents",
        "course = corners_of_line(scene.paths[0])",
        "course = reference",
        "a preview and a run have one width, along the first robot's path",
        "tests/preview/test_contents.py::test_a_preview_and_a_run_have_one_width",
    ),
    Edit(
        "preview",
        "physim/drawing/scene_model.py",
        "region",
        "shapely.symmetric_difference(",
        "shapely.union(",
        "an area within rings is that of the even-odd rule",
        "tests/test_scene_model.py::test_a_region_is_that_of_rings_taken_one_after_the_other",
    ),
)
