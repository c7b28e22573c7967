"""What the signs mean: one small drawing and a few words for each."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

from physim.control import Mode
from physim.video import marks, theme
from physim.video.camera import Lens
from physim.video.closest import Pair
from physim.video.robots import Fleet, draw_robot
from physim.video.text import Image, write
from physim.video.theme import Colour

ROW = 21
"""[px] height of a line of the legend"""
SIGN = 30
"""[px] room for the sign"""
_BOX = np.array([[-9.0, -5.5], [9.0, -5.5], [9.0, 5.5], [-9.0, 5.5]])
_UNIT = Lens(1.0, 0.0, 0.0)


def draw_modes(image: Image, left: int, top: int) -> None:
    """Draw one line a mode: a robot in its colour, and its name."""
    fleet = Fleet([[_BOX]])
    for row, mode in enumerate(Mode):
        y = top + row * ROW + ROW / 2.0
        vertices = Lens(1.0, left + 11.0, y).fixed(fleet.placed(np.zeros((1, 3))))
        draw_robot(image, fleet.split(vertices)[0], mode, False)
        write(image, theme.MODE_WORDS[mode], (left + SIGN, y + 5), theme.TEXT)


def draw_signs(image: Image, left: int, top: int, cluster: bool) -> int:
    """Draw the other signs, one a line; return the height used. ``cluster``: several robots."""
    signs = [sign for sign in _SIGNS if cluster or sign[0] != _CLOSEST]
    for row, (words, draw) in enumerate(signs):
        y = top + row * ROW + ROW / 2.0
        draw(image, left, y)
        write(image, words, (left + SIGN, y + 5), theme.TEXT)
    return len(signs) * ROW


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
    colour = theme.mix(theme.robot_colour(0), theme.WHITE, 0.42)
    x, row = int(left), round(y)
    for start, end in ((0, 9), (12, 15), (19, 22)):
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


_CLOSEST = "closest pair"
_SIGNS: tuple[tuple[str, Callable[[Image, float, float], None]], ...] = (
    ("contact", _contact),
    (_CLOSEST, _closest),
    ("target", _target),
    (f"trail, last {theme.TRAIL:g} s", _trail),
    ("path, dashed in danger area", _path),
    ("reference path", _reference),
    ("boundary", _wall),
    ("safe area", _area(theme.SAFE_AREA)),
    ("danger area", _area(theme.DANGER_AREA)),
)
