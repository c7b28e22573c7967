"""Edits of `physim.plots`."""

from __future__ import annotations

from tests.sabotage.edit import Edit

EDITS = (
    Edit(
        "plots",
        "physim/plots/modes.py",
        "_shares",
        "share_of_modes(record, danger=False)",
        "share_of_modes(record, danger=True)",
        "the share beside a row is that of safe mode",
        "tests/plots/test_figures.py::test_modes_tell_each_share",
    ),
    Edit(
        "plots",
        "physim/plots/modes.py",
        "modes",
        'told = f"out of danger: {1.0 - share:.1%}',
        'told = f"out of danger: {share:.1%}',
<<<<<<< HEAD
        "the share of all robots is that of safe mode",
=======
        "the share of all robots is that of time out of danger",
>>>>>>> w-pictures
        "tests/plots/test_figures.py::test_modes_tell_each_share",
    ),
    Edit(
        "plots",
        "physim/plots/deviation.py",
        "deviation",
        "mark(axis, peak.time, peak.value, text,",
        "mark(axis, peak.time, abs(peak.value), text,",
        "the peak of the deviation is marked on its side",
        "tests/plots/test_figures.py::test_the_peak_of_a_deviation_is_marked_on_its_side",
    ),
    Edit(
        "plots",
        "physim/plots/deviation.py",
        "sharp_turns",
        "abs((b - a + np.pi) % (2 * np.pi) - np.pi) > SHARP",
        "abs(b - a) > SHARP",
        "a turn is counted the short way round",
        "tests/plots/test_figures.py::test_sharp_turns_of_a_path",
    ),
    Edit(
        "plots",
        "physim/plots/width.py",
        "width",
        "[width_extreme(found, 0, largest) for largest in (False, True)]",
        "[width_extreme(found, 0, largest) for largest in (True, False)]",
        "least is least",
        "tests/plots/test_figures.py::test_width_marks_the_narrowest_and_the_widest_place",
    ),
    Edit(
        "plots",
        "physim/plots/distances.py",
        "thinned",
        "a + int(np.argmin(values[a:b]))",
        "a",
        "no dip is lost where a curve is thinned",
        "tests/plots/test_plots.py::test_no_dip_is_lost_where_a_curve_is_thinned",
    ),
    Edit(
        "plots",
        "physim/plots/distances.py",
        "_least",
        "(record.clearance, INK,",
        "(record.boundary_clearance, INK,",
        "distances to robots and to walls are told apart",
        "tests/plots/test_plots.py::test_distances_show_the_least_values_and_every_contact",
    ),
    Edit(
        "plots",
        "physim/plots/prediction.py",
        "predictions",
        "record.updates[np.isfinite(times) & (times > 0.0)]",
        "record.updates[np.isfinite(times)]",
        "decisions made in contact foretell none",
        "tests/plots/test_plots.py::test_a_prediction_counts_where_the_two_were_apart_and_tells_whether_it_was_kept",
    ),
    Edit(
        "plots",
        "physim/plots/prediction.py",
        "predictions",
<<<<<<< HEAD
        'row["next_step"] >= hits[k] and',
        "",
=======
        'int(row["next_step"] >= hits[k] and between[0] == between[1])',
        "1",
>>>>>>> w-pictures
        "a command that was changed before the contact is told",
        "tests/plots/test_plots.py::test_a_prediction_counts_where_the_two_were_apart_and_tells_whether_it_was_kept",
    ),
    Edit(
        "plots",
        "physim/plots/formation.py",
        "formation",
        "np.copysign(peak.value, signed)",
        "peak.value",
        "the peak of a formation error is marked on its side",
        "tests/plots/test_figures.py::test_the_peak_of_a_formation_error_is_marked_on_its_side",
    ),
    Edit(
        "plots",
        "physim/plots/formation.py",
        "formation",
        "below.plot(energy.time, energy.values,",
        "below.plot(energy.time, 2.0 * energy.values,",
        "the energy drawn is the metric",
        "tests/plots/test_figures.py::test_formation_marks_peak_and_end",
    ),
)
