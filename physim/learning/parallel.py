"""A world as a PettingZoo environment: every robot is an agent."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from physim.errors import PhysimError
from physim.learning.episode import Episodes, rendering
from physim.learning.task import WEIGHTS, Task

Rows = dict[str, Any]


class RobotsEnv(ParallelEnv):  # type: ignore[misc]
    """A PettingZoo ``ParallelEnv``, which `physim.env` makes.

    ``simulation`` is the `Simulation`, ``task`` what is seen and rewarded.
    """

    def __init__(
        self, task: Task, render_mode: str | None, record: str | os.PathLike[str] | None
    ) -> None:
        self.task, self.render_mode = task, render_mode
        self.metadata = {**rendering(task), "name": "physim", "is_parallelizable": True}
        self._episodes = Episodes(task, None, None, render_mode, record)
        self.simulation = self._episodes.simulation
        self.possible_agents = [f"robot_{i}" for i in self._episodes.robots]
        self.agents: list[str] = []
        self.observation_spaces = {
            name: Box(-np.inf, np.inf, (task.size,), np.float32) for name in self.possible_agents
        }
        self.action_spaces = {
            name: Box(-1.0, 1.0, (self._episodes.columns,), np.float32)
            for name in self.possible_agents
        }

    @property
    def max_cycles(self) -> int:
        """Actions of an episode at most."""
        return self._episodes.max_cycles

    @max_cycles.setter
    def max_cycles(self, cycles: int) -> None:
        self._episodes.max_cycles = min(cycles, self.task.max_cycles)

    def observation_space(self, agent: str) -> Box:
        """Space of what an agent sees, always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Box:
        """Space of its actions, always the same object."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Rows, Rows]:
        """Begin an episode of a seed, or of the next one; observations and infos by agent."""
        seen = self._episodes.reset(seed)
        self.agents = self.possible_agents[:]
        return self._each(seen), {name: {} for name in self.agents}

    def step(self, actions: Rows) -> tuple[Rows, Rows, Rows, Rows, Rows]:
        """Hold the actions of all agents for a period.

        Returns observations, rewards, who is terminated, who is truncated, and infos, by agent.
        Raises PhysimError where an agent has no action, and once an episode is over.
        """
        if not self.agents:
            raise PhysimError("no episode is going on; call reset first")
        if missing := [name for name in self.agents if name not in actions]:
            raise PhysimError(f"actions: none for {missing[0]}; every agent needs one")
        found = self._episodes.step(np.stack([actions[name] for name in self.agents]))
        agents = self.agents
        if found.terminated or found.truncated:
            self.agents = []
        told = [dict(zip(WEIGHTS, row, strict=True)) for row in found.terms.tolist()]
        return (
            self._each(found.seen),
            dict(zip(agents, found.reward.tolist(), strict=True)),
            dict.fromkeys(agents, found.terminated),
            dict.fromkeys(agents, found.truncated),
            {name: {"terms": one} for name, one in zip(agents, told, strict=True)},
        )

    def render(self) -> NDArray[np.uint8] | None:
        """Picture (720, 1280, 3) of the world now, with the render mode "rgb_array"."""
        return self._episodes.picture() if self.render_mode else None

    def close(self) -> None:
        """Close the record of an episode that goes on."""
        self._episodes.stop_recording("interrupted")

    def _each(self, rows: NDArray[np.float32]) -> Rows:
        return dict(zip(self.possible_agents, rows, strict=True))
