"""Edits of `physim.metrics`."""

from __future__ import annotations

from tests.sabotage.edit import Edit

EDITS = (
    Edit(
        "metrics",
        "physim/metrics/contacts.py",
        "contact_episodes",
        'np.diff(rows["step"]) > 1',
        'np.diff(rows["step"]) > 2',
        "an episode is a maximal run: one sample apart ends it",
        "tests/metrics/test_figures.py::test_episodes_are_maximal_runs",
    ),
    Edit(
        "metrics",
        "physim/metrics/contacts.py",
        "_episode",
        'float(run["impulse"][0])',
        'float(run["impulse"].max())',
        "the impact is the impulse of the first sample",
        "tests/metrics/test_figures.py::test_contact_episodes",
    ),
    Edit(
        "metrics",
        "physim/metrics/deep.py",
        "deep_contacts",
        "max(DEEP, float(advance[[i for i in (a, b) if i < record.robots]].sum()))",
        "DEEP",
        "an impact may be as deep as the two move in a step",
        "tests/metrics/test_deep.py::test_an_impact_may_be_as_deep_as_the_two_move_in_a_step",
    ),
    Edit(
        "metrics",
        "physim/metrics/way.py",
        "under_way",
        'np.minimum(rows["next_step"], record.steps_run)',
        'rows["next_step"]',
        "a decision weighs as long as it held within the run",
        "tests/metrics/test_figures.py::test_danger_share_by_decisions_and_by_time",
    ),
    Edit(
        "metrics",
        "physim/metrics/way.py",
        "under_way",
<<<<<<< HEAD
        "rows = rows[~_there(record, rows)]",
        "pass",
        "a robot that has arrived is not under way",
=======
        "rows[~_there(record, rows)]",
        "rows",
        "a robot at its stop station is not under way",
>>>>>>> w-pictures
        "tests/metrics/test_figures.py::test_danger_share_by_decisions_and_by_time",
    ),
    Edit(
        "metrics",
        "physim/metrics/way.py",
<<<<<<< HEAD
=======
        "finished",
        "(arrival_steps(record) >= 0).all()",
        "(arrival_steps(record) >= 0).any()",
        "a run is finished when all have arrived",
        "tests/metrics/test_figures.py::test_finished_means_that_all_have_arrived_by_their_motion",
    ),
    Edit(
        "metrics",
        "physim/metrics/way.py",
>>>>>>> w-pictures
        "time_to_finish",
        "arrival_steps(record).max()",
        "arrival_steps(record).min()",
        "the time to finish is that of the last robot",
        "tests/metrics/test_figures.py::test_finished_means_that_all_have_arrived_by_their_motion",
    ),
    Edit(
        "metrics",
        "physim/metrics/formation.py",
        "formation_energy",
        "0.5 * (errors * near).sum()",
        "(errors * near).sum()",
        "W is half the sum over all pairs (9)",
        "tests/metrics/test_formation.py::test_energy_is_that_of_the_controller",
    ),
    Edit(
        "metrics",
        "physim/metrics/formation.py",
        "formation_energy",
        "np.abs(s[:, None] - s) <= reach if pairs is None else pairs",
        "1.0 if pairs is None else pairs",
        "neighbours are those within range along s*",
        "tests/metrics/test_formation.py::test_energy_is_that_of_the_controller",
    ),
    Edit(
        "metrics",
        "physim/metrics/formation.py",
        "desired_leads",
        'rows["formation_error"] + station - station.mean()',
        'station - station.mean() - rows["formation_error"]',
        "a formation error is positive for a robot behind its place",
        "tests/metrics/test_formation.py::test_desired_leads_come_from_the_first_step",
    ),
    Edit(
        "metrics",
        "physim/metrics/motion.py",
        "deviation_peak",
        'Moment(float(row["deviation"])',
        'Moment(abs(float(row["deviation"]))',
        "the greatest deviation keeps its sign",
        "tests/metrics/test_courses.py::test_deviations_and_their_root_mean_square",
    ),
    Edit(
        "metrics",
        "physim/metrics/motion.py",
<<<<<<< HEAD
=======
        "averaged_speeds",
        "min(ends_of_way[i], end)",
        "end",
        "a window of averaged speeds lies wholly under way",
        "tests/metrics/test_courses.py::"
        "test_a_window_reaches_neither_beyond_the_run_nor_beyond_arrival",
    ),
    Edit(
        "metrics",
        "physim/metrics/motion.py",
>>>>>>> w-pictures
        "_forward",
        "chord / np.sinc(half / np.pi)",
        "chord",
        "the way on an arc is its length, not its chord",
        "tests/metrics/test_courses.py::test_averaged_speeds_of_arcs_are_their_own",
    ),
    Edit(
        "metrics",
        "physim/metrics/modes.py",
        "mode_switches",
        "np.diff(is_danger(record, mine))",
        'np.diff(mine["mode"])',
        "a change between the two kinds of danger is no switch",
        "tests/metrics/test_courses.py::test_modes_fill_the_run_and_switches_are_counted",
    ),
    Edit(
        "metrics",
        "physim/metrics/distances.py",
        "shortest_collision_time",
        "np.where(np.isnan(times), np.inf, times)",
        "np.where(np.isnan(times), 0.0, times)",
        "a decision that looked at no collision time counts for none",
        "tests/metrics/test_figures.py::test_shortest_collision_time_is_over_all_decisions",
    ),
    Edit(
        "metrics",
        "physim/metrics/pair_times.py",
        "_commands",
<<<<<<< HEAD
        'record.commands_over("applied", first, last)[steps[mine] - first]',
        'record.commands_over("applied", first + 1, last + 1)[steps[mine] - first]',
        "the pairs keep the commands given at that very step",
=======
        "steps[mine] - first",
        "np.maximum(steps[mine] - first - 1, 0)",
        "the pairs keep the commands applied at that very step",
>>>>>>> w-pictures
        "tests/metrics/test_pair_times.py::test_commands_are_those_given_at_that_step",
    ),
    Edit(
        "metrics",
        "physim/metrics/pair_times.py",
        "_reach",
        "* horizon + radius",
        "+ radius",
        "no pair that may meet within the horizon is left out",
        "tests/metrics/test_pair_times.py::test_least_over_all_pairs",
    ),
    Edit(
        "metrics",
        "physim/metrics/width.py",
        "corridor_width",
        "counts = ~np.isfinite(width) | between",
        "counts = np.ones_like(width, dtype=bool)",
        "there is a width only between two sides (Fig. 4)",
        "tests/metrics/test_courses.py::test_a_wall_across_the_path_has_no_width",
    ),
    Edit(
        "metrics",
        "physim/metrics/effort.py",
        "messages",
        '.updates["considered"].sum()',
        '.updates["considered"].astype(bool).sum()',
        "every considered robot is a message (14)",
        "tests/metrics/test_figures.py::test_messages_and_evaluations",
    ),
)
