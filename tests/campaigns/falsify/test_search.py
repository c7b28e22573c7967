"""The search alone, on functions whose least value is known."""

from __future__ import annotations

import numpy as np
import pytest

from tests.campaigns.falsify.worlds import five_robots
from tests.helpers import inside

Evolution, RandomSearch = inside("physim.campaigns.falsify", "Evolution", "RandomSearch")
Search, ROBOTS, Judged = inside("physim.campaigns.falsify", "Search", "ROBOTS", "Judged")
Touched, hunt, Space = inside("physim.campaigns.falsify", "Touched", "hunt", "Space")


def least(search: Search, runs: int, target: np.ndarray) -> float:
    """Least distance from a point that a search reaches."""
    found = np.inf
    while runs > 0:
        asked = search.ask()[:runs]
        assert all(((point >= 0.0) & (point <= 1.0)).all() for point in asked)
        values = [float(np.hypot.reduce(point - target)) for point in asked]
        search.tell(values)
        found, runs = min(found, *values), runs - len(asked)
    return found


@pytest.mark.parametrize("size", [1, 2, 10, 80])
def test_it_closes_in_on_the_least_where_chance_does_not(size: int) -> None:
    target, base = np.full(size, 0.8), np.full(size, 0.4)
    budget = 400 + 100 * size if size < 80 else 4000
    reached = least(Evolution(base, 3), budget, target)
    assert reached < 1e-2 * np.sqrt(size)
    if size > 1:
        assert least(RandomSearch(base, 3), budget, target) > 3.0 * reached


def test_the_same_seed_asks_the_same_and_another_does_not() -> None:
    base = np.full(4, 0.5)
    for kind in (Evolution, RandomSearch):
        one, same, other = kind(base, 1), kind(base, 1), kind(base, 2)
        for _ in range(5):
            asked = one.ask()
            assert np.array_equal(asked, same.ask())
            assert not np.array_equal(asked, other.ask())
            for search in (one, same, other):
                search.tell([float(point.sum()) for point in asked])


def test_it_begins_where_it_is_told() -> None:
    for base in (np.array([0.7, 0.4, 0.6]), np.array([0.3, 0.6, 0.5])):
        middle = np.mean([np.mean(Evolution(base, seed).ask(), axis=0) for seed in range(60)], 0)
        assert np.abs(middle - base).max() < 0.1


def judged(value: float | None) -> Judged:
    """A run with a clearance; below 0, one with a contact at that closing speed."""
    if value is None:
        return Judged(None, reason="broken")
    touched = Touched(ROBOTS, ("r1", "r2"), 1.0) if value <= 0.0 else None
    depth = 0.02 / (1.0 + abs(value))  # that of a hard contact may be small
    clearance = value if value > 0.0 else -depth
    return Judged(clearance, ("r1", "r2"), 1.0, touched, closing=max(0.0, -value))


def scripted(values: list[float | None]):
    """An evaluation that says these, run after run; then 5 m."""
    left = iter(values)

    def evaluate(worlds):
        return (judged(next(left, 5.0)) for _ in worlds)

    return evaluate


@pytest.fixture(scope="module")
def space() -> Space:
    return Space(five_robots(), ("heading",))


def fine(world) -> str:
    return ""


def test_the_first_failure_ends_the_search(space: Space) -> None:
    found = hunt(space, scripted([1.0, 2.0, 0.5, -0.1, -9.0]), fine, budget=50)
    assert (found.runs, found.run, found.failures, found.failed) == (4, 4, 1, True)
    assert [run for run, _, _ in found.history] == [1, 3, 4]
    assert [closing for _, _, closing in found.history] == [0.0, 0.0, 0.1]
    assert found.first == 1.0


def test_the_whole_budget_finds_the_severest(space: Space) -> None:
    values = [1.0, 2.0, 0.5, -0.1, -9.0]
    found = hunt(space, scripted(values), fine, budget=50, whole_budget=True)
    assert (found.runs, found.run, found.failures) == (50, 5, 2)
    assert found.judged is not None
    assert (found.judged.closing, found.judged.aim) == (9.0, -9.0)


def test_runs_are_no_more_than_the_budget(space: Space) -> None:
    asked = []

    def evaluate(worlds):
        asked.extend(worlds)
        return [judged(1.0) for _ in worlds]

    found = hunt(space, evaluate, fine, budget=23)
    assert (found.runs, len(asked), found.failed) == (23, 23, False)
    assert asked[0] == space.world


def test_what_breaks_off_or_is_refused_is_counted_and_never_a_failure(space: Space) -> None:
    refuse = iter(["", "", "no such world"])
    found = hunt(space, scripted([1.0, None, 0.9, -3.0]), lambda world: next(refuse, ""), budget=12)
    assert (found.broken, found.refused, found.failures, found.runs) == (1, 1, 0, 12)
    assert found.reason == "broken"
    assert found.judged is not None
    assert found.judged.clearance == 0.9


def test_told_to_stop_it_keeps_what_it_has(space: Space) -> None:
    calls = iter([False, False, True])
    found = hunt(space, scripted([1.0]), fine, budget=100, stop=lambda: next(calls))
    assert found.stopped
    assert found.judged is not None
    assert found.runs < 100
