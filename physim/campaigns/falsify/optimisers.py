"""Where to look next: CMA-ES in the unit box, or points at random.

CMA-ES (Hansen, The CMA evolution strategy: a tutorial, 2016; package ``cma``) learns from the
clearances of each generation where the next is to lie. It begins at the world itself; where it has
converged it begins anew at a random point. Nothing depends on who evaluates or how many at once.
"""

from __future__ import annotations

import contextlib
import math
import warnings
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from physim.drawing.plots.style import load_matplotlib
from physim.geometry.shapes import FloatArray
from physim.randomness import stream

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


class Search(Protocol):
    """Asks for points and is told what came of them."""

    def ask(self) -> list[FloatArray]:
        """Return the points (D,) of the next generation, each number in [0, 1]."""
        ...

    def tell(self, values: Sequence[float | None]) -> None:
        """Take `Judged.aim` of the generation; None for what could not be judged."""
        ...


class RandomSearch:
    """Points spread evenly over the box, whatever came of others."""

    def __init__(self, base: FloatArray, seed: int) -> None:
        self._random = stream(seed, "random search", 0)
        self._size = len(base)

    def ask(self) -> list[FloatArray]:
        """Return a generation."""
        return list(self._random.random((GENERATION, self._size)))

    def tell(self, values: Sequence[float | None]) -> None:
        """Nothing is learnt."""


class Evolution:
    """CMA-ES, begun anew where it has converged."""

    def __init__(self, base: FloatArray, seed: int) -> None:
        self._random = stream(seed, "evolution", 0)
        self._size = len(base)
        self._begin(base)

    def _begin(self, point: FloatArray) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            load_matplotlib()  # as physim does, before cma imports it for its own plots
            import cma

            # it takes no single number: then another stands beside it that does nothing
            start = np.append(point, 0.5) if self._size == 1 else point
            self._strategy: Any = cma.CMAEvolutionStrategy(
                np.clip(start, 0.02, 0.98).tolist(), SIGMA, self._options()
            )
        self._points: list[FloatArray] = []

    def _options(self) -> dict[str, Any]:
        return {
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

    def ask(self) -> list[FloatArray]:
        """Return a generation."""
        with warnings.catch_warnings(), contextlib.redirect_stdout(None):
            warnings.simplefilter("ignore")
            if self._strategy.stop():
                self._begin(self._random.random(self._size))
            self._points = [np.asarray(point) for point in self._strategy.ask()]
        return [point[: self._size] for point in self._points]

    def tell(self, values: Sequence[float | None]) -> None:
        """Learn from a whole generation; of a part of one nothing is learnt."""
        if len(values) < len(self._points):
            return
        known = [WORST if value is None or not math.isfinite(value) else value for value in values]
        with warnings.catch_warnings(), contextlib.redirect_stdout(None):
            warnings.simplefilter("ignore")
            self._strategy.tell([point.tolist() for point in self._points], known)
