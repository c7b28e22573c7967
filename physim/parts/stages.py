"""The stages of a step: sense, filter, disturb, and observers that look on.

    sense → decide → filter → disturb → move → report

Every stage is a list of parts found by name (an entry point and a key of the world) or given from
Python. A part is an object with frozen settings; what it remembers is an explicit state, any value
that can be pickled and is never written to, which the simulation holds: each call gets it and
returns the next one. Parts of one stage run one after the other. Truth (`Snapshot`) is for
disturbances alone: controllers and filters get what sensing gives (`Sensed`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from physim.geometry.path import project_near
from physim.geometry.shapes import FloatArray, IntArray, read_only
from physim.parts.controller import Decisions, Sensed, Snapshot
from physim.world.scene import Scene

if TYPE_CHECKING:
    from physim.simulation.loop import Simulation


@runtime_checkable
class SensingStage(Protocol):
    """Changes what robots know of one another: noise, delay, loss."""

    def start(self, scene: Scene) -> Any:
        """State at sample 0."""
        ...

    def sense(
        self, scene: Scene, truth: Snapshot, sensed: Sensed, state: Any
    ) -> tuple[Sensed, Any]:
        """What robots know at this step, and the state for the next; called at every step.

        ``sensed`` is what the stage before gave; rows for each observer come from `for_each`.
        """
        ...


@runtime_checkable
class Filter(Protocol):
    """Changes what controllers want before the robots execute it, at every step."""

    def start(self, scene: Scene) -> Any:
        """State at sample 0."""
        ...

    def filter(
        self, scene: Scene, sensed: Sensed, nominal: FloatArray, state: Any
    ) -> tuple[FloatArray, Any]:
        """Filtered commands (N, 2) for nominal ones (N, 2), which must not be written to."""
        ...


@runtime_checkable
class Disturbance(Protocol):
    """Makes robots depart from their commands: gains, slip, pushes."""

    def start(self, scene: Scene) -> Any:
        """State at sample 0."""
        ...

    def disturb(
        self, scene: Scene, truth: Snapshot, filtered: FloatArray, state: Any
    ) -> tuple[FloatArray, Any]:
        """Applied commands (N, 2) for filtered ones (N, 2), which must not be written to.

        They must be finite; the robots' limits bind controllers and filters only.
        """
        ...


class Step(NamedTuple):
    """What happened in one step, from sample ``truth.step`` to the next. Nothing in it changes."""

    truth: Snapshot
    """the sample at which it began"""
    sensed: Sensed
    decisions: Decisions | None
    """of the robots that were due; None where nobody was, or commands came from outside"""
    next_step: IntArray
    """(M,) when each of them decides again"""
    nominal: FloatArray
    """(N, 2) [m/s, rad/s] as controllers want it"""
    filtered: FloatArray
    """(N, 2) after the filters"""
    applied: FloatArray
    """(N, 2) after the disturbances: what the bodies are driven by"""
    pose: FloatArray
    """(N, 3) of robots at the sample after the step, as contacts allow"""
    contacts: NDArray[np.void]
    """rows, as `Record.contacts`, of that sample, and last the grazes of the step"""
    false_contacts: NDArray[np.void]
    """rows, as `Record.false_contacts`, of that sample"""
    arrived: NDArray[np.bool_]
    """(N,) which robots have arrived at that sample"""
    moving_pose: FloatArray
    """(B, 3) of all that moves at that sample, robots first"""


@runtime_checkable
class Observer(Protocol):
    """Looks on at a run; it cannot change it."""

    def start(self, simulation: Simulation) -> None:
        """Look at the sample at which it begins."""
        ...

    def after_step(self, step: Step) -> None:
        """After every step."""
        ...

    def close(self, ended: str) -> None:
        """After the last step; ``ended`` is finished, duration, interrupted or error."""
        ...


def everybody(truth: Snapshot, rows: tuple[IntArray, IntArray, IntArray, FloatArray]) -> Sensed:
    """What is sensed where everybody knows the truth: no copy; ``rows`` are those of `shared`."""
    robot, first, end, age = rows
    return Sensed(
        truth.step, robot, truth.moving_pose, truth.moving_command, truth.moving_velocity,
        truth.moving_station, age, first, end, truth.station,
    )  # fmt: skip


def shared(
    robots: int, moving: int | None = None
) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
    """Robot, first, end and age of rows about all that moves, which all of N observers share.

    Without ``moving`` the robots are all that does.
    """
    moving = robots if moving is None else moving
    robot = np.arange(moving)
    first, end, age = np.zeros(robots, np.int64), np.full(robots, moving), np.zeros(moving)
    return read_only(robot), read_only(first), read_only(end), read_only(age)


def for_each(sensed: Sensed) -> Sensed:
    """Give every observer rows of its own, in the order of observers: copies to be changed."""
    rows = [np.arange(a, b) for a, b in zip(sensed.first, sensed.end, strict=True)]
    taken = np.concatenate(rows) if rows else np.zeros(0, np.int64)
    counts = sensed.end - sensed.first
    end = np.cumsum(counts)
    names = ("robot", "pose", "command", "velocity", "reference_station", "age")
    copies = {name: getattr(sensed, name)[taken] for name in names}
    return sensed._replace(**copies, first=end - counts, end=end, station=sensed.station.copy())


def observer_of_row(sensed: Sensed) -> IntArray:
    """(M,) which observer each row belongs to, of rows that came from `for_each`."""
    return np.repeat(np.arange(len(sensed.first)), sensed.end - sensed.first)


def with_poses(scene: Scene, sensed: Sensed, pose: FloatArray) -> Sensed:
    """Put other poses (M, 3) into rows that came from `for_each`; stations follow them.

    Projections look near the stations that the rows had before, so that a path which passes near
    itself misleads nobody.
    """
    reference, own = sensed.reference_station.copy(), sensed.station.copy()
    who, pose = observer_of_row(sensed), np.array(pose, dtype=np.float64)
    for row, (x, y, _) in enumerate(pose):
        j = int(sensed.robot[row])
        reference[row] = project_near(scene.reference, 0, x, y, float(reference[row]))
        if j == who[row]:
            own[j] = project_near(scene.paths, j, x, y, float(own[j]))
    return sensed._replace(pose=pose, reference_station=reference, station=own)
