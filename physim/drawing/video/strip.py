"""Curves over the run, drawn up to the present time: least distances, or a curve a robot.

Of more than a dozen robots: their median, and bands of half and nine tenths of them. A cross on
the time axis says when a contact began, a diamond when two touched between samples.
"""

from __future__ import annotations

import numpy as np

from physim.drawing import palette
from physim.drawing.crowd import MOST_LINES, quantiles
from physim.drawing.labels import spread, ticks
from physim.drawing.timeline import Curves, Moment, Timeline
from physim.drawing.video.canvas import Canvas, Line, draw_contacts
from physim.drawing.video.text import BOLD, SMALL, shorten, width
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

    def __init__(self, timeline: Timeline, curves: Curves, canvas: Canvas) -> None:
        """``canvas`` keeps what is painted in it, from one moment to the next."""
        self._timeline, self._curves, self._canvas = timeline, curves, canvas
        wide, high = canvas.size
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
        full = self._axes()
        self._blank = full.pixels.copy()
        self._draw_curves(full, times, values)
        self._full = full.pixels
        self._full[:TOP] = self._blank[:TOP]  # what lies above the axis
        swept, x = timeline.contacts.swept, np.rint(self._x(timeline.contacts.began)).astype(int)
        _, first = np.unique([~swept, x // APART], axis=1, return_index=True)
        self._marks = list(zip(x[first].tolist(), swept[first].tolist(), strict=True))
        for at, is_swept in self._marks:
            self._mark(full, at, is_swept)
        self._shown: tuple[int, list[tuple[int, int, int]]] = (0, [])
        canvas.pixels[:] = self._blank

    def _x(self, time: FloatArray | float) -> FloatArray:
        begin, end = self._timeline.begin, self._timeline.duration
        return np.asarray(LEFT + (time - begin) / max(end - begin, 1e-9) * self._wide)

    def _y(self, value: FloatArray | float) -> FloatArray:
        return np.asarray(TOP + (self._top - value) / (self._top - self._low) * self._high)

    def _axes(self) -> Canvas:
        canvas = Canvas(self._canvas.size)
        canvas.area(0, 0, canvas.box.width, 0, palette.RULE)
        title, left = self._curves.title, 14
        canvas.write(title, (left, 20), SMALL, weight=BOLD)
        left += width(title, SMALL, BOLD) + 20
        bands = (("median", 1, 1.0), ("50 %", 5, INNER), ("90 %", 5, OUTER))
        for words, half, share in () if self._each else bands:
            shade = palette.mix(palette.WHITE, palette.BAND, share)
            canvas.area(left, 15 - half, left + 18, 15 + half, shade)
            canvas.write(words, (left + 23, 20), SMALL)
            left += 23 + width(words, SMALL) + 12
        right, bottom, grey = LEFT + self._wide, TOP + self._high, palette.QUIET
        for value, words in ticks(self._low, self._top, 5):
            y = round(float(self._y(value)))
            canvas.area(LEFT, y, right, y, palette.FAINT if value else grey)
            canvas.write(words, (LEFT - 8, y + 5), SMALL, colour=grey, anchor="right")
        for time, words in ticks(self._timeline.begin, self._timeline.duration, 8):
            x = round(float(self._x(time)))
            canvas.area(x, bottom, x, bottom + 4, grey)
            canvas.write(words, (x, bottom + 18), SMALL, colour=grey, anchor="middle")
        canvas.area(LEFT, bottom, right, bottom, grey)
        canvas.write("time [s]", (right + 16, bottom + 18), SMALL)
        return canvas

    def _draw_curves(self, canvas: Canvas, times: FloatArray, values: FloatArray) -> None:
        """Draw values (N, T) of the robots, a line each or, of many, bands."""
        colours = self._curves.colours
        lines = [(line, colour, 2.5) for line, colour in zip(values, colours, strict=True)]
        if not self._each:
            found = quantiles(values.T)
            for low, high, share in ((1, -2, OUTER), (2, -3, INNER)):
                colour = palette.mix(palette.WHITE, palette.BAND, share)
                pieces = (self._pieces(times, found[k]) for k in (low, high))
                for below, above in zip(*pieces, strict=True):
                    canvas.fill([np.concatenate((below, above[::-1]))], colour)
            ink, band = palette.INK, palette.BAND
            lines = [(found[0], ink, 1.0), (found[-1], ink, 1.0), (found[3], band, 2.5)]
        for line, colour, wide in lines:
            for piece in self._pieces(times, line):
                canvas.lines(piece[None], colour, wide)

    def _pieces(self, times: FloatArray, line: FloatArray) -> list[FloatArray]:
        """Known pieces (n, 2) [px] of a line (T,)."""
        known = np.isfinite(line)
        points = np.column_stack((self._x(times), self._y(np.where(known, line, 0.0))))
        breaks = np.flatnonzero(np.diff(known)) + 1
        pieces = zip(np.split(points, breaks), np.split(known, breaks), strict=True)
        return [piece for piece, is_known in pieces if is_known[0] and len(piece) > 1]

    def _mark(self, canvas: Canvas, x: int, swept: bool) -> None:
        draw_contacts(canvas, np.array([[float(x), TOP + self._high]]), swept, small=True)

    def paint(self, now: Moment) -> None:
        """Show one moment; only what is near the cursor, before and now, is drawn anew."""
        canvas, cursor = self._canvas, round(float(self._x(now.time)))
        begin, end = self._timeline.begin, self._timeline.duration
        named = now.time - begin >= LEAST * (end - begin)
        names = self._place_names(now) if named else []
        if (cursor, names) == self._shown:
            return
        before, self._shown = self._shown[0], (cursor, names)
        left, right = max(min(cursor, before) - 2 * REACH, 0), max(cursor, before) + NAMES + LEFT
        canvas.pixels[:, left:right] = self._blank[:, left:right]
        canvas.pixels[:, left : cursor + 1] = self._full[:, left : cursor + 1]
        canvas.area(cursor, TOP - 6, cursor, TOP + self._high, palette.QUIET)
        for x, swept in self._marks:
            if cursor - REACH < x <= cursor:  # whole, though half of it is still covered
                self._mark(canvas, x, swept)
        colours = [self._curves.colours[k] if self._each else palette.INK for k, _, _ in names]
        leads = [Line(np.array([[cursor + 1.0, at], [cursor + 11.0, y]])) for _, at, y in names]
        canvas.draw(leads, edges=colours)
        for (robot, _, y), colour in zip(names, colours, strict=True):
            name = self._names[robot]
            canvas.write(name, (cursor + 14, y + 5), SMALL, colour=colour, weight=BOLD)

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
