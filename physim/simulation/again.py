"""The run of a record set up anew: from its start, or as it was at any step.

What makes a simulation is imported where one is made: reading and judging records needs none.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from physim.errors import PhysimError, RecordError
from physim.record import Record

if TYPE_CHECKING:
    from physim.parts.controller import Controller
    from physim.parts.stages import Disturbance, Filter, SensingStage
    from physim.simulation.loop import Simulation


class AgainError(PhysimError):
    """A run cannot be simulated again; ``why`` says why not."""

    def __init__(self, record: Record, why: str) -> None:
        self.why = why
        super().__init__(f"{record.where}: cannot be simulated again: {why}")


def simulation_again(
    record: Record,
    *,
    controller: Controller | None = None,
    sensing: Sequence[SensingStage] = (),
    filters: Sequence[Filter] = (),
    disturbances: Sequence[Disturbance] = (),
    disturbed: bool = True,
) -> Simulation:
    """Set up the run of a record anew, from the world inside and the state where it went on.

    Unless it is to be ``disturbed``, without sensing stages and disturbances. No code is run
    because a record names it: parts that were given from Python, and a controller
    ``module:Class``, have to be given again. Raises AgainError where one is missing, and where the
    run made no step.
    """
    from physim.simulation.kept_states import state_at
    from physim.simulation.loop import Simulation

    if record.judged is not None:
        raise AgainError(
            record, f"its poses are of a log, {record.judged.source}; no run made them"
        )
    if record.noted_until <= record.begun_at:
        raise AgainError(record, "it made no step")
    try:
        world, name = record.world, record.controller_name
    except RecordError as error:
        raise AgainError(record, str(error).splitlines()[0]) from error
    if controller is None and (record.controller or ":" in name):
        raise AgainError(
            record,
            f"its controller is the class {name}; no code is run because a record names it: if you "
            f"trust the class, give --controller {name}",
        )
    given: dict[str, Sequence[Any]] = {"filter": filters}
    if disturbed or record.begun_at:  # its state is of a run with all parts
        given = {"sensing stage": sensing, **given, "disturbance": disturbances}
    for kind, parts in given.items():
        names = [name for word, name in record.given if word == kind]
        if len(names) != len(parts):
            raise AgainError(
                record,
                f"its {kind} {', '.join(names) or 'none'} came from Python; give it again there: "
                "rerun(record, sensing=..., filters=..., disturbances=...) of "
                "physim.analysis.validation.rerun",
            )
    try:
        state = state_at(record, record.begun) if record.begun_at else None
        without: dict[str, Any] = {"sensing": {"stages": ()}, "disturbances": ()}
        if not disturbed and state is None:
            world = world.changed(**without)
        simulation = Simulation(
            world, controller=controller, sensing=sensing, filters=filters,
            disturbances=disturbances, state=state,
        )  # fmt: skip
        return simulation if disturbed or state is None else simulation.branch(**without)
    except PhysimError as error:
        raise AgainError(record, str(error).splitlines()[0]) from error


def simulation_at(
    record: Record,
    step: int,
    *,
    stop: Callable[[], bool] = lambda: False,
    progress: Callable[[Simulation, float], None] | None = None,
    **parts: Any,
) -> Simulation:
    """The simulation of a record as it was at a step of its run, ``parts`` as `simulation_again`.

    It is simulated from the last state before that the record kept, or else from its start, and
    held against the last sample that was recorded up to the step. Raises AgainError where it cannot
    be, or is not the same to the bit there; and when ``stop`` says True, it stands at an earlier
    step.
    """
    from physim.simulation.kept_states import state_at

    simulation = simulation_again(record, **parts)
    seen = int(record.steps[np.searchsorted(record.steps, step, side="right") - 1])
    if len(kept := record.states["step"][record.states["step"] <= seen]):
        simulation.restore(state_at(record, int(kept[-1]) * record.dt))
    started, first = time.perf_counter(), simulation.step_number
    for target in (seen, step):
        while simulation.step_number < target and not stop():
            simulation.step()
            if progress is not None:
                made = (simulation.step_number - first) * record.dt
                progress(simulation, made / (time.perf_counter() - started))
        if target == seen == simulation.step_number:
            differing = (simulation.now.moving_pose != record.pose_at(seen)).any(axis=1)
            if differing.any():
                body, by = record.bodies[int(differing.argmax())], record.setup.made_with
                raise AgainError(
                    record,
                    f"{body.name} is not where it was at {seen * record.dt:g} s; the run was made "
                    f"with {by}; make the record again",
                )
    return simulation
