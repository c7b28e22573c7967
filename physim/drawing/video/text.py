"""Text in the picture, in any script: OpenCV's embedded outline fonts, antialiased."""

from __future__ import annotations

import functools
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from physim.drawing.labels import shortened
from physim.drawing.palette import INK, WHITE, Colour
from physim.drawing.video.layout import Image

Sprite = tuple[NDArray[np.float32], NDArray[np.float32]]
"""Colour times opacity (h, w, 3) from 0 to 255, and transparency (h, w, 3) from 0 to 1."""

NORMAL, BOLD = 420, 600


@functools.cache
def _face() -> Any:
    return cv2.FontFace("sans")


@functools.lru_cache(maxsize=4096)
def width(text: str, size: int, weight: int = NORMAL) -> int:
    """Return the width of ``text`` [px] at font size ``size`` [px]."""
    return int(cv2.getTextSize((8, 8), text, (0, 0), _face(), size, weight)[2])


@functools.lru_cache(maxsize=4096)
def shorten(text: str, size: int, room: int, weight: int = NORMAL) -> str:
    """Return ``text`` cleaned and, where wider than ``room`` px, cut and ended with an ellipsis."""
    return shortened(text, lambda cut: width(cut, size, weight) <= room)


def wrapped(text: str, size: int, room: int, most: int) -> list[str]:
    """Return ``text`` in at most ``most`` lines of ``room`` px, ended at commas, the last cut."""
    lines: list[str] = []
    for part in text.split(", ") if text else ():
        longer = f"{lines[-1]}, {part}" if lines else part
        if lines and (len(lines) == most or width(f"{longer},", size) <= room):
            lines[-1] = longer
        else:
            lines.append(part)
    ends = ["," for _ in lines[1:]] + [""]
    return [shorten(line + end, size, room) for line, end in zip(lines, ends, strict=False)]


def write(
    image: Image,
    text: str,
    at: tuple[float, float],
    size: int,
    *,
    colour: Colour = INK,
    weight: int = NORMAL,
    anchor: str = "left",
) -> None:
    """Write ``text`` with its baseline at ``at`` (x, y) [px]; ``anchor``: left, middle, right."""
    x = at[0]
    if anchor != "left":
        x -= width(text, size, weight) * (0.5 if anchor == "middle" else 1.0)
    cv2.putText(image, text, (round(x), round(at[1])), colour, _face(), size, weight)


@functools.lru_cache(maxsize=2048)
def sprite(text: str, size: int, colour: Colour, weight: int = BOLD) -> Sprite:
    """Return a text with a white halo, made ready to be blended into a picture."""
    wide, high = width(text, size, weight) + 8, size + 10
    ink = np.zeros((high, wide, 3), np.uint8)
    write(ink, text, (4, high - 8), size, colour=WHITE, weight=weight)
    cover = ink[:, :, :1].astype(np.float32) / 255.0
    halo = cv2.GaussianBlur(cv2.dilate(ink[:, :, 0], np.ones((3, 3), np.uint8)), (5, 5), 0)
    opacity = np.maximum(cover, np.minimum(halo[:, :, None] / 255.0 * 1.2, 0.9))
    tint = np.floor(cover * np.array(colour, np.float32) + (1.0 - cover) * 255.0)
    return (tint * opacity).astype(np.float32), np.repeat(1.0 - opacity, 3, 2).astype(np.float32)


def size_of(picture: Sprite) -> tuple[int, int]:
    """Return the width and height of a sprite [px]."""
    return picture[0].shape[1], picture[0].shape[0]


def stamp(image: Image, picture: Sprite, left: int, top: int) -> None:
    """Blend a sprite into ``image`` with its corner at (left, top), clipped at the edges."""
    colour, transparency = picture
    high, wide = transparency.shape[:2]
    y0, y1 = max(top, 0), min(top + high, image.shape[0])
    x0, x1 = max(left, 0), min(left + wide, image.shape[1])
    if y0 >= y1 or x0 >= x1:
        return
    part = (slice(y0 - top, y1 - top), slice(x0 - left, x1 - left))
    blended = image[y0:y1, x0:x1] * transparency[part]
    blended += colour[part]
    image[y0:y1, x0:x1] = blended
