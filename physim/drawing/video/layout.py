"""Sizes of the picture, and where things stand in it: view, strip below, panel to the right.

Lengths are pixels of the 1280 x 720 picture.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray

Image = NDArray[np.uint8]

WIDTH, HEIGHT = 1280, 720
PANEL_WIDTH = 272
STRIP_HEIGHT = 184

TEXT = 14
"""[px] font size of running text; 13 is the least used anywhere"""
SMALL = 13
TITLE = 17

TRAIL, SHORT_TRAIL = 10.0, 2.0
"""[s] simulated length of a trail, and of one in a crowd, where robots follow close behind"""
FLASH = 0.5
"""[s of video] length of the flash at a contact"""
MARK = 1.0
"""[s] least simulated time that the mark of a contact stays, and at least FLASH of video"""

SHIFT = 4
"""Fractional bits of the pixel coordinates given to OpenCV (1/16 px)."""
ONE = 1 << SHIFT


class Box(NamedTuple):
    """A rectangle of pixels."""

    left: int
    top: int
    width: int
    height: int

    @property
    def size(self) -> FloatArray:
        """Width and height (2,)."""
        return np.array([self.width, self.height], dtype=np.float64)

    def of(self, image: Image) -> Image:
        """Return the part of ``image`` in this box, as a view: drawing there is clipped to it."""
        return image[self.top : self.top + self.height, self.left : self.left + self.width]


def arrange() -> tuple[Box, Box, Box]:
    """Boxes of view, panel and strip, which do not overlap."""
    wide = WIDTH - PANEL_WIDTH
    high = HEIGHT - STRIP_HEIGHT
    panel = Box(wide, 0, PANEL_WIDTH, HEIGHT)
    return Box(0, 0, wide, high), panel, Box(0, high, wide, HEIGHT - high)


class Lens(NamedTuple):
    """World to pixels: scale [px/m], and the world's origin in pixels of the view (y down)."""

    scale: float
    x: float
    y: float

    def pixels(self, points: FloatArray) -> FloatArray:
        """Return points (…, 2) [m] as pixels (…, 2)."""
        return np.asarray(points) * (self.scale, -self.scale) + (self.x, self.y)

    def fixed(self, points: FloatArray) -> NDArray[np.int32]:
        """Return points (…, 2) [m] as OpenCV's fixed-point pixels (…, 2)."""
        return fixed(self.pixels(points))


def fixed(pixels: FloatArray) -> NDArray[np.int32]:
    """Return pixels as OpenCV's fixed-point numbers; far outside the picture they saturate."""
    return np.rint(np.clip(pixels, -1e6, 1e6) * ONE).astype(np.int32)
