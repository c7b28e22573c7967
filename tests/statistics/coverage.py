"""How often intervals hold the true value on data made up for it, and how often they should."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

REPETITIONS = 10_000
CONFIDENCE = 0.95
MONTE_CARLO = 3.3 * math.sqrt(CONFIDENCE * (1.0 - CONFIDENCE) / REPETITIONS)
"""0.7 %: what a share of exactly 95 % falls short of 95 % by in one of 2000 series of so many"""
LEAST = CONFIDENCE - MONTE_CARLO


def draws(*key: int) -> np.random.Generator:
    """Random numbers of a case; the same whenever it is tried."""
    return np.random.default_rng([2026, *key])


def share(held: NDArray[np.bool_]) -> float:
    assert held.shape == (REPETITIONS,)
    return float(np.mean(held))
