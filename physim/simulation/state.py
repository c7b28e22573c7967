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

VARYING = frozenset(
    f"physics.{name}" for name in ("part", "feature", "impulse", "contacts", "false_contacts")
)
"""Arrays of a state with as many rows as there are contacts"""


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

    def misfit(self, other: SimulationState) -> str:
        """What has another form in ``other``, or is not finite there; empty where all fits.

        A state may come from a stranger's record, and compiled code trusts the forms of arrays.
        """
        kinds = {"now": Snapshot, "physics": PhysicsState, "memory": dict, "stages": tuple}
        for name, kind in kinds.items():
            if not isinstance(getattr(other, name), kind):
                return name
        sizes = [len(one) if isinstance(one, tuple) else -1 for one in other.stages]
        if sizes != [len(one) for one in self.stages]:
            return "stages"
        mine, theirs = self._arrays(), other._arrays()
        if mine.keys() != theirs.keys():
            return "memory"
        for name, array in mine.items():
            found, first = theirs[name], 1 if name in VARYING else 0
            if (
                not isinstance(found, np.ndarray)
                or (found.dtype, found.ndim) != (array.dtype, array.ndim)
                or found.shape[first:] != array.shape[first:]
                or (name.endswith(".pose") and not np.isfinite(found).all())
            ):
                return name
        points = other.physics
        return "" if len(points.part) == len(points.feature) == len(points.impulse) else "physics"

    def _arrays(self) -> dict[str, NDArray[Any]]:
        found = {f"now.{name}": array for name, array in self.now._asdict().items()}
        found["now.step"] = np.asarray(self.now.step)
        found |= {n: getattr(self, n) for n in ("mode", "next_decision", "trail", "arrived")}
        found |= {f"memory.{name}": array for name, array in self.memory.items()}
        return found | {f"physics.{name}": one for name, one in self.physics.arrays().items()}
