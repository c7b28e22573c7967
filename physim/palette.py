"""Colours that videos and pictures share, RGB from 0 to 255.

The robots' own lines have the "muted" scheme of Paul Tol, which stays apart under the common kinds
of colour blindness.
"""

from __future__ import annotations

import functools

Colour = tuple[int, int, int]

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


def robot_colour(index: int) -> Colour:
    """Return the colour of a robot's own lines; it repeats after ten robots."""
    return ROBOTS[index % len(ROBOTS)]


@functools.lru_cache(maxsize=4096)
def mix(a: Colour, b: Colour, share: float) -> Colour:
    """Return ``a`` with ``share`` (0 to 1) of ``b``."""
    red, green, blue = (round(x + (y - x) * share) for x, y in zip(a, b, strict=True))
    return red, green, blue
