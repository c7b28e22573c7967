"""Record a run: the observer that writes what happened into a `RecordWriter`.

Steps are gathered in blocks; at the end of a block the clearances of all its samples are worked
out in one call and everything goes to the record, so memory stays flat however long the run.
"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from physim.contacts import CONTACT_ROW, FALSE_CONTACT_ROW, touching
from physim.errors import RecordError
from physim.geometry.clearance import ClearanceFinder
from physim.geometry.shapes import FloatArray, IntArray
from physim.parts.stages import Step
from physim.record import RecordWriter
from physim.record.layout import CONSIDERING, OPTIONAL, PARTS, SENSED, Layout
from physim.simulation.arrival import later_since
from physim.simulation.observation import View, formation_errors
from physim.world.scene import Scene

if TYPE_CHECKING:
    from physim.simulation.loop import Simulation

BLOCK_STEPS = 256
"""Samples gathered before they are worked on; less when the wall clock is first."""
BLOCK_POSES = 1 << 15
"""Poses of robots in a block: of very many robots it has fewer samples, so that memory stays small
and what was just written is still near the processor."""
BLOCK_SECONDS = 0.3
"""[s] of computing after which a block goes to the record, however short."""
SAMPLE_BYTES = 40
"""of a robot in a sample: its pose and two clearances"""
STATE_WORK, STEP_WORK, FEWEST_STEPS = 25_000, 5, 50
"""Steps of robots from one kept state to the next where a run keeps them by default, how many a
step costs beside those of its robots, and the fewest steps: some 70 ms of computing, and 1 to 6 %
of the file."""


@dataclass(frozen=True)
class SaveAt:
    """What a run records.

    ``every`` [steps] from one sample to the next, the world's ``time.record_every`` where it is
    None; ``tables``, those of updates, considered, contacts and false_contacts that are kept.
    Samples and commands are always there: without them a record could not be held against anything.
    ``states`` [s]: from one kept state to the next, from which `physim.state_at` lets another run
    start; "usual": as often as a branch needs to begin at once, and none where a part remembers
    what no record can keep. ``sensed``: whether what each robot sensed when it decided is kept, see
    `Record.sensed`.
    """

    every: int | None = None
    tables: Sequence[str] = OPTIONAL
    states: float | Literal["usual"] | None = None
    sensed: bool = False

    def __post_init__(self) -> None:
        """Raise ValueError for a table that there is not, and for no whole number of steps."""
        unknown = [table for table in self.tables if table not in OPTIONAL]
        if unknown:
            raise ValueError(f"tables: {unknown[0]!r}; allowed: {', '.join(OPTIONAL)}")
        states = 1.0 if self.states in (None, "usual") else self.states
        if isinstance(states, str) or not 0.0 < states < np.inf:
            raise ValueError(f"states = {states!r}; it must be a time in s, above 0, or usual")
        if self.every is None:
            return
        if isinstance(self.every, bool) or not isinstance(self.every, int | np.integer):
            raise ValueError(f"every = {self.every!r}; it must be a whole number of steps")
        if self.every < 1:
            raise ValueError(f"every = {self.every}; it must be at least 1 step")
        object.__setattr__(self, "every", int(self.every))


def check_room(scene: Scene, every: int, path: str | os.PathLike[str] | None) -> None:
    """Raise RecordError where the samples of a whole run surely do not fit.

    There is one every ``every`` steps; ``path`` is the file of the record, None for memory.
    """
    if path is None:
        where, room = "memory", float("inf")
        if "SC_PHYS_PAGES" in getattr(os, "sysconf_names", ()):
            room = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    else:
        folder = Path(path).absolute().parent
        while not folder.exists():
            folder = folder.parent
        disk, where = shutil.disk_usage(folder), str(folder)
        room = disk.free if disk.total else float("inf")  # no disk: /proc and the like
    needed = (scene.steps // every + 2) * (8 + SAMPLE_BYTES * scene.moving)
    if needed > room:
        raise RecordError(
            f"{where}: no room for the record: there are {room / 1e6:.3g} MB, and its samples "
            f"alone take {needed / 1e6:.3g} MB: {scene.robots:,} robots, time.duration "
            f"{scene.steps * scene.dt:g} s, time.record_every {every}; make the run smaller, or "
            "record less often"
        )


class Recorder:
    """Takes down one run of a `Simulation`, sample by sample, into a `RecordWriter`."""

    def __init__(self, writer: RecordWriter, every: int, tables: Sequence[str] = OPTIONAL) -> None:
        self.writer = writer
        self.every = every
        self.tables = tuple(tables)
        self.size = max(1, min(BLOCK_STEPS, BLOCK_POSES // writer.moving))
        self.steps: list[Step] = []
        self.begun = self.first = self.rejected = 0
        self.unrecorded: tuple[int, FloatArray, FloatArray | None] | None = None
        """the latest sample, its poses and steering (1, N), where that is not recorded"""
        self.taken = 0
        """steps taken down"""
        self.made = time.perf_counter()
        self.latest: FloatArray | None = None
        """(N, columns) latest command of each controller, once others are held: given from outside,
        or from before the record began"""

    def start(self, simulation: Simulation) -> None:
        """Take down the sample at which the simulation is."""
        self.scene = scene = simulation.scene
        self.begun = self.first = simulation.step_number
        self.view: View | None = None
        if self.begun:  # the record has no decision that gave the commands that are held
            self.latest = np.zeros((scene.robots, scene.columns))
        self.since = np.full(scene.robots, -1, dtype=np.int64)
        self.near = ClearanceFinder(scene.shapes, scene.wall_tree, scene.robots)
        self.least = np.full((2, scene.robots), np.inf)
        """[m] least distance of each robot from another, and from a wall, since the last recorded
        sample"""
        # the first sample is a row of its own, so that later windows end on recorded steps
        self._write_false_contacts([simulation.physics.false_contacts])
        contacts = simulation.contacts
        if self.begun:  # what happened in the step that led here is not of this record
            contacts = touching(contacts)
        pose, drive = simulation.now.moving_pose, simulation.now.drive
        self._write_samples(pose[None], simulation.arrived[None], [contacts], drive[None])
        self.last_write = time.monotonic()

    def after_step(self, step: Step) -> None:
        """Take down a step and the sample to which it led."""
        self.steps.append(step)
        self.taken += 1
        count = len(self.steps)
        late = time.monotonic() - self.last_write > BLOCK_SECONDS
        if count == self.size or late:
            self._write()

    def close(self, ended: str) -> None:
        """Write what is left; `finish` closes the record itself."""
        self._write(last=True)

    def finish(self, ended: str, clock: Mapping[str, float] = MappingProxyType({})) -> None:
        """Close the record itself, once nothing more is taken down; ``clock`` are further figures
        of the wall clock."""
        elapsed = time.perf_counter() - self.made
        self.writer.close(
            ended,
            steps_run=self.begun + self.taken,
            rejected=self.rejected,
            wall_clock={
                "seconds": elapsed, "factor": self.taken * self.scene.dt / max(elapsed, 1e-9),
                **clock,
            },
        )  # fmt: skip

    def _write(self, last: bool = False) -> None:
        """Write the block; the samples last, since they are what makes the record flush.

        The last sample of a run is recorded whatever ``every`` says.
        """
        steps, self.steps = self.steps, []
        self._write_decisions([step for step in steps if step.decisions is not None])
        self._write_commands(steps)
        self._write_false_contacts([step.false_contacts for step in steps])
        if steps:
            self._write_samples(
                stacked([step.moving_pose for step in steps]),
                stacked([step.arrived for step in steps]),
                [step.contacts for step in steps],
                stacked([step.drive for step in steps]),
            )
        if last and self.unrecorded is not None:
            step, pose, steering = self.unrecorded
            near, walls = self.least[:, None]
            self.writer.append_steps([step], pose[None], near, walls, steering)
        self.last_write = time.monotonic()

    def _write_commands(self, steps: Sequence[Step]) -> None:
        """Rows of the robots whose stages differ, or that were commanded from outside."""
        told, numbers = [], []
        for step in steps:
            decisions = step.decisions
            if self.latest is not None and decisions is not None:
                self.latest[decisions.robot] = decisions.command
            elif (
                self.latest is None and decisions is None and step.nominal is not step.truth.command
            ):
                self.latest = step.truth.command.copy()
            if self.latest is None and step.applied is step.filtered is step.nominal:
                continue
            latest = step.nominal if self.latest is None else self.latest.copy()
            told += [latest, step.nominal, step.filtered, step.applied]
            numbers.append(step.truth.step)
        if not told:
            return
        stages = stacked(told).reshape(len(numbers), 4, *told[0].shape)
        at, robot = (stages[:, 1:] != stages[:, :-1]).any(axis=(1, 3)).nonzero()
        rows = np.zeros(len(at), dtype=self.writer.types["/commands"])
        rows["step"], rows["robot"] = np.array(numbers)[at], robot
        names = iter((rows.dtype.names or ())[2:])
        for stage in range(1, 4):
            for part in range(told[0].shape[1]):
                rows[next(names)] = stages[at, stage, robot, part]
        self.writer.append("commands", rows)

    def _write_decisions(self, steps: Sequence[Step]) -> None:
        if not steps:
            return
        rows = update_rows(self.scene, steps, self.writer.types["/updates"])
        if "updates" in self.tables:
            self.writer.append("updates", rows)
        if SENSED in self.tables:
            for step, decided in ((step, step.decisions) for step in steps):
                self.view = View(self.scene, step.sensed, self.view)
                if decided is not None:
                    self.writer.append(SENSED, sensed_rows(self.view, decided.robot))
        if "considered" in self.tables:
            counts = np.empty(len(rows), dtype=CONSIDERING)
            counts["step"], counts["robot"] = rows["step"], rows["robot"]
            counts["count"] = rows["considered"]
            others = [d.considered for step in steps if (d := step.decisions) is not None]
            self.writer.append_considered(counts, np.concatenate(others))

    def _write_false_contacts(self, found: Sequence[NDArray[np.void]]) -> None:
        rows = [one for one in found if len(one)]
        self.rejected += sum(map(len, rows))
        if rows and "false_contacts" in self.tables:
            self.writer.append("false_contacts", np.concatenate(rows, dtype=FALSE_CONTACT_ROW))

    def _write_samples(
        self, poses: FloatArray, arrived: NDArray[np.bool_], contacts: Sequence[NDArray[np.void]],
        drive: FloatArray,
    ) -> None:  # fmt: skip
        """Contacts in the order of steps, and every ``every``-th of S samples of all that moves,
        ``poses`` (S, B, 3).

        With these go the least distances since the one before. ``arrived`` (S, N), ``drive``
        (S, N, 4), or (S, 0, 4) in a world without drives.
        """
        steering = drive[:, :, 3] if self.scene.steers else None
        self.since = later_since(self.since, self.first, arrived)
        self.writer.note_arrived(self.since)
        found = self.near.find(poses)
        rows = [one for one in contacts if len(one)]
        if rows and "contacts" in self.tables:
            self.writer.append("contacts", np.concatenate(rows, dtype=CONTACT_ROW))
        step = self.first + np.arange(len(poses))
        self.writer.note_extremes(step, found)
        gaps = np.stack((found.clearance, found.boundary_clearance))
        gaps[:, 0] = np.minimum(gaps[:, 0], self.least)
        ends = np.flatnonzero((step % self.every == 0) | (step == self.begun)) + 1
        if len(ends):
            starts = np.concatenate(([0], ends[:-1]))
            least = np.minimum.reduceat(gaps[:, : ends[-1]], starts, axis=1)
            turned = None if steering is None else steering[ends - 1]
            near, walls = least
            self.writer.append_steps(step[ends - 1], poses[ends - 1], near, walls, turned)
            gaps = gaps[:, ends[-1] :]
        self.least = gaps.min(axis=1, initial=np.inf)
        turned = None if steering is None else steering[-1:]
        self.unrecorded = (int(step[-1]), poses[-1], turned) if gaps.shape[1] else None
        self.first += len(poses)


def stacked(arrays: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Arrays of one shape as one, like `numpy.stack`; of many small ones in a third of the time."""
    return np.concatenate(arrays).reshape(len(arrays), *arrays[0].shape)


