"""The simulation: sense, decide, filter, drive, disturb, move, report, once a step.

One step runs from sample k to sample k + 1: the robots that are due at k decide from what they
sense of it, all hold their commands over the step, and the physics moves them as far as contacts
allow. What each stage is for: `physim.parts.stages`.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import DTypeLike

from physim.contacts import CONTACT_ROW
from physim.errors import ControllerError, PhysimError, WorldError
from physim.geometry.shapes import FloatArray, IntArray, locked, read_only
from physim.parts.controller import Controller, Observation, Sensed
from physim.parts.registry import (
    DISTURBANCE,
    FILTER,
    OBSERVER,
    SENSING,
    STAGES,
    check_part,
)
from physim.parts.stages import (
    Disturbance,
    Filter,
    Observer,
    SensingStage,
    Step,
    everybody,
    usable_rows,
)
from physim.parts.user_code import broken_by, is_shipped, kind_of, naming
from physim.simulation.arrays import Arrays
from physim.simulation.branching import branch_of
from physim.simulation.checks import taken_commands, taken_sensed
from physim.simulation.decisions import NOBODY, Asked, Decided, decide, replaced
from physim.simulation.driving import applied_of, followed
from physim.simulation.observation import View
from physim.simulation.parts import driven_by, listed, parts_of
from physim.simulation.present import DISTURBED, FILTERED, SENSE, Present
from physim.simulation.state import SimulationState
from physim.world import World
from physim.world.faults import describe
from physim.world.layout.scene_builder import build_scene
from physim.world.scene import Scene

LOOK_ON = "observers look on and change nothing"


class Simulation(Present):
    """A world in motion, step by step.

    How things stand at the present sample: ``now``, a `Snapshot` (poses, nominal commands,
    stations); ``mode`` (N,), the number of each robot's declared mode; ``last``, what happened in
    the last step. ``declared`` are the modes, rules and columns of the controller.
    Nothing that was handed out changes later. Stepping may go on beyond the world's duration;
    `simulate` stops there. A copy (`copy.deepcopy`, pickle) goes on like the original; it has no
    observers, and shares the controller and the stages, which are settings only.
    """

    decision_times: list[float] | None = None
    """[s] of processor time that decisions took, those of one step shared by the robots that were
    due; None: not measured"""

    def __init__(
        self,
        world: World | Scene,
        seed: int | None = None,
        controller: Controller | str | None = None,
        *,
        sensing: Sequence[SensingStage] = (),
        filters: Sequence[Filter] = (),
        disturbances: Sequence[Disturbance] = (),
        observers: Sequence[Observer] = (),
        state: SimulationState | None = None,
    ) -> None:
        """Set up sample 0, or the sample of a ``state`` of the same world and parts.

        Without ``seed`` the world's own is used, or that of ``state``; a Scene has its seed.
        ``controller`` is an object, or a registered name or ``module:Class`` that takes the place
        of the world's own; ``sensing``, ``filters`` and ``disturbances`` stand behind those that
        the world names. Raises WorldError or ControllerError where it cannot be run, TypeError for
        a name or a file in place of a world, PhysimError for a state of something else.
        """
        if isinstance(world, World):
            seed = state.seed if seed is None and state is not None else seed
            world = build_scene(driven_by(world, controller), seed)
        if not isinstance(world, Scene):
            raise TypeError(
                f"a World or a Scene is needed, not {type(world).__name__}; "
                "load_world(name or file) gives one"
            )
        self.scene = world
        stages = {SENSING: sensing, FILTER: filters, DISTURBANCE: disturbances}
        self.parts = parts_of(world.world, controller, stages)
        self._asked = Asked.of(self.parts.controller)
        if faults := self.parts.faults(world.world):
            raise WorldError(faults)
        self.observers = []
        self._host()
        self._begin()
        if state is not None:
            self.restore(state)
        for observer in listed("observers", observers):
            self.look_on(observer)

    @property
    def view(self) -> View:
        """What robots know of this sample, each its own rows."""
        return self._view_of(self._sense()[0])

    def _view_of(self, sensed: Sensed) -> View:
        view = self._view
        if view is None or view.sensed is not sensed:
            is_same = view is not None and view.scene is self.scene
            view = self._view = View(self.scene, sensed, view if is_same else None)
        return view

    def observe(self, i: int) -> Observation:
        """What Robot i, 0 to N - 1, may know now. Raises PhysimError for another i."""
        if not isinstance(i, SupportsIndex) or i not in range(self.scene.robots):
            raise PhysimError(f"robot {describe(i)}; allowed: 0 to {self.scene.robots - 1}")
        return self.view.observation(int(i))

    def arrays(
        self,
        others: int = 4,
        walls: int = 4,
        ahead: Sequence[float] = (1.0, 2.0),
        dtype: DTypeLike = np.float32,
    ) -> Arrays:
        """What all robots may know now, as arrays of fixed sizes for learners: `View.arrays`."""
        return self.view.arrays(others, walls, ahead, dtype)

    def look_on(self, observer: Observer) -> None:
        """Let an observer look on from now on; during a step, from the next on."""
        check_part(OBSERVER, observer)
        where = f"observer {type(observer).__name__} at {self.time:g} s"
        with nullcontext() if is_shipped(observer) else naming(where, observer.start):
            observer.start(self)
        self.observers.append(observer)

    # A step

    def step(self, commands: FloatArray | None = None, steps: int = 1) -> None:
        """Go from this sample to the next, or that many ``steps`` on.

        With ``commands`` (N, columns) every robot holds those and no controller is asked. Several
        steps are the same, bit for bit, as that many calls with these; they are checked once.
        Raises ControllerError for a command that is not finite or beyond what a robot can follow,
        PhysimError for ``steps`` that are no whole number from 1 on.
        """
        if steps != 1 or type(steps) is not int:
            if not isinstance(steps, int | np.integer) or isinstance(steps, bool) or steps < 1:
                raise PhysimError(f"steps = {steps!r}; it must be a whole number from 1 on")
            given, self.met = None if commands is None else self._given(commands), []
            for _ in range(steps):
                self._step(self._decide() if given is None else given)
            return
        self.met = []
        self._step(self._decide() if commands is None else self._given(commands))

    def _step(self, decided: Decided) -> None:
        """Make a step with what was decided."""
        truth = self.now
        sensing = self._sense(NOBODY)[1] if self._calls[SENSE] else self._states[SENSE]
        nominal = decided.nominal
        filtered, filters = self._run_stage(FILTERED, nominal)
        driven, drive = filtered, truth.drive
        if self.scene.drives:
            drive = followed(self.scene, filtered, drive, self.time)
            driven = applied_of(drive, filtered)
        applied, disturbances = self._run_stage(DISTURBED, driven)
        self.physics.step(applied)
        self._states = (sensing, filters, disturbances)
        self._told = truth, self._sensed, decided, filtered, applied
        self._arrive(truth.step + 1, nominal, drive)
        if len(self.physics.contacts):
            self.met.append(self.physics.contacts)
        if self.observers:
            self._report()

    def _run_stage(self, stage: int, given: Any) -> tuple[Any, tuple[Any, ...]]:
        """What the parts of a stage make of what they are given, in turn; and their next states.

        Whatever parts of users return is checked here: its shape, finite numbers, and limits.
        Raises ControllerError.
        """
        calls = self._calls[stage]
        if not calls:
            return given, self._states[stage]
        known: Any = self._sense()[0] if stage == FILTERED else self.now
        states = list(self._states[stage])
        is_apart = False
        for k, part, call in calls:
            on_demand = stage == SENSE and getattr(part, "on_demand", False)
            if on_demand and not is_apart and len(given.robot):
                given = usable_rows(given, self._usable)
            is_apart = on_demand
            try:  # not by `naming`, which takes as long as a step of the engine
                answer = call(self.scene, known, given, states[k])
                if is_shipped(part):
                    given, states[k] = answer
                    continue
                if type(answer) is not tuple or len(answer) != 2:
                    what = "sensed" if stage == SENSE else "commands"
                    raise ControllerError(
                        f"{call.__name__} returned {kind_of(answer)}; it must return "
                        f"({what}, state)"
                    )
                if stage == SENSE:
                    given = taken_sensed(answer[0], given, self.scene)
                else:
                    given = taken_commands(self.scene, answer[0], given, self._limits[stage])
                states[k] = answer[1]
            except KeyboardInterrupt:
                raise
            except BaseException as error:
                if is_shipped(part):
                    raise
                where = f"{STAGES[stage].word} {type(part).__name__} at {self.time:g} s"
                raise ControllerError(f"{where}: {broken_by(error, call)}") from error
        return given, tuple(states)

    def _sense(self, looking: IntArray | None = None) -> tuple[Sensed, tuple[Any, ...]]:
        """What robots know at this sample, and the states of the stages for the next.

        Where stages work on demand, at least those who are ``looking`` know of others.
        """
        looking = looking if self._is_on_demand else None
        if self._sensed is None or not (
            looking is NOBODY or self._looking is None or self._looking is looking
        ):
            given = self._nothing
            if looking is not NOBODY:
                rows = self._shared
                if looking is not None:
                    end = np.zeros(self.scene.robots, np.int64)
                    end[looking] = len(rows[0])
                    rows = (*rows[:2], read_only(end), *rows[3:])
                given = everybody(self.now, rows)
            self._looking = looking
            self._sensed = self._run_stage(SENSE, given)
        return self._sensed

    def _given(self, commands: FloatArray) -> Decided:
        """Nominal commands from outside."""
        try:  # not by `naming`, which takes as long as a step of the engine
            return Decided(taken_commands(self.scene, commands, None, self.scene.limits))
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise ControllerError(f"commands at {self.time:g} s: {broken_by(error)}") from error

    def _decide(self) -> Decided:
        """Nominal commands of all robots from now on; those that are due are asked."""
        if self.now.step < self._next_due:
            return Decided(self.now.command)
        due = read_only((self.next_decision <= self.now.step).nonzero()[0])
        view = self._view_of(self._sense(due)[0])
        began = time.thread_time()
        decided = decide(self._asked, view, due, self.now.command, self.memory)
        if self.decision_times is not None:
            self.decision_times.append((time.thread_time() - began) / len(due))
        if decided.decisions is not None:
            self.mode = replaced(self.mode, due, decided.decisions.mode)
        self.next_decision = replaced(self.next_decision, due, decided.next_step)
        self._next_due = int(np.minimum.reduce(self.next_decision))
        return decided

    def _arrive(self, step: int, nominal: FloatArray, drive: FloatArray) -> None:
        """Take up the sample to which the physics brought the robots."""
        pose = read_only(self.physics.pose)
        velocity, grazes = self._swept.follow(step, self.now.moving_pose, pose)
        if len(grazes):  # which the engine cannot see
            self.physics.contacts = np.concatenate(
                (self.physics.contacts, grazes), dtype=CONTACT_ROW
            )
        self._arrivals.follow(self._tracking, step, pose)
        self._take(step, pose, nominal, read_only(velocity), drive)

    def _report(self) -> None:
        """Let observers look at the step; one that is added sees the next step first."""
        last, now, due = self.last, self.now, self.next_decision
        for observer in tuple(self.observers):
            try:
                observer.after_step(last)  # type: ignore[arg-type]  # a step was made
                if self.now is not now or self.next_decision is not due:
                    raise ControllerError(f"it moved the simulation; {LOOK_ON}")
            except KeyboardInterrupt:
                raise
            except BaseException as error:
                if is_shipped(observer):
                    raise
                where = f"observer {type(observer).__name__} at {now.step * self.scene.dt:g} s"
                told = broken_by(error, observer.after_step)
                raise ControllerError(f"{where}: {told}") from error

    @property
    def last(self) -> Step | None:
        """What happened in the last step; None where no step was made."""
        if self._told is None:
            return None
        truth, known, decided, filtered, applied = self._told
        sensed = known[0] if known else everybody(truth, self._shared)
        return Step(
            truth, sensed._replace(step=truth.step), decided.decisions,
            decided.next_step, decided.nominal, filtered, applied, self.now.pose,
            locked(self.physics.contacts), locked(self.physics.false_contacts),
            self._arrivals.arrived, self.now.moving_pose, self.now.drive,
        )  # fmt: skip

    def branch(
        self, controller: Controller | str | Mapping[str, Any] | None = None, **changes: Any
    ) -> Simulation:
        """A simulation that goes on from the present sample with something changed.

        ``controller`` as for `Simulation`, or settings of the world's: robots whose controller is
        changed begin with its memory, and decide at once. ``changes`` are those of `World.changed`,
        of keys that move and reshape no body, which an error lists for any other; stages may be
        objects, which take the place of those that were given. A stage that is changed, too, begins
        anew; all else is kept, so that without changes what follows is bit for bit what follows
        here. Observers stay behind; `physim.record_run` records the branch. Raises PhysimError for
        a key that cannot change in mid-run, and what `Simulation` raises.
        """
        return branch_of(self, controller, changes)
