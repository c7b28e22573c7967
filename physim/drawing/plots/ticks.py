"""Ticks of a logarithmic axis: round values, at least two, however few or many decades it has."""

from __future__ import annotations

import math

ROUND, MORE = (1, 2, 5), (1, 1.5, 2, 3, 4, 5, 7)
"""Digits of the ticks in a decade: as a rule, and where these are less than two on the axis."""
MOST_TICKS = 12


def log_ticks(low: float, high: float) -> list[float]:
    """Rising round values from ``low`` to ``high``, two to `MOST_TICKS` of them.

    Both are positive, and ``high`` is at least 2.5 times ``low``. Of many decades every second,
    third … has a tick.
    """
    first, last = math.floor(math.log10(low)), math.floor(math.log10(high))
    for digits in (ROUND, MORE):
        if (last - first) * len(digits) > 2 * MOST_TICKS:
            break
        ticks = [float(f"{digit}e{k}") for k in range(first, last + 1) for digit in digits]
        ticks = [tick for tick in ticks if low <= tick <= high]
        if 2 <= len(ticks) <= MOST_TICKS:
            return ticks
    apart = -(-(last - first + 1) // MOST_TICKS)
    first = math.ceil(math.log10(low) / apart - 1e-12) * apart
    return [float(f"1e{k}") for k in range(first, last + 1, apart)]
