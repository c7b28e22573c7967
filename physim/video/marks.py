"""Things drawn in the view beside the robots: trails, targets, the closest pair, contacts."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from physim import palette
from physim.geometry.shapes import FloatArray
from physim.palette import Colour
from physim.video.closest import Pair
from physim.video.layout import FLASH, MARK, ONE, SHIFT, Image, Lens, fixed

CORNERS = np.array([[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])
"""of the diamond of a graze"""
ARMS = np.array([[[-1.0, -1.0], [1.0, 1.0]], [[-1.0, 1.0], [1.0, -1.0]]])
"""of the cross of a contact"""


def draw_lines(
    image: Image, lines: NDArray[np.int32], colour: Colour, width: int, closed: bool = False
) -> None:
    """Draw lines (k, n, 2) of fixed-point pixels."""
    cv2.polylines(image, list(lines), closed, colour, width, cv2.LINE_AA, SHIFT)


def draw_disc(
    image: Image, at: NDArray[np.int32], radius: float, colour: Colour, width: int = cv2.FILLED
) -> None:
    """Draw a disc, or a ring of some ``width``, of ``radius`` [px] round fixed-point pixels."""
    cv2.circle(image, at.tolist(), round(radius * ONE), colour, width, cv2.LINE_AA, SHIFT)


def draw_trail(view: Image, pixels: NDArray[np.int32], colour: Colour, bands: int) -> None:
    """Draw where a robot went, (T, 2) fixed-point pixels, old to new, fading in ``bands`` steps."""
    count = len(pixels) - 1
    for band in range(bands):
        first, last = band * count // bands, (band + 1) * count // bands
        if last > first:
            shade = palette.mix(colour, palette.SAFE_AREA, 0.85 * (1.0 - (band + 1) / bands))
            draw_lines(view, pixels[None, first : last + 1], shade, 2)


def draw_target(view: Image, lens: Lens, robot: FloatArray, target: FloatArray) -> None:
    """Draw a target (2,) [m] as a small ring, joined to its robot by a thin line."""
    if not np.isfinite(target).all():
        return
    ends = lens.fixed(np.stack((robot, target)))
    draw_lines(view, ends[None], palette.QUIET, 1)
    draw_disc(view, ends[1], 3.0, palette.WHITE)
    draw_disc(view, ends[1], 3.0, palette.INK, 1)


def draw_reference_point(view: Image, lens: Lens, place: FloatArray) -> None:
    """Draw the reference point (2,) [m] of a robot, where its target line starts."""
    at = lens.fixed(place)
    draw_disc(view, at, 3.5, palette.WHITE)
    draw_disc(view, at, 2.2, palette.INK)


def draw_closest(view: Image, lens: Lens, pair: Pair) -> None:
    """Join the closest points of the closest pair."""
    ends = lens.fixed(pair.points)
    draw_lines(view, ends[None], palette.WHITE, 5)
    draw_lines(view, ends[None], palette.INK, 2)
    for end in ends:
        draw_disc(view, end, 3.0, palette.INK)


def draw_flash(view: Image, centre: FloatArray, age: float, speed: float) -> None:
    """Draw the growing ring round a contact that began ``age`` simulated seconds ago."""
    grown = age / (FLASH * speed)
    if grown < 1.0 and np.isfinite(centre).all():
        draw_ring(view, centre, 9.0 + 25.0 * grown, 4)


def draw_ring(image: Image, centre: FloatArray, radius: float, width: int) -> None:
    """Draw a ring in the contact colour round ``centre`` (2,), all [px]."""
    draw_disc(image, fixed(centre), radius, palette.WHITE, width + 3)
    draw_disc(image, fixed(centre), radius, palette.CONTACT, width)


def draw_contact(image: Image, centre: FloatArray, swept: bool, small: bool = False) -> None:
    """Draw the cross of a contact, or the open diamond of a graze, at ``centre`` (2,) [px]."""
    if not np.isfinite(centre).all():
        return
    shape = CORNERS[None] if swept else ARMS
    arm, width = ((5.0, 2) if swept else (4.0, 2)) if small else ((9.0, 3) if swept else (7.0, 4))
    lines = fixed(centre + arm * shape)
    draw_lines(image, lines, palette.WHITE, width + 3, swept)
    draw_lines(image, lines, palette.CONTACT, width, swept)


def mark_lasts(speed: float) -> float:
    """Return how long [s, simulated] a contact's mark stays at least, at a playback speed."""
    return max(MARK, FLASH * speed)
