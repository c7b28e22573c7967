"""One frame of the video, put together: of one run, or of two side by side at the same time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np

from physim.drawing import palette
from physim.drawing.palette import rgb
from physim.drawing.timeline import Timeline
from physim.drawing.video.camera import Camera, common_scale
from physim.drawing.video.ground import Overview, ground, plain
from physim.drawing.video.layout import HEIGHT, TEXT, TITLE, WIDTH, Box, Image, arrange
from physim.drawing.video.legend import (
    CONTACT,
    ROW,
    SIGN,
    draw_ground_signs,
    draw_modes,
    draw_signs,
    signs,
)
from physim.drawing.video.panel import Panel, draw_progress
from physim.drawing.video.scale import draw_scale
from physim.drawing.video.strip import Strip
from physim.drawing.video.text import BOLD, shorten, width, write
from physim.drawing.video.view import View
from physim.world.differences import differences

if TYPE_CHECKING:
    from physim.parts.declarations import Mode
    from physim.world import World


DISTANCES = 0.5
"""Share of the strip for the least distances, where there are any"""
LEAST_OVERVIEW = 24
"""[px] height below which the overview is left out"""


class Painter:
    """Draws frames of one run at one playback speed: the view, figures beside it and below.

    There is one picture; from frame to frame only the parts of it that change are drawn.
    """

    def __init__(self, timeline: Timeline, speed: float, fps: float) -> None:
        self.timeline = timeline
        self._image: Image = np.empty((HEIGHT, WIDTH, 3), np.uint8)
        view, beside, below = arrange()
        world = ground(timeline)
        self._view = View(timeline, world, view, speed, fps)
        camera, entries = self._view.camera, signs(timeline, world)
        panel = beside.of(self._image)
        self._panel = Panel(timeline, panel, self._view.scales, speed, entries)
        free = self._panel.free
        self._overview_image = free.of(panel)
        crowded = camera.whole or free.height < LEAST_OVERVIEW
        modes = timeline.scene.modes
        self._overview = None if crowded else Overview(plain(timeline, world), free, modes)
        distances, strip = timeline.distances, below.of(self._image)
        split = round(DISTANCES * below.width) if distances.names else 0
        self._strips = [Strip(timeline, timeline.curves, strip[:, split:])]
        if split:
            self._strips.append(Strip(timeline, distances, strip[:, :split]))

    def frame(self, time: float) -> Image:
        """Return the picture (720, 1280, 3) uint8 RGB at ``time`` [s]."""
        return self.paint(time).copy()

    def paint(self, time: float) -> Image:
        """Return the picture at ``time`` [s] as it is until the next is asked for."""
        now = self.timeline.at(time)
        pair = self._view.paint(self._image, now)
        self._panel.paint(now, pair)
        if self._overview is not None:
            corners = self._view.corners(now.time)
            self._overview.paint(self._overview_image, corners, now)
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
SAMPLE = "shown at {:.1f} s: "
"""Before what is said of a coarse record, of which a sample before the clock's time is shown"""
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
        self.duration = max(timeline.duration for timeline in timelines)
        self._speed = speed
        half, high = (WIDTH - GAP) // 2, HEIGHT - HEADER - BARS - FOOTER
        boxes = Box(0, HEADER, half, high), Box(WIDTH - half, HEADER, half, high)
        self._grounds = [ground(timeline) for timeline in timelines]
        shown = [*zip(timelines, self._grounds, boxes, strict=True)]
        cameras = [Camera(one, world.extent, box, speed) for one, world, box in shown]
        most = common_scale(cameras, timelines)
        self._views = [View(one, world, box, speed, fps, most) for one, world, box in shown]
        self._titles = titles(left.record.world, right.record.world)
        self._names = file_names(left.record.path, right.record.path)
        self._still = self._draw_still()
        self._image = np.empty_like(self._still)

    def frame(self, time: float) -> Image:
        """Return the picture (720, 1280, 3) uint8 RGB at ``time`` [s]."""
        return self.paint(time).copy()

    def paint(self, time: float) -> Image:
        """Return the picture at ``time`` [s] as it is until the next is asked for."""
        image = self._image
        image[:] = self._still
        for view in self._views:
            end = view.timeline.duration
            then = min(time, end)
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
        count, arrived = timeline.contacts.count(time), timeline.arrived(time)
        colour = palette.CONTACT if count else palette.INK
        words = f"{count} contacts so far" if count != 1 else "1 contact so far"
        write(image, words, (right, 26), TITLE, colour=colour, weight=BOLD, anchor="right")
        words, end = f"{arrived} of {timeline.robots} arrived", timeline.duration
        if held:
            draw_ended(image, right, f"ended at {end:.1f} s, its last picture: {words}")
            return
        if timeline.over(time) and self._ends_first(timeline):
            words = f"ended at {end:.1f} s, {words}"
        if time < clock - 1e-6:
            words = SAMPLE.format(time) + words
        write(image, words, (right, 48), TEXT, colour=palette.QUIET, anchor="right")

    def _ends_first(self, timeline: Timeline) -> bool:
        """Whether a run is over before the other."""
        return timeline.duration < self.duration

    def _draw_still(self) -> Image:
        image = np.full((HEIGHT, WIDTH, 3), 255, np.uint8)
        for view, title, name in zip(self._views, self._titles, self._names, strict=True):
            record, left = view.timeline.record, view.box.left + PAD
            room = view.box.width - 2 * PAD - OUTCOME
            words = f"{record.name}, seed {record.seed}"
            if title and name:
                words = f"{name}: {words}"
            write(image, shorten(title or name, TITLE, room, BOLD), (left, 26), TITLE,
                  weight=BOLD)  # fmt: skip
            beside = ENDED if self._ends_first(view.timeline) else OUTCOME
            words = shorten(words, TEXT, view.box.width - 2 * PAD - beside)
            write(image, words, (left, 48), TEXT, colour=palette.QUIET)
        middle = WIDTH // 2
        cv2.line(image, (middle, 0), (middle, HEIGHT - FOOTER), palette.RULE, GAP)
        at = PAD + 190, HEIGHT - FOOTER + 31
        write(image, f"×{self._speed:g}", at, 17, colour=palette.QUIET, weight=BOLD, anchor="right")
        self._draw_legend(image)
        return image

    def _draw_legend(self, image: Image) -> None:
        """The modes: of both runs in one row, or of each below its view where they would mix up."""
        top = HEIGHT - FOOTER + 48
        draw_signs(image, BAR_END + 2 * PAD, HEIGHT - FOOTER + 14, ROW, [CONTACT])
        for view, world in zip(self._views, self._grounds, strict=True):
            left, right = view.box.left + BESIDE, view.box.left + view.box.width - PAD
            entries = signs(view.timeline, world)
            draw_ground_signs(image, left, right, BARS_TOP + (BARS - ROW) // 2, ROW, entries)
        both = [
            [view.timeline.scene.modes[k] for k in view.timeline.explained_modes]
            for view in self._views
        ]
        if shared := one_legend(*both):
            _draw_row(image, shared, PAD, WIDTH - PAD, top)
            return
        middle = WIDTH // 2
        cv2.line(image, (middle, top), (middle, top + ROW), palette.RULE, GAP)
        for view, modes in zip(self._views, both, strict=True):
            left = view.box.left + PAD
            _draw_row(image, modes, left, left + view.box.width - 2 * PAD, top)


def one_legend(left: Sequence[Mode], right: Sequence[Mode]) -> list[Mode]:
    """The modes of two runs, each once; none where a colour or a name stands for two."""
    mixed = any(
        (str(one) == str(other)) != (rgb(one.colour) == rgb(other.colour))
        for one in left
        for other in right
    )
    return [] if mixed else [*{str(mode): mode for mode in (*left, *right)}.values()]


def _draw_row(image: Image, modes: Sequence[Mode], left: int, right: int, top: int) -> None:
    """Draw modes side by side, the longest cut so that all end before ``right`` [px]."""
    lengths = [width(str(mode), TEXT) for mode in modes]
    room = right - left - len(modes) * (SIGN + 2 * PAD) + 2 * PAD
    most = max(lengths, default=0)
    while most > LEAST_WORDS and sum(min(length, most) for length in lengths) > room:
        most -= 1
    for mode, length in zip(modes, lengths, strict=True):
        draw_modes(image, left, top, ROW, [mode], SIGN + most)
        left += SIGN + min(length, most) + 2 * PAD


def draw_ended(image: Image, right: int, words: str) -> None:
    """Write in a header, up to ``right`` [px], light on dark, that a run is over."""
    top, bottom = BANNER
    words = shorten(words, TEXT, ENDED - PAD, BOLD)
    left = right - round(width(words, TEXT, BOLD)) - PAD // 2
    image[top:bottom, left : right + PAD // 2] = palette.INK
    white = (255, 255, 255)
    write(image, words, (right, 50), TEXT, colour=white, weight=BOLD, anchor="right")


def titles(left: World, right: World) -> tuple[str, str]:
    """Say of two effective worlds in what they differ: a title for either.

    Each is one line: the values of the keys that differ; where they are many, the names of the
    worlds, or of worlds with one name how many and the first of them; empty where the worlds are
    the same.
    """
    found = differences(left, right)
    if len(found) > MOST_NAMED and left.name != right.name:
        return left.name, right.name
    words = [_word(key.removesuffix(".type")) for key in found]
    if len(set(words)) < len(words):
        words = list(found)
    named = list(zip(words, found.values(), strict=True))[:MOST_NAMED]
    more = len(found) - len(named)
    many = f"{len(found)} values, " if more else ""
    first, second = (
        many + ", ".join(f"{word}: {pair[side]}" for word, pair in named) for side in (0, 1)
    )
    return first, second


def _word(key: str) -> str:
    """The end of a dotted key from its last name on: ``filters.0``, not ``0``."""
    parts = key.split(".")
    first = max((k for k, part in enumerate(parts) if not part.isdigit()), default=0)
    return ".".join(parts[first:])


def file_names(left: Path | None, right: Path | None) -> tuple[str, str]:
    """Names by which the files of two records are told apart; empty where they have none.

    Of ``with/record.h5`` the name is that of the folder.
    """
    first, second = (
        "" if path is None else path.absolute().parent.name if path.stem == "record" else path.stem
        for path in (left, right)
    )
    return (first, second) if first != second else ("", "")
