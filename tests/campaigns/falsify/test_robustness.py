"""The signed swept clearance that a search goes down, and the search alone."""

from __future__ import annotations

import numpy as np
import pytest

import physim
from physim.analysis.metrics import Figures
from tests.campaigns.falsify.worlds import five_robots, into_the_wall, judge, past_a_corner
from tests.helpers import inside

Evolution, RandomSearch = inside("physim.campaigns.falsify", "Evolution", "RandomSearch")
Judged = inside("physim.campaigns.falsify", "Judged")
Touched, hunt, Space = inside("physim.campaigns.falsify", "Touched", "hunt", "Space")
ROBOTS, WALL, judged = inside("physim.campaigns.falsify", "ROBOTS", "WALL", "judged")

FREE = {"step": 0.05, "duration": 3.0}


def test_without_contact_it_is_the_shortest_distance_of_the_summary() -> None:
    record = physim.simulate(five_robots(time=FREE))
    summary, found = physim.summarise(record), judged(record)
    distances = [
        summary.metrics[name] for name in ("shortest_distance", "shortest_boundary_distance")
    ]
    least = min(distances, key=lambda one: one.value)
    assert (found.failed, found.touched) == (False, None)
    assert found.clearance == least.value > 0.0
    assert found.time == least.time
    assert found.pair == tuple(summary.bodies[i] for i in least.bodies)


def test_a_contact_is_negative_by_its_depth() -> None:
    world = five_robots()
    record = physim.simulate(world)
    episodes, found = Figures(record).episodes, judged(record)
    deepest = max(episodes, key=lambda one: one.depth)
    assert found.clearance == pytest.approx(-deepest.depth, abs=1e-9)
    assert found.pair == tuple(record.bodies[i].name for i in (deepest.a, deepest.b))
    assert found.touched == (ROBOTS, ("r2", "r4"), episodes[0].time, ("", ""))


def test_a_wall_counts_as_another_kind() -> None:
    found = judge(into_the_wall())
    assert found.touched is not None
    assert found.touched.kind == WALL
    assert found.touched.pair == ("a", "left wall")
    assert found.clearance is not None
    assert found.clearance < 0.0


def test_a_contact_between_two_samples_counts() -> None:
    record = physim.simulate(past_a_corner())
    (graze,) = Figures(record).grazes
    assert not Figures(record).episodes
    assert record.clearance.min() > 0.0
    found = judged(record)
    assert found.clearance == -graze.depth < 0.0
    assert found.touched == (ROBOTS, ("stands", "passes"), graze.time, ("", ""))


def test_without_contact_between_samples_it_errs_to_the_high_side() -> None:
    """By at most half of what the two travel in a step: 7 mm here."""
    gap = 4e-4
    found = judge(past_a_corner(-gap))
    assert not found.failed
    assert found.clearance is not None
    assert 0.5 * gap < found.clearance <= gap + 0.5 * 1.4 * 0.01


@pytest.mark.parametrize(
    ("changes", "refused"),
    [
        ({"controller": {"type": "constant", "commands": [[9.0, 0.0]]}}, True),
        ({"controller": {"type": "tests.campaigns.falsify.test_robustness:Breaks"}}, False),
    ],
)
def test_what_cannot_be_run_has_no_clearance(changes: dict[str, object], refused: bool) -> None:
    found = judge(five_robots(**changes))
    assert (found.clearance, found.touched, found.refused) == (None, None, refused)
    assert found.reason


class Breaks:
    """A controller that raises in the middle of a run."""

    def decide(self, observation: physim.Observation, memory: object) -> physim.Decision:
        if observation.time > 0.5:
            raise ZeroDivisionError("no")
        return physim.Decision(v=0.0, omega=0.0, hold=0.1)


# the search alone, on functions whose least value is known
def least(search: Evolution | RandomSearch, runs: int, target: np.ndarray) -> float:
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


def made_up(value: float | None) -> Judged:
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
        return (made_up(next(left, 5.0)) for _ in worlds)

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
        return [made_up(1.0) for _ in worlds]

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
