"""From how many robots on a picture shows them together, and what it shows of them then.

Curves of more than a dozen robots cover each other and their colours come again, so the quantiles
of all are drawn instead; names of more than sixty hide what they name.
"""

from __future__ import annotations

import numpy as np

from physim.geometry.shapes import FloatArray

MOST_LINES = 12
"""Robots that have a curve each; of more, bands of quantiles are drawn."""
NAMED = 60
"""Robots that have a name, trail and path of their own on a map; more are drawn alike."""
QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
"""Shares of the robots below the lines of a band."""


def quantiles(values: FloatArray) -> FloatArray:
    """Return the `QUANTILES` (7, K) of the finite ones of values (K, N) at each of K moments.

    Linear between two values; NaN where a moment has no value.
    """
    ordered = np.sort(np.where(np.isfinite(values), values, np.nan), axis=1)  # NaN comes last
    count = np.isfinite(ordered).sum(axis=1)
    last = np.maximum(count - 1, 0)
    found = []
    for share in QUANTILES:
        at = share * last
        low = np.floor(at).astype(int)
        high = np.minimum(low + 1, last)
        moments = np.arange(len(values))
        below, above = ordered[moments, low], ordered[moments, high]
        found.append(np.where(count > 0, below + (above - below) * (at - low), np.nan))
    return np.array(found)
