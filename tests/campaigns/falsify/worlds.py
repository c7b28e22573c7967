"""Worlds that fail, or do not, in runs of milliseconds."""

from __future__ import annotations

from math import hypot, pi, sqrt
from typing import Any

from physim.world import World
from tests.helpers import inside

accepted, in_this_process = inside("physim.campaigns.falsify", "accepted", "in_this_process")
Judged = inside("physim.campaigns.falsify", "Judged")

BOX = {"length": 1.02, "width": 0.8}
EVALUATE = in_this_process()
ACCEPTS = accepted()


def robot(name: str, *pose: float, **more: Any) -> dict[str, Any]:
    return {"name": name, "footprint": BOX, "pose": pose, "path": {"offset": 0.0}, **more}


def five_robots(**changes: Any) -> World:
    """Five robots, of which the second drives into the fourth, 3.98 m ahead at 1 m/s.

    It touches at the sample of 4 s, whatever the others, the obstacles and the walls are.
    """
    values: dict[str, Any] = {
        "name": "five robots",
        "time": {"step": 0.05, "duration": 20.0},
        "corridor": {
            "centreline": [[0.0, 0.0], [5.0, 0.0], [10.0, 0.1], [15.0, 0.0], [20.0, 0.0]],
            "width": [12.0, 12.3, 12.1, 12.2, 12.0],
        },
        "robots": [
            robot("r1", 3.0, 4.0, 0.0),
            robot("r2", 3.0, 0.0, 0.0),
            robot("r3", 12.0, -4.0, 0.3),
            robot("r4", 8.0, 0.0, 0.0),
            robot("r5", 16.0, 4.1, 0.0),
        ],
        "controller": {
            "type": "constant",
            "commands": [[0.0, 0.0], [1.0, 0.0], [0.2, 0.0], [0.0, 0.0], [0.1, 0.0]],
        },
        "obstacles": [[[14.0, -1.0], [15.0, -1.0], [15.0, 0.0]]],
    }  # fmt: skip
    return World(**{**values, **changes})


def into_the_wall() -> World:
    """One robot drives at the wall, another drives along the road."""
    return World(
        name="into the wall",
        time={"step": 0.05, "duration": 12.0},
        corridor={"centreline": [[0.0, 0.0], [9.7, 0.0], [20.3, 0.0]], "width": 7.3},
        robots=[robot("a", 4.123, 0.217, 0.813), robot("b", 1.01, -1.07, 0.02)],
        controller={"type": "constant", "commands": [[1.0, 0.0], [0.5, 0.0]]},
    )


def past_a_corner(depth: float = 4e-4) -> World:
    """A robot passes the corner of another between two samples, ``depth`` [m] inside it."""
    half, long = sqrt(0.5), hypot(0.51, 0.4)
    x, y = (at + (long - depth) * half for at in (10.51, 0.4))
    back = (0.5 + 0.5 * 1.4 * 0.01) * half
    tip = [[0.0, -long], [0.3, 0.0], [0.0, 0.3], [-0.3, 0.0]]  # to the right of its heading
    return World(
        name="past a corner",
        time={"step": 0.01, "duration": 1.0},
        corridor={"centreline": [[0.0, 0.0], [20.0, 0.0]], "width": 12.0},
        robots=[
            robot("stands", 10.0, 0.0, 0.0),
            {**robot("passes", x - back, y + back, -0.25 * pi), "footprint": tip},
        ],
        controller={"type": "constant", "commands": [[0.0, 0.0], [1.4, 0.0]]},
    )


def judge(world: World) -> Judged:
    return next(iter(EVALUATE([world])))
