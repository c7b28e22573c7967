"""One frame of the video, put together."""

from __future__ import annotations

import numpy as np

from physim.timeline import Timeline
from physim.video.ground import ground, plain
from physim.video.layout import HEIGHT, WIDTH, Image, arrange
from physim.video.legend import signs
from physim.video.overview import Overview
from physim.video.panel import Panel
from physim.video.strip import Strip
from physim.video.view import View

LEAST_OVERVIEW = 24
"""[px] height below which the overview is left out"""


class Painter:
    """Draws frames of one run at one playback speed: the view, figures beside it and below."""

    def __init__(self, timeline: Timeline, speed: float, fps: float) -> None:
        self.timeline = timeline
        curves = timeline.curves
        view, self._panel_box, self._strip_box = arrange(curves is not None)
        world = ground(timeline)
        self._view = View(timeline, world, view, speed, fps)
        camera, shown = self._view.camera, signs(timeline, world)
        self._panel = Panel(timeline, self._panel_box, camera.scale, speed, shown)
        free = self._panel.free
        crowded = camera.whole or free.height < LEAST_OVERVIEW
        self._overview = None if crowded else Overview(plain(timeline, world), free)
        self._strip = Strip(timeline, curves, self._strip_box) if curves else None

    def frame(self, time: float) -> Image:
        """Return the picture (720, 1280, 3) uint8 RGB at ``time`` [s]."""
        now = self.timeline.at(time)
        image = np.empty((HEIGHT, WIDTH, 3), np.uint8)
        pair = self._view.paint(image, now)
        panel = self._panel_box.of(image)
        self._panel.paint(panel, now, pair)
        if self._overview is not None:
            corners = self._view.camera.corners(time)
            self._overview.paint(self._panel.free.of(panel), corners, now)
        if self._strip is not None:
            self._strip.paint(self._strip_box.of(image), now)
        return image
