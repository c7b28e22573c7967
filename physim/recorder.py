"""Record a run: the observer that writes what happened into a `RecordWriter`.

Poses are gathered in blocks; at the end of a block the clearances of all its samples are worked
out in one call and everything goes to the record, so memory stays flat however long the run.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from physim.arrival import since
from physim.contacts import CONTACT, FALSE_CONTACT
from physim.geometry.clearance import Clearances, clearances
from physim.geometry.shapes import FloatArray
from physim.grazes import GrazeFinder
from physim.perception import formation_errors
from physim.record import RecordWriter
from physim.record.layout import COMMAND, CONSIDERED, OPTIONAL
from physim.scene import Scene
from physim.stages import Step

if TYPE_CHECKING:
    from physim.simulation import Simulation

BLOCK_STEPS = 256
"""Samples gathered before they are worked on; less when the wall clock is first."""
BLOCK_SECONDS = 0.3
"""[s] of computing after which a block goes to the record, however short."""


@dataclass(frozen=True)
class SaveAt:
    """What a run records.

    ``every`` [steps] from one sample to the next, the world's ``time.record_every`` where it is
    None; ``tables``, those of `physim.record.layout.OPTIONAL` that are kept. Samples and commands
    are always there: without them a record could not be held against anything.
    """

    every: int | None = None
    tables: Sequence[str] = OPTIONAL

    def __post_init__(self) -> None:
        """Raise ValueError for a table that there is not, and for less than one step."""
        unknown = [table for table in self.tables if table not in OPTIONAL]
        if unknown:
            raise ValueError(f"tables: {unknown[0]!r}; allowed: {', '.join(OPTIONAL)}")
        if self.every is not None and self.every < 1:
            raise ValueError(f"every = {self.every}; it must be at least 1 step")


class Recorder:
    """Takes down one run of a `Simulation`, sample by sample, into a `RecordWriter`."""

    def __init__(self, writer: RecordWriter, every: int, tables: Sequence[str] = OPTIONAL) -> None:
        self.writer = writer
        self.every = every
        self.tables = tuple(tables)
        self.count = self.first = self.rejected = 0
        self.decided: list[Step] = []
        self.commands: list[NDArray[np.void]] = []
        self.contacts: list[NDArray[np.void]] = []
        self.false_contacts: list[NDArray[np.void]] = []
        self.from_outside = False

    def start(self, simulation: Simulation) -> None:
        """Take down sample 0. Raises ValueError where the simulation has made steps already."""
        if simulation.step_number:
            raise ValueError(
                f"the simulation is at step {simulation.step_number}; a record begins at step 0"
            )
        self.scene: Scene = simulation.scene
        robots = self.scene.robots
        size = max(self.every, BLOCK_STEPS - BLOCK_STEPS % self.every)
        self.poses = np.empty((size, robots, 3))
        self.arrived = np.empty((size, robots), dtype=np.bool_)
        self.since = np.full(robots, -1, dtype=np.int64)
        self.told = np.zeros((robots, 2))
        self.grazes = GrazeFinder(self.scene)
        self.poses[0], self.arrived[0], self.count = simulation.pose, simulation.arrived, 1
        self.contacts.append(simulation.contacts)
        self.false_contacts.append(simulation.physics.false_contacts)
        self.last_write = time.monotonic()
        self._write()  # sample 0 is a row of its own, so that later windows end on recorded steps

    def after_step(self, step: Step) -> None:
        """Take down a step and the sample to which it led."""
        count = self.count
        self.poses[count], self.arrived[count] = step.pose, step.arrived
        self.count = count + 1
        if len(step.contacts):
            self.contacts.append(step.contacts)
        if len(step.false_contacts):
            self.false_contacts.append(step.false_contacts)
        decisions = step.decisions
        if decisions is not None:
            self.decided.append(step)
            self.told[decisions.robot] = decisions.command
        elif step.nominal is not step.truth.command:
            self.from_outside = True
        if (
            self.from_outside
            or step.filtered is not step.nominal
            or step.applied is not step.filtered
        ):
            self._take_commands(step)
        full = self.count == len(self.poses)
        late = time.monotonic() - self.last_write > BLOCK_SECONDS
        if full or (late and self.count % self.every == 0):
            self._write()

    def close(self, ended: str) -> None:
        """Write what is left; the record itself is closed by who opened it."""
        self._write()

    def _take_commands(self, step: Step) -> None:
        """Keep the commands of robots whose stages differ, or who were told from outside."""
        stages = np.stack((self.told, step.nominal, step.filtered, step.applied))
        differ = (stages[1:] != stages[:-1]).any(axis=(0, 2))
        if differ.any():
            rows = np.zeros(int(differ.sum()), dtype=COMMAND)
            rows["step"], rows["robot"] = step.truth.step, np.flatnonzero(differ)
            for name, values in zip(
                (COMMAND.names or ())[2:], stages[1:, differ].transpose(0, 2, 1).reshape(6, -1),
                strict=True,
            ):  # fmt: skip
                rows[name] = values
            self.commands.append(rows)

    def _write(self) -> None:
        """Write the block; the samples last, since they are what makes the record flush."""
        self._write_decisions()
        if self.commands:
            self.writer.append("commands", np.concatenate(self.commands))
            self.commands = []
        if self.false_contacts:
            rows = np.concatenate(self.false_contacts, dtype=FALSE_CONTACT)
            self.rejected += len(rows)
            if "false_contacts" in self.tables:
                self.writer.append("false_contacts", rows)
            self.false_contacts = []
        if self.count:
            self._write_samples()
        self.first += self.count
        self.count = 0
        self.last_write = time.monotonic()

    def _write_decisions(self) -> None:
        steps, self.decided = self.decided, []
        if steps and "updates" in self.tables:
            rows = update_rows(self.scene, steps, self.writer.types["/updates"])
            self.writer.append("updates", rows)
        if steps and "considered" in self.tables:
            self.writer.append("considered", considered_rows(steps))

    def _write_samples(self) -> None:
        """Clearances, contacts at samples and between them in the order of steps, poses."""
        scene, poses = self.scene, self.poses[: self.count]
        self.since = later_since(self.since, self.first, self.arrived[: self.count])
        self.writer.note_arrived(self.since)
        found = clearances(poses, scene.shapes, scene.walls, scene.nearby)
        rows = np.concatenate(
            [*self.contacts, self.grazes.rows(self.first, poses, found)], dtype=CONTACT
        )
        if len(rows) and "contacts" in self.tables:
            self.writer.append("contacts", rows[np.argsort(rows["step"], kind="stable")])
        self.contacts = []
        self._write_poses(poses, found)

    def _write_poses(self, poses: FloatArray, found: Clearances) -> None:
        step = self.first + np.arange(self.count)
        self.writer.note_extremes(step, found)
        ends = np.append(np.arange(self.every, self.count + 1, self.every), self.count)
        ends = np.unique(ends) if self.first else np.array([1])
        starts = np.concatenate(([0], ends[:-1]))
        self.writer.append_steps(
            step[ends - 1],
            poses[ends - 1],
            np.minimum.reduceat(found.clearance, starts, axis=0),
            np.minimum.reduceat(found.boundary_clearance, starts, axis=0),
        )


def later_since(
    before: NDArray[np.int64], first: int, arrived: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Samples (N,) from which on robots have arrived, after a block (B, N) that begins at one."""
    found = since(arrived)
    throughout = (found == 0) & (before >= 0)
    return np.where(throughout, before, np.where(found >= 0, found + first, -1))


