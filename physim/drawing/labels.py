"""Labels of pictures: numbers and names in words, cut to their room, and places for them.

A label is tried in directions round what it belongs to, touching it or farther off; what it would
cover there is measured here, and each picture weighs that for itself: a film prefers that a
label stays where it is, and on paper no two may overlap. Lengths are [px] or [pt], as the caller
has them.
"""

from __future__ import annotations

import math
import re
import unicodedata
from bisect import bisect_right
from collections.abc import Callable
from decimal import Decimal
from typing import NamedTuple

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.units import decimals, true_minus

MOST_CHARACTERS = 400
"""of a text: no picture has room for more"""
NUMBERED = re.compile(r"[\w-]*[^\W\d]-?([0-9]{1,5})")
"""a name with a number at its end"""

# In words


def round_step(span: float, most: float) -> float:
    """Return the smallest of 1, 2, 5 × a power of ten that divides ``span`` into ``most`` parts."""
    if not (span > 0.0 and math.isfinite(span)):
        return 1.0
    decade = 10.0 ** math.floor(math.log10(span / most))
    steps = (factor * decade for factor in (1.0, 2.0, 5.0))
    return next((step for step in steps if step * most >= span * (1.0 - 1e-6)), 10.0 * decade)


def ticks(low: float, high: float, most: int) -> list[tuple[float, str]]:
    """Return the round numbers from ``low`` to ``high``, at most ``most`` + 1, and their words."""
    step = round_step(high - low, most)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [(k * step, number(k * step, step)) for k in range(first, last + 1)]


def number(value: float, step: float) -> str:
    """Write a tick: as many decimals as the step between ticks needs, and a true minus sign."""
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    return true_minus(decimals(value, digits, digits))


def significant(value: float, digits: int = 3) -> str:
    """Write a length: some significant digits, from 1 on with their zeros, and whole metres."""
    if value >= 10.0 ** (digits - 1):
        return f"{value:,.0f}"
    return f"{value:#.{digits}g}" if value >= 1.0 else f"{Decimal(f'{value:.{digits}g}'):f}"


def clean(text: str) -> str:
    """Return ``text`` on one line: control characters and unpaired surrogates become spaces.

    An unpaired surrogate is half a character, which no font has.
    """
    bad = {"Cc", "Cs", "Zl", "Zp"}
    spaced = "".join(" " if unicodedata.category(c) in bad else c for c in text)
    return " ".join(spaced.split())


def shortened(text: str, fits: int | Callable[[str], bool]) -> str:
    """Return ``text`` cleaned, as much of it as ``fits``, with an ellipsis where it is cut.

    A name keeps the number at its end, which tells the robots of a group apart. ``fits`` says
    whether a text does, or is the number of characters that do.
    """
    text = clean(text)[:MOST_CHARACTERS]
    short = fits if callable(fits) else lambda cut: len(cut) <= fits
    if short(text):
        return text
    number = NUMBERED.fullmatch(text)
    end = number[1] if number and short("…" + number[1]) else ""
    cuts = [text[:count].rstrip() + "…" + end for count in range(len(text) - len(end))]
    return cuts[max(0, bisect_right(cuts, False, key=lambda cut: not short(cut)) - 1)]


# Places


class Label(NamedTuple):
    """A label to place, and what it belongs to."""

    at: tuple[float, float]
    reach: float
    """radius to keep free round ``at``"""
    size: tuple[float, float]
    shape: FloatArray | None = None
    """(n, 2) outline round ``at``, to keep free instead of the disc of radius ``reach``"""


ANGLES = np.radians([90, 270, 45, 135, 0, 180, 315, 225, 67, 112, 22, 157, 247, 292, 202, 337])
"""Directions, y up, the preferred first."""
DIRECTIONS = np.column_stack((np.cos(ANGLES), np.sin(ANGLES)))
SIDES = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
"""Normals of the sides of a box"""
TURNS = np.arange(len(ANGLES)) / len(ANGLES)
"""How little they are preferred, from 0 to 1."""
DISC = 0.6
"""Share of the radius of a disc from which a line to its label starts: what it holds is smaller"""


def places(label: Label, gaps: tuple[float, ...], up: float = 1.0) -> FloatArray:
    """Return the middles (G A, 2) at which a label clears what it belongs to, gap by gap.

    ``up`` is -1 where y goes down.
    """
    direction = DIRECTIONS * (1.0, up)
    half = np.array(label.size) / 2.0
    if label.shape is None:
        out = label.reach + np.min(half / np.maximum(np.abs(direction), 1e-9), axis=1)
    else:
        out = exit_distance(direction, label.shape, half)
    return np.concatenate([label.at + direction * (out + gap)[:, None] for gap in gaps])


