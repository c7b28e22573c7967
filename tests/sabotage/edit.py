"""What an edit that breaks something on purpose is, and the rooms that such edits belong to."""

from __future__ import annotations

from types import MappingProxyType
from typing import NamedTuple


class Edit(NamedTuple):
    """One rule of the sources, broken: a fragment of a function, and what takes its place."""

    room: str
    """whose own tests must notice: a key of `ROOMS`"""
    file: str
    """where the function stood when this was written: a hint for readers, not looked at"""
    function: str
    """qualified name of the function, or of the class or constant, that holds the fragment"""
    old: str
    """fragment; it is found whatever blanks and line breaks stand between its words"""
    new: str
    """what takes its place"""
    breaks: str
    """the rule that no longer holds, in a few words"""
    notices: str
    """``file::function`` of a test of the room that turns red; it is run first"""


ROOMS = MappingProxyType(
    {
        "basics": (
            "tests/test_compiled.py",
            "tests/test_errors.py",
            "tests/test_escaping.py",
            "tests/test_frontend.py",
            "tests/test_randomness.py",
            "tests/test_stray_settings.py",
        ),
        "geometry": ("tests/geometry",),
        "statistics": ("tests/statistics",),
        "world": ("tests/world", "tests/test_world_schema.py"),
        "world_file": ("tests/world_file",),
        "scene": (
            "tests/test_start_poses.py",
            "tests/test_scene_builder.py",
            "tests/world/test_group.py",
        ),
        "checking": ("tests/checking",),
        "physics": ("tests/physics",),
        "controllers": ("tests/controllers", "tests/test_controllers_contract.py"),
        "loop": (
            "tests/test_decision_checks.py",
            "tests/test_simulation.py",
            "tests/test_evil_controllers.py",
            "tests/test_arrival.py",
            "tests/test_state.py",
            "tests/test_stages.py",
            "tests/test_refused_by_geometry.py",
            "tests/test_stage_errors.py",
            "tests/test_control_loop.py",
            "tests/test_observations.py",
            "tests/test_perception.py",
            "tests/test_recording.py",
            "tests/test_size.py",
            "tests/test_grazes.py",
            "tests/test_given.py",
            "tests/test_class_faults.py",
        ),
        "work": ("tests/test_work.py",),
        "record": (
            "tests/test_drafts.py",
            "tests/record",
        ),
        "metrics": ("tests/metrics",),
        "summary": ("tests/test_summary.py", "tests/test_walls_named.py"),
        "validation": ("tests/validation",),
        "video": ("tests/video",),
        "page": ("tests/page",),
        "plots": ("tests/plots",),
        "preview": ("tests/preview", "tests/test_scene_model.py"),
        "importing": ("tests/importing",),
        "templates": ("tests/templates",),
        "crashtest": ("tests/crashtest",),
        "campaigns": ("tests/campaigns",),
        "falsify": ("tests/falsify",),
        "reports": (
            "tests/campaigns/test_compare.py",
            "tests/campaigns/test_outcomes.py",
            "tests/campaigns/test_reading.py",
            "tests/campaigns/test_report.py",
            "tests/campaigns/test_until.py",
            "tests/cli/test_report.py",
        ),
        "reproduction": ("tests/reproduction",),
        "cli": ("tests/cli",),
    }
)
"""The tests of each room: files and folders."""
