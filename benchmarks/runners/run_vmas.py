"""VMAS: rectangles with differential drive, contacts by penalties; commands from outside.

One environment on the processor, though it is made for many at once. Two walls, or three.
"""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import torch
from common import (
    LENGTH_OF_ROBOT,
    PACKED,
    SPACING,
    SPEED,
    STEP,
    WIDTH,
    WIDTH_OF_ROBOT,
    places,
    rate,
    report,
    road_length,
    task,
)  # fmt: skip
from vmas import make_env
from vmas.simulator.core import Agent, Box, Landmark, Line, World
from vmas.simulator.dynamics.diff_drive import DiffDrive
from vmas.simulator.scenario import BaseScenario


class Corridor(BaseScenario):
    """Robots between two walls, or three; nothing is observed and nothing rewarded."""

    def __init__(self, robots: int, jam: bool) -> None:
        super().__init__()
        self.robots, self.jam, self.length = robots, jam, road_length(robots, jam)

    def make_world(self, batch_dim: int, device: Any, **_: Any) -> World:
        """One world; a wall is a landmark that stands."""
        world = World(batch_dim, device, dt=STEP, drag=0.0)
        for k in range(self.robots):
            world.add_agent(
                Agent(
                    name=f"a{k}", shape=Box(length=LENGTH_OF_ROBOT, width=WIDTH_OF_ROBOT),
                    dynamics=DiffDrive(world, integration="euler"), u_range=[1.0, 1.6],
                )
            )  # fmt: skip
        for k in range(3 if self.jam else 2):
            line = Line(length=WIDTH if k == 2 else self.length)
            world.add_landmark(Landmark(name=f"w{k}", shape=line, collide=True, movable=False))
        return world

    def reset_world_at(self, env_index: int | None = None) -> None:
        """Everybody to the start."""
        for agent, place in zip(
            self.world.agents, places(self.robots, PACKED if self.jam else SPACING), strict=True
        ):
            agent.set_pos(torch.tensor(place), batch_index=env_index)
        half = WIDTH / 2
        middles = [(self.length / 2, -half), (self.length / 2, half), (self.length, 0.0)]
        for wall, middle in zip(self.world.landmarks, middles, strict=False):
            wall.set_pos(torch.tensor(middle), batch_index=env_index)
        if self.jam:
            upright = torch.tensor([torch.pi / 2])
            self.world.landmarks[2].set_rot(upright, batch_index=env_index)

    def observation(self, agent: Agent) -> torch.Tensor:
        """Where an agent is."""
        return agent.state.pos

    def reward(self, agent: Agent) -> torch.Tensor:
        """None."""
        return torch.zeros(self.world.batch_dim)


def main() -> None:
    """Do what is asked."""
    asked = task()
    torch.set_num_threads(1)
    robots = asked["robots"]
    env = make_env(
        scenario=Corridor(robots, asked["jam"]), num_envs=1, device="cpu",
        continuous_actions=True, grad_enabled=False,
    )  # fmt: skip
    forward = [torch.tensor([[SPEED, 0.0]])] * robots
    found = rate(lambda: env.step(forward), robots, asked["seconds"], asked["most"], env.reset)
    report(**found, version=version("vmas"))


if __name__ == "__main__":
    main()
