"""Run a world, or the world inside a record, for its validation: in memory, every step."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from physim.cli.compiling import tell_compiling
from physim.cli.progress import Bar, interrupts
from physim.cli.run import COMPILING, ready
from physim.control import Controller
from physim.errors import PhysimError, RecordError
from physim.record import Record
from physim.recording import record_run
from physim.registry import CONTROLLER, make_part
from physim.validation.rerun import run_again, simulation_again
from physim.warm_up import is_warm
from physim.world import World
from physim.world_file import read_world
from physim.world_file.loading import world_of
from physim.world_file.nodes import Document
from physim.world_file.reading import read_document

EVERY_STEP = "time.record_every=1"


def world_given(options: argparse.Namespace, given: str) -> tuple[World, Document]:
    """World of a file or a shipped one, with the changes of the command line."""
    overrides = [*options.overrides, EVERY_STEP]
    return read_world(given, overrides=overrides, controller=options.controller)


def world_inside(options: argparse.Namespace, record: Record) -> tuple[World, Document]:
    """World that a record holds, to be run with other seeds.

    A class of one's own is code: it is imported only when named again by --controller. Other parts
    from Python cannot be had here.
    """
    document = read_document(record.world_text, f"world of {record.path}")
    for kind, name in record.given:
        if kind != CONTROLLER.word:
            raise PhysimError(
                f"{record.path}: its {kind} {name} came from Python, which --seeds cannot give"
            )
    name = record.controller or str(record.world.controller.type)
    if options.controller is None and (record.controller or ":" in name):
        raise PhysimError(
            f"{record.path}: has to be simulated again, and its controller is the class {name}; "
            "no code is run because a record names it: if you trust the class, give "
            f"--controller {name}"
        )
    overrides = [*options.overrides, EVERY_STEP]
    return world_of(document, overrides=overrides, controller=options.controller)


def run_of_record(record: Record, options: argparse.Namespace) -> Record:
    """Simulate the run of a record again, as far as it goes; Ctrl-C raises KeyboardInterrupt."""
    simulation = simulation_again(record, controller=_controller(record, options.controller))
    if not is_warm():
        tell_compiling("controller and distances", COMPILING, options.quiet)
    name = f"{record.name}, seed {record.seed}"
    bar = Bar(name, record.steps_run * record.dt, "s", options.quiet)
    with interrupts() as interrupt:
        try:
            again = run_again(
                record, simulation, stop=interrupt,
                progress=lambda now, factor: bar.update(now.time, f"{factor:.0f} x real time"),
            )  # fmt: skip
        finally:
            bar.close()
    if interrupt():
        again.close()
        raise KeyboardInterrupt
    return again


def _controller(record: Record, named: str | None) -> Controller | None:
    """The controller that the command line names; its settings are those inside the record where
    that names the same."""
    if named is None:
        return None
    own = record.world.controller
    settings = own.settings if named == own.type else {}
    made: Controller = make_part(CONTROLLER, named, settings, trusted=True)
    return made


def run_world(
    world: World,
    document: Document,
    seed: int | None,
    options: argparse.Namespace,
    stop: Callable[[], bool] | None = None,
) -> Record:
    """Run to the end, or until ``stop`` says so, in memory.

    Without ``stop`` Ctrl-C raises KeyboardInterrupt, after the step that is under way: in the
    middle of it the engine would swallow it.
    """
    if stop is None:
        with interrupts() as interrupt:
            record = run_world(world, document, seed, options, interrupt)
        if interrupt():
            record.close()
            raise KeyboardInterrupt
        return record
    simulation = ready(world, document, seed, options)
    scene = simulation.scene
    bar = Bar(
        f"{scene.world.name}, seed {scene.seed}", scene.steps * scene.dt, "s", options.quiet
    )  # fmt: skip
    try:
        return record_run(
            simulation,
            stop=stop,
            progress=lambda now, factor: bar.update(now.time, f"{factor:.0f} x real time"),
        )
    finally:
        bar.close()


def check_origin(record: Record, world: World, where: str | Path) -> None:
    """Raise RecordError unless a record was made from ``world``, whatever its seed and coarseness.

    Names the first key that differs.
    """
    import yaml

    try:
        theirs = yaml.safe_load(record.world_text)
    except yaml.YAMLError as error:
        told = " ".join(str(error).split())
        raise RecordError(f"{record.path}: the world inside cannot be read: {told}") from error
    ours = yaml.safe_load(world.to_yaml())
    for tree in (theirs, ours):
        if isinstance(tree, dict):
            tree.pop("seed", None)
            if isinstance(tree.get("time"), dict):
                tree["time"].pop("record_every", None)
    found = difference(theirs, ours, "")
    if found is not None:
        key, inside, given = found
        raise RecordError(
            f"{record.path}: not made from {where}: {key} is {_shown(inside)} in the record, "
            f"{_shown(given)} in the world (--set and --controller take the changes of a run)"
        )


def difference(a: object, b: object, key: str) -> tuple[str, object, object] | None:
    """First place at which two trees of plain values differ: key, value in a, value in b."""
    if isinstance(a, dict) and isinstance(b, dict):
        for name in [*a, *(n for n in b if n not in a)]:
            where = f"{key}.{name}" if key else str(name)
            found = difference(a.get(name), b.get(name), where)
            if found is not None:
                return found
        return None
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for k, (one, other) in enumerate(zip(a, b, strict=True)):
            found = difference(one, other, f"{key}[{k}]")
            if found is not None:
                return found
        return None
    return None if a == b else (key, a, b)


def _shown(value: object) -> str:
    if isinstance(value, list):
        return f"a list of {len(value)}"
    text = "absent" if value is None else str(value)
    return text if len(text) <= 60 else text[:57] + "..."