def update_rows(
    scene: Scene, steps: Sequence[Step], row_type: np.dtype[np.void]
) -> NDArray[np.void]:
    """Rows of the update table, in the order of steps."""
    told = [(step, step.decisions) for step in steps if step.decisions is not None]
    rows = np.zeros(sum(len(d.robot) for _, d in told), dtype=row_type)

    def column(values: Sequence[NDArray[Any]]) -> NDArray[Any]:
        return np.concatenate(values)

    rows["step"] = np.repeat([s.truth.step for s, _ in told], [len(d.robot) for _, d in told])
    for name in ("robot", "mode", "rule"):
        rows[name] = column([getattr(d, name) for _, d in told])
    rows["nominal_v"], rows["nominal_omega"] = column([d.command for _, d in told]).T
    applied = column([s.applied[d.robot] for s, d in told])
    rows["applied_v"], rows["applied_omega"] = applied.T
    for name in ("station", "reference_station", "deviation"):
        rows[name] = column([getattr(s.truth, name)[d.robot] for s, d in told])
    errors = formation_errors(scene, np.array([s.truth.reference_station for s, _ in told]))
    which = np.repeat(np.arange(len(told)), [len(d.robot) for _, d in told])
    rows["formation_error"] = errors[which, rows["robot"]]
    rows["considered"] = column([np.diff(d.considered_start) for _, d in told])
    rows["next_step"] = column([s.next_step for s, _ in told])
    report = column([d.report for _, d in told])
    fixed = len(row_type.names or ()) - report.shape[1]
    for k, name in enumerate((row_type.names or ())[fixed:]):
        rows[name] = report[:, k]
    return rows


def considered_rows(steps: Sequence[Step]) -> NDArray[np.void]:
    """Rows of the table of considered robots, in the order of the decisions."""
    told = [(step.truth.step, step.decisions) for step in steps if step.decisions is not None]
    rows = np.zeros(sum(len(d.considered) for _, d in told), dtype=CONSIDERED)
    counts = [np.diff(d.considered_start) for _, d in told]
    robots = [np.repeat(d.robot, count) for (_, d), count in zip(told, counts, strict=True)]
    rows["step"] = np.repeat([step for step, _ in told], [len(d.considered) for _, d in told])
    rows["robot"] = np.concatenate(robots)
    rows["other"] = np.concatenate([d.considered for _, d in told])
    return rows
