"""Cases of the crash test as worlds: small ones that ``physim run`` replays.

To the bit at the same coordinates; a box to push to rounding.
"""

from __future__ import annotations

from math import atan, cos, sin
from typing import Any

import numpy as np

from physim.analysis.crashtest.drafts import STEPS, Case, Layout
from physim.geometry.motion import arc
from physim.geometry.shapes import FloatArray
from physim.world import World

HALF_WIDTH = 29.0
"""[m] from the middle of the place to the boundary that closes it"""
LEAST = 1e-6
"""[m/s, rad/s] least limit of a robot that does not use it"""
WHEELBASE = 0.1
"""[m] of cars: short, so that they can take every arc"""


def way_of(layout: Layout, dt: float) -> tuple[FloatArray, FloatArray]:
    """Waypoints (n, 3) and times (n,) [s] of the mover of a layout: its arc, for a whole case."""
    (v, omega, lateral), duration = layout.command[1].tolist(), (STEPS + 1) * dt
    times = np.linspace(0.0, duration, 2 + int(0.5 * abs(omega) * duration))
    x, y, heading = layout.start[1].tolist()
    poses = [arc(x, y, heading, v, omega, lateral, time) for time in times.tolist()]
    return np.array(poses), times


def case_world(case: Case, seed: int, reason: str) -> World:
    """World of a case; ``reason`` goes into its description."""
    layout = case.layout
    (x, y), commands = case.origin, layout.command
    movers, pushed = [], []
    if layout.second != "robot":
        commands, other = commands[:1], layout.robots[1]
        px, py, heading = layout.start[1].tolist()
        c, s = cos(heading), sin(heading)
        corners = other.outline @ np.array([[c, s], [-s, c]]) + [px, py]
        pushed = [{"corners": corners.tolist(), "mass": other.mass}]
    if layout.second == "mover":
        poses, times = way_of(layout, case.dt)
        way = {"waypoints": poses.tolist(), "times": times.tolist()}
        movers, pushed = [{"name": "mover", "footprint": other.outline.tolist(), **way}], []
    square = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    ring = [(x + i * HALF_WIDTH, y + j * HALF_WIDTH) for i, j in square]
    robots = []
    for k, (v, omega, lateral) in enumerate(commands.tolist()):
        px, py, heading = layout.start[k].tolist()
        robots.append({
            "name": f"robot {k + 1}",
            "footprint": layout.robots[k].outline.tolist(),
            "pose": [px, py, heading],
            # a metre straight ahead: every robot needs a path, nobody follows it here
            "path": [(px, py), (px + cos(heading), py + sin(heading))],
            "limits": {"v": max(abs(v), LEAST), "omega": max(abs(omega), LEAST)},
        })  # fmt: skip
        if lateral:
            robots[k]["drive"] = {"type": "omni", "lateral": abs(lateral)}
        elif v and case.number % 2:
            steering = atan(WHEELBASE * abs(omega / v)) + LEAST
            robots[k]["drive"] = {"type": "car", "wheelbase": WHEELBASE, "steering": steering}
    columns = 3 if commands[:, 2].any() else 2
    values: dict[str, Any] = {
        "name": f"crash-{seed}-{case.number}",
        "description": f"Crash test, seed {seed}, case {case.number} ({case.kind}): {reason}",
        "seed": seed,
        "time": {"step": case.dt, "duration": round(STEPS * case.dt, 12)},
        "boundaries": [*(line.tolist() for line in layout.lines), [*ring, ring[0]]],
        "reference_path": [(x - 5.0, y - HALF_WIDTH + 1.0), (x + 5.0, y - HALF_WIDTH + 1.0)],
        "robots": robots,
        "controller": {"type": "constant", "commands": commands[:, :columns].tolist()},
        "obstacles": [*(outline.tolist() for outline, *_ in layout.solids), *pushed],
        "movers": movers,
    }
    return World(**values)
