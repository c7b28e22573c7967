"""How far robots move in a step: not so far that one could pass through something."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from physim.errors import Fault, Location
from physim.geometry.polygon import circumscribed_radius, convex_parts, smallest_width
from physim.geometry.shapes import FloatArray
from physim.tolerances import TUNNEL_FRACTION
from physim.world import Limits, Robot
from physim.world.faults import describe
from physim.world.layout.robots import shared


def step_faults(
    step: float, robots: Sequence[Robot], entries: Sequence[int], footprints: list[FloatArray]
) -> list[Fault]:
    """Refuse (v + r omega) dt beyond a quarter of the smallest width of any convex part.

    One fault at most: of the step, or of the limits of the one robot that is too fast for it.
    """
    radius, width = (
        np.array(shared(of, footprints))
        for of in (circumscribed_radius, lambda outline: smallest_width(convex_parts(outline)))
    )
    v, omega = np.array([(robot.limits.v, robot.limits.omega) for robot in robots]).T
    speed, limit = v + radius * omega, TUNNEL_FRACTION * float(width.min())
    count = int((speed * step > limit).sum())
    if not count:
        return []
    i, usual = int(np.argmax(speed)), Limits()
    at_usual = min(v[i], usual.v) + radius[i] * min(omega[i], usual.omega)
    where: Location = ("time", "step")
    if count == 1 and at_usual * step <= limit:
        where = ("robots", entries[i], "limits")
    unit = 10.0 ** (math.floor(math.log10(limit / speed[i])) - 2)  # three digits, rounded down
    largest = math.floor(limit / speed[i] / unit) * unit
    others = f", and {count - 1} more move too far" if count > 1 else ""
    return [
        Fault(
            where,
            f"{describe(robots[i].name)} could move {speed[i] * step:.4g} m in one step of "
            f"{step:.6g} s (v {v[i]:.6g} m/s + {radius[i]:.4g} m x {omega[i]:.6g} rad/s){others}; "
            f"at most {limit:.4g} m are allowed, a quarter of the smallest width, "
            f"that of {describe(robots[int(np.argmin(width))].name)}; use a step of at most "
            f"{largest:.3g} s or lower limits",
        )
    ]
