"""One frame of the video, put together."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from physim.video import legend, theme
from physim.video.ground import ground, plain
from physim.video.layout import arrange
from physim.video.overview import Overview
from physim.video.panel import Now, Panel
from physim.video.story import Story
from physim.video.strip import Strip
from physim.video.text import Image
from physim.video.view import View

if TYPE_CHECKING:
    from physim.record import Record

LEAST_OVERVIEW = 24
"""[px] height below which the overview is left out"""


class Painter:
    """Draws frames of one record at one playback speed: the view, figures beside it and below."""

    def __init__(self, record: Record, speed: float, fps: float) -> None:
        self.story = Story(record)
        curves = self.story.curves
        self._layout = arrange(curves is not None)
        world = ground(self.story)
        self._view = View(self.story, world, self._layout.view, speed, fps)
        camera = self._view.camera
        shown = legend.signs(self.story, world)
        self._panel = Panel(self.story, self._layout.panel, camera.scale, speed, shown)
        free = self._panel.free
        crowded = camera.whole or free.height < LEAST_OVERVIEW
        self._overview = None if crowded else Overview(plain(self.story, world), free)
        strip = self._layout.strip
        self._strip = Strip(self.story, curves, strip) if curves and strip else None

    def frame(self, time: float) -> Image:
        """Return the picture (720, 1280, 3) uint8 RGB at ``time`` [s]."""
        story, record = self.story, self.story.record
        sample = int(story.sample(time))
        pose = story.pose(time)
        rows = story.decisions(time)
        image = np.empty((theme.HEIGHT, theme.WIDTH, 3), np.uint8)
        pair = self._view.paint(image, time)
        depth = float(np.min(record.clearance[sample]))
        wall = float(np.min(record.boundary_clearance[sample]))
        deviation = float(story.deviations(rows)[0])
        touched = story.contacts.count(time), story.contacts.grazes(time)
        now = Now(
            time, touched[0] - touched[1], touched[1], pair, depth, wall, story.modes(rows),
            story.arrived(time), deviation,
        )  # fmt: skip
        panel = self._layout.panel.of(image)
        self._panel.paint(panel, now)
        if self._overview is not None:
            corners = self._view.camera.corners(time)
            free = self._panel.free.of(panel)
            self._overview.paint(free, corners, pose[:, :2], story.colours(rows))
        if self._strip is not None and self._layout.strip is not None:
            self._strip.paint(self._layout.strip.of(image), time, rows)
        return image
