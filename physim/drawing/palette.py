"""The one palette of everything that shows a run or a world, RGB from 0 to 255.

Contacts have the vermilion of Okabe and Ito (2008), and nothing else has it. Modes have the colours
that their controller declares; those of the paper's modes stay apart under the common kinds of
colour blindness, and so do the robots' own: every two of the ten, and each of them and a contact,
are at least 9 hundredths of Oklab apart, seen with full vision and without red or green cones.
"""

from __future__ import annotations

import functools
from types import MappingProxyType

Colour = tuple[int, int, int]

WHITE: Colour = (255, 255, 255)
INK: Colour = (34, 38, 44)
QUIET: Colour = (98, 104, 112)
RULE: Colour = (214, 218, 222)
FAINT: Colour = (236, 238, 240)

OUTSIDE: Colour = (241, 242, 243)
FLOOR: Colour = (250, 251, 252)
"""Accessible area of a run that knew no safe and danger areas."""
DANGER_AREA: Colour = (247, 214, 196)
"""darker than the safe area, so that the two differ without colour"""
SAFE_AREA: Colour = (229, 240, 246)
WALL: Colour = (38, 42, 48)
OBSTACLE: Colour = (128, 133, 140)
REFERENCE: Colour = (120, 126, 134)
MOVER: Colour = (250, 225, 25)
"""Movers, whoever they are, and nothing else."""
WAY: Colour = (154, 142, 33)
"""Where movers go: their colour, dark enough for a line on the ground."""

CONTACT: Colour = (213, 94, 0)
"""Contacts, swept ones included, and nothing else."""
UNDECIDED: Colour = (150, 155, 162)
"""A robot that has not decided yet, or whose controller gave no mode."""
WIDTH: Colour = (0, 105, 120)
"""Widths of the corridor, and its narrowest place."""
BAND: Colour = (86, 103, 133)
"""Bands and medians of a crowd."""

ROBOTS: tuple[Colour, ...] = (
    (30, 15, 165),
    (105, 195, 90),
    (180, 105, 255),
    (0, 75, 0),
    (135, 90, 75),
    (105, 0, 105),
    (180, 45, 150),
    (75, 90, 210),
    (195, 135, 150),
    (60, 180, 225),
)
"""Robots' own lines, by index; the first four are farthest apart."""


KEYS = MappingProxyType(
    {
        "paper": WHITE,
        "ink": INK,
        "quiet": QUIET,
        "rule": RULE,
        "faint": FAINT,
        "outside": OUTSIDE,
        "floor": FLOOR,
        "danger": DANGER_AREA,
        "safe": SAFE_AREA,
        "wall": WALL,
        "obstacle": OBSTACLE,
        "reference": REFERENCE,
        "mover": MOVER,
        "way": WAY,
        "contact": CONTACT,
        "undecided": UNDECIDED,
        "band": BAND,
    }
)
"""Names of colours, for what is drawn and for the page, which has others for some in the dark."""
PATH_TINT = 0.42
"""Share of white in the colour of a path."""


def keyed(key: str | int) -> Colour:
    """Return the colour of a name of `KEYS`, or a robot's own by its index."""
    return robot_colour(key) if isinstance(key, int) else KEYS[key]


def robot_colour(index: int) -> Colour:
    """Return the colour of a robot's own lines; it repeats after ten robots."""
    return ROBOTS[index % len(ROBOTS)]


def hexed(colour: Colour) -> str:
    """Colour as matplotlib, SVG and controllers write it, ``#rrggbb``."""
    return "#{:02x}{:02x}{:02x}".format(*colour)


def rgb(colour: str) -> Colour:
    """Colour of ``#rrggbb``."""
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return red, green, blue


@functools.lru_cache(maxsize=4096)
@functools.lru_cache(maxsize=1024)
def mix(a: Colour, b: Colour, share: float) -> Colour:
    """Return ``a`` with ``share`` (0 to 1) of ``b``."""
    red, green, blue = (round(x + (y - x) * share) for x, y in zip(a, b, strict=True))
    return red, green, blue
