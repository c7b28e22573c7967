"""The last picture of a run: where all robots went, where they touched, how they ended.

A view that follows the cluster would show little else than the end of the road.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from physim.drawing import palette
from physim.drawing.crowd import NAMED
from physim.drawing.labels import grown, overlaps
from physim.drawing.palette import Colour
from physim.drawing.timeline import Moment, Timeline
from physim.drawing.video.camera import MARGIN
from physim.drawing.video.ending import notes
from physim.drawing.video.ground import Ground, draw_ground
from physim.drawing.video.layout import TEXT, Box, Image, Lens, fixed
from physim.drawing.video.marks import Fleet, draw_contacts, draw_disc, draw_lines, draw_robots
from physim.drawing.video.text import NORMAL, shorten, size_of, sprite, stamp
from physim.geometry.shapes import FloatArray

POINTS = 1500
"""Points of a course, at most."""
TINY = 9.0
"""[px] length of a robot below which a dot stands for it"""
DOT = 3.5
"""[px] radius of that dot"""
LINE = TEXT + 6
"""[px] from one line of words to the next"""
EDGE = 10
"""[px] round the words"""
WIDEST = 0.7
"""Share of the view that a line of words may take"""
LEAST = 560
"""[px] and more where a view is narrow"""


class Closing:
    """Draws the world whole as a run leaves it, in the box of a view."""

    def __init__(self, timeline: Timeline, ground: Ground, box: Box) -> None:
        self._timeline, self._ground, self._box = timeline, ground, box
        low, high = ground.extent
        size = np.maximum(high - low, 1e-6)
        self.scale = scale = float(((box.size - 2.0 * MARGIN) / size).min())
        x, y = box.size / 2.0 + np.array([-0.5, 0.5]) * (low + high) * scale
        self._lens = Lens(scale, float(round(x)), float(round(y)))

    def paint(self, view: Image, now: Moment, fleet: Fleet) -> None:
        """Draw the last moment; ``fleet`` are the robots."""
        timeline, lens = self._timeline, self._lens
        draw_ground(view, self._ground, lens)
        crowd = timeline.robots > NAMED
        for robot, course in enumerate(self._courses()):
            colour = palette.BAND if crowd else palette.robot_colour(robot)
            draw_lines(view, fixed(lens.pixels(course))[None], colour, 1 if crowd else 2)
        self._draw_robots(view, now, fleet)
        contacts = timeline.contacts
        if len(contacts.began):
            places = lens.pixels(contacts.places[contacts.first])
            for swept in (True, False):
                draw_contacts(view, places[contacts.swept == swept], swept, small=True)
            draw_contacts(view, places[np.isfinite(contacts.deep)], False, deep=True)
        title = f"the whole run, {timeline.duration:.1f} s: where the robots went"
        boxes = fleet.boxes(lens.fixed(fleet.placed(now.pose)))
        write_corner(view, [title, *notes(timeline)], grown(boxes, DOT))

    @property
    def corners(self) -> FloatArray:
        """The lower left and upper right corner (2, 2) [m] of what is seen."""
        lens, (wide, high) = self._lens, self._box.size
        return np.array([[-lens.x, lens.y - high], [wide - lens.x, lens.y]]) / lens.scale

    def _courses(self) -> FloatArray:
        """Where the robots went, (N, T, 2) [m]."""
        record = self._timeline.record
        rows = np.unique(np.linspace(0, len(record.pose) - 1, POINTS).astype(int))
        return np.asarray(record.pose[rows][:, :, :2].transpose(1, 0, 2))

    def _draw_robots(self, view: Image, now: Moment, fleet: Fleet) -> None:
        """Robots in the colours of their modes; dots where they would be tiny."""
        lens, touching = self._lens, self._timeline.contacts.touching(now.time, len(now.pose))
        if 2.0 * float(self._timeline.scene.reach.max()) * lens.scale >= TINY:
            outlines = fleet.split(lens.fixed(fleet.placed(now.pose)))
            draw_robots(view, outlines, now.colours, touching.tolist())
            return
        edges: list[Colour] = [palette.CONTACT if touch else palette.INK for touch in touching]
        for place, colour, edge in zip(
            lens.fixed(now.pose[:, :2]), now.colours, edges, strict=True
        ):
            draw_disc(view, place, DOT, edge)
            draw_disc(view, place, 2.5, colour)


def write_corner(view: Image, lines: Sequence[str], bodies: FloatArray) -> None:
    """Write lines, the first one bold, at the side of a view where they cover the least.

    First of ``bodies``, boxes (N, 4) [px] of the robots they speak of, then of all that is drawn;
    in a corner where that covers no more.
    """
    high, wide = view.shape[:2]
    room = max(round(WIDEST * wide), min(wide - 2 * EDGE, LEAST))
    words = [
        sprite(shorten(line, TEXT, room), TEXT, palette.INK, *(() if k == 0 else (NORMAL,)))
        for k, line in enumerate(lines)
    ]
    width = max(size_of(word)[0] for word in words)
    tall = LINE * len(words)
    lefts, ends = (EDGE, wide - EDGE - width), (EDGE, high - EDGE - tall)
    tops = (*ends, *range(EDGE, max(ends), LINE))
    empty = (view == palette.OUTSIDE).all(axis=2)

    def covered(place: tuple[int, int]) -> tuple[float, int, bool]:
        left, top = place
        box = np.array([[left, top, left + width, top + tall]], float)
        hidden = float(overlaps(box, bodies).sum())
        drawn = int((~empty[top : top + tall, left : left + width]).sum())
        return hidden, drawn, top not in ends

    left, top = min(((x, y) for y in tops for x in lefts), key=covered)
    for k, word in enumerate(words):
        stamp(view, word, left, top + k * LINE)
