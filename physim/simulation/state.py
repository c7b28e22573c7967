"""The whole state of a simulation as one value: all that the next step depends on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray, IntArray
from physim.parts.controller import Snapshot
from physim.parts.given import GivenSettings
from physim.simulation.engine import PhysicsState


@dataclass(frozen=True)
class SimulationState:
    """State at one sample. It never changes; it can be compared, copied and pickled.

    With the scene (a world and a seed) and the same parts it determines all that follows.
    """

    scene: str
    """digest of the effective world, seed included"""
    seed: int
    parts: tuple[str, ...]
    """names of controller, sensing stages, filters and disturbances, in their order"""
    settings: tuple[GivenSettings, ...]
    """of each of these"""
    now: Snapshot
    """step; poses, nominal commands, stations"""
    mode: IntArray
    """(N,) number of the declared mode of each robot's last decision"""
    next_decision: IntArray
    """(N,) step"""
    memory: dict[str, NDArray[Any]]
    """what the controller remembers: named arrays"""
    stages: tuple[tuple[Any, ...], ...]
    """states of sensing stages, filters and disturbances"""
    trail: FloatArray
    """(W + 1, N, 2) places of the last samples, see `physim.simulation.arrival`"""
    arrived: NDArray[np.bool_]
    """(N,)"""
    physics: PhysicsState
    """of the engine"""
