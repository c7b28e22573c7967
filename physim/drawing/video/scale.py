"""The scale bar: a round length of the world, drawn to scale."""

from __future__ import annotations

import cv2

from physim.drawing import palette
from physim.drawing.labels import number, round_step
from physim.drawing.video.layout import TEXT, Image
from physim.drawing.video.text import write

LONGEST = 150
"""[px] a bar is at most so long"""
TICK = 5
"""[px] half the height of its ends"""


def draw_scale(image: Image, left: int, y: int, scale: float) -> None:
    """Draw a bar at ``left``, ``y`` [px] for a scale [px/m], and its length beside it."""
    step = round_step(LONGEST / scale, 1)
    lengths = (step / k for k in (1.0, 2.0, 2.5, 5.0, 10.0))
    length = next(length for length in lengths if length * scale <= LONGEST)
    end = left + round(length * scale)
    cv2.line(image, (left, y), (end, y), palette.INK, 2)
    for x in (left, end):
        cv2.line(image, (x, y - TICK), (x, y + TICK), palette.INK, 2)
    write(image, f"{number(length, length)} m", (end + 10, y + 5), TEXT)
