"""What part of the world the view shows: all of it, or the surroundings of the cluster."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import cv2
import numpy as np
import shapely

from physim.drawing.timeline import Timeline
from physim.drawing.video.layout import Box, Lens
from physim.geometry.shapes import FloatArray

MARGIN = 26.0
"""[px] free edge around all that must be seen"""
WHOLE = 30.0
"""[px] a world in which every robot is drawn at least this long is shown whole"""
LONG, SHORT, LARGE = 35.0, 18.0, 84.0
"""[px] length of the smallest robot: wanted at least, never below, never above"""


class Camera:
    """Shows the world whole, or follows the cluster at a fixed scale, moving smoothly.

    The path of the camera depends on the record and the playback speed alone, so a still at a time
    equals the video's frame of that time.
    """

    def __init__(
        self,
        timeline: Timeline,
        extent: tuple[FloatArray, FloatArray],
        box: Box,
        speed: float,
        most: float = inf,
    ) -> None:
        """``extent`` [m] are the lowest and highest x and y of the ground; ``most`` [px/m]."""
        self.box = box
        self.extent = extent
        low, high = extent
        size = np.maximum(high - low, 1e-6)
        room = box.size - 2.0 * MARGIN
        robot = smallest_length(timeline)
        fit = float((room / size).min())
        self.whole = fit * robot >= WHOLE
        self._times = np.zeros(1)
        self._centre = ((low + high) / 2.0)[None, :]
        self.scale = min(fit, most)
        if not self.whole:
            self._follow(timeline, room, robot, speed, most)

    def _follow(
        self, timeline: Timeline, room: FloatArray, robot: float, speed: float, most: float
    ) -> None:
        period = max(0.25, speed / 8.0, timeline.duration / 20000.0)
        count = max(2, int(np.ceil(timeline.duration / period)) + 1)
        self._times = np.linspace(0.0, max(timeline.duration, period), count)
        places = timeline.pose(self._times)[:, :, :2]
        reach = timeline.scene.reach.max()
        low, high = places.min(axis=1), places.max(axis=1)
        spread = (high - low).max(axis=0) + 2.0 * reach
        least = SHORT if (room / spread).min() * robot < LONG else LONG
        self.scale = float(np.clip((room / spread).min(), least / robot, LARGE / robot))
        self.scale = min(self.scale, most)
        centre = (low + high) / 2.0
        lost = ((high - low + 2.0 * reach) * self.scale > room + 1e-9).any(axis=1)
        centre[lost] = np.median(places[lost], axis=1)
        self._centre = _smooth(self._kept_inside(centre), max(1.0, 0.8 * speed) / period)

    def _kept_inside(self, centre: FloatArray) -> FloatArray:
        """Hold the view within the world's extent, where the world is larger than the view."""
        half = (self.box.size / 2.0 - MARGIN) / self.scale
        low, high = self.extent[0] + half, self.extent[1] - half
        middle = (low + high) / 2.0
        return np.clip(centre, np.minimum(low, middle), np.maximum(high, middle))

    def centre(self, time: float) -> FloatArray:
        """Return the centre of the view [m] at ``time`` [s]."""
        return np.array([np.interp(time, self._times, self._centre[:, k]) for k in (0, 1)])

    def corners(self, time: float) -> FloatArray:
        """Return the lower left and upper right corner (2, 2) [m] of what is seen."""
        half = self.box.size / 2.0 / self.scale
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


def common_scale(cameras: Sequence[Camera], timelines: Sequence[Timeline]) -> float:
    """Largest scale [px/m] that all cameras can have; inf where a robot would be too small."""
    scale = min(camera.scale for camera in cameras)
    return scale if min(map(smallest_length, timelines)) * scale >= SHORT else inf


def smallest_length(timeline: Timeline) -> float:
    """Return the largest extent of the robot whose largest extent is smallest [m]."""
    lengths = []
    for parts in timeline.scene.footprints:
        hull = shapely.MultiPoint(np.concatenate(parts)).minimum_rotated_rectangle
        corners = shapely.get_coordinates(hull)
        sides = np.hypot(*np.diff(corners, axis=0).T) if len(corners) > 1 else np.zeros(1)
        lengths.append(float(sides.max()))
    return max(min(lengths), 1e-6)


def _smooth(track: FloatArray, sigma: float) -> FloatArray:
    """Average a track (T, 2) with a Gaussian of ``sigma`` samples, the same forward and back."""
    size = 1, 2 * int(np.ceil(3.0 * sigma)) + 1
    smooth = cv2.GaussianBlur(track, size, sigma, sigmaY=sigma, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(smooth, dtype=np.float64)
