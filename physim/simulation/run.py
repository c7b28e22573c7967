"""Run a world to its end and record it: `simulate`."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Literal

import numpy as np

from physim.errors import ControllerError, PhysimError, RecordError
from physim.parts.controller import Controller
from physim.parts.declarations import kept_distance
from physim.parts.stages import Disturbance, Filter, Observer, SensingStage
from physim.parts.user_code import folder_kept, naming
from physim.record import NO_ORIGIN, Origin, Record, RecordWriter
from physim.record.layout import SENSED
from physim.simulation.kept_states import packed
from physim.simulation.loop import LOOK_ON, Simulation
from physim.simulation.parts import listed
from physim.simulation.recorder import (
    FEWEST_STEPS,
    STATE_WORK,
    STEP_WORK,
    Recorder,
    SaveAt,
    check_room,
)
from physim.simulation.state import SimulationState
from physim.world import World

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
    origin: Origin = NO_ORIGIN,
) -> Record:
    """Run a simulation from where it is to its end and record it; see `simulate`.

    A record that begins later than at step 0 keeps the state from which it went on, so that it can
    be simulated again; not where a part remembers what no record can keep. ``origin`` says of which
    record it is a branch. Raises TypeError where ``save`` is something else, and RecordError where
    its record cannot fit on the disk or in memory.
    """
    others = listed("observers", observers)
    recorder = recording(simulation, save=save, path=path, overwrite=overwrite, origin=origin)
    ended, late = "error", None
    times = simulation.decision_times = []
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
        simulation.observers, simulation.decision_times = [], None
        clock = {}
        if times:
            clock = {"decision_median": np.median(times), "decision_99": np.quantile(times, 0.99)}
        recorder.finish(ended, clock)
    record = recorder.writer.record()
    if late is not None:
        raise LateError(str(late), record) from late
    return record


def recording(
    simulation: Simulation,
    *,
    save: SaveAt = EVERYTHING,
    path: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    origin: Origin = NO_ORIGIN,
) -> Recorder:
    """Recorder of what a simulation does from now on, once it looks on; see `record_run`."""
    begun = simulation.step_number
    if not isinstance(save, SaveAt):
        raise TypeError(f"save: takes physim.SaveAt(every=..., tables=...), not {save!r}")
    if path is not None and os.path.lexists(path) and not overwrite:
        raise RecordError(f"{path}: exists; give another path, or overwrite=True")
    scene, every = simulation.scene, save.every or simulation.scene.world.time.record_every
    tables = (*save.tables, SENSED) if save.sensed else tuple(save.tables)
    check_room(scene, every, path)
    area, distance = scene.area, kept_distance(simulation.parts.controller)
    given = simulation.parts.given
    writer = RecordWriter(
        path, scene, scene.world.to_yaml(), accessible=area.accessible_rings,
        safe=area.safe_rings(distance), safe_distance=distance, record_every=every,
        declared=simulation.declared, tables=tables,
        given=tuple((part.kind.word, part.name) for part in given),
        given_settings=tuple(part.settings for part in given), begun_at=begun,
        begun_along=np.stack(simulation.now[4:7], axis=1) if begun else None, origin=origin,
        overwrite=overwrite,
    )  # fmt: skip
    if begun:
        with suppress(PhysimError):
            writer.keep_state(begun, packed(simulation.state))
    return Recorder(writer, every, tables)


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
    states: float | Literal["usual"] | None,
    progress: Callable[[Simulation, float], None] | None,
    stop: Callable[[], bool] | None,
) -> str:
    """Step to the end, keeping ``states`` as `SaveAt` says; says how it ended.

    Raises ControllerError for a step not taken down.
    """
    started, step, begun = time.perf_counter(), simulation.scene.dt, simulation.step_number
    apart = 0
    if states is not None:
        usual = max(FEWEST_STEPS, STATE_WORK // (simulation.scene.robots + STEP_WORK))
        apart = usual if states == "usual" else max(1, round(states / step))
    while simulation.step_number < simulation.scene.steps:
        simulation.step()
        if begun + recorder.taken != simulation.step_number:
            after = (begun + recorder.taken) * simulation.scene.dt
            raise ControllerError(
                f"an observer moved the simulation after {after:g} s, or let the recorder go (by "
                f"restore, reset or observers); {LOOK_ON}"
            )
        if apart and simulation.step_number % apart == 0:
            try:
                state = packed(simulation.state)
            except PhysimError:
                if states != "usual":
                    raise
                apart = 0
            else:
                recorder.writer.keep_state(simulation.step_number, state)
        if progress is not None:
            progress(simulation, recorder.taken * step / (time.perf_counter() - started))
        if simulation.finished:
            return "finished"
        if stop is not None and stop():
            return "interrupted"
    return "duration"
