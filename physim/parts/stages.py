"""The stages of a step: sense, filter, disturb, and observers that look on.

    sense → decide → filter → drive → disturb → move → report

Every stage is a list of parts found by name (an entry point and a key of the world) or given from
Python. A part is an object with frozen settings; what it remembers is an explicit state, any value
that can be pickled and is never written to, which the simulation holds: each call gets it and
returns the next one. Parts of one stage run one after the other. Truth (`Snapshot`) is for
disturbances alone: controllers and filters get what sensing gives (`Sensed`).
"""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.geometry.path import SHORTEST_WINDOW, track
from physim.geometry.shapes import Flags, FloatArray, IntArray, Polylines, Rows3, Rows6, read_only
from physim.parts.controller import Decisions, Sensed, Snapshot
from physim.parts.drive import NO_DRIVES
from physim.world.scene import Scene

if TYPE_CHECKING:
    from physim.simulation.loop import Simulation


@runtime_checkable
class SensingStage(Protocol):
    """Changes what robots know of one another: noise, delay, loss.

    A class with ``on_demand = True`` promises that its states do not depend on the rows that it is
    given. It gets rows of each observer's own, as of `for_each`, which must not be written to: of
    bodies within the sensing range, and of formation neighbours. Where all stages promise it, only
    observers that look at a step have rows: those that decide, or all where a filter or somebody
    outside looks. Where nobody looks there are none. With ``is_off``, too, it is not asked at all.
    """

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
        """Filtered commands (N, columns) for nominal ones, which must not be written to."""
        ...


@runtime_checkable
class Disturbance(Protocol):
    """Makes robots depart from what their drives make of commands: gains, slip, pushes."""

    def start(self, scene: Scene) -> Any:
        """State at sample 0."""
        ...

    def disturb(
        self, scene: Scene, truth: Snapshot, filtered: FloatArray, state: Any
    ) -> tuple[FloatArray, Any]:
        """Applied commands (N, columns) for those of the drives, which must not be written to.

        They must be finite; the robots' limits bind controllers and filters only.
        """
        ...


class Step(NamedTuple):
    """What happened in one step, from sample ``truth.step`` to the next. Nothing in it changes."""

    truth: Snapshot
    """the sample at which it began"""
    sensed: Sensed
    """what robots knew; where all sensing stages work on demand, those that looked"""
    decisions: Decisions | None
    """of the robots that were due; None where nobody was, or commands came from outside"""
    next_step: IntArray
    """(M,) when each of them decides again"""
    nominal: FloatArray
    """(N, columns) [m/s, rad/s, m/s] as controllers want it"""
    filtered: FloatArray
    """(N, columns) after the filters"""
    applied: FloatArray
    """(N, columns) after drives and disturbances: what the bodies are driven by"""
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
    drive: FloatArray = NO_DRIVES
    """(N, 4) what drives did in the step, as in `Snapshot`"""


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


BLOCK = 16
"""Rows that are looked at together"""
Shared = tuple[IntArray, IntArray, IntArray, FloatArray, FloatArray]
"""Robot, first, end, age and heard of rows"""


def everybody(truth: Snapshot, rows: Shared) -> Sensed:
    """What is sensed where everybody knows the truth: no copy; ``rows`` are those of `shared`."""
    robot, first, end, age, heard = rows
    return Sensed(
        truth.step, robot, truth.moving_pose, truth.moving_command, truth.moving_velocity,
        truth.moving_station, age, first, end, truth.station, heard, truth.drive,
    )  # fmt: skip


def shared(robots: int, moving: int | None = None) -> Shared:
    """Rows about all that moves, which all of N observers share.

    Without ``moving`` the robots are all that does. Other bodies tell nothing.
    """
    moving = robots if moving is None else moving
    robot = np.arange(moving)
    first, end, age = np.zeros(robots, np.int64), np.full(robots, moving), np.zeros(moving)
    heard = np.where(robot < robots, 0.0, np.inf)
    return read_only(robot), read_only(first), read_only(end), read_only(age), read_only(heard)


def nothing(truth: Snapshot) -> Sensed:
    """What is sensed where nobody looks: no rows."""
    none, no = np.zeros(0), np.zeros(0, np.int64)
    first = np.zeros(len(truth.station), np.int64)
    return Sensed(
        truth.step, no, truth.pose[:0], truth.command[:0], truth.velocity[:0], none, none, first,
        first, truth.station, none, truth.drive,
    )  # fmt: skip


def for_each(sensed: Sensed) -> Sensed:
    """Give every observer rows of its own, in the order of observers: copies to be changed."""
    return usable_rows(sensed, Usable(-1.0, -1.0, np.zeros(0, np.int64), False))


def usable_rows(sensed: Sensed, limits: Usable) -> Sensed:
    """Give every observer rows of its own, of those that it may use.

    Neighbours beyond its range are told of, and not seen.
    """
    observers, most = len(sensed.first), int((sensed.end - sensed.first).sum())
    taken, first, end = np.empty(most, np.int64), *np.empty((2, observers), np.int64)
    beyond = np.empty(most, np.bool_)
    many = take_rows(
        observers, sensed.first, sensed.end, len(sensed.robot), sensed.robot, sensed.pose,
        sensed.reference_station, limits, taken, beyond, first, end,
    )  # fmt: skip
    rows = kept_rows(sensed, taken[:many])
    hide_rows(many, beyond, rows.pose, rows.velocity)
    return rows._replace(first=first, end=end, station=sensed.station.copy())


