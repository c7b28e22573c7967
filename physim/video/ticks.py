"""Round numbers for axes and scale bars."""

from __future__ import annotations

import math


def round_step(span: float, most: int) -> float:
    """Return the smallest of 1, 2, 5 × a power of ten that divides ``span`` into ``most`` parts."""
    if not (span > 0.0 and math.isfinite(span)):
        return 1.0
    decade = 10.0 ** math.floor(math.log10(span / most))
    for factor in (1.0, 2.0, 5.0, 10.0):
        if factor * decade * most >= span * (1.0 - 1e-9):
            return factor * decade
    return 10.0 * decade


def ticks(low: float, high: float, most: int) -> list[float]:
    """Return the round numbers from ``low`` to ``high``, at most ``most`` + 1 of them."""
    step = round_step(high - low, most)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]


def number(value: float, step: float) -> str:
    """Write a tick: as many decimals as the step between ticks needs, and a true minus sign."""
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    text = f"{value:.{decimals}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")
    return text.replace("-", "−")


def metres(length: float) -> str:
    """Write a distance with two decimals, three below 0.1 m; an overlap has a true minus sign."""
    text = f"{length:.3f}" if abs(length) < 0.0995 else f"{length:.2f}"
    if float(text) == 0.0:
        text = "0.000"
    return text.replace("-", "−") + " m"
