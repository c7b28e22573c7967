"""What the signs mean: one small drawing and a few words for each."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import cv2
import numpy as np

from physim.declared import Mode
from physim.palette import rgb
from physim.video import marks, theme
from physim.video.camera import Lens
from physim.video.closest import Pair
from physim.video.ground import Ground
from physim.video.robots import Fleet, draw_robot
from physim.video.story import Story
from physim.video.text import Image, shorten, write
from physim.video.theme import Colour

ROW, LEAST_ROW = 21, 15
"""[px] height of a line of the legend, and the least where there are many"""
SIGN = 30
"""[px] room for the sign"""
CONTACT, CLOSEST, TARGET = "contact", "closest pair", "target"
BEGINS = "a contact begins"
GRAZE = "graze between samples"
TRAIL = f"trail, last {theme.TRAIL:g} s"
DASHED, PATH, REFERENCE = "path, dashed in danger area", "path", "reference path"
BOUNDARY, SAFE, DANGER, ACCESSIBLE = "boundary", "safe area", "danger area", "accessible area"
_BOX = np.array([[-9.0, -5.5], [9.0, -5.5], [9.0, 5.5], [-9.0, 5.5]])
_UNIT = Lens(1.0, 0.0, 0.0)


def draw_modes(
    image: Image, left: int, top: int, row: int, modes: Sequence[Mode], room: int
) -> None:
    """Draw one line a mode: a robot in its colour, and its words, ``room`` [px] wide at most."""
    fleet = Fleet([[_BOX]])
    for k, mode in enumerate(modes):
        y = top + k * row + row / 2.0
        vertices = Lens(1.0, left + 11.0, y).fixed(fleet.placed(np.zeros((1, 3))))
        draw_robot(image, fleet.split(vertices)[0], rgb(mode.colour), False)
        words = shorten(str(mode), theme.TEXT, room - SIGN)
        write(image, words, (left + SIGN, y + 5), theme.TEXT)


def signs(story: Story, ground: Ground) -> list[str]:
    """Return the words of the signs that can appear in the video of a record, in order."""
    dashed = any(stroke.dash is not None for stroke in ground.strokes)
    scene, areas = story.scene, story.scene.safe_distance > 0.0
    shown = {
        CONTACT: True,
        BEGINS: story.contacts.began.size > 0,
        GRAZE: bool(story.contacts.swept.any()),
        CLOSEST: story.robots > 1,
        TARGET: story.has_targets,
        TRAIL: True,
        DASHED: dashed,
        PATH: not dashed,
        REFERENCE: True,
        BOUNDARY: bool(scene.boundaries or scene.obstacles),
        SAFE: areas and bool(scene.safe),
        DANGER: areas,
        ACCESSIBLE: not areas and bool(scene.accessible),
    }
    return [words for words, there in shown.items() if there]


def draw_signs(image: Image, left: int, top: int, row: int, shown: Sequence[str]) -> int:
    """Draw the signs of the words ``shown``, one a line of ``row`` [px]; return the height used."""
    for k, words in enumerate(shown):
        y = top + k * row + row / 2.0
        _SIGNS[words](image, left, y)
        write(image, words, (left + SIGN, y + 5), theme.TEXT)
    return len(shown) * row


def _ends(left: float, y: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.array([[left, -y], [left + 22.0, -y]])


def _wall(image: Image, left: float, y: float) -> None:
    cv2.line(image, (int(left), round(y)), (int(left) + 22, round(y)), theme.WALL, 3)


def _area(colour: Colour) -> Callable[[Image, float, float], None]:
    def draw(image: Image, left: float, y: float) -> None:
        corners = (int(left), round(y) - 6), (int(left) + 22, round(y) + 6)
        cv2.rectangle(image, *corners, colour, cv2.FILLED)
        cv2.rectangle(image, *corners, theme.mix(colour, theme.INK, 0.25), 1)

    return draw


def _reference(image: Image, left: float, y: float) -> None:
    cv2.line(image, (int(left), round(y)), (int(left) + 22, round(y)), theme.REFERENCE, 2)


def _path(image: Image, left: float, y: float) -> None:
    _line(image, left, y, ((0, 22),))


def _dashed(image: Image, left: float, y: float) -> None:
    _line(image, left, y, ((0, 9), (12, 15), (19, 22)))


def _line(image: Image, left: float, y: float, pieces: Sequence[tuple[int, int]]) -> None:
    colour = theme.mix(theme.robot_colour(0), theme.WHITE, 0.42)
    x, row = int(left), round(y)
    for start, end in pieces:
        cv2.line(image, (x + start, row), (x + end, row), colour, 1, cv2.LINE_AA)


def _trail(image: Image, left: float, y: float) -> None:
    places = _ends(left, y)[0] + np.linspace(0.0, 22.0, 13)[:, None] * (1.0, 0.0)
    marks.draw_trail(image, _UNIT.fixed(places), theme.robot_colour(0), 12)


def _target(image: Image, left: float, y: float) -> None:
    start, end = _ends(left, y)
    marks.draw_target(image, _UNIT, start, end - (4.0, 0.0))


def _closest(image: Image, left: float, y: float) -> None:
    ends = _ends(left, y) + np.array([[3.0, 0.0], [-3.0, 0.0]])
    marks.draw_closest(image, _UNIT, Pair(0, 1, 0.0, ends))


def _contact(image: Image, left: float, y: float) -> None:
    marks.draw_contact(image, Lens(1.0, left + 11.0, y), np.zeros(2))


def _begins(image: Image, left: float, y: float) -> None:
    lens = Lens(1.0, left + 11.0, y)
    marks.draw_ring(image, lens.pixels(np.zeros(2)), 6.0, 2)


def _graze(image: Image, left: float, y: float) -> None:
    marks.draw_graze(image, Lens(1.0, left + 11.0, y), np.zeros(2))


_SIGNS: dict[str, Callable[[Image, float, float], None]] = {
    CONTACT: _contact,
    BEGINS: _begins,
    GRAZE: _graze,
    CLOSEST: _closest,
    TARGET: _target,
    TRAIL: _trail,
    DASHED: _dashed,
    PATH: _path,
    REFERENCE: _reference,
    BOUNDARY: _wall,
    SAFE: _area(theme.SAFE_AREA),
    DANGER: _area(theme.DANGER_AREA),
    ACCESSIBLE: _area(theme.FLOOR),
}
