"""Curves over the run, drawn up to the present time: least distances, or a curve a robot.

Of more than a dozen robots: their median, and bands of half and nine tenths of them. A cross on
the time axis says when a contact began, a diamond when two touched between samples.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from physim.drawing import palette
from physim.drawing.crowd import MOST_LINES, quantiles
from physim.drawing.labels import spread, ticks
from physim.drawing.timeline import Curves, Moment, Timeline
from physim.drawing.video.canvas import (
    BOLD,
    SHIFT,
    SMALL,
    Image,
    draw_contacts,
    draw_lines,
    fixed,
    shorten,
    width,
    write,
)
from physim.geometry.shapes import FloatArray

LEFT, TOP, BOTTOM, NAMES = 58, 30, 28, 78
"""[px] margins of the plot; NAMES is the room for names beside the last values"""
SPACING = 13
"""[px] between two names"""
LEAST = 0.03
"""Share of the run from which names are shown: before, they would fan out of one point."""
REACH, APART = 10, 8
"""[px] size of the mark on the time axis where a contact began, and in which there is one such
mark: more would hide each other"""
OUTER, INNER = 0.25, 0.6
"""Share of colour in the bands of nine tenths and of half of the robots"""


class Strip:
    """Draws the strip at any time: the full plot is drawn once and uncovered as time goes."""

    def __init__(self, timeline: Timeline, curves: Curves, image: Image) -> None:
        """``image`` keeps what is painted in it, from one moment to the next."""
        self._timeline, self._curves, self._image = timeline, curves, image
        high, wide = image.shape[:2]
        self._wide, self._high = wide - LEFT - NAMES, high - TOP - BOTTOM
        times = np.linspace(timeline.begin, timeline.duration, 2 * self._wide + 1)
        shown = timeline.shown(times)
        if curves is timeline.distances:  # the least until the next column; both lines seen at it
            values = np.minimum.reduceat(curves.values, shown).T
            seen = np.append(values.min(axis=0), 2.0 * values.min(axis=1))
        else:
            seen = values = curves.values[shown].T
        finite = seen[np.isfinite(seen)]
        top = max(float(np.abs(finite).max(initial=0.0)), 0.1) * 1.08
        self._low = min(float(finite.min(initial=0.0)) * 1.08, -0.15 * top)
        self._top = max(float(finite.max(initial=0.0)) * 1.08, 0.15 * top)
        self._each = len(curves.names) <= MOST_LINES
        self._names = [shorten(name, SMALL, NAMES - 14) for name in curves.names]
        self._blank = self._axes()
        self._full = self._blank.copy()
        self._draw_curves(times, values)
        self._full[:TOP] = self._blank[:TOP]  # what lies above the axis
        swept, x = timeline.contacts.swept, np.rint(self._x(timeline.contacts.began)).astype(int)
        _, first = np.unique([~swept, x // APART], axis=1, return_index=True)
        self._marks = list(zip(x[first].tolist(), swept[first].tolist(), strict=True))
        for at, is_swept in self._marks:
            self._mark(self._full, at, is_swept)
        self._shown: tuple[int, list[tuple[int, int, int]]] = (0, [])
        image[:] = self._blank

    def _x(self, time: FloatArray | float) -> FloatArray:
        begin, end = self._timeline.begin, self._timeline.duration
        return np.asarray(LEFT + (time - begin) / max(end - begin, 1e-9) * self._wide)

    def _y(self, value: FloatArray | float) -> FloatArray:
        return np.asarray(TOP + (self._top - value) / (self._top - self._low) * self._high)

    def _axes(self) -> Image:
        image = np.full(self._image.shape, 255, np.uint8)
        cv2.line(image, (0, 0), (self._image.shape[1], 0), palette.RULE, 1)
        title, left = self._curves.title, 14
        write(image, title, (left, 20), SMALL, weight=BOLD)
        left += width(title, SMALL, BOLD) + 20
        bands = (("median", 1, 1.0), ("50 %", 5, INNER), ("90 %", 5, OUTER))
        for words, half, share in () if self._each else bands:
            shade = palette.mix(palette.WHITE, palette.BAND, share)
            cv2.rectangle(image, (left, 15 - half), (left + 18, 15 + half), shade, cv2.FILLED)
            write(image, words, (left + 23, 20), SMALL)
            left += 23 + width(words, SMALL) + 12
        right, bottom, grey = LEFT + self._wide, TOP + self._high, palette.QUIET
        for value, words in ticks(self._low, self._top, 5):
            y = round(float(self._y(value)))
            cv2.line(image, (LEFT, y), (right, y), palette.FAINT if value else grey, 1)
            write(image, words, (LEFT - 8, y + 5), SMALL, colour=grey, anchor="right")
        for time, words in ticks(self._timeline.begin, self._timeline.duration, 8):
            x = round(float(self._x(time)))
            cv2.line(image, (x, bottom), (x, bottom + 4), grey, 1)
            write(image, words, (x, bottom + 18), SMALL, colour=grey, anchor="middle")
        cv2.line(image, (LEFT, bottom), (right, bottom), grey, 1)
        write(image, "time [s]", (right + 16, bottom + 18), SMALL)
        return image

    def _draw_curves(self, times: FloatArray, values: FloatArray) -> None:
        """Draw values (N, T) of the robots, a line each or, of many, bands."""
        colours = self._curves.colours
        lines = [(line, colour, 2) for line, colour in zip(values, colours, strict=True)]
        if not self._each:
            found = quantiles(values.T)
            for low, high, share in ((1, -2, OUTER), (2, -3, INNER)):
                colour = palette.mix(palette.WHITE, palette.BAND, share)
                pieces = (self._pieces(times, found[k]) for k in (low, high))
                for below, above in zip(*pieces, strict=True):
                    outline = np.concatenate((below, above[::-1]))
                    cv2.fillPoly(self._full, [outline], colour, cv2.LINE_AA, SHIFT)
            ink, band = palette.INK, palette.BAND
            lines = [(found[0], ink, 1), (found[-1], ink, 1), (found[3], band, 2)]
        for line, colour, wide in lines:
            for piece in self._pieces(times, line):
                draw_lines(self._full, piece[None], colour, wide)

    def _pieces(self, times: FloatArray, line: FloatArray) -> list[NDArray[np.int32]]:
        """Known pieces (n, 2) of a line (T,), in fixed-point pixels."""
        known = np.isfinite(line)
        points = fixed(np.column_stack((self._x(times), self._y(np.where(known, line, 0.0)))))
        breaks = np.flatnonzero(np.diff(known)) + 1
        pieces = zip(np.split(points, breaks), np.split(known, breaks), strict=True)
        return [piece for piece, is_known in pieces if is_known[0] and len(piece) > 1]

    def _mark(self, image: Image, x: int, swept: bool) -> None:
        draw_contacts(image, np.array([[x, TOP + self._high]]), swept, small=True)

    def paint(self, now: Moment) -> None:
        """Show one moment; only what is near the cursor, before and now, is drawn anew."""
        image, cursor = self._image, round(float(self._x(now.time)))
        begin, end = self._timeline.begin, self._timeline.duration
        named = now.time - begin >= LEAST * (end - begin)
        names = self._place_names(now) if named else []
        if (cursor, names) == self._shown:
            return
        before, self._shown = self._shown[0], (cursor, names)
        left, right = max(min(cursor, before) - 2 * REACH, 0), max(cursor, before) + NAMES + LEFT
        image[:, left:right] = self._blank[:, left:right]
        image[:, left : cursor + 1] = self._full[:, left : cursor + 1]
        cv2.line(image, (cursor, TOP - 6), (cursor, TOP + self._high), palette.QUIET, 1)
        for x, swept in self._marks:
            if cursor - REACH < x <= cursor:  # whole, though half of it is still covered
                self._mark(image, x, swept)
        for robot, at, y in names:
            colour = self._curves.colours[robot] if self._each else palette.INK
            cv2.line(image, (cursor + 1, at), (cursor + 11, y), colour, 1, cv2.LINE_AA)
            name = self._names[robot]
            write(image, name, (cursor + 14, y + 5), SMALL, colour=colour, weight=BOLD)

    def _place_names(self, now: Moment) -> list[tuple[int, int, int]]:
        """Robots that are named at the line ends, and heights [px] of line ends and names.

        Names are moved apart; of a crowd those of the greatest and the least are there.
        """
        values = self._curves.values[now.sample]
        known = np.flatnonzero(np.isfinite(values))
        named = known[np.argsort(-values[known], kind="stable")]
        if not self._each:
            named = named[[0, -1][: len(named)]]
        wanted = np.maximum(self._y(values[named]), TOP)
        limits = (TOP - 4.0 + SPACING / 2.0, TOP + self._high - SPACING / 2.0)
        places = np.rint((wanted, spread(wanted, SPACING, *limits))).astype(int).tolist()
        return list(zip(named.tolist(), *places, strict=True))
