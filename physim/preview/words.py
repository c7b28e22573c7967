"""Words of a preview: counts, shortened texts, names that the font has no signs for."""

from __future__ import annotations

from math import floor, log10
from typing import Any

from physim.preview.contents import Contents

FONT = "DejaVu Sans"
OTHER_FONTS = (
    "Noto Sans CJK SC", "Noto Sans CJK JP", "Noto Sans SC", "Noto Sans JP", "Noto Sans KR",
    "Source Han Sans SC", "WenQuanYi Zen Hei", "WenQuanYi Micro Hei", "Droid Sans Fallback",
    "PingFang SC", "Hiragino Sans", "Apple SD Gothic Neo", "Microsoft YaHei", "Yu Gothic",
    "Malgun Gothic", "Arial Unicode MS", "Noto Sans", "Noto Sans Devanagari", "Noto Sans Bengali",
    "Noto Sans Thai", "Noto Sans Tamil", "Noto Sans Ethiopic", "Nirmala UI", "Leelawadee UI",
    "Segoe UI Symbol", "Noto Sans Symbols2", "Noto Emoji", "Unifont",
)  # fmt: skip
"""Fonts for scripts that the first lacks, on Linux, macOS and Windows."""


def counts(shown: Contents) -> str:
    """One line of figures about a world."""
    width = shown.widths.width[shown.widths.between]
    told = [_many(len(shown.robots), "robot", "robots")]
    told.append(_many(len(shown.scene.boundaries), "boundary", "boundaries"))
    if shown.scene.obstacles:
        told.append(_many(len(shown.scene.obstacles), "obstacle", "obstacles"))
    told.append(f"reference path {metres(shown.length, 4)} m")
    if len(width):
        ends = dict.fromkeys((metres(width.min()), metres(width.max())))
        told.append(f"{' to '.join(ends)} m wide")
    if shown.random:
        told.append(f"start drawn with seed {shown.scene.seed}")
    return "  ·  ".join(told)


def _many(count: int, one: str, many: str) -> str:
    return f"{count:,} {one if count == 1 else many}"


def metres(value: float, digits: int = 3) -> str:
    """Length in words: some significant digits, from 1 m on with their zeros, and whole metres."""
    if value >= 10.0 ** (digits - 1):
        return f"{value:,.0f}"
    return f"{value:#.{digits}g}" if value >= 1.0 else f"{value:.{digits}g}"


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


def drawable(name: str, index: int, signs: frozenset[int] | None) -> str:
    """The name of a robot, cut to 24 characters, or its number where ``signs`` lack some of it."""
    name = " ".join(name.split())
    name = name if len(name) <= 24 else name[:23].rstrip() + "…"
    known = signs is None or signs.issuperset(map(ord, name))
    return name if known else f"robot {index + 1}"


def families(shown: Contents) -> tuple[list[str], frozenset[int]]:
    """Fonts that together have the most signs for a world's texts, and the signs they have.

    Most worlds need the first alone; others are looked for among those installed.
    """
    from matplotlib.font_manager import findfont, fontManager, get_font

    wanted = set(map(ord, "".join((shown.scene.name, shown.description, *shown.scene.names))))
    chosen = [FONT]
    signs = set(get_font(findfont(FONT)).get_charmap())
    installed = {entry.name for entry in fontManager.ttflist} if wanted - signs else set()
    for family in OTHER_FONTS:
        if family in installed and (more := set(get_font(findfont(family)).get_charmap())) & (
            wanted - signs
        ):
            chosen.append(family)
            signs |= more
    return chosen, frozenset(signs)
