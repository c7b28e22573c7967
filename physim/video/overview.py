"""The whole world, small, with the place of the view and of every robot."""

from __future__ import annotations

import cv2
import numpy as np

from physim import palette
from physim.geometry.shapes import FloatArray
from physim.timeline import Moment
from physim.video.background import draw_ground
from physim.video.ground import Ground
from physim.video.layout import ONE, SHIFT, Box, Image, Lens


class Overview:
    """Fits a ground into a box, which is drawn once."""

    def __init__(self, ground: Ground, box: Box) -> None:
        low, high = ground.extent
        size = np.maximum(high - low, 1e-6)
        room = box.size
        scale = float(((room - 10.0) / size).min())
        corner = room / 2.0 + np.array([-0.5, 0.5]) * (low + high) * scale
        self._lens = Lens(scale, float(corner[0]), float(corner[1]))
        self._ground = np.empty((box.height, box.width, 3), np.uint8)
        draw_ground(self._ground, ground, self._lens)

    def paint(self, image: Image, corners: FloatArray, now: Moment) -> None:
        """Draw the ground, the view's rectangle (two ``corners`` (2, 2) [m]) and the robots."""
        image[:] = self._ground
        radius = int(2.6 * ONE)
        for place, colour in zip(self._lens.fixed(now.pose[:, :2]), now.colours, strict=True):
            cv2.circle(image, place.tolist(), radius, colour, cv2.FILLED, cv2.LINE_AA, SHIFT)
        (x0, y0), (x1, y1) = np.rint(self._lens.pixels(corners)).astype(int).tolist()
        cv2.rectangle(image, (x0, y0), (x1, y1), palette.INK, 1)
        cv2.rectangle(image, (0, 0), (image.shape[1] - 1, image.shape[0] - 1), palette.RULE, 1)
