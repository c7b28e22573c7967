"""Numbers and units in words: the one place where a value becomes text.

Terminals and files have a plain minus sign; pictures and pages pass what they show through
`true_minus`. Values are in SI units.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

DIGITS = {"m": 3, "s": 2}
"""Decimals of units that have a fixed number of them"""
FINEST = 6
"""Decimals that a small value has at most"""
LARGE = 1e9
"""from which on values have an exponent"""
FEWEST, MOST = 1, 4
"""Decimals of percentages"""


def amount(value: float, unit: str = "", digits: int | None = None) -> str:
    """A value with its unit: ``0.386 m``, ``12.40 s``, ``36``, ``1.234 J``.

    Metres have three decimals and seconds two; what has another unit has four significant digits,
    or the ``digits`` decimals given. A small value has up to six decimals, so that two of its
    digits are seen; a very large one has an exponent. NaN is ``-``, infinity ``unbounded``.
    """
    if math.isnan(value):
        return "-"
    if math.isinf(value):
        return "unbounded"
    digits = DIGITS.get(unit) if digits is None else digits
    if abs(value) >= LARGE:
        text = f"{value:.4g}".replace("e+0", "e").replace("e+", "e")
    elif digits is None:
        whole = float(value).is_integer() or abs(value) >= 1000.0
        text = f"{value:,.1f}".removesuffix(".0") if whole else f"{value:.4g}"
    elif abs(value) >= 1.0:
        text = f"{value:,.{digits}f}"
    else:
        text = decimals(value, digits, digits if unit == "s" else FINEST)
        if float(text) == 0.0:
            text = f"{0.0:.{digits}f}"
    return f"{text} {unit}".rstrip()


def figure(value: float, digits: int = 4) -> str:
    """``0.3147``, ``30000``: so many significant digits, and no exponent where it is large."""
    return f"{value:.{digits}g}" if abs(value) < 10.0**digits else f"{value:.0f}"


def decimals(value: float, digits: int, most: int) -> str:
    """A number with so many decimals, and more, up to ``most``, where two digits take more."""
    size = abs(value)
    if size < 0.5 * 10.0**-most:
        value = 0.0  # zero has no minus sign
    if 0.0 < size < 1.0:
        digits = min(max(digits, 1 - math.floor(math.log10(size))), most)
    return f"{value:.{digits}f}"


def length(metres: float) -> str:
    """A length as one says it: ``1.25 m``, ``12.50 mm``, ``3.10 um``."""
    size = abs(metres)
    if 1e-9 <= size < 1e-5:
        return f"{1e6 * metres:.2f} um"
    if size < 0.1:
        return f"{1e3 * metres:.2f} mm"
    return f"{metres:.3g} m" if size >= LARGE else f"{metres:.2f} m"


def span(seconds: float) -> str:
    """A time span as one says it: ``1.250 s``, ``12.5 ms``, ``31 us``; below a nanosecond 0."""
    size = abs(seconds)
    if size < 1e-9:
        return "0 s"
    if size >= LARGE:
        return f"{seconds:.3g} s"
    if size >= 0.1:
        return f"{seconds:.3f} s"
    return f"{1e3 * seconds:.1f} ms" if size >= 1e-4 else f"{1e6 * seconds:.3g} us"


def between(time: float, dt: float) -> str:
    """``between 4.00 and 4.50 s``: a step of ``dt`` [s] by its end [s]."""
    digits = 2 if dt >= 0.01 else 4
    return f"between {time - dt:.{digits}f} and {time:.{digits}f} s"


def percent(share: float, digits: int | None = None, side: int = 0) -> str:
    """``99.9 %``; rounded down for a ``side`` of -1, up for 1, else to the nearest.

    What is neither 0 nor 1 is not written as 0 % or 100 % where up to four decimals can help it.
    """
    if math.isnan(share):
        return "-"
    digits = _digits_for(share) if digits is None else digits
    scaled = share * 100.0 * 10**digits
    slack = 1e-9 * max(1.0, abs(scaled))
    whole = (
        math.floor(scaled + slack) if side < 0
        else math.ceil(scaled - slack) if side > 0
        else round(scaled)
    )  # fmt: skip
    return f"{whole / 10**digits:.{digits}f} %"


def interval(low: float, high: float) -> str:
    """``[96.3 %, 100.0 %]``, both ends rounded outward."""
    digits = _digits_for(low, high)
    return f"[{percent(low, digits, -1)}, {percent(high, digits, 1)}]"


def _digits_for(*shares: float) -> int:
    """Decimals of percentages with which shares near 0 and 1 can be told from these."""
    inside = [min(share, 1.0 - share) for share in shares if 0.0 < share < 1.0]
    if not inside or min(inside) >= 0.01:
        return FEWEST
    return min(MOST, max(FEWEST, -math.floor(math.log10(min(inside)) + 1e-9) - 2))


def count(number: int) -> str:
    """``12,345``."""
    return f"{number:,}"


def joined(words: Iterable[str], last: str = "and") -> str:
    """``a, b and c``."""
    *before, end = words
    return f"{', '.join(before)} {last} {end}" if before else end


def true_minus(text: str) -> str:
    """Words with numbers, their minus signs as those on axes are."""
    return text.replace("-", "\N{MINUS SIGN}")
