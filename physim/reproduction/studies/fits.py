"""Time constants of what dies away."""

from __future__ import annotations

import math

import numpy as np

from physim.geometry.shapes import FloatArray

FEWEST = 5
"""Points that a fit needs."""


def time_constant(time: FloatArray, values: FloatArray) -> float:
    """Time constant [s] of values (K,) > 0 that die away: least squares on their logarithm.

    nan with fewer than `FEWEST` points; negative where the values grow.
    """
    if len(time) < FEWEST:
        return math.nan
    slope = float(np.polyfit(time - time[0], np.log(values), 1)[0])
    return math.inf if slope == 0.0 else -1.0 / slope


def root_mean_square(values: FloatArray) -> FloatArray:
    """Root of the mean square over robots: (K,) of values (K, N)."""
    return np.asarray(np.sqrt(np.square(values).mean(axis=1)))
