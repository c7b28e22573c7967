"""Colours of the product, wherever they stand in it."""

from __future__ import annotations

from tests.helpers import inside

BAND, CONTACT, DANGER_AREA = inside("physim.drawing", "BAND", "CONTACT", "DANGER_AREA")
FLOOR, INK, OUTSIDE, WHITE = inside("physim.drawing", "FLOOR", "INK", "OUTSIDE", "WHITE")
REFERENCE, ROBOTS, SAFE_AREA = inside("physim.drawing", "REFERENCE", "ROBOTS", "SAFE_AREA")
UNDECIDED, WALL, Colour = inside("physim.drawing", "UNDECIDED", "WALL", "Colour")
MOVER = inside("physim.drawing", "MOVER")
hexed, mix, rgb = inside("physim.drawing", "hexed", "mix", "rgb")
PATH_TINT, robot_colour = inside("physim.drawing", "PATH_TINT", "robot_colour")
