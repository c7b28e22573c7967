"""Sizes of the video, and the colours it uses of `physim.palette`.

Colours are RGB; lengths are pixels of the 1280 x 720 picture.
"""

from __future__ import annotations

from physim.palette import (
    CONTACT,
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
    UNDECIDED,
    WALL,
    WHITE,
    Colour,
    mix,
    robot_colour,
)

WIDTH, HEIGHT = 1280, 720
PANEL_WIDTH = 272
STRIP_HEIGHT = 184

TARGET: Colour = INK
CLOSEST: Colour = INK

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
    "robot_colour",
]
