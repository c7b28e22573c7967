"""Things drawn in the view beside the robots: trails, targets, the closest pair, contacts."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray
from physim.video import theme
from physim.video.camera import Lens, fixed
from physim.video.closest import Pair
from physim.video.text import Image
from physim.video.theme import SHIFT, Colour

ONE = 1 << SHIFT


def draw_trail(view: Image, pixels: NDArray[np.int32], colour: Colour, bands: int) -> None:
    """Draw where a robot went, (T, 2) fixed-point pixels, old to new, fading in ``bands`` steps."""
    count = len(pixels) - 1
    for band in range(bands):
        first, last = band * count // bands, (band + 1) * count // bands
        if last > first:
            shade = theme.mix(colour, theme.SAFE_AREA, 0.85 * (1.0 - (band + 1) / bands))
            piece = [pixels[first : last + 1]]
            cv2.polylines(view, piece, False, shade, 2, cv2.LINE_AA, SHIFT)


def draw_target(view: Image, lens: Lens, robot: FloatArray, target: FloatArray) -> None:
    """Draw a target (2,) [m] as a small ring, joined to its robot by a thin line."""
    if not np.isfinite(target).all():
        return
    ends = lens.fixed(np.stack((robot, target)))
    cv2.polylines(view, [ends], False, theme.QUIET, 1, cv2.LINE_AA, SHIFT)
    cv2.circle(view, ends[1].tolist(), 3 * ONE, theme.WHITE, cv2.FILLED, cv2.LINE_AA, SHIFT)
    cv2.circle(view, ends[1].tolist(), 3 * ONE, theme.TARGET, 1, cv2.LINE_AA, SHIFT)


def draw_reference_point(view: Image, lens: Lens, place: FloatArray) -> None:
    """Draw the reference point (2,) [m] of a robot, where its target line starts."""
    at = lens.fixed(place).tolist()
    cv2.circle(view, at, round(3.5 * ONE), theme.WHITE, cv2.FILLED, cv2.LINE_AA, SHIFT)
    cv2.circle(view, at, round(2.2 * ONE), theme.TARGET, cv2.FILLED, cv2.LINE_AA, SHIFT)


def draw_closest(view: Image, lens: Lens, pair: Pair) -> None:
    """Join the closest points of the closest pair."""
    ends = lens.fixed(pair.points)
    cv2.polylines(view, [ends], False, theme.WHITE, 5, cv2.LINE_AA, SHIFT)
    cv2.polylines(view, [ends], False, theme.CLOSEST, 2, cv2.LINE_AA, SHIFT)
    for end in ends.tolist():
        cv2.circle(view, end, 3 * ONE, theme.CLOSEST, cv2.FILLED, cv2.LINE_AA, SHIFT)


def draw_flash(view: Image, lens: Lens, place: FloatArray, age: float, speed: float) -> None:
    """Draw the growing ring round a contact that began ``age`` simulated seconds ago."""
    grown = age / (theme.FLASH * speed)
    centre = lens.pixels(place)
    if grown >= 1.0 or not np.isfinite(centre).all():
        return
    draw_ring(view, centre, 9.0 + 25.0 * grown, 4)


def draw_ring(image: Image, centre: FloatArray, radius: float, width: int) -> None:
    """Draw a ring in the contact colour round ``centre`` (2,), all [px]."""
    at, reach = fixed(centre).tolist(), round(radius * ONE)
    cv2.circle(image, at, reach, theme.WHITE, width + 3, cv2.LINE_AA, SHIFT)
    cv2.circle(image, at, reach, theme.CONTACT, width, cv2.LINE_AA, SHIFT)


def draw_contact(view: Image, lens: Lens, place: FloatArray) -> None:
    """Draw the cross of a contact at ``place`` (2,) [m]."""
    centre = lens.pixels(place)
    if np.isfinite(centre).all():
        draw_cross(view, centre, 7.0, 4)


def draw_graze(view: Image, lens: Lens, place: FloatArray) -> None:
    """Draw the diamond of a graze between two samples at ``place`` (2,) [m]."""
    centre = lens.pixels(place)
    if np.isfinite(centre).all():
        draw_diamond(view, centre, 9.0, 3)


def draw_diamond(image: Image, centre: FloatArray, arm: float, width: int) -> None:
    """Draw an open diamond in the contact colour, ``arm`` [px] to each side of ``centre``."""
    corners = arm * np.array([[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])
    diamond = [fixed(centre + corners)]
    cv2.polylines(image, diamond, True, theme.WHITE, width + 3, cv2.LINE_AA, SHIFT)
    cv2.polylines(image, diamond, True, theme.CONTACT, width, cv2.LINE_AA, SHIFT)


def draw_cross(image: Image, centre: FloatArray, arm: float, width: int) -> None:
    """Draw a cross in the contact colour, ``arm`` [px] to each side, at ``centre`` (2,) [px]."""
    arms = arm * np.array([[[-1.0, -1.0], [1.0, 1.0]], [[-1.0, 1.0], [1.0, -1.0]]])
    cross = list(fixed(centre + arms))
    cv2.polylines(image, cross, False, theme.WHITE, width + 3, cv2.LINE_AA, SHIFT)
    cv2.polylines(image, cross, False, theme.CONTACT, width, cv2.LINE_AA, SHIFT)


def mark_lasts(speed: float) -> float:
    """Return how long [s, simulated] a contact's mark stays at least, at a playback speed."""
    return max(theme.MARK, theme.FLASH * speed)
