"""Edits of `physim.controllers.world_checks`."""

from __future__ import annotations

from tests.sabotage.edit import Edit

EDITS = (
    Edit(
        "controllers",
        "controllers/world_checks.py",
        "omega_faults",
        "using = {i: robot for i, robot in robots.items() if robot.omegas is None}",
        "using = dict(robots)",
        "robots with speeds of their own are refused, too",
        "tests/controllers/test_limits.py::test_where_faults_are_told",
    ),
    Edit(
        "controllers",
        "controllers/world_checks.py",
        "_beyond",
        "slowest = min(slow, key=lambda robot: robot.limits.omega)",
        "slowest = slow[-1]",
        "not the slowest robot is named",
        "tests/controllers/test_limits.py::test_the_slowest_robot_is_named",
    ),
    Edit(
        "controllers",
        "controllers/world_checks.py",
        "omega_faults",
        "if fastest > robot.limits.omega",
        "if fastest >= robot.limits.omega",
        "a limit that just allows the speeds is refused",
        "tests/controllers/test_limits.py::test_where_faults_are_told",
    ),
    Edit(
        "controllers",
        "controllers/world_checks.py",
        "speed_faults",
        "if world.formation is None or",
        "if True or",
        "a speed beside a formation is a fault",
        "tests/controllers/test_world_checks.py::test_a_speed_beside_a_formation_is_one_fault",
    ),
    Edit(
        "controllers",
        "controllers/world_checks.py",
        "speed_doubts",
        "if of.speed <= fastest:",
        "if of.speed > 0.0:",
        "a speed beyond the limits of all robots is doubted",
        "tests/controllers/test_world_checks.py::test_a_speed_that_no_robot_reaches_is_doubted",
    ),
    Edit(
        "controllers",
        "controllers/world_checks.py",
        "stop_doubts",
        "if allowed >= short:",
        "if True:",
        "stops short of arrival are doubted",
        "tests/controllers/test_world_checks.py::test_stops_short_of_arrival_are_doubted_and_can_happen",
    ),
    Edit(
        "controllers",
        "controllers/world_checks.py",
        "range_doubts",
        "if world.sensing.range is None and world.formation is not None:",
        "if False:",
        "the range that is too short is named",
        "tests/controllers/test_world_checks.py::test_the_range_of_a_formation_counts_where_there_is_no_other",
    ),
    Edit(
        "controllers",
        "controllers/world_checks.py",
        "_needs",
        "sum(reaches[-2:])",
        "max(reaches)",
        "robots that drive at each other see it in time",
        "tests/controllers/test_world_checks.py::test_a_range_is_doubted_where_thresholds_cannot_be_kept",
    ),
    Edit(
        "controllers",
        "controllers/world_checks.py",
        "speed_doubts",
        "of.speed < bounds[0] <= fastest",
        "False",
        "a speed below those of (7) is doubted",
        "tests/controllers/test_world_checks.py::test_a_speed_that_no_robot_reaches_is_doubted",
    ),
)
