"""Lengths, times and lists in words, as the parts of the report share them."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

COLUMNS = 100
HUGE = 1e6
"""[m, s] from here on values are written in powers of ten: no run has such, a controller may
report one."""


def listed(words: Sequence[str], most: int) -> str:
    """``a, b and c``; where there are more than ``most``, their number."""
    if not words:
        return "no boundaries"
    if len(words) > most:
        return f"{len(words)} boundaries and obstacles"
    return joined(words)


def joined(words: Sequence[str]) -> str:
    """``a, b and c``."""
    words = list(words)
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def length(metres: float) -> str:
    """Length in metres, or in millimetres or micrometres where that reads better."""
    if 1e-9 <= abs(metres) < 1e-5:
        return f"{1e6 * metres:.2f} um"
    if math.isfinite(metres) and abs(metres) < 0.1:
        return f"{1e3 * metres:.2f} mm"
    return f"{metres:.3g} m" if abs(metres) >= HUGE else f"{metres:.2f} m"


def short(seconds: float) -> str:
    """A time span: seconds, or ms, us where it is small; below a nanosecond 0."""
    size = abs(seconds)
    if size < 1e-9:
        return "0 s"
    if size >= HUGE:
        return f"{seconds:.3g} s"
    if size >= 0.1:
        return f"{seconds:.3f} s"
    if size >= 1e-4:
        return f"{1e3 * seconds:.1f} ms"
    return f"{1e6 * seconds:.3g} us"


def wrapped(text: str, indent: str, hanging: str) -> list[str]:
    """Lines of at most `COLUMNS` columns, the first indented by ``indent``."""
    return textwrap.wrap(
        text, COLUMNS, initial_indent=indent, subsequent_indent=hanging, break_on_hyphens=False
    )
