"""Write a case as a small world that ``physim run`` replays, to the bit at the same coordinates."""

from __future__ import annotations

from math import cos, sin

from physim.crashtest.case import STEPS, Case
from physim.geometry.shapes import FloatArray
from physim.world import World

HALF_WIDTH = 29.0
"""[m] from the middle of the place to the boundary that closes it"""
LEAST = 1e-6
"""[m/s, rad/s] least limit of a robot that does not use it"""


def case_world(case: Case, seed: int, reason: str) -> World:
    """World of a case; ``reason`` goes into its description."""
    layout = case.layout
    (x, y), commands = case.origin, layout.command.tolist()
    corners = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    ring = [(x + i * HALF_WIDTH, y + j * HALF_WIDTH) for i, j in corners]
    robots = [
        {
            "name": f"robot {k + 1}",
            "footprint": layout.robots[k].outline.tolist(),
            "pose": layout.start[k].tolist(),
            "path": _ahead(layout.start[k]),
            "limits": {"v": max(abs(v), LEAST), "omega": max(abs(omega), LEAST)},
        }
        for k, (v, omega) in enumerate(commands)
    ]
    return World(
        name=f"crash-{seed}-{case.number}",
        description=f"Crash test, seed {seed}, case {case.number} ({case.kind}): {reason}",
        seed=seed,
        time={"step": case.dt, "duration": round(STEPS * case.dt, 12)},
        boundaries=[*(line.tolist() for line in layout.lines), [*ring, ring[0]]],
        reference_path=[(x - 5.0, y - HALF_WIDTH + 1.0), (x + 5.0, y - HALF_WIDTH + 1.0)],
        robots=robots,
        controller={"type": "constant", "commands": commands},
        obstacles=[solid.outline.tolist() for solid in layout.solids],
    )


def _ahead(pose: FloatArray) -> list[tuple[float, float]]:
    """A path of a metre straight ahead: every robot needs one, nobody follows it here."""
    x, y, heading = pose.tolist()
    return [(x, y), (x + cos(heading), y + sin(heading))]
