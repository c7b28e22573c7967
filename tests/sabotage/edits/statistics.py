"""Edits of the intervals, tests and goals in `physim.statistics`."""

from __future__ import annotations

from tests.sabotage.edit import Edit

EDITS = (
    Edit(
        "statistics",
        "physim/statistics/goal.py",
        "Watch.add",
        "self.is_empty |= low > high",
        "self.is_empty = low > high",
        "where intervals have nothing in common any more the last one that had stays",
        "tests/statistics/test_goal.py::"
        "test_a_watch_stays_where_the_intervals_have_nothing_in_common_any_more",
    ),
    Edit(
        "statistics",
        "physim/statistics/proportion.py",
        "clopper_pearson_each",
        "tail = (1.0 - confidence) / 2.0",
        "tail = 1.0 - confidence",
        "the interval of a rate has two tails",
        "tests/statistics/test_proportion.py::test_tails_hold_2_5_percent_each",
    ),
    Edit(
        "statistics",
        "physim/statistics/proportion.py",
        "runs_needed",
        "math.ceil(",
        "math.floor(",
        "the runs needed for a rate are enough",
        "tests/statistics/test_proportion.py::test_runs_needed_are_enough_and_no_more",
    ),
    Edit(
        "statistics",
        "physim/statistics/sequence.py",
        "_mixture",
        " - betaln(a, b)",
        "",
        "a prior is a distribution: evidence has mean 1",
        "tests/statistics/test_sequence.py::test_evidence_is_the_mixture_of_likelihoods",
    ),
    Edit(
        "statistics",
        "physim/statistics/sequence.py",
        "at_each_look",
        "math.log(1.0 - confidence)",
        "math.log(2.0 * (1.0 - confidence))",
        "the sequence holds at every look",
        "tests/statistics/test_sequence.py::test_ends_are_where_the_evidence_is_twenty",
    ),
    Edit(
        "statistics",
        "physim/statistics/sequence.py",
        "running",
        "low, high = np.maximum.accumulate(low), np.minimum.accumulate(high)",
        "",
        "an interval of the sequence never grows wider",
        "tests/statistics/test_sequence.py::test_the_running_intersection_is_the_intersection",
    ),
    Edit(
        "statistics",
        "physim/statistics/goal.py",
        "decide",
        "int(np.argmax(enough)) if enough.any() else len(good) - 1",
        "len(good) - 1",
        "runs after those that decide have no say",
        "tests/statistics/test_goal.py::test_what_comes_after_the_decision_has_no_say",
    ),
    Edit(
        "statistics",
        "physim/statistics/paired.py",
        "rate_differences",
        "often = clopper_pearson_each(a + b, n, 1.0 - (1.0 - SHARE_OF_SIDE) * error)",
        "often = (a + b) / n, (a + b) / n",
        "how often two arms differ is not known exactly either",
        "tests/statistics/test_paired.py::test_coverage_of_differences_of_rates",
    ),
    Edit(
        "statistics",
        "physim/statistics/paired.py",
        "rank_beyond",
        "tail = (1.0 - confidence) / 2.0",
        "tail = 1.0 - confidence",
        "the interval of a median has two tails",
        "tests/statistics/test_paired.py::test_ranks_of_the_interval_of_the_median",
    ),
    Edit(
        "statistics",
        "physim/statistics/paired.py",
        "holm",
        "[order] * sizes",
        "[order]",
        "findings are corrected for how many are looked at",
        "tests/statistics/test_paired.py::test_holm_keeps_the_error_of_all_together",
    ),
)
