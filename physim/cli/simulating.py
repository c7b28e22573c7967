"""Simulations on the command line: kernels loaded or compiled, a progress bar, Ctrl-C."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

from physim.cli.options import Changes
from physim.cli.progress import Bar, announce_compiling, interrupts
from physim.cli.warming import second_process
from physim.errors import PhysimError, WorldError, plain_key
from physim.parts.controller import Controller
from physim.parts.declarations import Declared
from physim.parts.registry import CONTROLLER, make_part
from physim.record import Record
from physim.simulation.loop import Simulation
from physim.simulation.recorder import check_room
from physim.simulation.run import is_warm, record_run, warm_up
from physim.world import World
from physim.world.checks.starts import check_walled_off
from physim.world.file import Document, read_world
from physim.world.file.loading import unused_settings
from physim.world.layout.scene_builder import build_scene

EVERY_STEP = "time.record_every"


def ready(
    world: World,
    document: Document,
    changes: Changes,
    quiet: bool,
    path: Path | None = None,
) -> Simulation:
    """Simulation of a world that was read, with the kernels loaded or compiled.

    A run too large for the disk of ``path``, or, where that is None, for memory, is refused before
    anything is compiled. A robot that counts from the start as beyond a wall is told of: it might
    be said to have arrived.
    """
    try:
        scene = build_scene(world, changes.seed)
    except WorldError as error:
        raise document.error(error.faults) from None
    tell(document.lines(check_walled_off(scene.layout)))

    def controller() -> Controller:
        choice, trusted = world.controller, changes.controller is not None
        made: Controller = make_part(CONTROLLER, choice.type, choice.settings, trusted=trusted)
        return made

    Declared.of(controller())  # refuses what cannot be
    check_room(scene, world.time.record_every, path)
    if is_warm():
        warm_up(scene, controller())
    else:
        announce_compiling("controller and distances", quiet)
        second = second_process(world.controller.type)
        wait = () if second is None else (second.wait,)
        seconds = warm_up(scene, controller(), *wait)
        if not quiet:
            text = f"compiled in {seconds:.0f} s and kept for later runs"
            print(text, file=sys.stderr, flush=True)
    return Simulation(scene, controller=controller())


def world_given(given: str, changes: Changes) -> tuple[World, Document]:
    """World that is given to a command with its changes; every step of its run is a sample.

    What is to be noted of it is told. Raises PhysimError where another spacing is asked for.
    """
    if any(plain_key(one) == EVERY_STEP for one in changes.set):
        raise PhysimError(f"--set {EVERY_STEP}: a validation looks at every step")
    every = (*changes.set, f"{EVERY_STEP}=1")
    world, document = read_world(given, overrides=every, controller=changes.controller)
    tell(document.lines(document.warnings))
    return world, document


def tell(lines: Iterable[str]) -> None:
    """Say what is to be noted, a line each, even to those who want quiet.

    The run may not be the one that they expect.
    """
    for line in lines:
        print(f"WARNING  {line}", file=sys.stderr, flush=True)


def run_of_record(
    record: Record, controller: str | None, quiet: bool, needed: bool
) -> Record | str:
    """Simulate the run of a record again, as far as it goes; Ctrl-C raises KeyboardInterrupt.

    Where it cannot be it gives the reason, or raises PhysimError where it is ``needed``.
    """
    from physim.analysis.validation.rerun import AgainError, run_again, simulation_again

    name = f"{record.name}, seed {record.seed}"
    bar = Bar(name, record.steps_run * record.dt, "s", quiet)
    try:
        simulation = simulation_again(record, controller=_controller(record, controller))
        if not is_warm():
            announce_compiling("controller and distances", quiet)
        with interrupts() as interrupt, bar:
            again = run_again(record, simulation, stop=interrupt, progress=bar.simulated)
    except AgainError as error:
        if needed:
            raise
        return error.why
    if interrupt():
        again.close()
        raise KeyboardInterrupt
    return again


def _controller(record: Record, named: str | None) -> Controller | None:
    """The controller that the command line names; its settings are those inside the record where
    that names the same. That those of another are left out is told."""
    if named is None:
        return None
    own = record.world.controller
    settings = own.settings if named == own.type else {}
    if left := [key for key in own.settings if key not in settings]:
        tell([f"world of {record.path}: controller: {unused_settings(left, own.type, named)}"])
    made: Controller = make_part(CONTROLLER, named, settings, trusted=True)
    return made


def run_world(world: World, document: Document, changes: Changes, quiet: bool) -> Record:
    """Run to the end, in memory.

    Ctrl-C raises KeyboardInterrupt, after the step that is under way: in the middle of it the
    engine would swallow it.
    """
    simulation = ready(world, document, changes, quiet)
    scene = simulation.scene
    name = f"{scene.world.name}, seed {scene.seed}"
    with interrupts() as interrupt, Bar(name, scene.steps * scene.dt, "s", quiet) as bar:
        record = record_run(simulation, stop=interrupt, progress=bar.simulated)
    if interrupt():
        record.close()
        raise KeyboardInterrupt
    return record
