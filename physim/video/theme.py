"""Colours and sizes of the video. Colours are RGB; lengths are pixels of the 1280 x 720 picture.

Modes and contacts use the palette of Okabe and Ito (2008), the robots' own lines the "muted"
scheme of Paul Tol: both stay apart under the common kinds of colour blindness.
"""

from __future__ import annotations

import functools

from physim.control import Mode

Colour = tuple[int, int, int]

WIDTH, HEIGHT = 1280, 720
PANEL_WIDTH = 272
STRIP_HEIGHT = 184

WHITE: Colour = (255, 255, 255)
INK: Colour = (34, 38, 44)
QUIET: Colour = (98, 104, 112)
RULE: Colour = (214, 218, 222)
FAINT: Colour = (236, 238, 240)

OUTSIDE: Colour = (241, 242, 243)
FLOOR: Colour = (250, 251, 252)
"""Accessible area of a run that knew no safe and danger areas."""
DANGER_AREA: Colour = (252, 229, 213)
SAFE_AREA: Colour = (231, 240, 246)
WALL: Colour = (38, 42, 48)
OBSTACLE: Colour = (128, 133, 140)
REFERENCE: Colour = (120, 126, 134)
TARGET: Colour = (34, 38, 44)
CONTACT: Colour = (213, 94, 0)
CLOSEST: Colour = (34, 38, 44)

MODES: dict[Mode, Colour] = {
    Mode.SAFE: (0, 114, 178),
    Mode.DISTANCE: (230, 159, 0),
    Mode.TIME: (204, 90, 160),
    Mode.ARRIVED: (0, 158, 115),
}
UNDECIDED: Colour = (150, 155, 162)
"""Fill of a robot that has not decided yet (or gave a mode that is not known)."""

MODE_WORDS: dict[Mode, str] = {
    Mode.SAFE: "safe",
    Mode.DISTANCE: "danger, by distance",
    Mode.TIME: "danger, by collision time",
    Mode.ARRIVED: "arrived",
}

ROBOTS: tuple[Colour, ...] = (
    (51, 34, 136),
    (204, 102, 119),
    (17, 119, 51),
    (170, 68, 153),
    (68, 170, 153),
    (153, 153, 51),
    (136, 34, 85),
    (221, 170, 51),
    (90, 170, 215),
    (110, 110, 110),
)

TEXT = 14
"""[px] font size of running text; 13 is the least used anywhere"""
SMALL = 13
TITLE = 17

TRAIL = 10.0
"""[s] simulated length of a trail"""
FLASH = 0.5
"""[s of video] length of the flash at a contact"""
MARK = 1.0
"""[s] least simulated time that the mark of a contact stays, and at least FLASH of video"""

SHIFT = 4
"""Fractional bits of the pixel coordinates given to OpenCV (1/16 px)."""


def robot_colour(index: int) -> Colour:
    """Return the colour of a robot's own lines; it repeats after ten robots."""
    return ROBOTS[index % len(ROBOTS)]


def mode_colour(mode: int) -> Colour:
    """Return the fill of a robot in ``mode``; -1 is a robot that has not decided yet."""
    try:
        return MODES[Mode(mode)]
    except ValueError:
        return UNDECIDED


@functools.lru_cache(maxsize=4096)
def mix(a: Colour, b: Colour, share: float) -> Colour:
    """Return ``a`` with ``share`` (0 to 1) of ``b``."""
    red, green, blue = (round(x + (y - x) * share) for x, y in zip(a, b, strict=True))
    return red, green, blue
