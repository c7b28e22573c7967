"""Words of a preview: counts, shortened texts, names that the font has no signs for."""

from __future__ import annotations

import functools
from math import floor, log10
from typing import Any

from physim.preview.contents import Contents


def counts(shown: Contents) -> str:
    """One line of figures about a world."""
    width = shown.widths.width[shown.widths.between]
    told = [_many(len(shown.robots), "robot", "robots")]
    told.append(_many(len(shown.boundaries), "boundary", "boundaries"))
    if shown.obstacles:
        told.append(_many(len(shown.obstacles), "obstacle", "obstacles"))
    told.append(f"reference path {metres(shown.length, 4)} m")
    if len(width):
        ends = dict.fromkeys((metres(width.min()), metres(width.max())))
        told.append(f"{' to '.join(ends)} m wide")
    if shown.random:
        told.append(f"start drawn with seed {shown.seed}")
    return "  ·  ".join(told)


def _many(count: int, one: str, many: str) -> str:
    return f"{count:,} {one if count == 1 else many}"


def metres(value: float, digits: int = 3) -> str:
    """Number with three significant digits, zeros kept, and whole metres from 100 on."""
    if value >= 10.0 ** (digits - 1):
        return f"{value:,.0f}"
    return f"{value:#.{digits}g}"


def station_words(station: float, length: float) -> str:
    """A station [m] to a thousandth of the length of its path or finer."""
    decimals = max(0, 3 - floor(log10(length)))
    return f"{station:.{decimals}f}"


def shortened(figure: Any, text: str, size: float, weight: str, share: float) -> str:
    """Text on one line that takes at most a share of the figure's width, cut with an ellipsis."""
    from physim.preview.lettering import text_size

    text = " ".join(text.split())[:400]
    room = share * 72.0 * figure.get_size_inches()[0]
    if text_size(figure, text, size, weight)[0] <= room:
        return text
    low, high = 0, len(text)
    while low < high:
        middle = (low + high + 1) // 2
        fits = text_size(figure, text[:middle].rstrip() + "…", size, weight)[0] <= room
        low, high = (middle, high) if fits else (low, middle - 1)
    return text[:low].rstrip() + "…"


def drawable(name: str, index: int) -> str:
    """The name of a robot, cut to 24 characters, or its number where the font lacks its signs."""
    name = " ".join(name.split())
    name = name if len(name) <= 24 else name[:23].rstrip() + "…"
    return name if _signs().issuperset(map(ord, name)) else f"robot {index + 1}"


@functools.cache
def _signs() -> frozenset[int]:
    from matplotlib.font_manager import findfont, get_font

    return frozenset(get_font(findfont("DejaVu Sans")).get_charmap())
