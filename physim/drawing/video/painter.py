"""One frame of the video, put together: of one run, or of two side by side at the same time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np

from physim.drawing import palette
from physim.drawing.timeline import Timeline
from physim.drawing.video.canvas import (
    BOLD,
    HEIGHT,
    PANEL,
    STRIP,
    TEXT,
    TITLE,
    VIEW,
    WIDTH,
    Box,
    Image,
    draw_progress,
    draw_scale,
    shorten,
    width,
    write,
)
from physim.drawing.video.ground import ground
from physim.drawing.video.panel import GROUND, ROW, SIGN, Panel, draw_signs, mode_signs, signs
from physim.drawing.video.strip import Strip
from physim.drawing.video.view import SHORT, Camera, View, smallest_length
from physim.drawing.video.whole import Whole
from physim.world.differences import differences

if TYPE_CHECKING:
    from physim.world import World

DISTANCES = 0.5
"""Share of the strip for the least distances, where there are any"""
LEAST_WHOLE = 24
"""[px] height below which the whole world is not shown beside the view"""


class Painter:
    """Draws frames of one run at one playback speed: the view, figures beside it and below.

    There is one picture; from frame to frame only the parts of it that change are drawn.
    """

    def __init__(self, timeline: Timeline, speed: float, fps: float) -> None:
        self.timeline, world = timeline, ground(timeline)
        self._image: Image = np.empty((HEIGHT, WIDTH, 3), np.uint8)
        self._view = View(timeline, world, VIEW, speed, fps)
        panel, strip = PANEL.of(self._image), STRIP.of(self._image)
        self._panel = Panel(timeline, world, panel, self._view.scales, speed)
        free, self._whole = self._panel.free, None
        self._whole_image = free.of(panel)
        if not self._view.camera.whole and free.height >= LEAST_WHOLE:
            self._whole = Whole(timeline, world, free, 5.0, small=True)
        split = round(DISTANCES * STRIP.width) if timeline.distances.names else 0
        self._strips = [Strip(timeline, timeline.curves, strip[:, split:])]
        if split:
            self._strips.append(Strip(timeline, timeline.distances, strip[:, :split]))

    def paint(self, time: float) -> Image:
        """Return the picture (720, 1280, 3) uint8 RGB at ``time`` [s], until the next is drawn."""
        now = self.timeline.at(time)
        pair = self._view.paint(self._image, now)
        self._panel.paint(now, pair)
        if self._whole is not None:
            over = self.timeline.over(now.time)
            corners = None if over else self._view.camera.corners(now.time)
            self._whole.paint_small(self._whole_image, now, corners)
        for strip in self._strips:
            strip.paint(now)
        return self._image


HEADER, BARS, FOOTER = 62, 26, 78
"""[px] height of the titles above the two views, of the scale bars below them, and of time and
legend below these"""
PAD, GAP = 16, 3
BAR_END = WIDTH - 140
"""[px] where the bar of the time ends; then comes the sign of a contact"""
BARS_TOP = HEIGHT - FOOTER - BARS
BESIDE = 230
"""[px] from the left end of a scale bar to the first sign beside it"""
LEAST_WORDS = 24
"""[px] of a mode's words, however many there are"""
OUTCOME, ENDED = 200, 340
"""[px] at the right end of a header for what came of a run, and of one that ends first"""
BANNER = (33, 57)
"""[px] from top to bottom of what marks the header of such a run"""
PALE = 0.45
"""Share of white in its picture"""
MOST_NAMED = 2
"""Differing values of the two worlds that the titles name."""