def exit_distance(direction: FloatArray, shape: FloatArray, half: FloatArray) -> FloatArray:
    """Return how far a box of half sizes (2,) must go in directions (d, 2) to clear a shape.

    Exact for a convex ``shape`` (n, 2) round the origin; of others the hull is cleared.
    """
    edges = np.concatenate((shape[1:], shape[:1])) - shape
    normals = edges[:, ::-1] * (1.0, -1.0)
    axes = np.concatenate((normals, -normals, SIDES))
    support = (shape @ axes.T).max(axis=0) + np.abs(axes) @ half
    along = direction @ axes.T
    exits = np.where(along > 1e-9, support / np.maximum(along, 1e-9), np.inf)
    return np.asarray(np.maximum(exits.min(axis=1), 0.0))


def around(middles: FloatArray, size: tuple[float, float]) -> FloatArray:
    """Return the boxes (n, 4) of labels of one size: least x, least y, greatest x, greatest y."""
    half = np.array(size) / 2.0
    return np.concatenate((middles - half, middles + half), axis=-1)


def grown(boxes: FloatArray, by: float) -> FloatArray:
    """Return boxes (n, 4) with ``by`` more on every side."""
    return np.asarray(boxes + (-by, -by, by, by))


def overlaps(boxes: FloatArray, others: FloatArray) -> FloatArray:
    """Return the common area (n, m) of boxes (n, 4) and others (m, 4)."""
    x0, y0, x1, y1 = boxes.T[:, :, None]
    wide = np.minimum(x1, others[:, 2]) - np.maximum(x0, others[:, 0])
    high = np.minimum(y1, others[:, 3]) - np.maximum(y0, others[:, 1])
    return np.asarray(np.maximum(wide, 0.0) * np.maximum(high, 0.0))


def covered(boxes: FloatArray, pieces: FloatArray, prices: FloatArray | None = None) -> FloatArray:
    """Return the length (n,) of straight pieces (s, 2, 2) that boxes (n, 4) cover.

    With ``prices`` (s,) what it costs. A piece that only touches a box is not covered.
    """
    seen = (pieces.max(axis=1) >= boxes[:, :2].min(axis=0)) & (
        pieces.min(axis=1) <= boxes[:, 2:].max(axis=0)
    )
    rows = np.flatnonzero(seen.all(axis=1))
    if not len(rows):
        return np.zeros(len(boxes))
    start, direction = pieces[rows, 0], pieces[rows, 1] - pieces[rows, 0]
    length = np.hypot(*direction.T) * (1.0 if prices is None else prices[rows])
    direction = np.where(np.abs(direction) < 1e-9, 1e-9, direction)
    ends = (boxes[:, None, :2] - start) / direction, (boxes[:, None, 2:] - start) / direction
    early, late = np.minimum(*ends), np.maximum(*ends)
    enter = np.maximum(np.maximum(early[..., 0], early[..., 1]), 0.0)
    share = np.minimum(np.minimum(late[..., 0], late[..., 1]), 1.0) - enter
    return np.asarray(np.maximum(share, 0.0) @ length)


def leader(label: Label, middle: FloatArray, least: float) -> FloatArray | None:
    """Return the line (2, 2) to a label from what it belongs to; None for one beside it.

    Beside it is a label whose edge is no farther than ``least`` from ``at``.
    """
    offset = middle - label.at
    distance = float(np.hypot(*offset))
    direction = offset / distance
    end = distance - float(np.min(np.array(label.size) / 2.0 / np.maximum(np.abs(direction), 1e-9)))
    if end <= least:
        return None
    shape = label.shape
    start = (
        DISC * label.reach if shape is None else exit_distance(direction[None], shape, np.zeros(2))
    )
    return np.stack((direction * start, direction * end)) + label.at


def spread(wanted: FloatArray, gap: float, low: float, high: float) -> FloatArray:
    """Move rising positions at least ``gap`` apart within [low, high], least in squares.

    Isotonic regression by pooling neighbours that would come too close.
    """
    steps = gap * np.arange(len(wanted))
    pools: list[tuple[float, int]] = []
    for value in (wanted - steps).tolist():
        total, count = value, 1
        while pools and pools[-1][0] / pools[-1][1] >= total / count:
            before, members = pools.pop()
            total, count = total + before, count + members
        pools.append((total, count))
    means = np.array([total / count for total, count in pools for _ in range(count)])
    top = high - gap * max(len(wanted) - 1, 0)
    return np.asarray(np.clip(means, low, max(low, top)) + steps)
