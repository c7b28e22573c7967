"""A filter with memory and a disturbance, given from Python."""

from __future__ import annotations

import numpy as np


class Ramp:
    """A filter that lets the forward speed change by no more than so much a step."""

    def __init__(self, step: float = 0.02) -> None:
        self.step = step

    def start(self, scene):
        return np.zeros(scene.robots)

    def filter(self, scene, sensed, nominal, state):
        filtered = nominal.copy()
        filtered[:, 0] = state + np.clip(nominal[:, 0] - state, -self.step, self.step)
        return filtered, filtered[:, 0].copy()


class Slip:
    """A disturbance: robots go 3 % slower than told."""

    def start(self, scene):
        return None

    def disturb(self, scene, truth, filtered, state):
        return filtered * (0.97, 1.0), state


class Heard:
    """A sense stage: everybody is heard 1 % of a metre to the left of where they are."""

    def start(self, scene):
        return None

    def sense(self, scene, truth, sensed, state):
        pose = sensed.pose.copy()
        pose[:, 1] += 0.01
        return sensed._replace(pose=pose), state
