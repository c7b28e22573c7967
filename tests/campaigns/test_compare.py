"""Comparisons: planted differences are found with their size, and none where none is planted."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from physim.errors import PhysimError
from tests.campaigns.tables import failed, hit, row
from tests.campaigns.test_report import HOSTILE, Elements
from tests.helpers import facts, inside

ALPHA, FEWEST_PAIRS, Comparison = inside("physim.campaigns", "ALPHA", "FEWEST_PAIRS", "Comparison")
between, by, compare, Outcomes = inside("physim.campaigns", "between", "by", "compare", "Outcomes")
pairs = inside("physim.campaigns", "pairs")
comparison_page = inside("physim.campaigns.report", "comparison_page")
comparison_text = inside("physim.campaigns.report", "comparison_text")
median_difference, sign_test = inside("physim.statistics", "median_difference", "sign_test")


def campaign(shift: float = 0.0, seeds: int = 60, hits: int = 0, **other: Any) -> Outcomes:
    """Two controllers, ``other`` is ``shift`` nearer and touches with ``hits`` of the seeds."""
    rng = np.random.default_rng(3)
    hard, noise = rng.normal(0.5, 0.2, seeds), rng.normal(0.0, 0.02, (2, seeds))
    rows = []
    for seed in range(seeds):
        rows.append(row(seed, least_distance=hard[seed] + noise[0, seed]))
        value = hard[seed] + noise[1, seed] - shift
        bad = {"contacts": 1} if seed < hits else {}
        rows.append(row(seed, controller="other", least_distance=value, **bad, **other))
    return Outcomes(rows)


def finding(comparisons: list[Comparison], name: str) -> Any:
    return next(f for f in comparisons[0].findings if f.name == name)


def test_a_planted_difference_is_found_with_its_size() -> None:
    found = compare(by(campaign(shift=0.05, hits=20, time_to_finish=15.0), "controller"))
    near = finding(found, "least_distance")
    assert near.better == "a"
    assert near.low < -0.05 < near.high < 0.0
    free, late = finding(found, "contact_free"), finding(found, "time_to_finish")
    assert free.better == "a"
    assert (late.better, late.difference) == ("b", -3.0)  # of times less is better
    assert (free.only_a, free.only_b, free.difference) == (20, 0, pytest.approx(-20 / 60))


def test_pairing_sees_what_the_arms_alone_do_not() -> None:
    """Seeds differ by 0.2 m, the arms by 0.03 m."""
    (one,) = compare(by(campaign(shift=0.03), "controller"))
    a, b = pairs(one.a, one.b, "least_distance")
    near = next(f for f in one.findings if f.name == "least_distance")
    assert near.better == "a"
    _, low, high = median_difference(a)
    assert low < float(np.median(b)) < high


def test_arms_that_do_not_differ_are_not_said_to_be_equal() -> None:
    found = compare(by(campaign(), "controller"))
    assert {f.better for f in found[0].findings} == {""}
    for words in (comparison_text(found), Elements(comparison_page(found, "yard")).said):
        assert "no difference shown" in words
        assert "equal" not in words


def test_the_test_and_the_verdict_are_of_the_same_question() -> None:
    """Of 100 seeds 41 are equal, so the median of the differences is 0; B is better with 57."""
    gains = [0.0] * 41 + [0.1] * 57 + [-0.1] * 2
    rows = [row(seed, controller=name, deviation_peak=1.0 - gain * (name == "other"))
            for seed, gain in enumerate(gains) for name in ("good", "other")]  # fmt: skip
    found = compare(by(Outcomes(rows), "controller"), {"deviation_peak": -1})
    one = finding(found, "deviation_peak")
    assert (one.better, one.only_a, one.only_b, one.ties) == ("b", 2, 57, 41)
    assert one.p_corrected < 1e-4


def test_p_values_are_those_of_the_tests_corrected_together() -> None:
    outcomes = campaign(shift=0.01, hits=7)
    (one,) = compare(by(outcomes, "controller"), {"contact_free": 1, "least_distance": 1})
    free, near = one.findings
    a, b = pairs(one.a, one.b, "least_distance")
    assert near.p == sign_test(int(sum(a > b)), int(sum(b > a)))
    assert free.p == sign_test(7, 0)
    small, large = sorted((free, near), key=lambda f: f.p)
    assert small.p_corrected == pytest.approx(min(1.0, 2 * small.p))
    assert large.p_corrected == pytest.approx(max(small.p_corrected, large.p))


@pytest.mark.parametrize("few", [1, 5, 6])
def test_too_few_pairs_to_show_a_difference_count_in_no_correction(few: int) -> None:
    """As of a world in which nothing is random: its single run would cost the others power."""
    large, small = (
        by(campaign(hits=6), "controller"),
        by(campaign(seeds=few, hits=few), "controller"),
    )
    names = {"contact_free": 1, "least_distance": 1}
    alone, (both, other) = compare(large, names), compare([*large, *small], names)
    unchanged = [f.p_corrected for f in both.findings] == [f.p_corrected for f in alone[0].findings]
    assert unchanged == (few < FEWEST_PAIRS)
    assert [f.is_tested for f in other.findings] == [few >= FEWEST_PAIRS] * 2
    assert min(2.0 / 2.0**few, 1.0) > ALPHA or few >= FEWEST_PAIRS


def test_a_difference_that_does_not_survive_the_correction_is_not_shown() -> None:
    outcomes = campaign(hits=6)
    (alone,) = compare(by(outcomes, "controller"), {"contact_free": 1})
    assert alone.findings[0].better == "a"
    (among,) = compare(by(outcomes, "controller"))
    free = next(f for f in among.findings if f.name == "contact_free")
    assert free.p < 0.05 < free.p_corrected
    assert free.better == ""


def test_seeds_of_one_arm_alone_are_told_and_left_out() -> None:
    rows = [row(seed) for seed in range(10)]
    rows += [row(seed, controller="other", least_distance=0.1) for seed in range(4, 12)]
    found = compare(by(Outcomes(rows), "controller"))
    (one,) = found
    assert (one.seeds, one.a.alone, one.b.alone) == (6, (0, 1, 2, 3), (10, 11))
    assert all(f.pairs == 6 for f in one.findings)


def test_failed_runs_count_in_rates_and_not_in_measures() -> None:
    rows = [row(seed) for seed in range(10)]
    rows += [failed(seed, controller="other") if seed < 3 else row(seed, controller="other")
             for seed in range(10)]  # fmt: skip
    found = compare(by(Outcomes(rows), "controller"))
    assert finding(found, "rate").b == 0.7
    assert finding(found, "least_distance").pairs == 7


def test_by_matches_cells_that_are_alike_in_the_rest() -> None:
    rows = [row(seed, world=world, settings=settings, controller=controller)
            for seed in range(3) for world in ("a", "b") for settings in ("", "gain=1")
            for controller in ("x", "y")]  # fmt: skip
    outcomes = Outcomes(rows)
    for dimension, place in (("world", 0), ("settings", 1), ("controller", 2)):
        pairs = by(outcomes, dimension)
        assert len(pairs) == 4
        for a, b, _ in pairs:
            differing = [k for k in range(3) if a.cell.names[k] != b.cell.names[k]]
            assert differing == [place]
    three = Outcomes([row(1, controller=name) for name in "xyz"])
    assert [(a.label, b.label) for a, b, _ in by(three, "controller")] == [
        ("x", "y"), ("x", "z"), ("y", "z"),
    ]  # fmt: skip


def test_a_is_the_one_that_was_asked_for_first() -> None:
    rows = [row(1, world=world, controller=name) for world in "ab" for name in "xyz"]
    order = [("a", "", "z"), ("a", "", "x"), ("b", "", "z"), ("b", "", "x")]  # y: of another run
    pairs = by(Outcomes(rows), "controller", order)
    assert [(a.label, b.label, common) for a, b, common in pairs] == [
        (*labels, world) for world in "ab" for labels in (("z", "x"), ("z", "y"), ("x", "y"))
    ]


def test_two_campaigns_are_matched_by_what_they_have_in_common() -> None:
    one = Outcomes([row(1, world=world) for world in "ab"])
    other = Outcomes([row(1, world=world, controller="other") for world in "bc"])
    ((a, b, common),) = between(one, other, ("A", "B"))
    assert (a.label, b.label, common) == ("good", "other", "b")
    same = between(one, one, ("before", "after"))
    assert [(a.label, b.label, common) for a, b, common in same] == [
        ("before", "after", "a, good"), ("before", "after", "b, good"),
    ]  # fmt: skip


def test_what_cannot_be_compared_is_refused() -> None:
    one = Outcomes([row(1)])
    with pytest.raises(PhysimError, match=facts("--by controller", "good")):
        by(one, "controller")
    many = Outcomes([row(1, world=world, controller=c) for world in "ab" for c in "xy"])
    other = Outcomes([row(1, world="c", controller=c) for c in "xz"])
    with pytest.raises(PhysimError, match=facts("A, B", "x")):
        between(many, other, ("A", "B"))
    with pytest.raises(PhysimError, match="no seed in common"):
        compare(between(one, Outcomes([row(2)]), ("A", "B")))
    crowd = Outcomes([row(1, controller=str(k)) for k in range(30)])
    with pytest.raises(PhysimError, match=facts("435", "200")):
        compare(by(crowd, "controller"))


def test_hostile_names_are_only_names() -> None:
    rows = [make(seed, world=HOSTILE, controller=name) for seed in range(8)
            for name, make in ((HOSTILE, row), (HOSTILE + "2", hit))]  # fmt: skip
    found = compare(by(Outcomes(rows), "controller"))
    page = comparison_page(found, HOSTILE)
    assert "script" not in Elements(page).tags
    for words in (page, comparison_text(found)):
        assert "\x1b" not in words
        assert "\u202e" not in words
