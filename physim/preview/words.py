"""Words of a preview: counts, shortened texts, names that the font has no signs for."""

from __future__ import annotations

from math import floor, log10

from physim.errors import plural
from physim.labels import shortened, significant
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
    scene = shown.scene
    words = [plural(scene.robots, "robot"), plural(len(scene.boundaries), "boundary", "boundaries")]
    if scene.obstacles:
        words.append(plural(len(scene.obstacles), "obstacle"))
    words.append(f"reference path {significant(shown.length, 4)} m")
    if len(width):
        ends = dict.fromkeys((significant(width.min()), significant(width.max())))
        words.append(f"{' to '.join(ends)} m wide")
    if shown.random:
        words.append(f"start drawn with seed {scene.seed}")
    return "  ·  ".join(words)


def station_words(station: float, length: float) -> str:
    """A station [m] to a thousandth of the length of its path or finer."""
    decimals = max(0, 3 - floor(log10(length)))
    return f"{station:.{decimals}f}"


def drawable(name: str, index: int, signs: frozenset[int] | None) -> str:
    """The name of a robot, cut to 24 characters, or its number where ``signs`` lack some of it."""
    name = shortened(name, 24)
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
