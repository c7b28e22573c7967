"""What the signs mean: one small drawing and a few words for each."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import cv2
import numpy as np

from physim import palette
from physim.declared import Mode
from physim.palette import Colour, rgb
from physim.timeline import Timeline
from physim.video.closest import Pair
from physim.video.ground import PATH_TINT, Ground
from physim.video.layout import TEXT, TRAIL, Image, Lens
from physim.video.marks import draw_closest, draw_contact, draw_ring, draw_target, draw_trail
from physim.video.robots import Fleet, draw_robot
from physim.video.text import shorten, write

ROW, LEAST_ROW = 21, 15
"""[px] height of a line of the legend, and the least where there are many"""
SIGN, WIDE = 30, 22
"""[px] room for a sign, and its width"""
CONTACT, CLOSEST, TARGET = "contact", "closest pair", "target"
BEGINS = "a contact begins"
GRAZE = "graze between samples"
RECENT = f"trail, last {TRAIL:g} s"
DASHED, PATH, REFERENCE = "path, dashed in danger area", "path", "reference path"
BOUNDARY = "boundary"
START, MIDDLE, END = np.array([[0.0, 0.0], [WIDE / 2.0, 0.0], [WIDE, 0.0]])
_BOX = np.array([[-9.0, -5.5], [9.0, -5.5], [9.0, 5.5], [-9.0, 5.5]])


def draw_modes(
    image: Image, left: int, top: int, row: int, modes: Sequence[Mode], room: int
) -> None:
    """Draw one line a mode: a robot in its colour, and its words, ``room`` [px] wide at most."""
    fleet = Fleet([[_BOX]])
    for k, mode in enumerate(modes):
        y = top + k * row + row / 2.0
        vertices = Lens(1.0, left + MIDDLE[0], y).fixed(fleet.placed(np.zeros((1, 3))))
        draw_robot(image, fleet.split(vertices)[0], rgb(mode.colour), False)
        words = shorten(str(mode), TEXT, room - SIGN)
        write(image, words, (left + SIGN, y + 5), TEXT)


def signs(timeline: Timeline, ground: Ground) -> list[str]:
    """Return the words of the signs that can appear in the video of a record, in order."""
    dashed = any(stroke.dash is not None for stroke in ground.strokes)
    scene, contacts = timeline.scene, timeline.contacts
    shown = {
        CONTACT: True,
        BEGINS: contacts.began.size > 0,
        GRAZE: bool(contacts.swept.any()),
        CLOSEST: timeline.robots > 1,
        TARGET: timeline.has("target_x", "target_y"),
        RECENT: True,
        DASHED: dashed,
        PATH: not dashed,
        REFERENCE: True,
        BOUNDARY: bool(scene.boundaries or scene.obstacles),
    }
    areas = [area.name for area in reversed(scene.areas)]
    return [words for words, there in shown.items() if there] + areas


def draw_signs(image: Image, left: int, top: int, row: int, shown: Sequence[str]) -> int:
    """Draw the signs of the words ``shown``, one a line of ``row`` [px]; return the height used."""
    for k, words in enumerate(shown):
        y = top + k * row + row / 2.0
        _SIGNS[words](image, Lens(1.0, left, y))
        write(image, words, (left + SIGN, y + 5), TEXT)
    return len(shown) * row


def _area(colour: Colour) -> Callable[[Image, Lens], None]:
    def draw(image: Image, lens: Lens) -> None:
        x, y = round(lens.x), round(lens.y)
        corners = (x, y - 6), (x + WIDE, y + 6)
        cv2.rectangle(image, *corners, colour, cv2.FILLED)
        cv2.rectangle(image, *corners, palette.mix(colour, palette.INK, 0.25), 1)

    return draw


def _line(colour: Colour, width: int, *pieces: tuple[int, int]) -> Callable[[Image, Lens], None]:
    def draw(image: Image, lens: Lens) -> None:
        x, y = round(lens.x), round(lens.y)
        for start, end in pieces:
            cv2.line(image, (x + start, y), (x + end, y), colour, width)

    return draw


_OWN = palette.robot_colour(0)
_OWN_PATH = palette.mix(_OWN, palette.WHITE, PATH_TINT)
_SIGNS: dict[str, Callable[[Image, Lens], None]] = {
    CONTACT: lambda image, lens: draw_contact(image, lens.pixels(MIDDLE), False),
    BEGINS: lambda image, lens: draw_ring(image, lens.pixels(MIDDLE), 6.0, 2),
    GRAZE: lambda image, lens: draw_contact(image, lens.pixels(MIDDLE), True),
    CLOSEST: lambda image, lens: draw_closest(
        image, lens, Pair(0, 1, 0.0, np.stack((START + (3.0, 0.0), END - (3.0, 0.0))))
    ),
    TARGET: lambda image, lens: draw_target(image, lens, START, END - (4.0, 0.0)),
    RECENT: lambda image, lens: draw_trail(
        image, lens.fixed(np.linspace(START, END, 13)), _OWN, 12
    ),
    DASHED: _line(_OWN_PATH, 1, (0, 9), (12, 15), (19, 22)),
    PATH: _line(_OWN_PATH, 1, (0, WIDE)),
    REFERENCE: _line(palette.REFERENCE, 2, (0, WIDE)),
    BOUNDARY: _line(palette.WALL, 3, (0, WIDE)),
    "safe area": _area(palette.SAFE_AREA),
    "danger area": _area(palette.DANGER_AREA),
    "accessible area": _area(palette.FLOOR),
}
