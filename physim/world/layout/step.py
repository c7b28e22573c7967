"""How far robots move in a step: not so far that one could pass through something."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from physim.errors import Fault
from physim.geometry.polygon import circumscribed_radius, smallest_width
from physim.geometry.shapes import FloatArray
from physim.tolerances import TUNNEL_FRACTION
from physim.units import figure
from physim.world import Limits, Robot
from physim.world.faults import describe
from physim.world.layout.driven import drives_of
from physim.world.layout.robots import shared


def step_faults(
    step: float,
    robots: Sequence[Robot],
    entries: Sequence[int],
    footprints: list[FloatArray],
    parts: list[tuple[FloatArray, ...]],
) -> list[Fault]:
    """Refuse (v + r omega) dt beyond a quarter of the smallest width of any convex part.

    v is the greatest speed in any direction. One fault at most: of the step, or of the limits of
    the one robot that is too fast for it.
    """
    radius = np.array(shared(circumscribed_radius, footprints))
    width = np.array(shared(smallest_width, parts))
    v, omega, lateral, *_ = drives_of(robots, entries).most.T
    v = np.hypot(v, lateral)
    speed, limit = v + radius * omega, TUNNEL_FRACTION * float(width.min())
    count = int((speed * step > limit).sum())
    if not count:
        return []
    i, thin, usual = int(np.argmax(speed)), int(np.argmin(width)), Limits()
    at_usual = min(v[i], usual.v) + radius[i] * min(omega[i], usual.omega)
    is_its = count == 1 and at_usual * step <= limit
    unit = 10.0 ** (math.floor(math.log10(limit / speed[i])) - 2)  # three digits, rounded down
    largest = math.floor(limit / speed[i] / unit) * unit
    others = f", and {count - 1} more move too far" if count > 1 else ""
    return [
        Fault(
            ("robots", entries[i], "limits") if is_its else ("time", "step"),
            f"{describe(robots[i].name)} could move {figure(speed[i] * step)} m in a step of "
            f"{step:.6g} s, by v = {figure(v[i], 6)} m/s and omega = {figure(omega[i], 6)} rad/s"
            f"{others}; at most {limit:.4g} m are allowed, a quarter of the smallest width, that "
            f"of {describe(robots[thin].name)}: use a step of at most {largest:.3g} s, or lower "
            "limits",
        )
    ]
