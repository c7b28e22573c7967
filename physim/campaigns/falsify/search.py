"""The search: generation after generation, until a failure or the end of the budget.

Where to look next is found by CMA-ES in the unit box, or points are drawn at random. CMA-ES
(Hansen, The CMA evolution strategy: a tutorial, 2016; package ``cma``) learns from the clearances
of each generation where the next is to lie. It begins at the world itself; where it has converged
it begins anew at a random point.

Runs count in the order in which they were asked for, whoever did them: where one of a generation
fails, those behind it are as though never made. So the result depends on world, bounds, seed and
budget alone.
"""

from __future__ import annotations

import contextlib
import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from physim.campaigns.falsify.evaluate import Accepts, Evaluate, Judged, StoppedError
from physim.campaigns.falsify.space import Drawn, Space
from physim.campaigns.pool import never
from physim.drawing.plots.style import load_matplotlib
from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray
from physim.randomness import stream
from physim.world import World

SIGMA = 0.3
"""[-] share of each range by which the first generation spreads"""
WORST = 1e6
"""[m] what a world counts in the search that could not be judged; it is never a result"""
FLAT = 1e-4
"""[m] Where clearances differ by less from generation to generation the search has converged."""
NARROW = 1e-6
"""[-] It has, too, where it spreads by less than this share of each range."""
MOST_JOINT = 60
"""Numbers up to which CMA-ES learns how they belong together, which takes their number squared."""
GENERATION = 16
"""Points drawn at random at a time"""


class RandomSearch:
    """Points spread evenly over the box, whatever came of others."""

    def __init__(self, base: FloatArray, seed: int) -> None:
        self._random = stream(seed, "random search", 0)
        self._size = len(base)

    def ask(self) -> list[FloatArray]:
        """Points (D,) of the next generation, each number in [0, 1]."""
        return list(self._random.random((GENERATION, self._size)))

    def tell(self, values: Sequence[float | None]) -> None:
        """Nothing is learnt."""


class Evolution:
    """CMA-ES, begun anew where it has converged."""

    def __init__(self, base: FloatArray, seed: int) -> None:
        self._random = stream(seed, "evolution", 0)
        self._size = len(base)
        self._points: list[FloatArray] = []
        with _silent():
            self._begin(base)

    def _begin(self, point: FloatArray) -> None:
        load_matplotlib()  # as physim does, before cma imports it for its own plots
        import cma

        # it takes no single number: then another stands beside it that does nothing
        start = np.append(point, 0.5) if self._size == 1 else point
        options = {
            "bounds": [0.0, 1.0],
            "randn": lambda *shape: self._random.standard_normal(shape),
            "seed": math.nan,  # none: all that is drawn is drawn by randn
            "verbose": -9,
            "verb_log": 0,
            "tolfun": FLAT,
            "tolfunhist": FLAT,
            "tolx": NARROW,
            "CMA_diagonal": self._size > MOST_JOINT,
        }
        self._strategy: Any = cma.CMAEvolutionStrategy(
            np.clip(start, 0.02, 0.98).tolist(), SIGMA, options
        )

    def ask(self) -> list[FloatArray]:
        """Points (D,) of the next generation, each number in [0, 1]."""
        with _silent():
            if self._strategy.stop():
                self._begin(self._random.random(self._size))
            self._points = [np.asarray(point) for point in self._strategy.ask()]
        return [point[: self._size] for point in self._points]

    def tell(self, values: Sequence[float | None]) -> None:
        """Learn from `Judged.aim` of a whole generation, None for what could not be judged.

        Of a part of one nothing is learnt.
        """
        if len(values) < len(self._points):
            return
        known = [WORST if value is None or not math.isfinite(value) else value for value in values]
        with _silent():
            self._strategy.tell([point.tolist() for point in self._points], known)


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    with warnings.catch_warnings(), contextlib.redirect_stdout(None):
        warnings.simplefilter("ignore")
        yield


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

    @property
    def note(self) -> str:
        """What is known of the worst so far, in a few words."""
        if (worst := self.judged) is None or worst.clearance is None:
            return ""
        if worst.failed:
            return f"severest contact {worst.closing:.2f} m/s"
        return f"least clearance {worst.clearance:.4g} m"

    def over(self, whole_budget: bool) -> bool:
        """Whether the search has come to its end."""
        return self.runs >= self.budget or (self.failed and not whole_budget)

    def take(self, one: Drawn, result: Judged, accepts: Accepts) -> float | None:
        """Count a run; its `Judged.aim`, None where it says nothing.

        Only what a check accepts is kept.
        """
        self.runs += 1
        self.repaired += one.repaired
        aim, reason = result.aim, result.reason
        is_worse = aim is not None and (self.judged is None or aim < (self.judged.aim or 0.0))
        if aim is not None and (result.failed or is_worse):
            reason = accepts(one.world)
        if aim is None or result.clearance is None or reason:
            is_refused = result.refused or aim is not None
            self.refused += is_refused
            self.broken += not is_refused
            self.reason = self.reason or reason
            return None
        self.failures += result.failed
        if is_worse:
            self.world, self.judged, self.run = one.world, result, self.runs
            self.history.append((self.runs, result.clearance, result.closing))
        if self.first is None:
            self.first = aim
        return aim


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
        drawn, values = drawn[: budget - found.runs], []
        results = evaluate([one.world for one in drawn])
        for one, result in zip(drawn, results, strict=True):
            values.append(found.take(one, result, accepts))
            progress(found)
            if found.over(whole_budget):
                break
        return values

    try:
        if judge([Drawn(space.world, False)])[0] is None:
            raise PhysimError(f"the world itself cannot be judged: {found.reason}")
        search = (RandomSearch if at_random else Evolution)(space.base, seed)
        while not found.over(whole_budget):
            search.tell(judge([space.at(point) for point in search.ask()]))
    except StoppedError:
        found.stopped = True
    return found
