"""Numbers rounded twice, when they are packed and when they are shown: as if only once.

1.4045 m packed to a millimetre is 1.405 m, which is shown as 1.41 m. What would be packed halfway
between two numbers that are shown is packed on its own side of the middle, one quantum beside it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from physim.geometry.shapes import FloatArray

LEAST_SHORT = 0.0995
"""[m] from which on the page shows lengths with two decimals; smaller ones with three"""


def for_unit(values: ArrayLike, quantum: float, unit: str) -> FloatArray:
    """Numbers (n,) as they are to be packed, of which the page shows as many decimals as usual."""
    given = np.asarray(values, dtype=np.float64)
    if unit != "m":
        return for_decimals(given, quantum, 2)
    fine, coarse = (for_decimals(given, quantum, decimals) for decimals in (3, 2))
    return np.where(np.abs(given) < LEAST_SHORT, fine, coarse)


def for_decimals(values: ArrayLike, quantum: float, decimals: int) -> FloatArray:
    """The same of numbers that are shown with so many decimals; moved by one quantum at most."""
    given = np.asarray(values, dtype=np.float64)
    half = 0.5 * 10.0**-decimals / quantum
    if half < 0.75 or abs(half - round(half)) > 1e-6:
        return given  # no whole number of quanta is the middle
    with np.errstate(invalid="ignore"):
        scaled = given / quantum
        whole = np.rint(scaled)
        middle = np.mod(whole, 2 * round(half)) == round(half)
        side = np.sign(scaled - whole)
    return np.where(middle & (side != 0.0), (whole + side) * quantum, given)
