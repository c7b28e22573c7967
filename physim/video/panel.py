"""The panel beside the view: time, speed, contacts, distances, legend, scale bar."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np

from physim.geometry.shapes import IntArray
from physim.video import legend, theme
from physim.video.closest import Pair
from physim.video.layout import Box
from physim.video.story import Story
from physim.video.text import BOLD, Image, shorten, write
from physim.video.ticks import metres, number, round_step

PAD = 18
CLOCK, FIGURES, MODES = 70, 142, 228
"""[px] tops of the clock, the figures and the modes"""
BELOW = 134
"""[px] room below the legend for the scale bar and a small overview"""


class Now(NamedTuple):
    """What the panel says at one time."""

    time: float
    contacts: int
    """at samples"""
    grazes: int
    """between samples"""
    pair: Pair | None
    depth: float
    """[m] signed clearance of the closest robots, for an overlap; not used while apart"""
    wall: float
    """[m] smallest distance of a robot to a wall; inf when there is none"""
    modes: IntArray
    arrived: int
    """robots that have arrived, judged by their motion"""
    deviation: float
    """[m] of Robot 0 from its path, left positive; shown where it is the only robot"""


class Panel:
    """Draws the panel; all that stays the same is drawn once."""

    def __init__(
        self, story: Story, box: Box, scale: float, speed: float, signs: Sequence[str]
    ) -> None:
        """``scale`` [px/m] is the view's; ``signs`` are the words of the legend's signs."""
        self._story, self._box, self._speed = story, box, speed
        self._right = box.width - PAD
        self._still = self._draw_still(scale, signs)

    @property
    def free(self) -> Box:
        """The part of the panel, in its own pixels, that is left for the overview."""
        top = self._bottom + 8
        return Box(PAD, top, self._right - PAD, self._box.height - top - 14)

    def _draw_still(self, scale: float, signs: Sequence[str]) -> Image:
        image = np.full((self._box.height, self._box.width, 3), 255, np.uint8)
        cv2.line(image, (0, 0), (0, self._box.height), theme.RULE, 1)
        record, room = self._story.record, self._right - PAD
        name = shorten(record.name, theme.TITLE, room, BOLD)
        write(image, name, (PAD, 32), theme.TITLE, weight=BOLD)
        count = self._story.robots
        robots = "1 robot" if count == 1 else f"{count} robots"
        words = f"{robots}, seed {record.seed}"
        write(image, words, (PAD, 53), theme.SMALL, colour=theme.QUIET)
        modes = [self._story.scene.modes[k] for k in self._story.shown_modes]
        row = self._row_height = self._row(len(modes) + len(signs))
        legend.draw_modes(image, PAD, MODES, row, modes, room - 30)
        top = MODES + len(modes) * row + (12 if modes else 0)
        self._rule(image, MODES - 8)
        if modes:
            self._rule(image, top - 6)
        used = legend.draw_signs(image, PAD, top, row, signs)
        self._bottom = self._scale_bar(image, top + used + 6, scale)
        return image

    def _row(self, rows: int) -> int:
        """Height of a line of the legend [px], so that scale bar and overview have room."""
        room = self._box.height - MODES - BELOW
        return max(legend.LEAST_ROW, min(legend.ROW, room // max(rows, 1)))

    def _rule(self, image: Image, y: int) -> None:
        cv2.line(image, (PAD, y), (self._right, y), theme.RULE, 1)

    def _scale_bar(self, image: Image, top: int, scale: float) -> int:
        """Draw a bar of a round length at most 150 px long; return its bottom."""
        step = round_step(150.0 / scale, 1)
        length = (
            step
            if step * scale <= 150.0
            else next(step / k for k in (2.0, 2.5, 5.0, 10.0) if step / k * scale <= 150.0)
        )
        self._rule(image, top)
        y, end = top + 20, PAD + round(length * scale)
        cv2.line(image, (PAD, y), (end, y), theme.INK, 2)
        for x in (PAD, end):
            cv2.line(image, (x, y - 5), (x, y + 5), theme.INK, 2)
        write(image, f"{number(length, length)} m", (end + 10, y + 5), theme.TEXT)
        return top + 34

    def paint(self, image: Image, now: Now) -> None:
        """Draw the panel as it is now."""
        image[:] = self._still
        self._clock(image, now.time)
        if now.arrived:
            every = now.arrived == self._story.robots
            words = "all arrived" if every and now.arrived > 1 else f"{now.arrived} arrived"
            at = (self._right, 53)
            write(image, words, at, theme.SMALL, colour=theme.INK, weight=BOLD, anchor="right")
        self._figures(image, now)
        row = self._row_height
        for k, mode in enumerate(self._story.shown_modes):
            count = int((now.modes == mode).sum())
            y = MODES + k * row + row // 2 + 5
            colour = theme.INK if count else theme.QUIET
            write(
                image,
                str(count),
                (self._right, y),
                theme.TEXT,
                colour=colour,
                weight=BOLD,
                anchor="right",
            )

    def _clock(self, image: Image, time: float) -> None:
        write(image, f"{time:.1f} s", (PAD, CLOCK + 32), 30, weight=BOLD)
        speed = f"×{self._speed:g}"
        write(
            image,
            speed,
            (self._right, CLOCK + 31),
            20,
            weight=BOLD,
            anchor="right",
            colour=theme.QUIET,
        )
        y, span = CLOCK + 50, self._right - PAD
        done = PAD + round(span * time / max(self._story.duration, 1e-9))
        cv2.line(image, (PAD, y), (self._right, y), theme.FAINT, 5)
        cv2.line(image, (PAD, y), (done, y), theme.QUIET, 5)

    def _figures(self, image: Image, now: Now) -> None:
        contact = theme.CONTACT if now.contacts or now.grazes else theme.INK
        rows = [("contacts so far", str(now.contacts), contact)]
        if self._story.contacts.swept.any():
            rows = [("contacts, grazes so far", f"{now.contacts}, {now.grazes}", contact)]
        if now.pair is not None:
            names = self._story.record.names
            pair = " – ".join(shorten(names[k], theme.TEXT, 48) for k in (now.pair.a, now.pair.b))
            gap = now.pair.distance if now.pair.distance > 0.0 else min(now.depth, 0.0)
            colour = theme.INK if gap > 0.0 else theme.CONTACT
            rows.append((f"closest: {pair}", metres(gap), colour))
        if np.isfinite(now.wall):
            colour = theme.INK if now.wall > 0.0 else theme.CONTACT
            rows.append(("closest to a wall", metres(now.wall), colour))
        if now.pair is None and np.isfinite(now.deviation):
            side = "left" if now.deviation >= 0.0 else "right"
            rows.append((f"off its path, {side}", metres(abs(now.deviation)), theme.INK))
        for row, (words, value, colour) in enumerate(rows):
            y = FIGURES + 12 + row * 22
            write(image, words, (PAD, y), theme.TEXT, colour=theme.QUIET)
            write(
                image,
                value,
                (self._right, y),
                theme.TEXT,
                colour=colour,
                weight=BOLD,
                anchor="right",
            )
