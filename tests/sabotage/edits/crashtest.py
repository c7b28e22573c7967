"""Edits of `physim.analysis.crashtest`."""

from __future__ import annotations

from tests.sabotage.edit import Edit

EDITS = (
    Edit(
        "crashtest",
        "physim/analysis/crashtest/report.py",
        "classify",
        "if physical != (first := first_sample(distance)):",
        "if False and physical != (first := first_sample(distance)):",
        "an engine's contact elsewhere than the shapes' is unexplained",
        "tests/crashtest/test_verdict.py::test_verdicts",
    ),
    Edit(
        "crashtest",
        "physim/analysis/crashtest/report.py",
        "classify",
        "xi < np.inf and not gap <= CONTACT + ROUNDING",
        "False",
        "a collision time at which nothing touches is false",
        "tests/crashtest/test_verdict.py::test_a_collision_time_at_which_nothing_touches_is_false",
    ),
    Edit(
        "crashtest",
        "physim/analysis/crashtest/report.py",
        "classify",
        "* dt < xi - TIME",
        "* dt < xi - dt",
        "a collision time is not late",
        "tests/crashtest/test_experiment.py::test_engine_and_analysis_agree",
    ),
    Edit(
        "crashtest",
        "physim/analysis/crashtest/report.py",
        "classify",
        "abs(distance[at] - CONTACT) > ROUNDING",
        "abs(distance[at] - CONTACT) > 100 * ROUNDING",
        "rounding excuses a sample only about the contact tolerance",
        "tests/crashtest/test_verdict.py::"
        "test_rounding_excuses_a_sample_only_about_the_contact_tolerance",
    ),
    Edit(
        "crashtest",
        "physim/analysis/crashtest/prediction.py",
        "point_speed",
        "vx = v * math.cos(pose[2]) - omega * (y - pose[1])",
        "vx = v * math.cos(pose[2])",
        "a point of a turning robot moves with it",
        "tests/crashtest/test_prediction.py::test_the_speed_of_a_point_is_that_of_its_arc",
    ),
    Edit(
        "crashtest",
        "physim/analysis/crashtest/prediction.py",
        "swept_step",
        "(step + 1) * case.dt",
        "step * case.dt",
        "the swept check looks at the whole step",
        "tests/crashtest/test_experiment.py::test_swept_contacts_are_where_the_collision_time_says",
    ),
    Edit(
        "crashtest",
        "physim/analysis/crashtest/experiment.py",
        "_batches",
        "draw_case(seed, k, place_of(k % BLOCK), store)",
        "draw_case(0, k, place_of(k % BLOCK), store)",
        "another seed draws other cases",
        "tests/crashtest/test_experiment.py::test_without_the_guard_the_engines_false_contacts_are_reported",
    ),
    Edit(
        "crashtest",
        "physim/analysis/crashtest/experiment.py",
        "_compare",
        "if folder is not None:",
        "if False:",
        "an unexplained case becomes a world",
        "tests/crashtest/test_experiment.py::"
        "test_every_unexplained_case_becomes_a_world_that_replays",
    ),
    Edit(
        "crashtest",
        "physim/analysis/crashtest/case.py",
        "footprint",
        "smallest_width(parts)",
        "10.0 * smallest_width(parts)",
        "cases keep the tunnelling rule",
        "tests/crashtest/test_experiment.py::"
        "test_cases_are_clear_at_the_start_and_keep_the_tunnelling_rule",
    ),
)
