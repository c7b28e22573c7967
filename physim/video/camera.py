"""What part of the world the view shows: all of it, or the surroundings of the cluster."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray
from physim.video.layout import Box
from physim.video.story import Story
from physim.video.theme import SHIFT

MARGIN = 26.0
"""[px] free edge around all that must be seen"""
WHOLE = 30.0
"""[px] a world in which every robot is drawn at least this long is shown whole"""
LONG, SHORT, LARGE = 35.0, 18.0, 84.0
"""[px] length of the smallest robot: wanted at least, never below, never above"""


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
    return np.rint(np.clip(pixels, -1e6, 1e6) * (1 << SHIFT)).astype(np.int32)


class Camera:
    """Shows the world whole, or follows the cluster at a fixed scale, moving smoothly.

    The path of the camera depends on the record and the playback speed alone, so a still at a time
    equals the video's frame of that time.
    """

    def __init__(
        self, story: Story, extent: tuple[FloatArray, FloatArray], box: Box, speed: float
    ) -> None:
        self.box = box
        self.extent = extent
        low, high = extent
        size = np.maximum(high - low, 1e-6)
        room = np.array([box.width, box.height], dtype=np.float64) - 2.0 * MARGIN
        robot = smallest_length(story)
        fit = float((room / size).min())
        self.whole = fit * robot >= WHOLE
        self._times = np.zeros(1)
        self._centre = ((low + high) / 2.0)[None, :]
        self.scale = fit
        if not self.whole:
            self._follow(story, room, robot, speed)

    def _follow(self, story: Story, room: FloatArray, robot: float, speed: float) -> None:
        period = max(0.25, speed / 8.0, story.duration / 20000.0)
        count = max(2, int(np.ceil(story.duration / period)) + 1)
        self._times = np.linspace(0.0, max(story.duration, period), count)
        places = story.pose(self._times)[:, :, :2]
        reach = max(np.hypot(*part.T).max() for body in story.record.footprints for part in body)
        low, high = places.min(axis=1), places.max(axis=1)
        spread = (high - low).max(axis=0) + 2.0 * reach
        least = SHORT if (room / spread).min() * robot < LONG else LONG
        self.scale = float(np.clip((room / spread).min(), least / robot, LARGE / robot))
        centre = (low + high) / 2.0
        lost = ((high - low + 2.0 * reach) * self.scale > room + 1e-9).any(axis=1)
        centre[lost] = np.median(places[lost], axis=1)
        self._centre = _smooth(self._kept_inside(centre), max(1.0, 0.8 * speed) / period)

    def _kept_inside(self, centre: FloatArray) -> FloatArray:
        """Hold the view within the world's extent, where the world is larger than the view."""
        half = (np.array([self.box.width, self.box.height]) / 2.0 - MARGIN) / self.scale
        low, high = self.extent[0] + half, self.extent[1] - half
        middle = (low + high) / 2.0
        return np.clip(centre, np.minimum(low, middle), np.maximum(high, middle))

    def centre(self, time: float) -> FloatArray:
        """Return the centre of the view [m] at ``time`` [s]."""
        return np.array([np.interp(time, self._times, self._centre[:, k]) for k in (0, 1)])

    def corners(self, time: float) -> FloatArray:
        """Return the lower left and upper right corner (2, 2) [m] of what is seen."""
        half = np.array([self.box.width, self.box.height]) / 2.0 / self.scale
        centre = self.centre(time)
        return np.stack((centre - half, centre + half))

    def lens(self, time: float) -> Lens:
        """Return the map to pixels of the view; the world's origin falls on a whole pixel.

        So the static background can be cut from one picture of the world without resampling.
        """
        x, y = self.centre(time)
        return Lens(
            self.scale,
            float(round(self.box.width / 2.0 - x * self.scale)),
            float(round(self.box.height / 2.0 + y * self.scale)),
        )


def smallest_length(story: Story) -> float:
    """Return the largest extent of the robot whose largest extent is smallest [m]."""
    lengths = []
    for parts in story.record.footprints:
        points = np.concatenate(parts)
        hull = shapely.MultiPoint(points).minimum_rotated_rectangle
        corners = shapely.get_coordinates(hull)
        sides = np.hypot(*np.diff(corners, axis=0).T) if len(corners) > 1 else np.zeros(1)
        lengths.append(float(sides.max()))
    return max(min(lengths), 1e-6)


def _smooth(track: FloatArray, sigma: float) -> FloatArray:
    """Average a track (T, 2) with a Gaussian of ``sigma`` samples, the same forward and back."""
    half = int(np.ceil(3.0 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-half, half + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    padded = np.pad(track, ((half, half), (0, 0)), mode="edge")
    return np.column_stack([np.convolve(padded[:, k], kernel, mode="valid") for k in (0, 1)])
