"""Path following alone: (1) to (6) in plain Python, deaf to other robots and to walls.

A baseline to compare with, and an example of a controller written from the observation alone. An
omnidirectional robot keeps its heading and goes straight towards the target, which is ours.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, hypot, sin, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from physim.errors import Fault, Location
from physim.parts.controller import Decision, Observation
from physim.parts.declarations import AT_STOP, SAFE, STANDARD_COLUMNS, Rule

from .path_following import Aim, best_plan, judging_time, speed_pairs
from .settings import ModeSwitchingSettings, PathFollowingSettings
from .world_checks import omega_faults, speed_doubts, speed_faults, stop_doubts

if TYPE_CHECKING:
    from physim.world import Robot, World


class PathFollowing:
    """Path following by target chasing only, without formation or avoidance."""

    modes = (SAFE, AT_STOP)
    rules = (
        Rule("path_following", "path following by (5)"),
        Rule("stop", "stands at its stop station"),
    )
    columns = STANDARD_COLUMNS[:2]
    drives = ("unicycle", "car", "omni")
    told = "formation"

    Settings = PathFollowingSettings

    def __init__(self, settings: PathFollowingSettings | None = None) -> None:
        self.settings = PathFollowingSettings() if settings is None else settings
        self.paper = ModeSwitchingSettings(**self.settings.model_dump(exclude_unset=True))
        """the paper's, of which it uses those of target chasing: it keeps no distance"""

    def robot_faults(self, robots: Mapping[int, Robot]) -> list[Fault]:
        """Refuse robots whose limits do not allow the rotational speeds to choose from."""
        return omega_faults(self.paper.omegas, False, robots)

    def world_faults(self, world: World, where: Location) -> list[Fault]:
        """Refuse a speed of its own beside that of a formation."""
        return speed_faults(self.paper, world, where)

    def world_doubts(self, world: World, where: Location) -> list[Fault]:
        """Doubt speeds out of reach, and stops short of arrival."""
        return [
            *speed_doubts(self.paper, world, where, by_7=False),
            *stop_doubts(self.paper, world),
        ]

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Choose the speed pair that ends nearest to the target (5)."""
        rules = self.paper.rules()
        x, y = observation.path.target(observation.station, rules.look_ahead)
        if observation.station >= observation.stop_station - rules.arrival_tolerance:
            return Decision(0.0, 0.0, hold=rules.update_period, mode=AT_STOP, rule="stop")
        omegas = observation.omegas or self.paper.omegas
        formation = observation.formation
        nu = formation.speed if formation.active else self.paper.speed
        nu = min(nu, observation.limits[0])
        missing = observation.stop_station - observation.station
        nu = min(nu, sqrt(observation.vehicle.braking * missing))
        target = {"target_x": x, "target_y": y}
        if observation.vehicle.sideways > 0.0:
            dx, dy, heading = x - observation.pose[0], y - observation.pose[1], observation.pose[2]
            c, s, far = cos(heading), sin(heading), hypot(dx, dy)
            v, lateral = nu * (c * dx + s * dy) / far, nu * (c * dy - s * dx) / far
            slower = min(1.0, observation.vehicle.sideways / max(abs(lateral), 1e-9))
            return Decision(
                slower * v, 0.0, hold=rules.update_period, mode=SAFE, rule="path_following",
                report=target, lateral=slower * lateral,
            )  # fmt: skip
        pairs = speed_pairs(np.array([1.0]), nu, np.array(omegas))
        period = max(rules.update_period, rules.judge_ahead)
        for k, (v, omega) in enumerate(pairs.each.tolist()):
            pairs.each[k] = observation.vehicle.clipped(v, omega, period)
        dwell = np.array([rules.update_period])
        left = observation.path.length - observation.station
        ahead = judging_time(rules.judge_ahead, left, nu)
        plan = best_plan(observation.pose, pairs, dwell, Aim(x, y, ahead))
        v, omega = plan[0]
        return Decision(
            v, omega, hold=rules.update_period, mode=SAFE, rule="path_following",
            report=target,
        )  # fmt: skip
