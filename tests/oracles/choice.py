"""Which candidates are right when several are as good: equal ones, and those too near to tell."""

from __future__ import annotations

import numpy as np

from tests.oracles.tolerances import ROUNDING, SAME


def smallest(keys, tolerance=ROUNDING):
    """Candidates (a set) that may be called the smallest by K ``keys`` (C,), first key first.

    Those equal in one key are told apart by the next, and in the end by their order. Where some
    are nearer than the tolerance but not the same, each of them is right. ``tolerance`` is that of
    the first key. The second result is the number of keys after which there was nothing left to
    settle, K + 1 where it was the order.
    """
    left = np.arange(len(keys[0]))
    for number, key in enumerate(keys):
        value = np.asarray(key)[left]
        least = value.min()
        over = value - least if np.isfinite(least) else np.where(value == least, 0.0, np.inf)
        near = over <= (tolerance if number == 0 else ROUNDING)
        left = left[near]
        if len(left) == 1 or (over[near] > SAME).any():
            return set(left.tolist()), number + 1
    return {int(left[0])}, len(keys) + 1
