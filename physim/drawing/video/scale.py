"""The scale bar: a round length of the world, drawn to scale."""

from __future__ import annotations

import math

import cv2

from physim.drawing import palette
from physim.drawing.labels import number
from physim.drawing.video.layout import TEXT, Image
from physim.drawing.video.text import write

LONGEST = 150
"""[px] a bar is at most so long"""
TICK = 5
"""[px] half the height of its ends"""


def bar_length(scale: float) -> float:
    """Return the length [m] of a bar: the greatest of 1, 2, 5 × a power of ten with room for it.

    Of these `number` writes every digit; of 2.5 it would not.
    """
    most = LONGEST / scale
    decade = 10.0 ** math.floor(math.log10(most))
    return next(factor * decade for factor in (5.0, 2.0, 1.0, 0.5) if factor * decade <= most)


def draw_scale(image: Image, left: int, y: int, scale: float) -> None:
    """Draw a bar at ``left``, ``y`` [px] for a scale [px/m], and its length beside it."""
    length = bar_length(scale)
    end = left + round(length * scale)
    cv2.line(image, (left, y), (end, y), palette.INK, 2)
    for x in (left, end):
        cv2.line(image, (x, y - TICK), (x, y + TICK), palette.INK, 2)
    write(image, f"{number(length, length)} m", (end + 10, y + 5), TEXT)