def sensed_rows(view: View, robots: IntArray) -> NDArray[np.void]:
    """What each of some robots may know: of itself, of bodies within range, of its neighbours."""
    known = [
        np.unique((view.own_row(i), *view.others(i), *view.neighbours(i))) for i in robots.tolist()
    ]
    at, sensed = np.concatenate(known), view.sensed
    rows = np.empty(len(at), dtype=Layout.sensed.dtype)
    rows["step"], rows["body"] = sensed.step, sensed.robot[at]
    rows["observer"] = np.repeat(robots, [len(one) for one in known])
    rows["x"], rows["y"], rows["heading"] = sensed.pose[at].T
    rows["vx"], rows["vy"], rows["omega"] = sensed.velocity[at].T
    for name in ("age", "reference_station", "heard"):
        rows[name] = getattr(sensed, name)[at]
    return rows


def update_rows(
    scene: Scene, steps: Sequence[Step], row_type: np.dtype[np.void]
) -> NDArray[np.void]:
    """Rows of the update table, in the order of steps."""
    decided = [(step, step.decisions) for step in steps if step.decisions is not None]
    counts = np.array([len(d.robot) for _, d in decided])
    which = np.repeat(np.arange(len(decided)), counts)

    def told(field: str) -> NDArray[Any]:
        return np.concatenate([getattr(d, field) for _, d in decided])

    def truth(field: str) -> NDArray[Any]:
        return stacked([getattr(step.truth, field) for step, _ in decided])

    robot, reference, report = told("robot"), truth("reference_station"), told("report")
    rows = np.empty(len(robot), dtype=row_type)
    rows["step"] = np.array([step.truth.step for step, _ in decided])[which]
    rows["robot"], rows["mode"], rows["rule"] = robot, told("mode"), told("rule")
    applied = stacked([step.applied for step, _ in decided])[which, robot]
    for stage, commands in (("nominal", told("command")), ("applied", applied)):
        for part, values in zip(PARTS, commands.T, strict=False):
            rows[f"{stage}_{part}"] = values
    rows["station"] = truth("station")[which, robot]
    rows["reference_station"] = reference[which, robot]
    rows["deviation"] = truth("deviation")[which, robot]
    rows["formation_error"] = formation_errors(scene, reference)[which, robot]
    between = np.cumsum(counts[:-1] + 1)  # from the last start of a step to the first of the next
    rows["considered"] = np.delete(np.diff(told("considered_start")), between - 1)
    rows["next_step"] = np.concatenate([step.next_step for step, _ in decided])
    names = row_type.names or ()
    for name, values in zip(names[len(names) - report.shape[1] :], report.T, strict=True):
        rows[name] = values
    return rows
