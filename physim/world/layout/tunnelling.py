"""How far robots move in a step: not so far that one could pass through something."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from physim.errors import Fault, Location
from physim.geometry.polygon import (
    circumscribed_radius,
    convex_parts,
    least_width,
    smallest_width,
)
from physim.tolerances import TUNNEL_FRACTION
from physim.world import Limits
from physim.world.faults import describe

HUGE = 15.0
"""[m] A footprint that reaches further from its reference point is likely in other units."""

SLIVER = 0.1
"""[-] of the width of an outline below which one of its convex parts is hardly meant"""


class Moving(NamedTuple):
    """What says how far a robot may move in one step."""

    number: int
    name: str
    outline: ArrayLike
    """simple, (n, 2) [m] in the robot's frame"""
    v: float
    """[m/s]"""
    omega: float
    """[rad/s]"""


def tunnelling(robots: Sequence[Moving], step: float) -> list[Fault]:
    """Refuse (v + r |omega|) dt beyond a quarter of the smallest width: see physics, time step.

    One fault at most: of the step where it is too long for several robots, or for one at the
    limits that robots have by default; else of the limits of the one robot that is too fast, or
    of a footprint so large that it can hardly be in metres.
    """
    if not robots:
        return []
    outlines = [np.asarray(robot.outline, dtype=np.float64) for robot in robots]
    keys = [outline.tobytes() for outline in outlines]
    different = dict(zip(keys, outlines, strict=True))
    known = {key: smallest_width(convex_parts(outline)) for key, outline in different.items()}
    widths = [known[key] for key in keys]
    narrowest = robots[int(np.argmin(widths))]
    limit = TUNNEL_FRACTION * min(widths)
    speeds = [robot.v + circumscribed_radius(robot.outline) * robot.omega for robot in robots]
    count = sum(speed * step > limit for speed in speeds)
    if not count:
        return []
    speed, robot = max(zip(speeds, robots, strict=True), key=lambda pair: pair[0])
    radius, usual = circumscribed_radius(robot.outline), Limits()
    at_usual = min(robot.v, usual.v) + radius * min(robot.omega, usual.omega)
    where: Location = ("time", "step")
    if radius > HUGE:
        where = ("robots", robot.number, "footprint")
    elif count == 1 and at_usual * step <= limit:
        where = ("robots", robot.number, "limits")
    others = f", and {count - 1} more move too far" if count > 1 else ""
    moves, allowed = _told_apart(speed * step, limit)
    message = (
        f"{describe(robot.name)} could move {moves} m in one step of "
        f"{step:.6g} s (v {robot.v:.6g} m/s + {radius:.4g} m x omega "
        f"{robot.omega:.6g} rad/s){others}; at most {allowed} m are allowed, a quarter "
        f"of the smallest width, that of {describe(narrowest.name)}{_of_parts(narrowest)}; "
        f"use a step of at most {_floored(limit / speed)} s or lower limits"
    )
    if radius > HUGE:
        message = (
            f"{describe(robot.name)} reaches {radius:.6g} m from its reference point; are its "
            f"lengths in metres, not in centimetres or millimetres? As it stands, {message}"
        )
    return [Fault(where, message)]


def _of_parts(robot: Moving) -> str:
    """Why a robot counts as narrow that is not: a convex part of it is a sliver; empty if none."""
    outline = np.asarray(robot.outline, dtype=np.float64)
    parts = convex_parts(outline)
    width = smallest_width(parts)
    if len(parts) < 2 or width > SLIVER * least_width(outline):
        return ""
    return (
        f" ({width:.2g} m: its outline is dented, and cut into {len(parts)} convex parts; leave "
        "out corners that are meant to lie on a line)"
    )


def _told_apart(one: float, other: float) -> tuple[str, str]:
    """Two different numbers, to four significant digits or as many as they differ in."""
    texts = ((f"{one:.{digits}g}", f"{other:.{digits}g}") for digits in range(4, 18))
    return next(pair for pair in texts if pair[0] != pair[1])


def _floored(value: float) -> str:
    """Three significant digits, rounded down."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return f"{math.floor(value / unit) * unit:.3g}"
