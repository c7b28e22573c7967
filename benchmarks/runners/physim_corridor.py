"""physim's corridor: the world, the settings of its controllers, the controller of one's own.

The walls are 200 segments. The paper's controller decides every 0.1 s, as those of the peers do.
"""

from __future__ import annotations

from math import atan2, hypot, pi
from typing import Any

import numpy as np
from common import (
    LENGTH_OF_ROBOT,
    PACKED,
    PERIOD,
    SPACING,
    SPEED,
    STEP,
    WIDTH,
    WIDTH_OF_ROBOT,
    lane,
    places,
    road_length,
)  # fmt: skip

from physim import Decision, Mode, Simulation, World

SHORT = {"look_ahead": 1.0, "horizon": 10.0, "longest_interval": PERIOD}
NEAR = {"distance_low": 0.15, "distance_high": 0.25, "boundary_low": 0.05, "safe_distance": 0.3}
SOON = {"time_low": 0.5, "time_high": 1.0}
ALWAYS = {"distance_low": 0.5, "distance_high": 0.8, "boundary_low": 6.0, "avoidance": "time"}
"""Thresholds under which no robot is ever safe: no place of the corridor is 6 m from its walls. All
decide by (13), the dearer rule."""
SEGMENTS = 200
SEGMENTS_OF_DEAD_END = 50
FAR = 200.0
"""[m] from the corridor to walls that nobody sees"""
FAR_LENGTH = 64.0


def corridor(
    robots: int, settings: dict[str, Any] | None = None, jam: bool = False, noise: float = 0.05,
    duration: float = 2000.0, speed: float = SPEED, segments: int = SEGMENTS,
    spacing: float | None = None, far: int = 0,
) -> World:  # fmt: skip
    """World of the corridor; without settings nobody decides. ``far`` segments are out of sight."""
    rng = np.random.default_rng(0)
    spacing = spacing or (PACKED if jam else SPACING)
    length = road_length(robots, jam, spacing) + 0.5
    margin = 0.5 if jam else 3.0
    points = np.linspace(0.0, length - margin, max(2, segments // 2 - 1))
    robot = {
        "footprint": {"length": LENGTH_OF_ROBOT, "width": WIDTH_OF_ROBOT},
        "limits": {"v": max(1.0, speed), "omega": 1.6},
    }
    standing = [
        {**robot, "name": f"a{i}", "path": {"offset": lane(i)},
         "pose": [x + rng.normal(0.0, noise), y + rng.normal(0.0, noise),
                  rng.normal(0.0, 2.0 * noise)]}
        for i, (x, y) in enumerate(places(robots, spacing))
    ]  # fmt: skip
    paper = {"type": "mode_switching", **(settings or {})}
    formation = {
        "gain": 0.005, "speed": speed, "limits": [0.8 * speed, max(1.0, speed)],
        "spacing": "initial", "range": 10.0,
    }  # fmt: skip
    road = {
        "corridor": {"centreline": [[float(x), 0.0] for x in points], "width": WIDTH,
                     "end_margin": margin},
    }  # fmt: skip
    if far:
        road = _with_far_walls(points, far)
    return World(
        name="corridor",
        seed=0,
        time={"step": STEP, "duration": duration},
        robots=standing,
        formation=formation,
        controller={"type": "constant"} if settings is None else paper,
        **road,
    )


def _with_far_walls(points: np.ndarray, far: int) -> dict[str, Any]:
    """The corridor as walls that are drawn, and a line of ``far`` segments that nobody sees."""
    xs, half = [-1.0, *points.tolist(), float(points[-1]) + 3.0], WIDTH / 2
    round_it = [*([x, -half] for x in xs), *([x, half] for x in xs[::-1]), [xs[0], -half]]
    line = [[float(x), FAR] for x in np.linspace(0.0, FAR_LENGTH, far + 1)]
    return {
        "boundaries": [round_it, line],
        "reference_path": [[float(x), 0.0] for x in points],
    }


class Cautious:
    """The controller of one's own in README.md."""

    modes = (Mode("going", "#0072b2"), Mode("waiting", "#e69f00", "waits", danger=True))

    def decide(self, observation: Any, memory: Any) -> Decision:
        """Steer to a point 2 m ahead; wait while a robot further along is near."""
        o = observation
        if o.station >= o.stop_station - 0.05:
            return Decision(v=0.0, omega=0.0, hold=PERIOD, mode="going")
        x, y, heading = o.pose
        tx, ty = o.path.target(o.station, 2.0)
        error = (atan2(ty - y, tx - x) - heading + pi) % (2 * pi) - pi
        omega = max(-o.limits[1], min(o.limits[1], 2.0 * error))
        ahead = [s for s in o.others if s.station > o.reference_station]
        if any(hypot(s.pose[0] - x, s.pose[1] - y) < 1.1 for s in ahead):
            return Decision(v=0.0, omega=omega, hold=PERIOD, mode="waiting")
        return Decision(v=min(SPEED, o.limits[0]), omega=omega, hold=PERIOD, mode="going")


PAPER = {
    "free": {**SHORT, **NEAR, **SOON},
    "danger": {**SHORT, **NEAR, **SOON, **ALWAYS},
    "default": {"longest_interval": PERIOD},
    "short": {"longest_interval": PERIOD, "safe_distance": 0.3},
    "long": {**SHORT, **NEAR, **SOON, "safe_distance": 1.0},
}
"""Settings of the paper's controller by what is measured; ``short`` is the default but for L,
``long`` is ``free`` but for L."""
FORWARD = ("drive", "jam", "dead_end")
"""What is driven straight on, from outside."""


def simulation(kind: str, robots: int, **walls: int) -> Simulation:
    """Set up what is to be measured; ``walls`` are numbers of segments."""
    if kind in PAPER:
        return Simulation(corridor(robots, PAPER[kind], **walls))
    if kind == "plain":
        return Simulation(corridor(robots), controller=Cautious())
    if kind == "dead_end":  # which they have a way to
        return Simulation(
            corridor(robots, jam=True, spacing=SPACING, segments=SEGMENTS_OF_DEAD_END)
        )
    return Simulation(corridor(robots, jam=kind == "jam", noise=0.004 if kind == "jam" else 0.0))
