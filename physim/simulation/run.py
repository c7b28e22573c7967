"""Run a world to its end and record it: `simulate`.

`warm_up` compiles or loads every kernel that a run needs, so that no run waits in its middle.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from types import SimpleNamespace
from typing import cast

import numpy as np

from physim.compiled import is_cached
from physim.errors import ControllerError, PhysimError, RecordError
from physim.geometry.clearance import clearances
from physim.geometry.path import Tracking
from physim.geometry.shapes import read_only
from physim.geometry.swept_contacts import find_swept_contacts
from physim.parts.controller import Controller
from physim.parts.declarations import kept_distance
from physim.parts.stages import Disturbance, Filter, Observer, SensingStage
from physim.parts.user_code import folder_kept, naming
from physim.record import Record, RecordWriter
from physim.simulation.engine import Physics
from physim.simulation.kept_states import packed
from physim.simulation.loop import LOOK_ON, Simulation
from physim.simulation.parts import listed
from physim.simulation.recorder import Recorder, SaveAt, check_room
from physim.simulation.state import SimulationState
from physim.simulation.swept_contacts import SweptContactFinder
from physim.world import World
from physim.world.scene import Scene

EVERYTHING = SaveAt()


def simulate(
    world: World,
    *,
    seed: int | None = None,
    controller: Controller | str | None = None,
    sensing: Sequence[SensingStage] = (),
    filters: Sequence[Filter] = (),
    disturbances: Sequence[Disturbance] = (),
    state: SimulationState | None = None,
    observers: Sequence[Observer] = (),
    save: SaveAt = EVERYTHING,
    path: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    progress: Callable[[Simulation, float], None] | None = None,
    stop: Callable[[], bool] | None = None,
) -> Record:
    """Run a world until every robot has arrived or its duration is over, and record it.

    The record goes to the file ``path``, which must not exist unless ``overwrite`` is set, or
    stays in memory; ``save`` says what is recorded. Stages, controller and ``state``, from which a
    run goes on, are as for `Simulation`; ``observers`` look on. ``progress`` is called after every
    step with the simulation and the real-time factor; when ``stop`` says True the run ends there,
    with a complete record. Raises WorldError or ControllerError, and RecordError where the record
    cannot fit on the disk or in memory; a run that breaks off leaves its record closed, ended
    "error".
    """
    simulation = Simulation(
        world, seed, controller, sensing=sensing, filters=filters, disturbances=disturbances,
        state=state,
    )  # fmt: skip
    return record_run(
        simulation, observers=observers, save=save, path=path, overwrite=overwrite,
        progress=progress, stop=stop,
    )  # fmt: skip


def record_run(
    simulation: Simulation,
    *,
    observers: Sequence[Observer] = (),
    save: SaveAt = EVERYTHING,
    path: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    progress: Callable[[Simulation, float], None] | None = None,
    stop: Callable[[], bool] | None = None,
) -> Record:
    """Run a simulation from where it is to its end and record it; see `simulate`.

    A record that begins later than at step 0 keeps the state from which it went on, so that it can
    be simulated again; not where a part remembers what no record can keep. Raises TypeError where
    ``save`` is something else, and RecordError where its record cannot fit on the disk or in
    memory.
    """
    begun = simulation.step_number
    if not isinstance(save, SaveAt):
        raise TypeError(f"save: takes physim.SaveAt(every=..., tables=...), not {save!r}")
    if path is not None and os.path.lexists(path) and not overwrite:
        raise RecordError(f"{path}: exists; give another path, or overwrite=True")
    others = listed("observers", observers)
    scene, every = simulation.scene, save.every or simulation.scene.world.time.record_every
    check_room(scene, every, path)
    area, distance = scene.area, kept_distance(simulation.parts.controller)
    given = simulation.parts.given
    writer = RecordWriter(
        path, scene, scene.world.to_yaml(), accessible=area.accessible_rings,
        safe=area.safe_rings(distance), safe_distance=distance, record_every=every,
        declared=simulation.declared, tables=save.tables,
        given=tuple((part.kind.word, part.name) for part in given),
        given_settings=tuple(part.settings for part in given), begun_at=begun,
        begun_along=np.stack(simulation.now[4:], axis=1) if begun else None, overwrite=overwrite,
    )  # fmt: skip
    if begun:
        with suppress(PhysimError):
            writer.keep_state(begun, packed(simulation.state))
    recorder = Recorder(writer, every, save.tables)
    started, ended, late = time.perf_counter(), "error", None
    try:
        for observer in (recorder, *others):
            simulation.look_on(observer)
        with folder_kept():
            ended = _loop(simulation, recorder, save.states, progress, stop)
            recorder.close(ended)
            late = _close(simulation, ended)
    finally:
        if ended == "error":
            _close(simulation, ended)  # the error that ended the run is the one to report
            recorder.close(ended)
        simulation.observers = []
        elapsed = time.perf_counter() - started
        writer.close(
            ended,
            steps_run=begun + recorder.taken,
            rejected=recorder.rejected,
            wall_clock={
                "seconds": elapsed, "factor": recorder.taken * scene.dt / max(elapsed, 1e-9)
            },
        )  # fmt: skip
    if late is not None:
        raise LateError(str(late), writer.record()) from late
    return writer.record()


class LateError(ControllerError):
    """An observer failed after the last step, in ``close``: the run and its record are whole."""

    def __init__(self, message: str, record: Record) -> None:
        self.record = record
        super().__init__(message)


def _close(simulation: Simulation, ended: str) -> ControllerError | None:
    """Close every observer but the recorder, whatever becomes of the others; the first error."""
    late: ControllerError | None = None
    observers, simulation.observers = simulation.observers, []
    for observer in observers:
        if isinstance(observer, Recorder):
            continue
        where = f"observer {type(observer).__name__} at {simulation.time:g} s"
        try:
            with naming(where, observer.close):
                now = simulation.now
                observer.close(ended)
                if simulation.now is not now:
                    raise ControllerError(f"it moved the simulation in close; {LOOK_ON}")
        except ControllerError as error:
            late = late or error
    return late


def _loop(
    simulation: Simulation,
    recorder: Recorder,
    states: float | None,
    progress: Callable[[Simulation, float], None] | None,
    stop: Callable[[], bool] | None,
) -> str:
    """Step to the end, keeping ``states`` so often [s]; says how it ended.

    Raises ControllerError for a step not taken down.
    """
    started, step, begun = time.perf_counter(), simulation.scene.dt, simulation.step_number
    apart = 0 if states is None else max(1, round(states / step))
    while simulation.step_number < simulation.scene.steps:
        simulation.step()
        if begun + recorder.taken != simulation.step_number:
            after = (begun + recorder.taken) * simulation.scene.dt
            raise ControllerError(
                f"an observer moved the simulation after {after:g} s, or let the recorder go (by "
                f"restore, reset or observers); {LOOK_ON}"
            )
        if apart and simulation.step_number % apart == 0:
            recorder.writer.keep_state(simulation.step_number, packed(simulation.state))
        if progress is not None:
            progress(simulation, recorder.taken * step / (time.perf_counter() - started))
        if simulation.finished:
            return "finished"
        if stop is not None and stop():
            return "interrupted"
    return "duration"


def is_warm() -> bool:
    """Whether the kernels of a run lie compiled on disk.

    `warm_up` compiles the swept contacts last: when they are there, so is the rest.
    """
    return is_cached(find_swept_contacts)


class Unmoved(Simulation):
    """A simulation without an engine, which has to be compiled before it can be made."""

    def _host(self) -> None:
        self.physics = cast(Physics, SimpleNamespace(pose=self.scene.start.copy()))


def warm_up_motion(scene: Scene, controller: Controller | None = None) -> None:
    """Compile or load what a run and its summary need beside decisions and swept contacts."""
    simulation = Simulation(scene, controller=controller)
    simulation.step(np.zeros((scene.robots, 2)))
    start = scene.start.copy()
    start[0, :2] = scene.walls.vertices[0]  # what only a contact needs
    Physics(scene.shapes, scene.walls, start, scene.mass, scene.dt)
    clearances(simulation.pose[None], scene.shapes, scene.wall_tree)
    # its record is followed in one go
    tracking = Tracking(scene.paths, scene.reference, scene.shapes.radius, read_only(scene.start))
    tracking.course(read_only(simulation.pose[None]))


def warm_up(
    scene: Scene,
    controller: Controller | None = None,
    wait: Callable[[], object] = lambda: None,
) -> float:
    """Compile or load all that a run needs; returns the seconds it took.

    ``controller`` should be one of its own, since it is asked once. ``wait`` is called when what it
    needs is there: another process may compile the rest meanwhile.
    """
    from physim.frontend import without_collector

    started = time.perf_counter()
    with folder_kept(), without_collector():
        Unmoved(scene, controller=controller)._decide()
        wait()
        warm_up_motion(scene, controller)
        SweptContactFinder(scene).search(scene.start, scene.start)  # nobody moves
    return time.perf_counter() - started
