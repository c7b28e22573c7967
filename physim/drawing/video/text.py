"""Text of pictures: Pillow draws it in DejaVu Sans, which comes with matplotlib.

Of a character that this font lacks, such as a Chinese one, the first font of the system that has it
is taken; where none does, a box stands for it. Lengths are pixels.
"""

from __future__ import annotations

import functools
import math
import re
from contextlib import suppress
from itertools import groupby
from typing import NamedTuple

import matplotlib
import numpy as np
from matplotlib.ft2font import FT2Font
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFilter, ImageFont

from physim.drawing import palette
from physim.drawing.labels import shortened
from physim.drawing.palette import Colour

TEXT, SMALL, NAME, TITLE = 13, 12, 14, 16
"""Font sizes; the second is the least used anywhere, the third is that of names in the view"""
NORMAL, BOLD = "DejaVuSans", "DejaVuSans-Bold"
"""Fonts."""
LEFT, ABOVE, BELOW = 4, 2, 8
"""Room beside a text for its halo, above its font size, and below its baseline"""
HALO = 230
"""Greatest opacity of a halo, of 255"""

CLEAR = np.repeat(np.linspace(1.0, 0.0, 256, dtype=np.float32)[:, None], 4, axis=1)
"""Transparency (256, 4) of red, green, blue and 255 by opacity."""


class Sprite(NamedTuple):
    """A text ready to be blended into a picture; arrays are (h, w, 4)."""

    colour: NDArray[np.float32]
    """red, green, blue and 255, times opacity"""
    transparency: NDArray[np.float32]
    """from 0 to 1"""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [px]."""
        return self.colour.shape[1], self.colour.shape[0]


@functools.lru_cache(maxsize=4096)
def width(text: str, size: int, weight: str = NORMAL) -> int:
    """Return the width of ``text`` [px] at font size ``size`` [px]."""
    return math.ceil(sum(piece.advance for piece in _pieces(text, size, weight)))


@functools.lru_cache(maxsize=4096)
def shorten(text: str, size: int, room: int, weight: str = NORMAL) -> str:
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


@functools.lru_cache(maxsize=512)
def sprite(
    text: str, size: int, colour: Colour, weight: str = NORMAL, halo: bool = False
) -> Sprite:
    """Return a text as a picture, from `LEFT` of it to `BELOW` its baseline."""
    shape = size + ABOVE + BELOW, width(text, size, weight) + 2 * LEFT
    cover, around, x = np.zeros(shape, np.uint8), np.zeros(shape, np.uint8), 0.0
    for piece in _pieces(text, size, weight):
        for whole, part in ((cover, piece.cover), (around, piece.halo))[: 1 + halo]:
            place = whole[:, round(x) : round(x) + part.shape[1]]
            np.maximum(place, part[:, : place.shape[1]], out=place)
        x += piece.advance
    tint = _shades(colour).take(cover, axis=0)
    tint += 0.5  # to round where the sum is cut to a whole number
    if not halo:
        return Sprite(tint, CLEAR.take(cover, axis=0))
    tint += _shades(palette.WHITE).take(around - cover, axis=0)
    return Sprite(tint, CLEAR.take(around, axis=0))


class Piece(NamedTuple):
    """A part of a text as a picture: arrays (h, w) from 0 to 255, from `LEFT` of it."""

    cover: NDArray[np.uint8]
    halo: NDArray[np.uint8]
    """opacity of the piece and its halo"""
    advance: float
    """to the next piece [px]"""


@functools.lru_cache(maxsize=512)
def _pieces(text: str, size: int, weight: str) -> tuple[Piece, ...]:
    """Digits one by one, since numbers change from frame to frame, and what is between them.

    Bold letters are wider, so they are a size smaller.
    """
    return tuple(
        _piece("".join(run), file, size, size - (weight == BOLD))
        for part in re.findall(r"[0-9]|[^0-9]+", text)
        for file, run in groupby(part, lambda character: _file(character, weight))
    )


@functools.lru_cache(maxsize=2048)
def _piece(text: str, file: str, size: int, letters: int) -> Piece:
    font = _font(file, letters)
    advance = font.getlength(text)
    picture = Image.new("L", (math.ceil(advance) + 2 * LEFT, size + ABOVE + BELOW))
    ImageDraw.Draw(picture).text((LEFT, size + ABOVE), text, fill=255, font=font, anchor="ls")
    soft = picture.filter(ImageFilter.MaxFilter(3)).filter(ImageFilter.GaussianBlur(1.1))
    cover = np.asarray(picture)
    return Piece(cover, np.maximum(cover, np.minimum(np.asarray(soft), HALO)), advance)


@functools.lru_cache(maxsize=64)
def _shades(colour: Colour) -> NDArray[np.float32]:
    """A colour and 255, times opacities from 0 to 1 in 256 steps: (256, 4)."""
    return np.outer(np.arange(256) / 255.0, (*colour, 255)).astype(np.float32)


@functools.lru_cache(maxsize=64)
def _font(file: str, size: int) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(file, size)


@functools.lru_cache(maxsize=4096)
def _file(character: str, weight: str) -> str:
    own = f"{matplotlib.get_data_path()}/fonts/ttf/{weight}.ttf"
    if ord(character) in _characters(own):
        return own
    return next((file for file in _system() if ord(character) in _characters(file)), own)


@functools.cache
def _system() -> list[str]:
    from matplotlib.font_manager import findSystemFonts  # asks the system, so when needed

    return sorted(findSystemFonts())


@functools.cache
def _characters(file: str) -> frozenset[int]:
    with suppress(RuntimeError, OSError):  # a font that cannot be read has none
        return frozenset(FT2Font(file).get_charmap())
    return frozenset()
