"""What agents see, do and are rewarded for: settings of an environment, checked once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from physim.errors import PhysimError, nearest
from physim.simulation.arrays import OTHER, OWN, WALL, layout_of
from physim.world import World
from physim.world.file import load_world

WEIGHTS = {
    "progress": 1.0, "contact": -1.0, "boundary": -1.0, "arrival": 1.0, "time": 0.0,
    "smoothness": 0.0,
}  # fmt: skip
"""Weight of each term of a reward by default"""


@dataclass(frozen=True)
class Task:
    """What is asked of the agents of a world; `physim.env` says what each means."""

    world: World
    period: float
    """[s] that an action is held"""
    held: int
    """physics steps of a period"""
    others: int
    walls: int
    ahead: tuple[float, ...]
    """[m]"""
    weights: tuple[float, ...]
    """of the terms, in the order of `WEIGHTS`"""
    contact_ends: bool
    max_cycles: int
    """actions of an episode at most"""

    @property
    def columns(self) -> dict[str, slice]:
        """Where the fields of `Arrays` stand in an observation, by their names."""
        sizes = {
            "own": len(OWN) + 2 * len(self.ahead), "others": len(OTHER) * self.others,
            "others_mask": self.others, "walls": len(WALL) * self.walls, "walls_mask": self.walls,
        }  # fmt: skip
        ends = np.cumsum([0, *sizes.values()]).tolist()
        return {name: slice(*ends) for name, ends in zip(sizes, pairwise(ends), strict=True)}

    @property
    def size(self) -> int:
        """Numbers of an observation."""
        return int(self.columns["walls_mask"].stop)


def task_of(
    world: World | str,
    changes: Mapping[str, Any],
    period: float,
    others: int,
    walls: int,
    ahead: Sequence[float],
    rewards: Mapping[str, float] | None,
    contact_ends: bool,
    max_cycles: int | None,
) -> Task:
    """Check what is asked for. Raises PhysimError, WorldError."""
    one = (world if isinstance(world, World) else load_world(world)).changed(**changes)
    layout = layout_of(others, walls, ahead, np.float32)
    step, duration = one.time.step, one.time.duration
    most = round(duration / step)
    is_number = isinstance(period, int | float) and not isinstance(period, bool)
    held = round(period / step) if is_number and 0.0 < period <= duration else 0
    if not held or abs(held * step - period) > 1e-9 * period:
        raise PhysimError(
            f"period = {period!r}; it must be a multiple of time.step = {step:g} s, up to "
            f"time.duration = {duration:g} s"
        )
    weights = dict(WEIGHTS)
    for name, weight in (rewards or {}).items():
        if name not in WEIGHTS:
            raise PhysimError(
                f"rewards: no term {name!r}; allowed: {', '.join(WEIGHTS)}"
                f"{nearest(str(name)[:100], list(WEIGHTS))}"
            )
        is_number = isinstance(weight, int | float | np.number) and not isinstance(weight, bool)
        if not (is_number and np.isfinite(weight)):
            raise PhysimError(f"rewards: {name} = {weight!r}; it must be a finite number")
        weights[name] = float(weight)
    cycles = most // held if max_cycles is None else max_cycles
    if type(cycles) is not int or not 1 <= cycles <= most // held:
        raise PhysimError(
            f"max_cycles = {max_cycles!r}; it must be a whole number from 1 to {most // held}, "
            f"which is time.duration / period; a longer time.duration allows more"
        )
    return Task(
        one, float(period), held, layout.others, layout.walls, tuple(layout.ahead.tolist()),
        tuple(weights.values()), bool(contact_ends), cycles,
    )  # fmt: skip
