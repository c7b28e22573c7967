"""Formation error or deviation of each robot over the run, drawn up to the present time.

A cross on the time axis says when a contact began, a diamond when two grazed between samples.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray, IntArray
from physim.video import marks, theme
from physim.video.camera import fixed
from physim.video.layout import Box
from physim.video.story import Curves, Story
from physim.video.text import BOLD, Image, shorten, write
from physim.video.theme import SHIFT
from physim.video.ticks import number, round_step, ticks

LEFT, TOP, BOTTOM, NAMES = 58, 30, 28, 78
"""[px] margins of the plot; NAMES is the room for names beside the last values"""
SPACING = 13
"""[px] between two names"""
LEAST = 0.03
"""Share of the run from which names are shown: before, they would fan out of one point."""
ARM = 4
"""[px] half the size of the cross on the time axis where a contact began"""


class Strip:
    """Draws the strip at any time: the full plot is drawn once and uncovered as time goes."""

    def __init__(self, story: Story, curves: Curves, box: Box) -> None:
        self._story = story
        self._curves = curves
        self._box = box
        self._wide, self._high = box.width - LEFT - NAMES, box.height - TOP - BOTTOM
        columns = 2 * self._wide + 1
        times = np.linspace(0.0, story.duration, columns)
        rows = np.stack([story.decision(i, times) for i in range(story.robots)])
        values = np.stack([curves.values(row) for row in rows])
        finite = values[np.isfinite(values)]
        top = max(float(np.abs(finite).max(initial=0.0)), 0.1) * 1.08
        low = min(float(finite.min(initial=0.0)) * 1.08, -0.15 * top)
        high = max(float(finite.max(initial=0.0)) * 1.08, 0.15 * top)
        self._range = (low, high)
        self._names = [shorten(name, theme.SMALL, NAMES - 14) for name in story.record.names]
        self._blank = self._axes()
        self._full = self._blank.copy()
        self._draw_lines(times, values)
        self._grazes = self._columns(story.contacts.swept)
        self._began = self._columns(~story.contacts.swept)
        for x in self._grazes:
            self._draw_graze(self._full, int(x))
        for x in self._began:
            self._draw_contact(self._full, int(x))

    def _columns(self, chosen: NDArray[np.bool_]) -> IntArray:
        """Return where on the time axis the chosen contacts began, each column once."""
        began = self._story.contacts.began[chosen]
        return np.unique(np.rint(self._x(began)).astype(np.int64))

    def _x(self, time: FloatArray | float) -> FloatArray:
        return LEFT + np.asarray(time) / max(self._story.duration, 1e-9) * self._wide

    def _y(self, value: FloatArray | float) -> FloatArray:
        low, high = self._range
        return TOP + (high - np.asarray(value)) / (high - low) * self._high

    def _axes(self) -> Image:
        image = np.full((self._box.height, self._box.width, 3), 255, np.uint8)
        cv2.line(image, (0, 0), (self._box.width, 0), theme.RULE, 1)
        write(image, self._curves.title, (14, 20), theme.SMALL, weight=BOLD)
        right, bottom = LEFT + self._wide, TOP + self._high
        low, high = self._range
        step = round_step(high - low, 5)
        for value in ticks(low, high, 5):
            y = int(np.rint(self._y(value)))
            colour = theme.QUIET if value == 0.0 else theme.FAINT
            cv2.line(image, (LEFT, y), (right, y), colour, 1)
            at = (LEFT - 8, y + 5)
            write(image, number(value, step), at, theme.SMALL, colour=theme.QUIET, anchor="right")
        step = round_step(self._story.duration, 8)
        for time in ticks(0.0, self._story.duration, 8):
            x = int(np.rint(self._x(time)))
            cv2.line(image, (x, bottom), (x, bottom + 4), theme.QUIET, 1)
            at = (x, bottom + 18)
            write(image, number(time, step), at, theme.SMALL, colour=theme.QUIET, anchor="middle")
        cv2.line(image, (LEFT, bottom), (right, bottom), theme.QUIET, 1)
        write(image, "time [s]", (right + 22, bottom + 18), theme.SMALL, colour=theme.INK)
        return image

    def _draw_lines(self, times: FloatArray, values: FloatArray) -> None:
        for index, line in enumerate(values):
            known = np.isfinite(line)
            points = fixed(np.column_stack((self._x(times), self._y(np.where(known, line, 0.0)))))
            breaks = np.flatnonzero(np.diff(known.astype(int))) + 1
            colour = theme.robot_colour(index)
            for piece, shown in zip(np.split(points, breaks), np.split(known, breaks), strict=True):
                if shown[0] and len(piece) > 1:
                    cv2.polylines(self._full, [piece], False, colour, 2, cv2.LINE_AA, SHIFT)

    def _draw_contact(self, image: Image, x: int) -> None:
        marks.draw_cross(image, np.array([x, TOP + self._high], dtype=np.float64), ARM, 2)

    def _draw_graze(self, image: Image, x: int) -> None:
        centre = np.array([x, TOP + self._high], dtype=np.float64)
        marks.draw_diamond(image, centre, ARM + 1, 2)

    def paint(self, image: Image, time: float, rows: IntArray) -> None:
        """Draw the strip as it is at ``time`` [s]; ``rows``: the robots' last decisions."""
        cursor = int(np.rint(self._x(time)))
        image[:] = self._blank
        image[:, : cursor + 1] = self._full[:, : cursor + 1]
        cv2.line(image, (cursor, TOP - 6), (cursor, TOP + self._high), theme.QUIET, 1)
        # whole, though half of it is still covered
        for columns, draw in (
            (self._grazes, self._draw_graze), (self._began, self._draw_contact)
        ):  # fmt: skip
            for x in columns[(columns <= cursor) & (columns > cursor - 2 * ARM - 2)]:
                draw(image, int(x))
        if time >= LEAST * self._story.duration:
            self._write_names(image, cursor, self._curves.values(rows))

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
            colour = theme.robot_colour(int(robot))
            ends = fixed(np.array([[cursor + 1.0, at], [cursor + 11.0, y]]))
            cv2.polylines(image, [ends], False, colour, 1, cv2.LINE_AA, SHIFT)
            name = self._names[robot]
            write(image, name, (cursor + 14, y + 5), theme.SMALL, colour=colour, weight=BOLD)


def spread(wanted: FloatArray, gap: float, low: float, high: float) -> FloatArray:
    """Move rising positions at least ``gap`` apart within [low, high], least in squares.

    Isotonic regression by pooling neighbours that would come too close.
    """
    steps = gap * np.arange(len(wanted))
    pools: list[tuple[float, int]] = []
    for value in (wanted - steps).tolist():
        total, count = value, 1
        while pools and pools[-1][0] / pools[-1][1] >= total / count:
            before, members = pools.pop()
            total, count = total + before, count + members
        pools.append((total, count))
    places = np.array([total / count for total, count in pools for _ in range(count)])
    top = high - gap * max(len(wanted) - 1, 0)
    moved: FloatArray = np.clip(places, low, max(low, top)) + steps
    return moved
