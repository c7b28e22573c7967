"""The simulation: observe, decide, filter, move, once a step.

One step runs from sample k to sample k + 1: the robots that are due at k decide from one snapshot,
all hold their commands over the step, and the physics moves them as far as contacts allow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from physim.control import (
    NO_MODE,
    BatchController,
    Batched,
    Controller,
    Decisions,
    Mode,
    Observation,
    Snapshot,
)
from physim.control_loop import PlainBatch, as_commands, check_commands, check_told, hold_steps
from physim.errors import ControllerError, PhysimError, WorldError
from physim.geometry.shapes import FloatArray, IntArray
from physim.perception import Perception
from physim.physics import Physics
from physim.registry import make_controller, robot_faults
from physim.scene import Scene
from physim.scene_builder import build_scene
from physim.world import World


class Filter(Protocol):
    """Stands between what controllers want and what robots are given, at every step."""

    def __call__(self, scene: Scene, snapshot: Snapshot, wanted: FloatArray) -> FloatArray:
        """Given commands (N, 2) for wanted ones (N, 2); must not write to its arguments."""
        ...


@dataclass(slots=True)
class Update:
    """Decisions of one step with what the robots knew then: rows of the update table."""

    snapshot: Snapshot
    """as it was, stations of the deciding robots only"""
    decisions: Decisions
    given: FloatArray
    """(M, 2) commands after the filters"""
    next_step: IntArray
    """(M,) when each decides again"""
    formation_error: FloatArray
    """(M,) [m]"""
    deviation: FloatArray
    """(M,) [m] left positive"""


class Simulation:
    """A world in motion, step by step.

    How things stand at the present sample: ``pose`` (N, 3) x, y [m], heading [rad, unwrapped],
    read-only; ``command`` (N, 2) v [m/s], omega [rad/s] as wanted by the controllers; ``mode``
    (N,), NO_MODE where none was given; ``contacts``, rows of `physim.contacts.CONTACT`;
    ``step_number``; ``time`` [s]. Stepping may go on beyond the world's duration; `simulate` stops
    there.
    """

    def __init__(
        self,
        world: World | Scene,
        seed: int | None = None,
        controller: Controller | str | None = None,
        filters: Sequence[Filter] = (),
    ) -> None:
        """Set up sample 0.

        Raises WorldError or ControllerError where it cannot be run, TypeError for a name or a file
        in place of a world.

        ``controller`` is an object, or a registered name or ``module:Class`` that takes the place
        of the world's own. Without ``seed`` the world's own is used; a Scene has its seed.
        """
        if isinstance(world, World):
            if isinstance(controller, str):
                world = world.changed(controller={"type": controller})
            world = build_scene(world, seed)
        if not isinstance(world, Scene):
            raise TypeError(
                f"a World or a Scene is needed, not {type(world).__name__}; "
                "load_world(name or file) gives one"
            )
        self.scene = scene = world
        self.controller = _controller(scene.world, controller)
        self.given = "" if controller is None else _name(controller, scene.world)
        """what decides in place of the world's own controller; empty where that one decides"""
        if faults := robot_faults(self.controller, dict(enumerate(scene.world.robots))):
            raise WorldError(faults)
        self.physics = Physics(
            scene.shapes,
            scene.walls,
            scene.start,
            scene.mass,
            scene.dt,
            friction=scene.world.physics.friction,
            elasticity=scene.world.physics.elasticity,
        )
        self.perception = Perception(scene)
        self.filters = tuple(filters)
        self.step_number = 0
        self.pose: FloatArray = read_only(self.physics.pose)
        self.command = np.zeros((scene.robots, 2))
        self.mode = np.full(scene.robots, NO_MODE, dtype=np.int64)
        self.next_decision = np.zeros(scene.robots, dtype=np.int64)
        self.update: Update | None = None
        self._batch: BatchController = (
            self.controller.batch(scene)
            if isinstance(self.controller, Batched)
            else PlainBatch(self.controller, scene, self.observe)
        )

    @property
    def time(self) -> float:
        """[s] simulated time of the present sample."""
        return self.step_number * self.scene.dt

    @property
    def contacts(self) -> NDArray[np.void]:
        """Contact rows of the present sample."""
        return self.physics.contacts

    @property
    def finished(self) -> bool:
        """Whether every robot has arrived."""
        return bool((self.mode == int(Mode.ARRIVED)).all())

    def snapshot(self) -> Snapshot:
        """All robots now: poses, commands held before this step, stations."""
        p = self.perception
        return Snapshot(self.step_number, self.pose, self.command, p.station, p.reference_station)

    def observe(self, i: int) -> Observation:
        """What Robot i, 0 to N - 1, may know now. Raises PhysimError for another i."""
        if not 0 <= i < self.scene.robots:
            raise PhysimError(f"robot {i}; allowed: 0 to {self.scene.robots - 1}")
        return self.perception.observe(i, self.snapshot())

    def step(self, commands: FloatArray | None = None) -> None:
        """Go from this sample to the next.

        With ``commands`` (N, 2) every robot holds those and no controller is asked. Raises
        ControllerError for a command that is not finite or beyond a robot's limits.
        """
        update: Update | None = None
        snapshot = self.snapshot()
        if commands is not None:
            wanted = as_commands(commands, self.time)
            check_commands(self.scene, self.time, np.arange(self.scene.robots), wanted)
        else:
            due = (self.next_decision <= self.step_number).nonzero()[0]
            wanted = self.command
            if len(due):
                wanted, update = self._decide(snapshot, due)
        given = self._filtered(snapshot, wanted) if self.filters else wanted
        if update is not None:
            update.given = given[update.decisions.robot]
        self.update = update
        self.physics.step(given)
        self.command = wanted
        self.pose = read_only(self.physics.pose)
        self.step_number += 1
        self.perception.track(self.pose)

    def _filtered(self, snapshot: Snapshot, wanted: FloatArray) -> FloatArray:
        """Given commands (N, 2): the wanted ones through every filter in turn."""
        given = wanted
        for rule in self.filters:
            given = rule(self.scene, snapshot, given)
        check_commands(self.scene, self.time, np.arange(self.scene.robots), given)
        return given

    def _decide(self, snapshot: Snapshot, due: IntArray) -> tuple[FloatArray, Update]:
        """Ask the robots that are due; commands (N, 2) of all robots from now on, and who said."""
        decisions = self._batch.decide_due(snapshot, due)
        check_commands(self.scene, self.time, due, decisions.command)
        check_told(self.scene, self.time, decisions)
        next_step = self.step_number + hold_steps(self.scene, self.time, due, decisions.hold)
        wanted = self.command.copy()
        wanted[due] = decisions.command
        self.mode[due] = decisions.mode
        self.next_decision[due] = next_step
        known = self.perception
        frozen = snapshot._replace(
            station=known.station[due], reference_station=known.reference_station[due]
        )
        update = Update(
            frozen,
            decisions,
            decisions.command,
            next_step,
            known.formation_errors()[due],
            known.deviation[due],
        )
        return wanted, update


def _controller(world: World, given: Controller | str | None) -> Controller:
    if isinstance(given, str):
        made: Controller = make_controller(given, {}, trusted=True)
        return made
    if isinstance(given, type):
        raise ControllerError(f"controller is the class {given.__name__}; give an instance of it")
    return given or make_controller(world.controller.type, world.controller.settings)


def _name(given: Controller | str, world: World) -> str:
    """Name of a controller, ``module:Class`` of an object; empty where it is the world's own."""
    own = world.controller
    if not isinstance(given, str):
        if ":" not in own.type and _alike(given, make_controller(own.type, own.settings)):
            return ""
        given = f"{type(given).__module__}:{type(given).__qualname__}"
    return "" if given == own.type else given


def _alike(one: Controller, other: Controller) -> bool:
    settings = (getattr(controller, "settings", None) for controller in (one, other))
    return type(one) is type(other) and next(settings) == next(settings)


def read_only(array: FloatArray) -> FloatArray:
    """Return the array itself, so marked that writing to it is an error."""
    array.flags.writeable = False
    return array
