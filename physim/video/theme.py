"""Colours and sizes of the video. Colours are RGB; lengths are pixels of the 1280 x 720 picture.

Modes and contacts use the palette of Okabe and Ito (2008), which stays apart under the common
kinds of colour blindness. What all pictures share is in `physim.palette`.
"""

from __future__ import annotations

from physim.control import Mode
from physim.palette import (
    DANGER_AREA,
    FAINT,
    FLOOR,
    INK,
    OBSTACLE,
    OUTSIDE,
    QUIET,
    REFERENCE,
    ROBOTS,
    RULE,
    SAFE_AREA,
    WALL,
    WHITE,
    Colour,
    mix,
    robot_colour,
)

WIDTH, HEIGHT = 1280, 720
PANEL_WIDTH = 272
STRIP_HEIGHT = 184

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


def mode_colour(mode: int) -> Colour:
    """Return the fill of a robot in ``mode``; -1 is a robot that has not decided yet."""
    try:
        return MODES[Mode(mode)]
    except ValueError:
        return UNDECIDED


__all__ = [
    "CLOSEST",
    "CONTACT",
    "DANGER_AREA",
    "FAINT",
    "FLASH",
    "FLOOR",
    "HEIGHT",
    "INK",
    "MARK",
    "MODES",
    "MODE_WORDS",
    "OBSTACLE",
    "OUTSIDE",
    "PANEL_WIDTH",
    "QUIET",
    "REFERENCE",
    "ROBOTS",
    "RULE",
    "SAFE_AREA",
    "SHIFT",
    "SMALL",
    "STRIP_HEIGHT",
    "TARGET",
    "TEXT",
    "TITLE",
    "TRAIL",
    "UNDECIDED",
    "WALL",
    "WHITE",
    "WIDTH",
    "Colour",
    "mix",
    "mode_colour",
    "robot_colour",
]
