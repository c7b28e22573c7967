"""Parts of a frame, and what of a colour is in them."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.drawing import palette
from tests.helpers import inside

HEIGHT, WIDTH, PANEL_WIDTH = inside("physim.drawing.video", "HEIGHT", "WIDTH", "PANEL_WIDTH")
STRIP_HEIGHT, Camera, BOX = inside("physim.drawing.video", "STRIP_HEIGHT", "Camera", "VIEW")
ground = inside("physim.drawing.video", "ground")
Timeline = inside("physim.drawing", "Timeline")

VIEW = (slice(0, HEIGHT - STRIP_HEIGHT), slice(0, WIDTH - PANEL_WIDTH))
STRIP = (slice(HEIGHT - STRIP_HEIGHT, None), VIEW[1])


def pixels(image: Any, colour: palette.Colour, part: Any = VIEW) -> int:
    """How many pixels of a part of a frame have a colour."""
    return int((image[part] == np.array(colour, np.uint8)).all(axis=2).sum())


def around(record: Any, time: float, place: Any, reach: int) -> tuple[slice, slice]:
    """The pixels next to a place [m] of the view, at a time of a film at speed 1."""
    timeline = Timeline(record)
    camera = Camera(timeline, ground(timeline).extent, BOX, 1.0)
    column, row = np.rint(camera.lens(time).pixels(np.asarray(place))).astype(int).tolist()
    return slice(row - reach, row + reach + 1), slice(column - reach, column + reach + 1)
