"""The whole state of a simulation as one value: all that the next step depends on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray, IntArray
from physim.parts.controller import Snapshot
from physim.parts.given import GivenSettings
from physim.simulation.engine import PhysicsState

if TYPE_CHECKING:
    from physim.simulation.parts import Parts

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

    def refuse_other(self, state: object, parts: Parts) -> None:
        """Refuse what a simulation with some parts, of this state, cannot be restored to.

        Raises PhysimError for a state of another run, or one that is damaged; TypeError for what is
        no state.
        """
        if not isinstance(state, SimulationState):
            raise TypeError(f"a state is needed, such as `state` is, not {type(state).__name__}")
        if state.parts != self.parts:
            raise PhysimError(
                f"the state is of a run with {', '.join(state.parts)}; this one has "
                f"{', '.join(self.parts)}"
            )
        if other := parts.set_otherwise(state.settings):
            raise PhysimError(f"the state is of a run in which {other}; give it the same")
        if state.scene != self.scene:
            raise PhysimError("the state is of another world or seed; restore it in its own")
        if wrong := self._misfit(state):
            raise PhysimError(f"the state is damaged: {wrong} is not as in a state of this world")

    def _misfit(self, other: SimulationState) -> str:
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
                or not (found.flags.c_contiguous and found.flags.aligned)
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
