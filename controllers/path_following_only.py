"""Path following alone: (1) to (6) in plain Python, deaf to other robots and to walls.

A baseline to compare with, and an example of a controller written from the observation alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from physim.control import Decision, Mode, Observation, Report
from physim.errors import Fault

from .limits import omega_faults
from .path_following import best_plan, judging_time, speed_pairs
from .settings import ModeSwitchingSettings

if TYPE_CHECKING:
    from physim.world import Robot


class PathFollowing:
    """Path following by target chasing only, without formation or avoidance."""

    def __init__(self) -> None:
        self.settings = ModeSwitchingSettings()
        self.rules = self.settings.rules()

    def robot_faults(self, robots: Mapping[int, Robot]) -> list[Fault]:
        """Refuse robots whose limits do not allow the rotational speeds to choose from."""
        return omega_faults(self.settings.omegas, False, robots)

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Choose the speed pair that ends nearest to the target (5)."""
        rules = self.rules
        x, y = observation.path.target(observation.station, rules.look_ahead)
        if observation.station >= observation.stop_station - rules.arrival_tolerance:
            return Decision(0.0, 0.0, hold=rules.update_period, mode=Mode.ARRIVED)
        omegas = observation.omegas or self.settings.omegas
        nu = min(observation.formation.speed, observation.limits[0])
        pairs = speed_pairs(np.array([1.0]), nu, np.array(omegas))
        dwell = np.array([rules.update_period])
        left = observation.path.length - observation.station
        ahead = judging_time(rules.judge_ahead, left, nu)
        plan = best_plan(observation.pose, pairs, dwell, ahead, x, y)
        v, omega = plan[0]
        report = Report(target=(x, y))
        return Decision(v, omega, hold=rules.update_period, mode=Mode.SAFE, report=report)
