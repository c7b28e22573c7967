"""A world as a Gymnasium environment: one robot is the agent."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from gymnasium import Env
from gymnasium.spaces import Box
from numpy.typing import NDArray

from physim.errors import PhysimError, nearest
from physim.learning.episode import Episodes, rendering
from physim.learning.task import WEIGHTS, Task
from physim.parts.controller import Controller
from physim.world.layout.scene_builder import build_scene

Floats = NDArray[np.float32]


class RobotEnv(Env[Floats, Floats]):
    """A Gymnasium ``Env``, which `physim.single_env` makes.

    ``simulation`` is the `Simulation`, ``task`` what is seen and rewarded.
    """

    def __init__(
        self,
        task: Task,
        robot: int | str,
        controller: Controller | str | None,
        render_mode: str | None,
        record: str | os.PathLike[str] | None,
    ) -> None:
        names = list(build_scene(task.world).names)
        number = names.index(robot) if robot in names else robot
        if type(number) is not int or number not in range(len(names)):
            hint = nearest(str(robot)[:100], names)
            raise PhysimError(
                f"robot = {robot!r}; it must be a name, or a number from 0 to {len(names) - 1}"
                f"{hint}"
            )
        self.task, self.render_mode, self.metadata = task, render_mode, rendering(task)
        self._episodes = Episodes(task, [number], controller, render_mode, record)
        self.simulation = self._episodes.simulation
        self.observation_space = Box(-np.inf, np.inf, (task.size,), np.float32)
        self.action_space = Box(-1.0, 1.0, (self._episodes.columns,), np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Floats, dict[str, Any]]:
        """Begin an episode of a seed, or of the next one."""
        super().reset(seed=seed)
        return self._episodes.reset(seed)[0], {}

    def step(self, action: Floats) -> tuple[Floats, float, bool, bool, dict[str, Any]]:
        """Hold an action for a period."""
        found = self._episodes.step(np.asarray(action)[None])
        terms = dict(zip(WEIGHTS, found.terms[0].tolist(), strict=True))
        reward = found.reward.item(0)
        return found.seen[0], reward, found.terminated, found.truncated, {"terms": terms}

    def render(self) -> NDArray[np.uint8] | None:
        """Picture (720, 1280, 3) of the world now, with the render mode "rgb_array"."""
        return self._episodes.picture() if self.render_mode else None

    def close(self) -> None:
        """Close the record of an episode that goes on."""
        self._episodes.stop_recording("interrupted")
