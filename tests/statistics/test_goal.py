"""Goals: what the grammar takes and refuses, and that what is decided is right."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.helpers import examples, inside
from tests.statistics.coverage import LEAST, REPETITIONS, draws, share

RATES, Goal, Watch, decide = inside("physim.statistics", "RATES", "Goal", "Watch", "decide")
read_goal, running = inside("physim.statistics", "read_goal", "running")


@pytest.mark.parametrize(
    ("text", "goal"),
    [
        ("0.02", Goal("rate", "", 0.02)),
        ("2%", Goal("rate", "", 0.02)),
        (" .5 ", Goal("rate", "", 0.5)),
        ("rate > 0.99", Goal("rate", ">", 0.99)),
        ("rate>99%", Goal("rate", ">", 0.99)),
        ("contact_free < 0.5", Goal("contact_free", "<", 0.5)),
        ("finished > 99.9 %", Goal("finished", ">", 0.999)),
        ("rate > 0", Goal("rate", ">", 0.0)),
        ("rate < 1", Goal("rate", "<", 1.0)),
    ],
)
def test_goals(text: str, goal: Goal) -> None:
    read = read_goal(text)
    assert (read.rate, read.sign) == (goal.rate, goal.sign)
    assert read.number == pytest.approx(goal.number)
    assert read_goal(str(read)) == read


@pytest.mark.parametrize("text", [
    "rate > ", "rate", "", "0", "1", "120%", "rate > 1.5", "rate > 101%", "rate >= 0.9",
    "rate = 0.9", "rats > 0.9", "RATE > 0.9", "0.9 < rate", "-0.02",
    "rate > 0.9 and finished > 0.9", "rate > -1", "1e-3", "__import__('os').system('true')",
    "rate > nan",
])  # fmt: skip
def test_what_is_no_goal_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="width") as refused:
        read_goal(text)
    told = str(refused.value)
    assert all(rate in told for rate in RATES)
    assert f'"{text}"' in told


def test_what_comes_after_the_decision_has_no_say() -> None:
    good = draws(1).random(5000) < 0.97
    for goal in (Goal("rate", ">", 0.9), Goal("rate", "<", 0.9), Goal("rate", "", 0.05)):
        whole = decide(goal, good)
        assert whole.decided
        assert whole.runs < 4000
        for more in (0, 1, 7, 800):
            assert decide(goal, good[: whole.runs + more]) == whole
        assert not decide(goal, good[: whole.runs - 1]).decided


def test_a_decision_is_the_first_look_that_decides() -> None:
    good = draws(2).random(2000) < 0.8
    looks = running(good)
    found = decide(Goal("rate", ">", 0.7), good)
    assert looks.low[found.runs - 1] > 0.7 >= looks.low[found.runs - 2]
    assert (found.low, found.high) == (looks.low[found.runs - 1], looks.high[found.runs - 1])
    assert found.successes == np.count_nonzero(good[: found.runs])
    assert found.holds is True
    assert decide(Goal("rate", "<", 0.7), good).holds is False
    assert decide(Goal("rate", ">", 0.9), good).holds is False
    narrow = decide(Goal("rate", "", 0.1), good)
    assert narrow.high - narrow.low <= 0.1
    assert narrow.holds is None


@pytest.mark.parametrize(
    ("text", "good"),
    [("rate > 0", False), ("rate < 0", False), ("rate > 1", True), ("rate < 1", True)],
)
def test_a_bound_that_the_interval_only_touches_is_not_decided(text: str, good: bool) -> None:
    """However many runs succeed: that every one does is never known, nor that none does."""
    goal = read_goal(text)
    for runs in (1, 50):
        found = decide(goal, [good] * runs)
        assert (found.runs, found.decided, found.holds) == (runs, False, None)
    watch = Watch(goal)
    assert not any(watch.add(good) for _ in range(50))


def test_the_interval_told_holds_the_share_told() -> None:
    """Also where the runs drift, so that ends of earlier looks leave the share out."""
    good = [True] * 60 + [False] * 40
    found = decide(Goal("rate", ">", 0.92), good)
    looks = running(good[: found.runs])
    share = found.successes / found.runs
    assert share < looks.low[-1]
    assert (found.low, found.high, found.holds) == (share, looks.high[-1], False)


def test_without_enough_runs_nothing_is_decided() -> None:
    found = decide(Goal("rate", ">", 0.999), [True] * 100)
    assert (found.runs, found.decided, found.holds) == (100, False, None)
    assert decide(Goal("rate", "", 0.01), []).decided is False


@pytest.mark.parametrize(("rate", "bound"), [(0.9, 0.9), (0.5, 0.5), (0.99, 0.99)])
def test_where_the_rate_is_the_bound_few_are_decided(rate: float, bound: float) -> None:
    """The hardest case: whatever is decided is wrong; looked at after each of 300 runs."""
    goal = Goal("rate", ">", bound)
    outcomes = draws(3, int(100 * rate)).random((REPETITIONS, 300)) < rate
    from tests.statistics.test_sequence import every_count, sequence

    low, high = every_count(sequence)
    successes, look = np.cumsum(outcomes, axis=1), np.arange(300)
    decided = goal.reached(low[look, successes], high[look, successes]).any(axis=1)
    assert share(~decided) >= LEAST
    some = [k for k in range(REPETITIONS) if decided[k]][:3]
    assert [decide(goal, outcomes[k]).decided for k in (*some, 0)] == [True] * len(some) + [
        bool(decided[0])
    ]


@pytest.mark.parametrize("text", ["rate > 0.9", "rate < 0.9", "0.1", "rate > 0.97"])
def test_one_by_one_is_as_all_at_once(text: str) -> None:
    goal = read_goal(text)
    good = draws(4).random(800) < 0.95
    watch = Watch(goal)
    told = [watch.add(bool(one)) for one in good]
    whole = decide(goal, good)
    assert watch.decision == whole
    assert told == [k + 1 >= whole.runs and whole.decided for k in range(len(good))]


def test_a_watch_stays_where_the_intervals_have_nothing_in_common_any_more() -> None:
    """Runs that drift are no sample of one rate: what comes later decides nothing any more."""
    goal = read_goal("rate > 0.56118")
    outcomes = [True] * 8 + [False] * 28 + [True] * 1500
    watch = Watch(goal)
    for one in outcomes:
        watch.add(one)
    assert watch.is_empty
    assert watch.decision == decide(goal, outcomes)


@examples(25, deep=100)
@given(
    st.lists(st.tuples(st.integers(1, 60), st.sampled_from([0.0, 0.1, 0.5, 0.9, 1.0])), max_size=5),
    st.floats(0.02, 0.98),
    st.integers(0, 2**32),
)
def test_a_watch_says_what_is_decided_of_all_of_runs_that_drift(
    parts: list[tuple[int, float]], bound: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    outcomes = [bool(rng.random() < rate) for count, rate in parts for _ in range(count)]
    goal = read_goal(f"rate > {bound:.4f}")
    watch = Watch(goal)
    for one in outcomes:
        watch.add(one)
    assert watch.decision == decide(goal, outcomes)
