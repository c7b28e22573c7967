"""Record a run: the observer that writes what happened into a `RecordWriter`.

Steps are gathered in blocks; at the end of a block the clearances of all its samples are worked
out in one call and everything goes to the record, so memory stays flat however long the run.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from physim.contacts import CONTACT_ROW, FALSE_CONTACT_ROW
from physim.geometry.clearance import Clearances, clearances
from physim.geometry.shapes import FloatArray
from physim.parts.stages import Step
from physim.record import RecordWriter
from physim.record.layout import COMMAND, CONSIDERED, OPTIONAL
from physim.simulation.arrival import since
from physim.simulation.observation import formation_errors
from physim.simulation.swept_contacts import SweptContactFinder
from physim.world.scene import Scene

if TYPE_CHECKING:
    from physim.simulation.loop import Simulation

BLOCK_STEPS = 256
"""Samples gathered before they are worked on; less when the wall clock is first."""
BLOCK_SECONDS = 0.3
"""[s] of computing after which a block goes to the record, however short."""
NO_COMMANDS = np.zeros(0, dtype=COMMAND)


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
        self.size = max(every, BLOCK_STEPS - BLOCK_STEPS % every)
        self.steps: list[Step] = []
        self.first = self.rejected = 0
        self.latest: FloatArray | None = None
        """(N, 2) latest command of each controller, once commands came from outside"""

    def start(self, simulation: Simulation) -> None:
        """Take down sample 0. Raises ValueError where the simulation has made steps already."""
        if simulation.step_number:
            raise ValueError(
                f"the simulation is at step {simulation.step_number}; a record begins at step 0"
            )
        self.scene: Scene = simulation.scene
        self.since = np.full(self.scene.robots, -1, dtype=np.int64)
        self.swept = SweptContactFinder(self.scene)
        # sample 0 is a row of its own, so that later windows end on recorded steps
        self._write_false_contacts([simulation.physics.false_contacts])
        self._write_samples(simulation.pose[None], simulation.arrived[None], [simulation.contacts])
        self.last_write = time.monotonic()

    def after_step(self, step: Step) -> None:
        """Take down a step and the sample to which it led."""
        self.steps.append(step)
        count = len(self.steps)
        late = time.monotonic() - self.last_write > BLOCK_SECONDS
        if count == self.size or (late and count % self.every == 0):
            self._write()

    def close(self, ended: str) -> None:
        """Write what is left; the record itself is closed by who opened it."""
        self._write()

    def _write(self) -> None:
        """Write the block; the samples last, since they are what makes the record flush."""
        steps, self.steps = self.steps, []
        self._write_decisions([step for step in steps if step.decisions is not None])
        if commands := [rows for step in steps if len(rows := self._commands(step))]:
            self.writer.append("commands", np.concatenate(commands))
        self._write_false_contacts([step.false_contacts for step in steps])
        if steps:
            self._write_samples(
                np.array([step.pose for step in steps]),
                np.array([step.arrived for step in steps]),
                [step.contacts for step in steps if len(step.contacts)],
            )
        self.last_write = time.monotonic()

    def _commands(self, step: Step) -> NDArray[np.void]:
        """Rows of the robots whose stages differ, or that were commanded from outside."""
        decisions = step.decisions
        if self.latest is not None and decisions is not None:
            self.latest[decisions.robot] = decisions.command
        elif self.latest is None and decisions is None and step.nominal is not step.truth.command:
            self.latest = step.truth.command.copy()
        if self.latest is None and step.applied is step.filtered is step.nominal:
            return NO_COMMANDS
        latest = step.nominal if self.latest is None else self.latest
        stages = np.stack((latest, step.nominal, step.filtered, step.applied))
        differ = (stages[1:] != stages[:-1]).any(axis=(0, 2))
        rows = np.zeros(int(differ.sum()), dtype=COMMAND)
        rows["step"], rows["robot"] = step.truth.step, np.flatnonzero(differ)
        for name, values in zip(
            (COMMAND.names or ())[2:], stages[1:, differ].transpose(0, 2, 1).reshape(6, -1),
            strict=True,
        ):  # fmt: skip
            rows[name] = values
        return rows

    def _write_decisions(self, steps: Sequence[Step]) -> None:
        if not steps:
            return
        rows = update_rows(self.scene, steps, self.writer.types["/updates"])
        if "updates" in self.tables:
            self.writer.append("updates", rows)
        if "considered" in self.tables:
            self.writer.append("considered", considered_rows(steps, rows))

    def _write_false_contacts(self, found: Sequence[NDArray[np.void]]) -> None:
        rows = [one for one in found if len(one)]
        self.rejected += sum(map(len, rows))
        if rows and "false_contacts" in self.tables:
            self.writer.append("false_contacts", np.concatenate(rows, dtype=FALSE_CONTACT_ROW))

    def _write_samples(
        self, poses: FloatArray, arrived: NDArray[np.bool_], contacts: Sequence[NDArray[np.void]]
    ) -> None:
        """Clearances, contacts at samples and between them in the order of steps, poses (B, N, 3).

        ``arrived`` (B, N); ``contacts`` are those of samples that have some.
        """
        self.since = later_since(self.since, self.first, arrived)
        self.writer.note_arrived(self.since)
        found = clearances(poses, self.scene.shapes, self.scene.walls, self.scene.wall_grid)
        rows = np.concatenate(
            [*contacts, self.swept.rows(self.first, poses, found)], dtype=CONTACT_ROW
        )
        if len(rows) and "contacts" in self.tables:
            self.writer.append("contacts", rows[np.argsort(rows["step"], kind="stable")])
        self._write_poses(poses, found)
        self.first += len(poses)

    def _write_poses(self, poses: FloatArray, found: Clearances) -> None:
        count = len(poses)
        step = self.first + np.arange(count)
        self.writer.note_extremes(step, found)
        ends = np.append(np.arange(self.every, count + 1, self.every), count)
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
    decided = [(step, step.decisions) for step in steps if step.decisions is not None]

    def column(values: Sequence[NDArray[Any]]) -> NDArray[Any]:
        return np.concatenate(values)

    robot = column([d.robot for _, d in decided])
    which = np.repeat(np.arange(len(decided)), [len(d.robot) for _, d in decided])
    rows = np.zeros(len(robot), dtype=row_type)
    rows["step"] = np.array([s.truth.step for s, _ in decided])[which]
    rows["robot"] = robot
    rows["mode"], rows["rule"] = (
        column([d.mode for _, d in decided]),
        column([d.rule for _, d in decided]),
    )
    rows["nominal_v"], rows["nominal_omega"] = column([d.command for _, d in decided]).T
    applied = np.array([s.applied for s, _ in decided])[which, robot]
    rows["applied_v"], rows["applied_omega"] = applied.T
    station, reference, deviation = (
        np.array([getattr(s.truth, name) for s, _ in decided])
        for name in ("station", "reference_station", "deviation")
    )
    rows["station"], rows["reference_station"] = station[which, robot], reference[which, robot]
    rows["deviation"] = deviation[which, robot]
    rows["formation_error"] = formation_errors(scene, reference)[which, robot]
    rows["considered"] = column([np.diff(d.considered_start) for _, d in decided])
    rows["next_step"] = column([s.next_step for s, _ in decided])
    report = column([d.report for _, d in decided])
    fixed = len(row_type.names or ()) - report.shape[1]
    for k, name in enumerate((row_type.names or ())[fixed:]):
        rows[name] = report[:, k]
    return rows


def considered_rows(steps: Sequence[Step], updates: NDArray[np.void]) -> NDArray[np.void]:
    """Rows of the table of considered robots, in the order of the decisions in ``updates``."""
    decided = [step.decisions for step in steps if step.decisions is not None]
    rows = np.zeros(int(updates["considered"].sum()), dtype=CONSIDERED)
    for name in ("step", "robot"):
        rows[name] = np.repeat(updates[name], updates["considered"])
    rows["other"] = np.concatenate([d.considered for d in decided])
    return rows
