"""The panel beside the view: time, speed, contacts, distances, legend, scale bar."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import cv2
import numpy as np

from physim import palette
from physim.labels import metres, number, round_step
from physim.palette import Colour
from physim.timeline import Moment, Timeline
from physim.video.closest import Pair
from physim.video.layout import SMALL, TEXT, TITLE, Box, Image
from physim.video.legend import LEAST_ROW, ROW, draw_modes, draw_signs
from physim.video.text import BOLD, shorten, write

PAD = 18
CLOCK, FIGURES, MODES = 70, 142, 228
"""[px] tops of the clock, the figures and the modes"""
BELOW = 134
"""[px] room below the legend for the scale bar and a small overview"""


class Panel:
    """Draws the panel; all that stays the same is drawn once."""

    def __init__(
        self, timeline: Timeline, box: Box, scale: float, speed: float, signs: Sequence[str]
    ) -> None:
        """``scale`` [px/m] is the view's; ``signs`` are the words of the legend's signs."""
        self._timeline, self._box = timeline, box
        self._right = box.width - PAD
        self._still = self._draw_still(scale, speed, signs)

    @property
    def free(self) -> Box:
        """The part of the panel, in its own pixels, that is left for the overview."""
        top = self._bottom + 8
        return Box(PAD, top, self._right - PAD, self._box.height - top - 14)

    def _draw_still(self, scale: float, speed: float, signs: Sequence[str]) -> Image:
        image = np.full((self._box.height, self._box.width, 3), 255, np.uint8)
        cv2.line(image, (0, 0), (0, self._box.height), palette.RULE, 1)
        record, room = self._timeline.record, self._right - PAD
        name = shorten(record.name, TITLE, room, BOLD)
        write(image, name, (PAD, 32), TITLE, weight=BOLD)
        count = self._timeline.robots
        robots = "1 robot" if count == 1 else f"{count} robots"
        words = f"{robots}, seed {record.seed}"
        write(image, words, (PAD, 53), SMALL, colour=palette.QUIET)
        write(image, f"×{speed:g}", (self._right, CLOCK + 31), 20, colour=palette.QUIET,
              weight=BOLD, anchor="right")  # fmt: skip
        modes = [self._timeline.scene.modes[k] for k in self._timeline.explained_modes]
        row = self._row_height = self._row(len(modes) + len(signs))
        draw_modes(image, PAD, MODES, row, modes, room - 30)
        top = MODES + len(modes) * row + (12 if modes else 0)
        self._rule(image, MODES - 8)
        if modes:
            self._rule(image, top - 6)
        used = draw_signs(image, PAD, top, row, signs)
        self._bottom = self._scale_bar(image, top + used + 6, scale)
        return image

    def _row(self, rows: int) -> int:
        """Height of a line of the legend [px], so that scale bar and overview have room."""
        room = self._box.height - MODES - BELOW
        return max(LEAST_ROW, min(ROW, room // max(rows, 1)))

    def _rule(self, image: Image, y: int) -> None:
        cv2.line(image, (PAD, y), (self._right, y), palette.RULE, 1)

    def _scale_bar(self, image: Image, top: int, scale: float) -> int:
        """Draw a bar of a round length at most 150 px long; return its bottom."""
        step = round_step(150.0 / scale, 1)
        lengths = (step / k for k in (1.0, 2.0, 2.5, 5.0, 10.0))
        length = next(length for length in lengths if length * scale <= 150.0)
        self._rule(image, top)
        y, end = top + 20, PAD + round(length * scale)
        cv2.line(image, (PAD, y), (end, y), palette.INK, 2)
        for x in (PAD, end):
            cv2.line(image, (x, y - 5), (x, y + 5), palette.INK, 2)
        write(image, f"{number(length, length)} m", (end + 10, y + 5), TEXT)
        return top + 34

    def paint(self, image: Image, now: Moment, pair: Pair | None) -> None:
        """Draw the panel at one moment, with the closest pair of robots."""
        image[:] = self._still
        write(image, f"{now.time:.1f} s", (PAD, CLOCK + 32), 30, weight=BOLD)
        share = now.time / max(self._timeline.duration, 1e-9)
        draw_progress(image, PAD, self._right, CLOCK + 50, share)
        arrived = self._timeline.arrived(now.time)
        if arrived:
            every = arrived == self._timeline.robots > 1
            self._at_right(image, "all arrived" if every else f"{arrived} arrived", 53, SMALL)
        for row, (words, value, colour) in enumerate(self._figures(now, pair)):
            y = FIGURES + 12 + row * 22
            write(image, words, (PAD, y), TEXT, colour=palette.QUIET)
            self._at_right(image, value, y, colour=colour)
        for k, mode in enumerate(self._timeline.explained_modes):
            count = int((now.modes == mode).sum())
            y = MODES + k * self._row_height + self._row_height // 2 + 5
            self._at_right(image, str(count), y, colour=palette.INK if count else palette.QUIET)

    def _at_right(
        self, image: Image, text: str, y: int, size: int = TEXT, colour: Colour = palette.INK
    ) -> None:
        write(image, text, (self._right, y), size, colour=colour, weight=BOLD, anchor="right")

    def _figures(self, now: Moment, pair: Pair | None) -> Iterator[tuple[str, str, Colour]]:
        """Words, value and colour of every line of figures."""
        record, contacts = self._timeline.record, self._timeline.contacts
        grazes = contacts.grazes(now.time)
        touched = contacts.count(now.time) - grazes
        colour = palette.CONTACT if touched or grazes else palette.INK
        if contacts.swept.any():
            yield "contacts, grazes so far", f"{touched}, {grazes}", colour
        else:
            yield "contacts so far", str(touched), colour
        if pair is not None:
            names = " – ".join(shorten(record.names[k], TEXT, 48) for k in (pair.a, pair.b))
            depth = min(float(np.min(record.clearance[now.sample])), 0.0)
            gap = pair.distance if pair.distance > 0.0 else depth
            yield f"closest: {names}", metres(gap), palette.INK if gap > 0.0 else palette.CONTACT
        wall = float(np.min(record.boundary_clearance[now.sample]))
        if np.isfinite(wall):
            colour = palette.INK if wall > 0.0 else palette.CONTACT
            yield "closest to a wall", metres(wall), colour
        deviation = float(self._timeline.values("deviation", now.decisions)[0])
        if pair is None and np.isfinite(deviation):
            side = "left" if deviation >= 0.0 else "right"
            yield f"off its path, {side}", metres(abs(deviation)), palette.INK


def draw_progress(image: Image, left: int, right: int, y: int, share: float) -> None:
    """Draw a bar of which a share is done."""
    cv2.line(image, (left, y), (right, y), palette.FAINT, 5)
    cv2.line(image, (left, y), (left + round((right - left) * share), y), palette.QUIET, 5)
