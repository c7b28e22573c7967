"""How a simulation stands at a sample: set up, looked at, kept as a value, taken up again."""

from __future__ import annotations

import copy
import hashlib
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from physim.errors import plural
from physim.geometry.clearance import ClearanceFinder, Clearances
from physim.geometry.path import Tracking, put_projected
from physim.geometry.shapes import FloatArray, IntArray, locked, read_only
from physim.parts.controller import FASTEST, Sensed, Snapshot
from physim.parts.declarations import NO_NUMBER, Declared
from physim.parts.drive import NO_DRIVES
from physim.parts.registry import STAGES
from physim.parts.stages import Observer, Usable, nothing, shared
from physim.parts.user_code import naming
from physim.simulation.arrival import Arrivals
from physim.simulation.decisions import Asked, Decided
from physim.simulation.engine import Physics
from physim.simulation.forms import first_memory
from physim.simulation.observation import View
from physim.simulation.parts import Parts
from physim.simulation.state import SimulationState
from physim.simulation.swept_contacts import SweptContactFinder
from physim.world.layout.scene_builder import reseeded
from physim.world.scene import Scene

SENSE, FILTERED, DISTURBED = range(3)
"""Numbers of the stages whose parts are `STAGES`"""


class Present:
    """A world as it stands at a sample, which `Simulation` moves on.

    All that the next step depends on is in ``state``; all else here follows from it, and from scene
    and parts, which are settings only.
    """

    scene: Scene
    parts: Parts
    observers: list[Observer]
    now: Snapshot
    mode: NDArray[np.int64]
    next_decision: NDArray[np.int64]
    memory: dict[str, NDArray[Any]]
    met: list[NDArray[np.void]]
    """contacts of every step of the last call of `step`, of those that had some"""
    _next_due: int
    _sensed: tuple[Sensed, tuple[Any, ...]] | None
    _looking: IntArray | None
    """who looks at what is sensed; None: everybody"""
    _view: View | None = None
    _states: tuple[tuple[Any, ...], ...]
    _told: tuple[Snapshot, Any, Decided, FloatArray, FloatArray] | None
    _digested: tuple[Scene | None, str] = None, ""
    _found: tuple[Snapshot | None, Clearances | None] = None, None

    @property
    def step_number(self) -> int:
        """Number of the present sample."""
        return self.now.step

    @property
    def time(self) -> float:
        """[s] simulated time of the present sample."""
        return self.now.step * self.scene.dt

    @property
    def pose(self) -> FloatArray:
        """(N, 3) x, y [m], heading [rad, unwrapped]; read-only."""
        return self.now.pose

    @property
    def command(self) -> FloatArray:
        """(N, columns) nominal commands v [m/s], omega [rad/s], and lateral [m/s], that are held;
        read-only. Scene.columns says how many numbers a command has."""
        return self.now.command

    @property
    def velocity(self) -> FloatArray:
        """(N, 3) vx, vy [m/s], omega [rad/s] over the last step, world frame; read-only."""
        return self.now.velocity

    @property
    def clearance(self) -> FloatArray:
        """(N,) [m] signed distance of each robot from the nearest other body that moves; inf
        without others."""
        return np.asarray(self._distances.clearance[0])

    @property
    def boundary_clearance(self) -> FloatArray:
        """(N,) [m] signed distance of each robot from the nearest wall; inf without walls."""
        return np.asarray(self._distances.boundary_clearance[0])

    @property
    def arrived(self) -> NDArray[np.bool_]:
        """(N,) which robots have arrived; read-only."""
        return self._arrivals.arrived

    @property
    def contacts(self) -> NDArray[np.void]:
        """Contacts at the present sample, rows as `Record.contacts` has them.

        Grazes of the step that led to it stand last.
        """
        return np.asarray(locked(self.physics.contacts))

    def __repr__(self) -> str:
        """Size and time."""
        size = plural(self.scene.robots, "robot")
        return f"<Simulation seed {self.scene.seed}: {size}, at {self.time:g} s>"

    @property
    def finished(self) -> bool:
        """Whether every robot has arrived."""
        return self._arrivals.all

    @property
    def declared(self) -> Declared:
        """Modes, rules and columns of the controller."""
        return self._asked.declared

    @property
    def _distances(self) -> Clearances:
        """Clearances of the present sample, found once."""
        of, found = self._found
        if found is None or of is not self.now:
            scene = self.scene
            finder = ClearanceFinder(scene.shapes, scene.wall_tree, scene.robots)
            found = locked(finder.find(self.now.moving_pose[None]))
            self._found = self.now, found
        return found

    # State

    @property
    def state(self) -> SimulationState:
        """Everything that the next step depends on, as a value."""
        of, digest = self._digested
        if of is not self.scene:
            digest = hashlib.sha256(self.scene.world.to_yaml().encode()).hexdigest()
            self._digested = self.scene, digest
        return SimulationState(
            scene=digest,
            seed=self.scene.seed,
            parts=self.parts.names,
            settings=self.parts.settings,
            now=self.now,
            mode=self.mode,
            next_decision=self.next_decision,
            memory={name: array.copy() for name, array in self.memory.items()},
            stages=self._states,
            trail=self._arrivals.trail.copy(),
            arrived=self.arrived,
            physics=self.physics.state,
        )

    def restore(self, state: SimulationState) -> None:
        """Go to the sample of a state; what follows is bit for bit what followed there.

        Raises PhysimError for a state of another world, seed, controller or stage, or of a part
        with other settings; TypeError for what is no state.
        """
        self.state.refuse_other(state, self.parts)
        self.physics.restore(state.physics)
        for array in (*state.now[1:], state.mode, state.next_decision):
            read_only(array)  # which unpickled arrays are not
        self._tracking.stations = read_only(np.stack(state.now[4:7]))
        self.now, self.mode, self.next_decision = state.now, state.mode, state.next_decision
        self._next_due = int(state.next_decision.min())
        self.memory = {name: array.copy() for name, array in state.memory.items()}
        self._states = state.stages
        self._arrivals.restore(state.trail, state.arrived)
        self._sensed, self._told = None, None

    def reset(self, seed: int | None = None) -> None:
        """Go back to sample 0, with another seed or the same. Observers are let go."""
        before = self.scene.shapes
        if seed is not None and seed != self.scene.seed:
            self.scene = reseeded(self.scene, seed)
        self.observers = []
        if self.scene.shapes is before:
            self.physics.reset(self.scene.moving_start)
        else:  # the seed draws footprints or the road
            self._host()
        self._begin()

    def _host(self) -> None:
        """Put all that moves into the engine."""
        scene = self.scene
        self._swept = SweptContactFinder(scene)
        self.physics = Physics(
            scene.shapes, scene.walls, scene.moving_start, scene.mass, scene.dt,
            friction=scene.world.physics.friction, elasticity=scene.world.physics.elasticity,
            movers=scene.movers,
        )  # fmt: skip

    def _begin(self) -> None:
        """Everything but the engine, as it is at sample 0."""
        scene, robots = self.scene, self.scene.robots
        self.memory = first_memory(self._asked.form, scene)
        self._shared = shared(robots, scene.moving)
        self._parts = tuple(map(self.parts.of, STAGES))
        self._calls = tuple(
            [
                (k, part, getattr(part, kind.calls[1].partition("(")[0]))
                for k, part in enumerate(parts) if not getattr(part, "is_off", False)
            ]
            for kind, parts in zip(STAGES, self._parts, strict=True)
        )  # fmt: skip
        self._usable = Usable.of(scene)
        demands = [getattr(part, "on_demand", False) for _, part, _ in self._calls[SENSE]]
        self._is_on_demand = bool(demands) and all(demands) and not self._parts[FILTERED]
        self._limits = {FILTERED: scene.limits, DISTURBED: np.full(scene.limits.shape, FASTEST)}
        states = []
        for kind, parts in zip(STAGES, self._parts, strict=True):
            begun_with = []
            for part in parts:
                with naming(f"{kind.word} {type(part).__name__} at 0 s", part.start):
                    begun_with.append(part.start(scene))
            states.append(tuple(begun_with))
        self._states = tuple(states)
        self._tracking = Tracking(
            scene.paths, scene.reference, scene.shapes.radius[:robots], read_only(scene.start)
        )
        self._arrivals = Arrivals(scene, self._tracking)
        self.mode = read_only(np.full(robots, NO_NUMBER, dtype=np.int64))
        self.next_decision = read_only(np.zeros(robots, dtype=np.int64))
        self._next_due, self._told, self.met = 0, None, []
        still = read_only(np.zeros((scene.moving, 3)))
        drive = read_only(np.zeros((robots, 4))) if scene.drives else NO_DRIVES
        held = read_only(np.zeros((robots, scene.columns)))
        self._take(0, read_only(self.physics.pose), held, still, drive)
        self._nothing = nothing(self.now)

    def _take(
        self, step: int, pose: FloatArray, nominal: FloatArray, velocity: FloatArray,
        drive: FloatArray,
    ) -> None:  # fmt: skip
        own, beside, station = self._tracking.stations
        every, speeds, command, along = pose, velocity, nominal, station
        n, bodies = len(station), len(pose)
        if bodies > n:
            pose, velocity, along = pose[:n], velocity[:n], np.empty(bodies)
            along[:n] = station
            put_projected(self.scene.reference, every, n, bodies, along)
            if step and nominal is self.now.command:
                command = self.now.moving_command
            else:
                command = np.zeros((bodies, nominal.shape[1]))
                command[:n] = nominal
                read_only(command)
            read_only(along)
        self.now = Snapshot(
            step, pose, nominal, velocity, own, beside, station, every, speeds, command, along,
            drive,
        )  # fmt: skip
        self._sensed = None

    def __getstate__(self) -> dict[str, Any]:
        """Scene, parts and state: the engine itself is built anew from these."""
        return {"scene": self.scene, "parts": self.parts, "state": self.state}

    def __setstate__(self, values: dict[str, Any]) -> None:
        """Build the engine anew and go to the state."""
        self.scene, self.parts = values["scene"], values["parts"]
        self._asked = Asked.of(self.parts.controller)
        self.observers = []
        self._host()
        self._begin()
        self.restore(values["state"])

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """Return a simulation of its own that shares what never changes."""
        other = copy.copy(self)  # by __getstate__
        memo[id(self)] = other
        return other
