"""Which robots a disturbance is for: all of them, or those that its settings name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

import numpy as np
from pydantic import Field

from physim.errors import Fault, Location, nearest
from physim.geometry.shapes import IntArray
from physim.world import World
from physim.world.faults import describe
from physim.world.group import each_robot
from physim.world.kinds import MOST_ROBOTS, Label
from physim.world.scene import Scene

SHOWN = 5
"""Names that are listed where one is unknown"""

Named = Annotated[
    tuple[Label, ...] | None,
    Field(min_length=1, max_length=MOST_ROBOTS, description="names of its robots; all when absent"),
]
Stream = Annotated[
    int,
    Field(
        ge=0,
        le=10**9,
        description="number of the draws: two entries of one type draw alike unless theirs differ",
    ),
]


def robots_of(scene: Scene, named: Named) -> IntArray:
    """Indices (n,) of the robots that are named, increasing; of all where ``named`` is None."""
    return np.array([i for i, name in enumerate(scene.names) if named is None or name in named])


def name_faults(world: World, where: Location, named: Named) -> Iterator[Fault]:
    """A fault for each name that no robot of the world has."""
    if named is None:
        return
    known = [robot.name for robot in each_robot(world.robots, world.seed)[0]]
    there = ", ".join(known[:SHOWN]) + (", …" if len(known) > SHOWN else "")
    for k, name in enumerate(named):
        if name not in known:
            message = f"no robot has the name {describe(name)}; there are {there}"
            yield Fault((*where, "robots", k), message + nearest(name, known))
