"""Formation error or deviation of each robot over the run, drawn up to the present time.

A cross on the time axis says when a contact began, a diamond when two touched between samples.
"""

from __future__ import annotations

import cv2
import numpy as np

from physim.drawing import palette
from physim.drawing.labels import spread, ticks
from physim.drawing.timeline import Curves, Moment, Timeline
from physim.drawing.video.layout import SMALL, Box, Image, fixed
from physim.drawing.video.marks import draw_contact, draw_lines
from physim.drawing.video.text import BOLD, shorten, write
from physim.geometry.shapes import FloatArray

LEFT, TOP, BOTTOM, NAMES = 58, 30, 28, 78
"""[px] margins of the plot; NAMES is the room for names beside the last values"""
SPACING = 13
"""[px] between two names"""
LEAST = 0.03
"""Share of the run from which names are shown: before, they would fan out of one point."""
REACH = 10
"""[px] size of the mark on the time axis where a contact began"""


class Strip:
    """Draws the strip at any time: the full plot is drawn once and uncovered as time goes."""

    def __init__(self, timeline: Timeline, curves: Curves, box: Box) -> None:
        self._timeline = timeline
        self._curves = curves
        self._box = box
        self._wide, self._high = box.width - LEFT - NAMES, box.height - TOP - BOTTOM
        columns = 2 * self._wide + 1
        times = np.linspace(0.0, timeline.duration, columns)
        values = timeline.values(curves.column, timeline.decisions(times)).T
        finite = values[np.isfinite(values)]
        top = max(float(np.abs(finite).max(initial=0.0)), 0.1) * 1.08
        low = min(float(finite.min(initial=0.0)) * 1.08, -0.15 * top)
        high = max(float(finite.max(initial=0.0)) * 1.08, 0.15 * top)
        self._range = (low, high)
        self._names = [shorten(name, SMALL, NAMES - 14) for name in timeline.record.names]
        self._blank = self._axes()
        self._full = self._blank.copy()
        self._draw_lines(times, values)
        columns = np.rint(self._x(timeline.contacts.began)).astype(int).tolist()
        found = set(zip(~timeline.contacts.swept, columns, strict=True))
        self._marks = [(x, not contact) for contact, x in sorted(found)]
        for x, swept in self._marks:
            self._mark(self._full, x, swept)

    def _x(self, time: FloatArray | float) -> FloatArray:
        return LEFT + np.asarray(time) / max(self._timeline.duration, 1e-9) * self._wide

    def _y(self, value: FloatArray | float) -> FloatArray:
        low, high = self._range
        return TOP + (high - np.asarray(value)) / (high - low) * self._high

    def _axes(self) -> Image:
        image = np.full((self._box.height, self._box.width, 3), 255, np.uint8)
        cv2.line(image, (0, 0), (self._box.width, 0), palette.RULE, 1)
        write(image, self._curves.title, (14, 20), SMALL, weight=BOLD)
        right, bottom = LEFT + self._wide, TOP + self._high
        low, high = self._range
        for value, words in ticks(low, high, 5):
            y = int(np.rint(self._y(value)))
            colour = palette.QUIET if value == 0.0 else palette.FAINT
            cv2.line(image, (LEFT, y), (right, y), colour, 1)
            at = (LEFT - 8, y + 5)
            write(image, words, at, SMALL, colour=palette.QUIET, anchor="right")
        for time, words in ticks(0.0, self._timeline.duration, 8):
            x = int(np.rint(self._x(time)))
            cv2.line(image, (x, bottom), (x, bottom + 4), palette.QUIET, 1)
            at = (x, bottom + 18)
            write(image, words, at, SMALL, colour=palette.QUIET, anchor="middle")
        cv2.line(image, (LEFT, bottom), (right, bottom), palette.QUIET, 1)
        write(image, "time [s]", (right + 22, bottom + 18), SMALL, colour=palette.INK)
        return image

    def _draw_lines(self, times: FloatArray, values: FloatArray) -> None:
        for index, line in enumerate(values):
            known = np.isfinite(line)
            points = fixed(np.column_stack((self._x(times), self._y(np.where(known, line, 0.0)))))
            breaks = np.flatnonzero(np.diff(known)) + 1
            for piece, is_known in zip(
                np.split(points, breaks), np.split(known, breaks), strict=True
            ):
                if is_known[0] and len(piece) > 1:
                    draw_lines(self._full, piece[None], palette.robot_colour(index), 2)

    def _mark(self, image: Image, x: int, swept: bool) -> None:
        draw_contact(image, np.array([x, TOP + self._high]), swept, small=True)

    def paint(self, image: Image, now: Moment) -> None:
        """Draw the strip as it is at one moment."""
        cursor = int(np.rint(self._x(now.time)))
        image[:] = self._blank
        image[:, : cursor + 1] = self._full[:, : cursor + 1]
        cv2.line(image, (cursor, TOP - 6), (cursor, TOP + self._high), palette.QUIET, 1)
        for x, swept in self._marks:
            if cursor - REACH < x <= cursor:  # whole, though half of it is still covered
                self._mark(image, x, swept)
        if now.time >= LEAST * self._timeline.duration:
            self._write_names(
                image, cursor, self._timeline.values(self._curves.column, now.decisions)
            )

    def _write_names(self, image: Image, cursor: int, values: FloatArray) -> None:
        """Names at the line ends, moved apart; of many robots those farthest from 0."""
        low, high = TOP - 4.0, float(TOP + self._high)
        room = int((high - low) // SPACING)
        known = np.flatnonzero(np.isfinite(values))
        named = known[np.argsort(-np.abs(values[known]), kind="stable")][:room]
        named = named[np.argsort(-values[named], kind="stable")]
        wanted = np.asarray(self._y(values[named]), dtype=np.float64)
        limits = (low + SPACING / 2.0, high - SPACING / 2.0)
        for robot, at, y in zip(named, wanted, spread(wanted, SPACING, *limits), strict=True):
            colour = palette.robot_colour(int(robot))
            ends = fixed(np.array([[cursor + 1.0, at], [cursor + 11.0, y]]))
            draw_lines(image, ends[None], colour, 1)
            name = self._names[robot]
            write(image, name, (cursor + 14, y + 5), SMALL, colour=colour, weight=BOLD)