class Beside:
    """Draws frames of two runs: the first on the left, the second on the right.

    The titles say in what the two worlds differ, and below them how the files are called. Of a run
    that is over before the other its last picture stays, pale and marked as such; when both are
    over, either is shown whole.
    """

    def __init__(self, left: Timeline, right: Timeline, speed: float, fps: float) -> None:
        timelines = left, right
        self.duration = max(left.duration, right.duration)
        self._speed = speed
        half, high = (WIDTH - GAP) // 2, HEIGHT - HEADER - BARS - FOOTER
        boxes = Box(0, HEADER, half, high), Box(WIDTH - half, HEADER, half, high)
        self._grounds = [ground(timeline) for timeline in timelines]
        shown = [*zip(timelines, self._grounds, boxes, strict=True)]
        # the largest scale that both can have, unless a robot would be too small
        most = min(Camera(one, world.extent, box, speed).scale for one, world, box in shown)
        if min(map(smallest_length, timelines)) * most < SHORT:
            most = np.inf
        self._views = [View(one, world, box, speed, fps, most) for one, world, box in shown]
        self._still = self._draw_still()
        self._image = np.empty_like(self._still)

    def paint(self, time: float) -> Image:
        """Return the picture (720, 1280, 3) uint8 RGB at ``time`` [s], until the next is drawn."""
        image = self._image
        image[:] = self._still
        for view in self._views:
            then = min(time, view.timeline.duration)
            held = view.timeline.over(time) and time < self.duration - 1e-9
            now = view.timeline.at(then)
            view.paint(image, now, held)
            if held:
                shown = view.box.of(image)
                shown[:] = (PALE * 255.0 + (1.0 - PALE) * shown).astype(np.uint8)
            self._outcome(image, view, now.time, then, held)
            over = view.timeline.over(now.time) and not held
            draw_scale(image, view.box.left + PAD, BARS_TOP + BARS // 2, view.scales[over])
        y = HEIGHT - FOOTER + 32
        write(image, f"{time:.1f} s", (PAD, y), 24, weight=BOLD)
        draw_progress(image, PAD + 200, BAR_END, y - 8, time / max(self.duration, 1e-9))
        return image

    def _outcome(self, image: Image, view: View, time: float, clock: float, held: bool) -> None:
        """What came of a run so far, at the right end of its title; of one ``held`` that it is.

        ``time`` is that of the view, told where the ``clock`` is ahead of it.
        """
        timeline, right = view.timeline, view.box.left + view.box.width - PAD
        count, end = timeline.contacts.count(time), timeline.duration
        colour = palette.CONTACT if count else palette.INK
        words = f"{count} contacts so far" if count != 1 else "1 contact so far"
        write(image, words, (right, 26), TITLE, colour=colour, weight=BOLD, anchor="right")
        words = f"{timeline.arrived(time)} of {timeline.robots} finished"
        if held:
            words = f"ended at {end:.1f} s, its last picture: {words}"
            words = shorten(words, TEXT, ENDED - PAD, BOLD)
            left, (top, bottom) = right - width(words, TEXT, BOLD) - PAD // 2, BANNER
            image[top:bottom, left : right + PAD // 2] = palette.INK
            write(image, words, (right, 50), TEXT, colour=palette.WHITE, weight=BOLD,
                  anchor="right")  # fmt: skip
            return
        if timeline.over(time) and end < self.duration:
            words = f"ended at {end:.1f} s, {words}"
        if time < clock - 1e-6:
            words = f"shown at {time:.1f} s: {words}"
        write(image, words, (right, 48), TEXT, colour=palette.QUIET, anchor="right")

    def _draw_still(self) -> Image:
        image = np.full((HEIGHT, WIDTH, 3), 255, np.uint8)
        records = [view.timeline.record for view in self._views]
        named = titles(records[0].world, records[1].world)
        files = file_names(records[0].path, records[1].path)
        for view, title, name in zip(self._views, named, files, strict=True):
            record, left = view.timeline.record, view.box.left + PAD
            room = view.box.width - 2 * PAD
            words = f"{record.name}, seed {record.seed}"
            if title and name:
                words = f"{name}: {words}"
            head = shorten(title or name, TITLE, room - OUTCOME, BOLD)
            write(image, head, (left, 26), TITLE, weight=BOLD)
            beside = ENDED if view.timeline.duration < self.duration else OUTCOME
            words = shorten(words, TEXT, room - beside)
            write(image, words, (left, 48), TEXT, colour=palette.QUIET)
        middle, top = WIDTH // 2, HEIGHT - FOOTER + 48
        cv2.line(image, (middle, 0), (middle, HEIGHT - FOOTER), palette.RULE, GAP)
        cv2.line(image, (middle, top), (middle, top + ROW), palette.RULE, GAP)
        write(image, f"×{self._speed:g}", (PAD + 190, HEIGHT - FOOTER + 31), 17,
              colour=palette.QUIET, weight=BOLD, anchor="right")  # fmt: skip
        for view, world in zip(self._views, self._grounds, strict=True):
            timeline, left = view.timeline, view.box.left + PAD
            right, entries = view.box.left + view.box.width - PAD, signs(timeline, world)
            _draw_row(image, timeline, left, right, top)
            contact = [("contact", entries["contact"])]
            draw_signs(image, BAR_END + 2 * PAD, HEIGHT - FOOTER + 14, ROW, contact)
            left = view.box.left + BESIDE
            for words in (word for word in reversed(GROUND) if word in entries):
                wide = SIGN + width(words, TEXT)
                if left + wide <= right:  # of what stands still as many as have the room
                    entry = [(words, entries[words])]
                    draw_signs(image, left, BARS_TOP + (BARS - ROW) // 2, ROW, entry)
                    left += wide + PAD
        return image


def _draw_row(image: Image, timeline: Timeline, left: int, right: int, top: int) -> None:
    """Draw modes side by side, the longest cut so that all end before ``right`` [px]."""
    entries = mode_signs([timeline.scene.modes[k] for k in timeline.explained_modes])
    lengths = [width(words, TEXT) for words, _ in entries]
    room = right - left - len(entries) * (SIGN + PAD) + PAD
    most = max(lengths, default=0)
    while most > LEAST_WORDS and sum(min(length, most) for length in lengths) > room:
        most -= 1
    for entry, length in zip(entries, lengths, strict=True):
        draw_signs(image, left, top, ROW, [entry], SIGN + most)
        left += SIGN + min(length, most) + PAD


def titles(left: World, right: World) -> tuple[str, str]:
    """Say of two effective worlds in what they differ: a title for either.

    Each is one line: the values of the keys that differ; where they are many, the names of the
    worlds, or of worlds with one name how many and the first of them; empty where the worlds are
    the same.
    """
    found = differences(left, right)
    if len(found) > MOST_NAMED and left.name != right.name:
        return left.name, right.name
    words = []
    for key in found:  # of filters.0 not 0 alone
        parts = key.removesuffix(".type").split(".")
        last = max((k for k, part in enumerate(parts) if not part.isdigit()), default=0)
        words.append(".".join(parts[last:]))
    if len(set(words)) < len(words):
        words = list(found)
    named = list(zip(words, found.values(), strict=True))[:MOST_NAMED]
    many = f"{len(found)} values, " if len(found) > len(named) else ""
    first, second = (
        many + ", ".join(f"{word}: {pair[side]}" for word, pair in named) for side in (0, 1)
    )
    return first, second


def file_names(left: Path | None, right: Path | None) -> tuple[str, str]:
    """Names by which the files of two records are told apart; empty where they have none.

    Of ``with/record.h5`` the name is that of the folder.
    """
    first, second = (
        "" if path is None else path.absolute().parent.name if path.stem == "record" else path.stem
        for path in (left, right)
    )
    return (first, second) if first != second else ("", "")
