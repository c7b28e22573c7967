"""Pictures in 255 colours: those of the palette exactly, and of blended edges the nearest.

What counts in a drawing is rare: the colour of a contact, of a sign in the legend. Methods that
choose colours by how many pixels have them lose these, so they are given, and kept.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.drawing.palette import Colour
from physim.drawing.video.layout import Image
from physim.geometry.shapes import FloatArray, IntArray

MOST = 255
"""Colours; one more says that a pixel stays as it was."""
FLAT = 100
"""Colours that are taken for how many pixels have them; the others fill the gaps in between."""
COARSE = 8
"""Levels of a colour that are one where gaps are looked for."""


def chosen_colours(samples: Iterable[Image], kept: Sequence[Colour]) -> NDArray[np.uint8]:
    """Return at most `MOST` colours (n, 3) for pictures like ``samples``, ``kept`` among them."""
    codes = [np.unique(_codes(sample), return_counts=True) for sample in samples]
    every = np.concatenate([code for code, _ in codes])
    code, place = np.unique(every, return_inverse=True)
    count = np.bincount(place, np.concatenate([number for _, number in codes]))
    flat = code[np.argsort(-count, kind="stable")[:FLAT]]
    own = np.array([red << 16 | green << 8 | blue for red, green, blue in kept], dtype=np.int64)
    first = list(dict.fromkeys([*own.tolist(), *flat.tolist()]))[:MOST]
    return _filled(first, code, count)


def _filled(first: Sequence[int], code: IntArray, count: NDArray[Any]) -> NDArray[np.uint8]:
    """Add, one by one, the colour that most pixels are farthest from."""
    rgb = _levels(code)
    _, cell = np.unique(rgb // COARSE @ np.array([65536, 256, 1]), return_inverse=True)
    weight = np.bincount(cell, count)
    middle = np.stack([np.bincount(cell, count * rgb[:, k]) for k in range(3)], axis=1)
    middle = np.rint(middle / weight[:, None])
    found = [_levels(np.array(first))]
    distance = _squares(middle, found[0]).min(axis=1)
    for _ in range(MOST - len(first)):
        worst = int(np.argmax(weight * distance))
        if distance[worst] == 0.0:
            break
        found.append(middle[worst][None])
        distance = np.minimum(distance, _squares(middle, found[-1])[:, 0])
    return np.concatenate(found).astype(np.uint8)


class Indexer:
    """Turns pictures into numbers of colours (n, 3), each pixel into that of the nearest."""

    def __init__(self, colours: NDArray[np.uint8]) -> None:
        self._colours = colours.astype(np.float64)
        self._number = np.full(1 << 24, -1, dtype=np.int16)  # by the code of a colour

    def __call__(self, image: Image) -> NDArray[np.uint8]:
        """Return the numbers (h, w) of the colours of a picture (h, w, 3)."""
        codes = _codes(image)
        unknown = np.unique(codes[self._number[codes] < 0])
        for some in np.array_split(unknown, len(unknown) // 4096 + 1):
            self._number[some] = np.argmin(_squares(_levels(some), self._colours), axis=1)
        return self._number[codes].astype(np.uint8).reshape(image.shape[:2])


def _codes(image: Image) -> IntArray:
    """Return one number for the colour of each pixel (h w,)."""
    red, green, blue = np.moveaxis(image.reshape(-1, 3).astype(np.int64), 1, 0)
    return np.asarray(red << 16 | green << 8 | blue)


def _levels(code: IntArray) -> FloatArray:
    """Return red, green and blue (n, 3) of codes (n,)."""
    return np.stack((code >> 16, code >> 8 & 255, code & 255), axis=1).astype(np.float64)


def _squares(some: NDArray[Any], others: NDArray[Any]) -> FloatArray:
    """Return the squared distances (n, m) of colours, green counting most, as for the eye."""
    weight = np.sqrt(np.array([0.3, 0.59, 0.11]))
    a, b = some * weight, others * weight
    return np.asarray(
        np.maximum((a * a).sum(1)[:, None] + (b * b).sum(1) - 2.0 * a @ b.T, 0.0).round(6)
    )
