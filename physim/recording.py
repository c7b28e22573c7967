"""Run a world to its end and record it: `simulate`.

Poses are gathered in blocks; at the end of a block the clearances of all its samples are worked
out in one call and everything goes to the record, so memory stays flat however long the run.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.contacts import CONTACT, FALSE_CONTACT
from physim.control import Controller
from physim.errors import RecordError
from physim.geometry.clearance import Clearances, clearances
from physim.geometry.shapes import FloatArray
from physim.grazes import GrazeFinder
from physim.record import Record, RecordWriter
from physim.record.layout import UPDATE
from physim.simulation import Filter, Simulation, Update
from physim.world import World

BLOCK_STEPS = 256
"""Samples gathered before they are worked on; less when the wall clock is first."""
BLOCK_SECONDS = 0.3
"""[s] of computing after which a block goes to the record, however short."""


class Recorder:
    """Takes down one run of a `Simulation`, sample by sample, into a `RecordWriter`."""

    def __init__(self, simulation: Simulation, writer: RecordWriter) -> None:
        scene = simulation.scene
        self.simulation = simulation
        self.writer = writer
        self.every = scene.world.time.record_every
        size = max(self.every, BLOCK_STEPS - BLOCK_STEPS % self.every)
        self.poses = np.empty((size, scene.robots, 3))
        self.count = 0
        self.first = 0
        self.updates: list[Update] = []
        self.contacts = [simulation.contacts]
        self.grazes = GrazeFinder(scene)
        self.false_contacts = [simulation.physics.false_contacts]
        self.rejected = 0
        self.since = time.monotonic()
        self._take_pose()
        self._write()  # sample 0 is a row of its own, so that later windows end on recorded steps

    def after_step(self) -> None:
        """Take down the present sample and the decisions that led to it."""
        self._take_pose()
        if self.simulation.update is not None:
            self.updates.append(self.simulation.update)
        if len(self.simulation.contacts):
            self.contacts.append(self.simulation.contacts)
        if len(self.simulation.physics.false_contacts):
            self.false_contacts.append(self.simulation.physics.false_contacts)
        full = self.count == len(self.poses)
        if full or (time.monotonic() - self.since > BLOCK_SECONDS and self.count % self.every == 0):
            self._write()

    def close(self, ended: str, wall_clock: dict[str, float]) -> None:
        """Write what is left and close the record."""
        self._write()
        self.writer.close(
            ended,
            steps_run=self.simulation.step_number,
            rejected=self.rejected,
            wall_clock=wall_clock,
        )

    def _take_pose(self) -> None:
        self.poses[self.count] = self.simulation.pose
        self.count += 1

    def _write(self) -> None:
        """Write the block; the samples last, since they are what makes the record flush."""
        if self.updates:
            self.writer.append_updates(update_rows(self.updates))
            self.updates = []
        if self.false_contacts:
            rows = np.concatenate(self.false_contacts, dtype=FALSE_CONTACT)
            self.writer.append_false_contacts(rows)
            self.rejected += len(rows)
            self.false_contacts = []
        if self.count:
            scene, poses = self.simulation.scene, self.poses[: self.count]
            found = clearances(poses, scene.shapes, scene.walls, scene.nearby)
            self.contacts.append(self.grazes.rows(self.first, poses, found))
            self._write_contacts()
            self._write_poses(poses, found)
        self.first += self.count
        self.count = 0
        self.since = time.monotonic()

    def _write_contacts(self) -> None:
        """Contacts at samples and between them, in the order of steps."""
        rows = np.concatenate(self.contacts, dtype=CONTACT)
        if len(rows):
            self.writer.append_contacts(rows[np.argsort(rows["step"], kind="stable")])
        self.contacts = []

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


def update_rows(updates: Sequence[Update]) -> NDArray[np.void]:
    """Rows of the update table, in the order of steps."""
    rows = np.zeros(sum(len(u.decisions.robot) for u in updates), dtype=UPDATE)
    rows["step"] = np.repeat(
        [u.snapshot.step for u in updates], [len(u.decisions.robot) for u in updates]
    )

    def column(values: Sequence[NDArray[Any]]) -> NDArray[Any]:
        return np.concatenate(values)

    rows["robot"] = column([u.decisions.robot for u in updates])
    rows["mode"] = column([u.decisions.mode for u in updates])
    wanted = column([u.decisions.command for u in updates])
    rows["wanted_v"], rows["wanted_omega"] = wanted.T
    given = column([u.given for u in updates])
    rows["given_v"], rows["given_omega"] = given.T
    rows["station"] = column([u.snapshot.station for u in updates])
    rows["reference_station"] = column([u.snapshot.reference_station for u in updates])
    rows["formation_error"] = column([u.formation_error for u in updates])
    rows["deviation"] = column([u.deviation for u in updates])
    rows["next_step"] = column([u.next_step for u in updates])
    report = column([u.decisions.report for u in updates]).T
    rows["target_x"], rows["target_y"], rows["distance"] = report[:3]
    rows["boundary_distance"], rows["collision_time"] = report[3:5]
    rows["considered"], rows["evaluations"] = report[5:]
    return rows


def simulate(
    world: World,
    *,
    seed: int | None = None,
    controller: Controller | str | None = None,
    filters: Sequence[Filter] = (),
    path: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    progress: Callable[[Simulation, float], None] | None = None,
    stop: Callable[[], bool] | None = None,
) -> Record:
    """Run a world until every robot has arrived or its duration is over, and record it.

    The record goes to the file ``path``, which must not exist unless ``overwrite`` is set, or
    stays in memory. ``progress`` is called after every
    step with the simulation and the real-time factor; when ``stop`` says True the run ends
    there, with a complete record. Raises WorldError or ControllerError; a run that breaks off
    leaves its record closed, ended "error".
    """
    simulation = Simulation(world, seed, controller, filters)
    return record_run(simulation, path=path, overwrite=overwrite, progress=progress, stop=stop)


def record_run(
    simulation: Simulation,
    *,
    path: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    progress: Callable[[Simulation, float], None] | None = None,
    stop: Callable[[], bool] | None = None,
) -> Record:
    """Run a simulation from its start to its end and record it; see `simulate`.

    Raises ValueError for one that has made steps already: its record would lack them.
    """
    if simulation.step_number:
        raise ValueError(
            f"the simulation is at step {simulation.step_number}; a record begins at step 0"
        )
    if path is not None and os.path.lexists(path) and not overwrite:
        raise RecordError(f"{path}: exists; give another path, or overwrite=True")
    scene = simulation.scene
    area, distance = scene.area, _safe_distance(simulation)
    writer = RecordWriter(
        path, scene, scene.world.to_yaml(), accessible=area.accessible_rings,
        safe=area.safe_rings(distance), safe_distance=distance,
    )  # fmt: skip
    if simulation.filters:
        writer.note_filters()
    if simulation.given:
        writer.note_controller(simulation.given)
    started = time.perf_counter()
    recorder = Recorder(simulation, writer)
    ended = "error"
    try:
        ended = _loop(simulation, recorder, progress, stop)
    finally:
        elapsed = time.perf_counter() - started
        recorder.close(ended, {"seconds": elapsed, "factor": simulation.time / max(elapsed, 1e-9)})
    return writer.record()


def _loop(
    simulation: Simulation,
    recorder: Recorder,
    progress: Callable[[Simulation, float], None] | None,
    stop: Callable[[], bool] | None,
) -> str:
    """Step to the end; says how it ended."""
    started = time.perf_counter()
    while simulation.step_number < simulation.scene.steps:
        simulation.step()
        recorder.after_step()
        if progress is not None:
            progress(simulation, simulation.time / (time.perf_counter() - started))
        if simulation.update is not None and simulation.finished:
            return "finished"
        if stop is not None and stop():
            return "interrupted"
    return "duration"


def _safe_distance(simulation: Simulation) -> float:
    """L of the controller, for the pictures; 0 where it has none."""
    settings = getattr(simulation.controller, "settings", None)
    return float(getattr(settings, "safe_distance", 0.0))


__all__ = ["Recorder", "record_run", "simulate", "update_rows"]
