"""The search itself: generation after generation, until a failure or the end of the budget.

Runs count in the order in which they were asked for, whoever did them: where one of a generation
fails, those behind it are as though never made. So the result depends on world, bounds, seed and
budget alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from physim.campaigns.falsify.evaluate import Accepts, Evaluate, StoppedError, never
from physim.campaigns.falsify.optimisers import Evolution, RandomSearch, Search
from physim.campaigns.falsify.robustness import Judged
from physim.campaigns.falsify.space import Drawn, Space
from physim.errors import PhysimError
from physim.world import World


@dataclass
class Hunt:
    """What a search has found so far."""

    budget: int
    runs: int = 0
    """judged, the first of them that of the world itself"""
    failures: int = 0
    """runs in which something touched"""
    repaired: int = 0
    """worlds that were moved to where they are allowed before they were run"""
    refused: int = 0
    """worlds that could not be run, or that a check refuses: they count as nothing"""
    broken: int = 0
    """runs that broke off, by an error of the controller or of another part"""
    reason: str = ""
    """of the first that was refused or broke off"""
    first: float | None = None
    """[m] signed swept clearance of the world itself"""
    world: World | None = None
    """the worst so far that a check accepts"""
    judged: Judged | None = None
    """of that"""
    run: int = 0
    """which run that was, from 1"""
    stopped: bool = False
    """told to stop before the end"""
    history: list[tuple[int, float, float]] = field(default_factory=list)
    """of each run that was worse than all before it: which, its signed swept clearance [m], and the
    closing speed [m/s] of its severest contact"""

    @property
    def failed(self) -> bool:
        """Whether the worst is a failure."""
        return self.judged is not None and self.judged.failed

    def over(self, whole_budget: bool) -> bool:
        """Whether the search has come to its end."""
        return self.runs >= self.budget or (self.failed and not whole_budget)


def hunt(
    space: Space,
    evaluate: Evaluate,
    accepts: Accepts,
    *,
    budget: int,
    seed: int = 0,
    at_random: bool = False,
    whole_budget: bool = False,
    progress: Callable[[Hunt], None] = lambda _: None,
    stop: Callable[[], bool] = never,
) -> Hunt:
    """Look for the worst world of a space with at most ``budget`` runs.

    The first failure ends the search unless ``whole_budget`` is set. ``stop`` ends it with what is
    known by then. Raises PhysimError where the world itself cannot be run.
    """
    found = Hunt(budget)

    def judge(drawn: list[Drawn]) -> list[float | None]:
        if stop():
            raise StoppedError
        drawn = drawn[: budget - found.runs]
        results = evaluate([one.world for one in drawn])
        return _take(found, drawn, results, accepts, whole_budget, progress)

    try:
        if judge([Drawn(space.world, False)])[0] is None:
            raise PhysimError(f"the world itself cannot be judged: {found.reason}")
        search = _search(space, seed, at_random)
        while not found.over(whole_budget):
            search.tell(judge([space.at(point) for point in search.ask()]))
    except StoppedError:
        found.stopped = True
    return found


def _search(space: Space, seed: int, at_random: bool) -> Search:
    return RandomSearch(space.base, seed) if at_random else Evolution(space.base, seed)


def _take(
    found: Hunt,
    drawn: list[Drawn],
    results: Iterable[Judged],
    accepts: Accepts,
    whole_budget: bool,
    progress: Callable[[Hunt], None],
) -> list[float | None]:
    """Count the runs of a generation in their order; what the search makes least."""
    values: list[float | None] = []
    for one, result in zip(drawn, results, strict=True):
        found.runs += 1
        found.repaired += one.repaired
        values.append(_counted(found, one.world, result, accepts))
        if found.first is None:
            found.first = values[-1]
        progress(found)
        if found.over(whole_budget):
            break
    return values


def _counted(found: Hunt, world: World, result: Judged, accepts: Accepts) -> float | None:
    """`Judged.aim` of a run; None where it says nothing. Only what a check accepts is kept."""
    aim = result.aim
    if aim is None or result.clearance is None:
        found.refused += result.refused
        found.broken += not result.refused
        found.reason = found.reason or result.reason
        return None
    is_worse = found.judged is None or aim < (found.judged.aim or 0.0)
    if result.failed or is_worse:
        reason = accepts(world)
        if reason:
            found.refused += 1
            found.reason = found.reason or reason
            return None
    found.failures += result.failed
    if is_worse:
        found.world, found.judged, found.run = world, result, found.runs
        found.history.append((found.runs, result.clearance, result.closing))
    return aim