class Usable(NamedTuple):
    """Which rows an observer may use: of itself, of bodies in range, of formation neighbours."""

    reach: float
    """[m] of bodies so near; below 0: all rows"""
    neighbours: float
    """[m] of robots whose stations are so near; below 0: there are no formation neighbours"""
    adjacency: IntArray
    """(N N,) 1 where a robot is a neighbour"""
    is_listed: bool
    """whether neighbours are those of ``adjacency`` alone"""

    @staticmethod
    def of(scene: Scene) -> Usable:
        """Which rows observers of a scene may use."""
        plan = scene.formation
        near = plan.range if plan.active else -1.0
        listed = len(plan.adjacency) > 0
        return Usable(scene.sensing_range, near, plan.adjacency.reshape(-1), listed)


@compiled
def take_rows(
    observers: int,
    first: IntArray,
    end: IntArray,
    rows: int,
    robot: IntArray,
    pose: Rows3,
    station: FloatArray,
    limits: Usable,
    taken: IntArray,
    beyond: Flags,
    taken_first: IntArray,
    taken_end: IntArray,
) -> int:
    """Write the numbers of the rows of every observer, in their order, into ``taken``: how many.

    And which are ``beyond`` its range. Blocks of rows that are all out of reach are not looked at.
    """
    count, square = 0, limits.reach * limits.reach
    boxes = np.empty((rows // BLOCK + 1, 6), np.float64)
    put_boxes(rows, pose, station, boxes)
    for i in range(observers):
        taken_first[i], taken_end[i], me, row = count, count, first[i] + i, first[i]
        if row == end[i]:
            continue
        if me >= end[i] or robot[me] != i:
            me = row
            while robot[me] != i:
                me += 1
        x, y, own = pose[me, 0], pose[me, 1], station[me]
        while row < end[i]:
            box, after = boxes[row // BLOCK], min(end[i], BLOCK * (row // BLOCK + 1))
            dx = max(box[0] - x, x - box[1], 0.0)
            dy = max(box[2] - y, y - box[3], 0.0)
            along = max(box[4] - own, own - box[5])
            is_told = limits.neighbours >= 0.0 and (limits.is_listed or along <= limits.neighbours)
            if limits.reach >= 0.0 and dx * dx + dy * dy > square and not is_told:
                row = after
            while row < after:
                dx, dy, j = pose[row, 0] - x, pose[row, 1] - y, robot[row]
                is_seen = row == me or limits.reach < 0.0 or dx * dx + dy * dy <= square
                is_used = is_seen
                if is_told and not is_seen and j < observers:
                    if limits.is_listed:
                        is_used = limits.adjacency[observers * i + j] != 0
                    else:
                        is_used = abs(station[row] - own) <= limits.neighbours
                if is_used:
                    taken[count], beyond[count] = row, not is_seen
                    count += 1
                row += 1
        taken_end[i] = count
    return count


@compiled
def put_boxes(rows: int, pose: Rows3, station: FloatArray, out: Rows6) -> None:
    """Write least and greatest x, y and station of every block of so many rows."""
    for row in range(rows):
        box = out[row // BLOCK]
        if row % BLOCK == 0:
            for m in range(3):
                box[2 * m], box[2 * m + 1] = np.inf, -np.inf
        for m in range(3):
            value = pose[row, m] if m < 2 else station[row]
            if value < box[2 * m]:
                box[2 * m] = value
            if value > box[2 * m + 1]:
                box[2 * m + 1] = value


@compiled
def hide_rows(many: int, hidden: Flags, pose: Rows3, velocity: Rows3) -> None:
    """Make ``hidden`` ones of so many rows unseen."""
    for row in range(many):
        if hidden[row]:
            for m in range(3):
                pose[row, m], velocity[row, m] = np.nan, np.nan


def kept_rows(sensed: Sensed, kept: NDArray[Any]) -> Sensed:
    """Copies of some rows, by a mask or their numbers; ``first`` and ``end`` are as before."""
    names = ("robot", "pose", "command", "velocity", "reference_station", "age", "heard")
    at = kept.nonzero()[0] if kept.dtype == np.bool_ else kept
    return sensed._replace(**{name: getattr(sensed, name).take(at, axis=0) for name in names})


def observer_of_row(sensed: Sensed) -> IntArray:
    """(M,) which observer each row belongs to, of rows that came from `for_each`."""
    return np.repeat(np.arange(len(sensed.first)), sensed.end - sensed.first)


def with_poses(scene: Scene, sensed: Sensed, pose: FloatArray) -> Sensed:
    """Put other poses (M, 3) into rows that came from `for_each`; stations follow them.

    Projections look near the stations that the rows had before, so that a path which passes near
    itself misleads nobody.
    """
    reference, own = sensed.reference_station.copy(), sensed.station.copy()
    pose = np.array(pose, dtype=np.float64)
    follow_poses(
        scene.reference, scene.paths, len(pose), observer_of_row(sensed), sensed.robot, pose,
        reference, own, SHORTEST_WINDOW,
    )  # fmt: skip
    return sensed._replace(pose=pose, reference_station=reference, station=own)


@compiled
def follow_poses(
    reference: Polylines,
    paths: Polylines,
    rows: int,
    observer: IntArray,
    robot: IntArray,
    pose: Rows3,
    station: FloatArray,
    own: FloatArray,
    window: float,
) -> None:
    """Move stations (M,) of rows, and the ``own`` (N,) of observers, along with their poses."""
    for row in range(rows):
        x, y = pose[row, 0], pose[row, 1]
        if not isnan(x):  # else it is not seen
            station[row], _, _ = track(reference, 0, x, y, station[row], window)
            j = robot[row]
            if j == observer[row]:
                own[j], _, _ = track(paths, j, x, y, own[j], window)
