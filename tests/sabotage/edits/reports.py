"""Edits of the reports, comparisons and goals of campaigns."""

from __future__ import annotations

from tests.sabotage.edit import Edit

EDITS = (
    Edit(
        "reports",
        "physim/campaigns/outcomes.py",
        "Outcomes.contact_free",
        " & ~self.failed",
        "",
        "a run that was interrupted is not contact-free",
        "tests/campaigns/test_outcomes.py::test_what_counts",
    ),
    Edit(
        "reports",
        "physim/campaigns/outcomes.py",
        "Outcomes.__init__",
        "for name in (*CELL, *VERSIONS)",
        "for name in (*CELL, *CELL)",
        "another world of the same name is another cell",
        "tests/campaigns/test_outcomes.py::"
        "test_cells_of_a_name_that_mean_another_world_or_version_stay_apart",
    ),
    Edit(
        "reports",
        "physim/campaigns/report/contents.py",
        "_cell",
        "[goal.rate][:count]",
        "[goal.rate]",
        "what comes after a gap in the seeds has no say",
        "tests/campaigns/test_report.py::test_only_runs_without_a_gap_decide",
    ),
    Edit(
        "reports",
        "physim/campaigns/report/markup.py",
        "text",
        "html.escape(escaped(str(value)), quote=True)",
        "escaped(str(value))",
        "names from files are no markup",
        "tests/campaigns/test_report.py::test_hostile_names_are_only_names",
    ),
    Edit(
        "reports",
        "physim/campaigns/report/wording.py",
        "percent",
        "math.floor(scaled + slack) if side < 0",
        "math.ceil(scaled - slack) if side < 0",
        "ends of intervals are rounded outward",
        "tests/campaigns/test_report.py::test_ends_are_rounded_outward",
    ),
    Edit(
        "reports",
        "physim/campaigns/report/pictures.py",
        "remake",
        'row["controller"] if row["controller"] in controllers else None',
        'row["controller"]',
        "code of one's own is not run for a picture unless named",
        "tests/cli/test_report.py::test_code_of_ones_own_is_not_run_for_pictures_unless_named",
    ),
    Edit(
        "reports",
        "physim/campaigns/compare.py",
        "Finding.better",
        "self.corrected > ALPHA",
        "self.p > ALPHA",
        "a difference is shown after the correction for all that is looked at",
        "tests/campaigns/test_compare.py::"
        "test_a_difference_that_does_not_survive_the_correction_is_not_shown",
    ),
    Edit(
        "reports",
        "physim/campaigns/compare.py",
        "_findings",
        "known = ~(np.isnan(values_a) | np.isnan(values_b))",
        "known = ~np.isnan(values_a)",
        "a pair is left out of a measure that one of its runs does not have",
        "tests/campaigns/test_compare.py::test_failed_runs_count_in_rates_and_not_in_measures",
    ),
    Edit(
        "reports",
        "physim/campaigns/until.py",
        "Decided.__call__",
        "return all(",
        "return any(",
        "a sweep goes on until its goal is decided in all cells",
        "tests/campaigns/test_until.py::test_all_cells_are_to_be_decided",
    ),
    Edit(
        "reports",
        "physim/campaigns/reading.py",
        "_each_once",
        "np.lexsort((np.arange(len(codes)), fine, codes))",
        "np.lexsort((np.arange(len(codes)), codes))",
        "of a run that was done again the row that says more counts",
        "tests/campaigns/test_reading.py::test_in_bulk_as_one_by_one",
    ),
)
