"""Edits of `physim.analysis.summary` and of the expectations of worlds."""

from __future__ import annotations

from tests.sabotage.edit import Edit

EDITS = (
    Edit(
        "summary",
        "physim/analysis/expectations.py",
        "expectations",
        "+ len(metrics.grazes(record))",
        "",
        "a contact between samples breaks an expectation too",
        "tests/test_summary.py::test_a_contact_between_samples_counts_as_one",
    ),
    Edit(
        "summary",
        "physim/analysis/expectations.py",
        "_holds",
        'got >= wanted if key.startswith("min_") else got <= wanted',
        'got > wanted if key.startswith("min_") else got <= wanted',
        "a bound that is just met holds",
        "tests/test_summary.py::test_exactly_on_the_bound_holds",
    ),
    Edit(
        "summary",
        "physim/analysis/expectations.py",
        "_holds",
        "return got is wanted",
        "return True",
        "a run that was to finish and did not is told",
        "tests/test_summary.py::test_expectation_held_and_broken",
    ),
    Edit(
        "summary",
        "physim/analysis/summary/summary.py",
        "Summary.held",
        "return all(",
        "return any(",
        "a run holds its world's expectations if it holds every one",
        "tests/test_summary.py::test_a_run_holds_when_every_expectation_does",
    ),
    Edit(
        "summary",
        "physim/analysis/summary/summary.py",
        "Summary._contacts",
        '"impact_newton_seconds": e.impact',
        '"impact_newton_seconds": e.impulse',
        "impact and impulse of a contact are told apart",
        "tests/test_summary.py::test_figures_and_names",
    ),
    Edit(
        "summary",
        "physim/analysis/summary/summary.py",
        "Summary._contacts",
        '"duration_s": e.samples * self.dt',
        '"duration_s": e.samples',
        "a contact lasts as long as its samples",
        "tests/test_summary.py::test_contacts_one_by_one",
    ),
    Edit(
        "summary",
        "physim/analysis/summary/summary.py",
        "_contacts",
        "with_boundaries=len(episodes) - robots",
        "with_boundaries=len(episodes)",
        "contacts are counted by kind",
        "tests/test_summary.py::test_figures_and_names",
    ),
    Edit(
        "summary",
        "physim/analysis/summary/table.py",
        "_contact_rows",
        "{1e3 * e.depth:.1f} mm",
        "{e.depth:.1f} mm",
        "depths in the table are millimetres",
        "tests/test_summary.py::test_contacts_one_by_one",
    ),
    Edit(
        "summary",
        "physim/analysis/summary/table.py",
        "_contact_rows",
        "_more(contacts.count - len(rows))",
        "_more(0)",
        "the table says how many contacts it leaves out",
        "tests/test_summary.py::test_contacts_one_by_one",
    ),
)
