"""One frame of a video of two runs side by side, at the same simulated time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import numpy as np

from physim.video import legend, theme
from physim.video.ground import ground
from physim.video.layout import Box
from physim.video.story import Story
from physim.video.text import BOLD, Image, shorten, width, write
from physim.video.view import View
from physim.world.differences import differences

if TYPE_CHECKING:
    from physim.record import Record
    from physim.world import World

HEADER, FOOTER = 62, 78
"""[px] height of the titles above the two views, and of time and legend below"""
PAD, GAP = 16, 3
MOST_NAMED = 2
"""Differing values of the two worlds that the titles name; of more the number."""


class Beside:
    """Draws frames of two records: the first on the left, the second on the right.

    The titles say in what the two worlds differ. A run that is over stays as it ended.
    """

    def __init__(self, left: Record, right: Record, speed: float, fps: float) -> None:
        stories = Story(left), Story(right)
        self.duration = max(story.duration for story in stories)
        self._speed = speed
        half, high = (theme.WIDTH - GAP) // 2, theme.HEIGHT - HEADER - FOOTER
        boxes = Box(0, HEADER, half, high), Box(theme.WIDTH - half, HEADER, half, high)
        self._views = [
            View(story, ground(story), box, speed, fps)
            for story, box in zip(stories, boxes, strict=True)
        ]
        self._titles = titles(left.world, right.world)
        self._still = self._draw_still()

    def frame(self, time: float) -> Image:
        """Return the picture (720, 1280, 3) uint8 RGB at ``time`` [s]."""
        image = self._still.copy()
        for view in self._views:
            then = min(time, view.story.duration)
            view.paint(image, then)
            self._told(image, view, then)
        y = theme.HEIGHT - FOOTER + 32
        write(image, f"{time:.1f} s", (PAD, y), 24, weight=BOLD)
        left, right = PAD + 200, theme.WIDTH - PAD
        done = left + round((right - left) * time / max(self.duration, 1e-9))
        cv2.line(image, (left, y - 8), (right, y - 8), theme.FAINT, 5)
        cv2.line(image, (left, y - 8), (done, y - 8), theme.QUIET, 5)
        return image

    def _told(self, image: Image, view: View, time: float) -> None:
        """What came of a run so far, at the right end of its title."""
        story, right = view.story, view.box.left + view.box.width - PAD
        count, arrived = story.contacts.count(time), story.arrived(time)
        colour = theme.CONTACT if count else theme.INK
        words = f"{count} contacts so far" if count != 1 else "1 contact so far"
        write(image, words, (right, 26), theme.TITLE, colour=colour, weight=BOLD, anchor="right")
        ended = time >= story.duration and story.duration < self.duration
        words = f"over at {story.duration:.1f} s, " if ended else ""
        words += f"{arrived} of {story.robots} arrived"
        write(image, words, (right, 48), theme.TEXT, colour=theme.QUIET, anchor="right")

    def _draw_still(self) -> Image:
        image = np.full((theme.HEIGHT, theme.WIDTH, 3), 255, np.uint8)
        for view, title in zip(self._views, self._titles, strict=True):
            record, left = view.story.record, view.box.left + PAD
            room = view.box.width - 2 * PAD - 200
            words = shorten(f"{record.name}, seed {record.seed}", theme.TEXT, room)
            write(image, shorten(title, theme.TITLE, room, BOLD), (left, 26), theme.TITLE,
                  weight=BOLD)  # fmt: skip
            write(image, words, (left, 48), theme.TEXT, colour=theme.QUIET)
        middle = theme.WIDTH // 2
        cv2.line(image, (middle, 0), (middle, theme.HEIGHT - FOOTER), theme.RULE, GAP)
        at = PAD + 190, theme.HEIGHT - FOOTER + 31
        write(image, f"×{self._speed:g}", at, 17, colour=theme.QUIET, weight=BOLD, anchor="right")
        self._draw_legend(image)
        return image

    def _draw_legend(self, image: Image) -> None:
        """The modes of both runs, each once, in one row."""
        modes = {
            str(mode): mode
            for view in self._views
            for mode in (view.story.scene.modes[k] for k in view.story.shown_modes)
        }
        left, top = PAD, theme.HEIGHT - FOOTER + 48
        room = (theme.WIDTH - 2 * PAD) // (len(modes) + 1)
        legend.draw_signs(image, left, top, legend.ROW, [legend.CONTACT])
        left += legend.SIGN + width(legend.CONTACT, theme.TEXT) + 2 * PAD
        for words, mode in modes.items():
            legend.draw_modes(image, left, top, legend.ROW, [mode], room)
            shown = shorten(words, theme.TEXT, room - legend.SIGN)
            left += legend.SIGN + width(shown, theme.TEXT) + 2 * PAD


def titles(left: World, right: World) -> tuple[str, str]:
    """Say of two effective worlds in what they differ: a title for either.

    Each is one line: the values of the keys that differ, or the number of these where they are
    many; empty where the worlds are the same.
    """
    found = differences(left, right)
    if len(found) > MOST_NAMED:
        return f"{len(found)} values differ", f"{len(found)} values differ"
    words = [key.removesuffix(".type").rsplit(".", 1)[-1] for key in found]
    first, second = (
        ", ".join(f"{word}: {pair[side]}" for word, pair in zip(words, found.values(), strict=True))
        for side in (0, 1)
    )
    return first, second
