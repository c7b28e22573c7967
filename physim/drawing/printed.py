"""How wide figures are in print."""

from __future__ import annotations

from numbers import Real
from typing import Any

WIDTHS = {"column": 3.5, "page": 7.16}
"""[in] of one and of two columns of the usual paper"""
LEAST, MOST = 3.3, 20.0
"""[in]; in less than the narrowest usual column, titles of axes run into each other"""
ALLOWED = f"column (3.5 in), page (7.16 in), or a number of inches from {LEAST:g} to {MOST:g}"


def printed_width(given: Any) -> float:
    """Width [in] for one of the names of `WIDTHS` or a number. Raises ValueError: what may be."""
    value: Any = WIDTHS.get(given) if isinstance(given, str) else given
    is_number = isinstance(value, Real) and not isinstance(value, bool)
    if not is_number or not LEAST <= value <= MOST:
        raise ValueError(ALLOWED)
    return float(value)
