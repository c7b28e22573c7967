"""The legend: one small drawing and a few words for each sign that a picture can have."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import cv2
import numpy as np

from physim.drawing import palette
from physim.drawing.crowd import NAMED
from physim.drawing.palette import Colour, rgb
from physim.drawing.scene_model import shape
from physim.drawing.timeline import Timeline
from physim.drawing.video.closest import Pair
from physim.drawing.video.ground import Ground
from physim.drawing.video.layout import SHORT_TRAIL, TEXT, TRAIL, Image, Lens
from physim.drawing.video.marks import (
    Fleet,
    draw_closest,
    draw_contacts,
    draw_ring,
    draw_robots,
    draw_targets,
    draw_trails,
)
from physim.drawing.video.text import shorten, width, write
from physim.parts.declarations import Mode

PAD = 18
"""[px] beside and between what the legend shows"""
ROW, LEAST_ROW = 21, 15
"""[px] height of a line of the legend, and the least where there are many"""
SIGN, WIDE = 30, 22
"""[px] room for a sign, and its width"""
CONTACT, CLOSEST, TARGET = "contact", "closest pair", "target"
DEEP = "too deep: not physical"
NO_MODES = "robot; no modes are given"
BEGINS = "a contact begins"
SWEPT = "contact between samples"
RECENT, RECENT_ALL = f"trail, last {TRAIL:g} s", f"trails, last {SHORT_TRAIL:g} s"
COURSES = {RECENT: "trail of the whole run", RECENT_ALL: "trails of the whole run"}
"""What the picture of the end of a run shows instead"""
DASHED_ALL, PATH_ALL = "paths, dashed in danger area", "paths"
DASHED, PATH, REFERENCE = "path, dashed in danger area", "path", "reference path"
BOUNDARY, OBSTACLE = "boundary", "obstacle"
GROUND = ("safe area", "danger area", "accessible area", OBSTACLE, BOUNDARY, REFERENCE)
"""Signs of what stands still, those first that say most"""
START, MIDDLE, END = np.array([[0.0, 0.0], [WIDE / 2.0, 0.0], [WIDE, 0.0]])
_BOX = np.array([[-9.0, -5.5], [9.0, -5.5], [9.0, 5.5], [-9.0, 5.5]])


def draw_modes(
    image: Image, left: int, top: int, row: int, modes: Sequence[Mode], room: int
) -> None:
    """Draw one line a mode: a robot in its colour, and its words, ``room`` [px] wide at most."""
    fleet = Fleet([shape([_BOX])])
    for k, mode in enumerate(modes):
        y = top + k * row + row / 2.0
        vertices = Lens(1.0, left + MIDDLE[0], y).fixed(fleet.placed(np.zeros((1, 3))))
        draw_robots(image, fleet.split(vertices), [rgb(mode.colour)], [False])
        words = shorten(str(mode), TEXT, room - SIGN)
        write(image, words, (left + SIGN, y + 5), TEXT)


def signs(timeline: Timeline, ground: Ground) -> list[str]:
    """Return the words of the signs that can appear in the video of a record, in order."""
    dashed = any(item.dash is not None for item in ground.items)
    scene, contacts, crowd = timeline.scene, timeline.contacts, timeline.robots > NAMED
    entries = {
        NO_MODES: timeline.modeless,
        CONTACT: True,
        BEGINS: contacts.began.size > 0,
        DEEP: bool(np.isfinite(contacts.deep).any()),
        SWEPT: bool(contacts.swept.any()),
        CLOSEST: timeline.robots > 1,
        TARGET: not crowd and timeline.has("target_x", "target_y"),
        RECENT_ALL if crowd else RECENT: True,
        DASHED_ALL if crowd else DASHED: dashed,
        PATH_ALL if crowd else PATH: not dashed,
        REFERENCE: True,
        BOUNDARY: bool(scene.boundaries),
        OBSTACLE: bool(scene.obstacles),
    }
    areas = [area.name for area in reversed(scene.areas)]
    return [words for words, there in entries.items() if there] + areas


def draw_signs(image: Image, left: int, top: int, row: int, entries: Sequence[str]) -> int:
    """Draw the signs of ``entries``, one a line of ``row`` [px]; return the height used."""
    for k, words in enumerate(entries):
        y = top + k * row + row / 2.0
        _SIGNS[words](image, Lens(1.0, left, y))
        write(image, words, (left + SIGN, y + 5), TEXT)
    return len(entries) * row


def draw_ground_signs(
    image: Image, left: int, right: int, top: int, row: int, entries: Sequence[str]
) -> None:
    """Draw the signs of what stands still side by side, as many as have the room."""
    for words in GROUND:
        wide = SIGN + round(width(words, TEXT))
        if words in entries and left + wide <= right:
            draw_signs(image, left, top, row, [words])
            left += wide + PAD


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


def _trail(colour: Colour) -> Callable[[Image, Lens], None]:
    def draw(image: Image, lens: Lens) -> None:
        draw_trails(image, lens.fixed(np.linspace(START, END, 13))[None], colour, 12)

    return draw


def _robot(image: Image, lens: Lens) -> None:
    fleet = Fleet([shape([_BOX])])
    vertices = Lens(1.0, lens.x + MIDDLE[0], lens.y).fixed(fleet.placed(np.zeros((1, 3))))
    draw_robots(image, fleet.split(vertices), [_OWN], [False])


_OWN = palette.robot_colour(0)
_OWN_PATH = palette.mix(_OWN, palette.WHITE, palette.PATH_TINT)
_ALL_PATHS = palette.mix(palette.BAND, palette.WHITE, palette.PATH_TINT)
_DASHES = (0, 9), (12, 15), (19, 22)
_SIGNS: dict[str, Callable[[Image, Lens], None]] = {
    CONTACT: lambda image, lens: draw_contacts(image, lens.pixels(MIDDLE[None]), False),
    NO_MODES: _robot,
    DEEP: lambda image, lens: draw_contacts(image, lens.pixels(MIDDLE[None]), False, deep=True),
    BEGINS: lambda image, lens: draw_ring(image, lens.pixels(MIDDLE), 6.0, 2),
    SWEPT: lambda image, lens: draw_contacts(image, lens.pixels(MIDDLE[None]), True),
    CLOSEST: lambda image, lens: draw_closest(
        image, lens, Pair(0, 1, 0.0, np.stack((START + (3.0, 0.0), END - (3.0, 0.0))))
    ),
    TARGET: lambda image, lens: draw_targets(image, lens, START[None], END[None] - (4.0, 0.0)),
    RECENT: _trail(_OWN),
    RECENT_ALL: _trail(palette.BAND),
    COURSES[RECENT]: _line(_OWN, 2, (0, WIDE)),
    COURSES[RECENT_ALL]: _line(palette.BAND, 1, (0, WIDE)),
    DASHED: _line(_OWN_PATH, 1, *_DASHES),
    DASHED_ALL: _line(_ALL_PATHS, 1, *_DASHES),
    PATH: _line(_OWN_PATH, 1, (0, WIDE)),
    PATH_ALL: _line(_ALL_PATHS, 1, (0, WIDE)),
    REFERENCE: _line(palette.REFERENCE, 2, (0, WIDE)),
    BOUNDARY: _line(palette.WALL, 3, (0, WIDE)),
    OBSTACLE: _area(palette.OBSTACLE),
    "safe area": _area(palette.SAFE_AREA),
    "danger area": _area(palette.DANGER_AREA),
    "accessible area": _area(palette.FLOOR),
}
