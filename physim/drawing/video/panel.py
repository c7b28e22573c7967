"""The panel beside the view: time, speed, contacts, distances, legend, scale bar."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import cv2
import numpy as np

from physim.drawing import palette
from physim.drawing.distances import Distances
from physim.drawing.labels import metres
from physim.drawing.palette import Colour
from physim.drawing.timeline import Moment, Timeline
from physim.drawing.video.closest import Pair, as_recorded
from physim.drawing.video.layout import SMALL, TEXT, TITLE, Box, Image
from physim.drawing.video.legend import COURSES, LEAST_ROW, PAD, ROW, draw_modes, draw_signs
from physim.drawing.video.scale import draw_scale
from physim.drawing.video.text import BOLD, shorten, width, wrapped, write

CLOCK, FIGURES = 70, 142
"""[px] tops of the clock and the figures"""
FIGURE, HEAD, SETTINGS = 22, 18, 15
"""[px] height of a line of figures, of the words above the modes, and of a line of settings"""
NOW, CLOSEST_NOW = "touching now", "closest now: "
ROOMS = (90, 72, 60, 48, 40, 34, 28)
"""[px] for each of two names, the first with which they fit beside words and a value"""
BELOW = 134
"""[px] room below the legend for the scale bar and a small overview"""


class Panel:
    """Draws the panel; all that stays the same is drawn once, and texts when they change."""

    def __init__(
        self,
        timeline: Timeline,
        image: Image,
        scales: tuple[float, float],
        speed: float,
        signs: Sequence[str],
    ) -> None:
        """``image`` keeps what is painted in it, from one moment to the next.

        ``scales`` [px/m] are the view's, during the run and at its end; ``signs`` are the words of
        the legend's signs.
        """
        self._timeline, self._image = timeline, image
        self._distances = Distances(timeline.record)
        self._box = Box(0, 0, image.shape[1], image.shape[0])
        self._right = self._box.width - PAD
        contacts = timeline.contacts
        lines = 3 + bool(len(contacts.began)) + bool(np.isfinite(contacts.deep).any())
        self._modes_top = FIGURES + 20 + lines * FIGURE
        set_to = timeline.record.setup.controller.set_to
        self._set_to = wrapped(set_to, SMALL, self._right - PAD, most=3)
        self._head = HEAD + SETTINGS * len(self._set_to)
        self._scales = scales
        self._still = self._draw_still(speed, signs)
        self._shown: dict[Box, object] = {}
        image[:] = self._still

    @property
    def free(self) -> Box:
        """The part of the panel, in its own pixels, that is left for the overview."""
        top = self._bottom + 8
        return Box(PAD, top, self._right - PAD, self._box.height - top - 14)

    def _draw_still(self, speed: float, signs: Sequence[str]) -> Image:
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
        top = self._modes_top
        self._rule(image, top - 8)
        words = f"{'modes of' if modes else 'controller'} {record.setup.controller.name}"
        write(image, shorten(words, SMALL, room), (PAD, top + 10), SMALL, colour=palette.QUIET)
        for k, line in enumerate(self._set_to, 1):
            write(image, line, (PAD, top + 10 + k * SETTINGS), SMALL, colour=palette.QUIET)
        self._modes_top = top = top + self._head
        if modes:
            draw_modes(image, PAD, top, row, modes, room - 30)
            top += len(modes) * row + 12
            self._rule(image, top - 6)
        used = draw_signs(image, PAD, top, row, signs)
        self._trails = [
            (Box(PAD - 2, top + k * row, self._box.width - PAD, row), words)
            for k, words in enumerate(signs)
            if words in COURSES
        ]
        self._bar = Box(PAD - 2, top + used + 12, self._box.width - PAD, 28)
        self._rule(image, self._bar.top - 6)
        self._bottom = self._bar.top + self._bar.height
        return image

    def _row(self, rows: int) -> int:
        """Height of a line of the legend [px], so that scale bar and overview have room."""
        room = self._box.height - self._modes_top - self._head - BELOW
        return max(LEAST_ROW, min(ROW, room // max(rows, 1)))

    def _rule(self, image: Image, y: int) -> None:
        cv2.line(image, (PAD, y), (self._right, y), palette.RULE, 1)

    def _show_scale(self, over: bool) -> None:
        scale = self._scales[over]
        if self._is_new(self._bar, scale):
            draw_scale(self._image, PAD, self._bar.top + 14, scale)

    def _show_trails(self, over: bool) -> None:
        """Tell how long trails are, which the picture of the end shows whole if it is another."""
        whole = over and self._scales[0] != self._scales[1]
        for box, words in self._trails:
            shown = COURSES[words] if whole else words
            if self._is_new(box, shown):
                box.of(self._image)[:] = 255
                draw_signs(self._image, PAD, box.top, box.height, [shown])

    def paint(self, now: Moment, pair: Pair | None) -> None:
        """Show one moment, with the closest pair of robots."""
        self._show_clock(now.time)
        self._show_scale(self._timeline.over(now.time))
        self._show_trails(self._timeline.over(now.time))
        # the legend counts who is in each mode, such as the paper's "arrived"
        every = self._timeline.arrived(now.time) == self._timeline.robots
        words = "finished" if every else ""
        self._show_line(53, "", words, palette.INK, size=SMALL, left=self._box.width // 2)
        for row, (words, value, colour) in enumerate(self._figures(now, pair)):
            self._show_line(FIGURES + 12 + row * FIGURE, words, value, colour)
        for k, mode in enumerate(self._timeline.explained_modes):
            count = int((now.modes == mode).sum())
            y = self._modes_top + k * self._row_height + self._row_height // 2 + 5
            colour = palette.INK if count else palette.QUIET
            self._show_line(y, "", str(count), colour, left=self._right - 50)

    def _show_clock(self, time: float) -> None:
        words = f"{time:.1f} s"
        if self._is_new(Box(PAD, CLOCK + 4, self._right - 60 - PAD, 38), words):
            write(self._image, words, (PAD, CLOCK + 32), 30, weight=BOLD)
        share = time / max(self._timeline.duration, 1e-9)
        length = round((self._right - PAD) * share)
        if self._is_new(Box(PAD - 4, CLOCK + 46, self._right - PAD + 8, 9), length):
            draw_progress(self._image, PAD, self._right, CLOCK + 50, share)

    def _show_line(
        self, y: int, words: str, value: str, colour: Colour, size: int = TEXT, left: int = PAD
    ) -> None:
        """Show words and at the right end a value, with their baseline at ``y`` [px]."""
        box = Box(left, y - size + 1, self._box.width - left, size + 4)
        if self._is_new(box, (words, value, colour)):
            write(self._image, words, (left, y), size, colour=palette.QUIET)
            write(
                self._image, value, (self._right, y), size, colour=colour, weight=BOLD,
                anchor="right",
            )  # fmt: skip

    def _is_new(self, box: Box, content: object) -> bool:
        """Whether a box is to show something else than it does; it is blank then."""
        if self._shown.get(box) == content:
            return False
        self._shown[box] = content
        box.of(self._image)[:] = box.of(self._still)
        return True

    def _figures(self, now: Moment, pair: Pair | None) -> Iterator[tuple[str, str, Colour]]:
        """Words, value and colour of every line of figures."""
        contacts = self._timeline.contacts
        clearance, walls = (one[0] for one in self._distances.at(np.array([now.sample])))
        swept = contacts.swept_count(now.time)
        touched = contacts.count(now.time) - swept
        colour = palette.CONTACT if touched or swept else palette.INK
        if contacts.swept.any():
            yield "contacts, between samples", f"{touched}, {swept}", colour
        else:
            yield "contacts so far", str(touched), colour
        if np.isfinite(contacts.deep).any():
            deep = contacts.deep_count(now.time)
            yield "of them not physical", str(deep), palette.CONTACT if deep else palette.INK
        if len(contacts.began):
            yield NOW, *self._touching(now.time)
        if pair is not None:
            a, b, gap = as_recorded(pair, clearance)
            words = CLOSEST_NOW + self._both(a, b, CLOSEST_NOW, metres(gap))
            yield words, metres(gap), palette.INK if gap > 0.0 else palette.CONTACT
        wall = float(np.min(walls))
        if np.isfinite(wall):
            yield "wall, closest now", metres(wall), palette.INK if wall > 0.0 else palette.CONTACT
        deviation = float(self._timeline.record.course[now.sample, 0, 1])
        if pair is None:
            side = "left" if deviation >= 0.0 else "right"
            yield f"off its path now, {side}", metres(abs(deviation)), palette.INK

    def _touching(self, time: float) -> tuple[str, Colour]:
        """Who touches whom: the last that began, and how many others."""
        contacts = self._timeline.contacts
        present = contacts.present(time)
        if not len(present):
            return "none", palette.INK
        more = f" + {len(present) - 1}" if len(present) > 1 else ""
        a, b = contacts.bodies[present[-1]].tolist()
        return self._both(a, b, NOW, more) + more, palette.CONTACT

    def _both(self, a: int, b: int, *beside: str) -> str:
        """Names of two bodies, cut so that they fit in one line with what stands ``beside``."""
        bodies = self._timeline.record.bodies
        free = self._right - PAD - 12 - sum(width(words, TEXT, BOLD) for words in beside)
        tried = (" – ".join(shorten(bodies[k].name, TEXT, room) for k in (a, b)) for room in ROOMS)
        return next((names for names in tried if width(names, TEXT, BOLD) <= free), "…")


def draw_progress(image: Image, left: int, right: int, y: int, share: float) -> None:
    """Draw a bar of which a share is done."""
    cv2.line(image, (left, y), (right, y), palette.FAINT, 5)
    cv2.line(image, (left, y), (left + round((right - left) * share), y), palette.QUIET, 5)
