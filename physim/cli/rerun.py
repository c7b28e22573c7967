"""Run a world for its validation: in memory, with the poses of every step."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np

from physim.cli.progress import Bar, interrupts
from physim.cli.run import ready
from physim.errors import PhysimError, RecordError
from physim.record import Record
from physim.recording import record_run
from physim.world import World
from physim.world_file import read_world
from physim.world_file.loading import world_of
from physim.world_file.nodes import Document
from physim.world_file.reading import read_document

EVERY_STEP = "time.record_every=1"

SAME = 1e-9
"""[m, rad] Samples of a run that was simulated again must agree to this."""


def world_given(options: argparse.Namespace, given: str) -> tuple[World, Document]:
    """World of a file or a shipped one, with the changes of the command line."""
    overrides = [*options.overrides, EVERY_STEP]
    return read_world(given, overrides=overrides, controller=options.controller)


def world_inside(options: argparse.Namespace, record: Record) -> tuple[World, Document]:
    """World that a record holds.

    A class of one's own is code: it is imported only when named again by --controller.
    """
    document = read_document(record.world_text, f"world of {record.path}")
    if options.controller is None and ":" in (name := str(record.world.controller.type)):
        raise PhysimError(
            f"{record.path}: has to be simulated again, and its controller is the class {name}; "
            "no code is run because a record names it: if you trust the class, give "
            f"--controller {name}"
        )
    overrides = [*options.overrides, EVERY_STEP]
    return world_of(document, overrides=overrides, controller=options.controller)


def run_again(
    world: World,
    document: Document,
    seed: int | None,
    options: argparse.Namespace,
    stop: Callable[[], bool] | None = None,
    last: int | None = None,
) -> Record:
    """Run to the end, to step ``last``, or until ``stop`` says so, in memory.

    Without ``stop`` Ctrl-C raises KeyboardInterrupt, after the step that is under way: in the
    middle of it the engine would swallow it.
    """
    if stop is None:
        with interrupts() as interrupt:
            record = run_again(world, document, seed, options, interrupt, last)
        if interrupt():
            record.close()
            raise KeyboardInterrupt
        return record
    simulation = ready(world, document, seed, options)
    scene = simulation.scene
    end = scene.steps if last is None else last
    bar = Bar(f"{scene.world.name}, seed {scene.seed}", end * scene.dt, "s", options.quiet)
    try:
        return record_run(
            simulation,
            stop=lambda: stop() or simulation.step_number == last,
            progress=lambda now, factor: bar.update(now.time, f"{factor:.0f} x real time"),
        )
    finally:
        bar.close()


def last_step(record: Record) -> int | None:
    """Step at which a run that was interrupted or killed ended; None where it ended by itself."""
    return record.steps_run if record.ended in ("interrupted", "running") else None


def check_samples(coarse: Record, full: Record) -> None:
    """Raise RecordError unless a coarse record has the samples and contacts of the run again."""
    names = coarse.names
    if coarse.robots != full.robots or coarse.steps_run != full.steps_run:
        raise RecordError(
            f"{coarse.path}: simulated again from the world inside, the run ends at step "
            f"{full.steps_run} instead of {coarse.steps_run}; this record cannot be validated"
        )
    gap = np.abs(full.pose[coarse.steps] - coarse.pose).max(axis=2)
    if (gap > SAME).any():
        k, i = (int(v) for v in np.argwhere(gap > SAME)[0])
        raise RecordError(
            f"{coarse.path}: simulated again from the world inside, {names[i]} is "
            f"{gap[k, i]:.3g} m away from its recorded sample at {coarse.time[k]:.2f} s; made by "
            "another version or controller? Record every step (time.record_every=1) to validate"
        )

    check_contacts(coarse, full)


def check_contacts(coarse: Record, full: Record) -> None:
    """Raise RecordError unless a coarse record tells the contacts of the run again."""
    columns = ["step", "a", "b", "phase", "kind"]
    told = coarse.contacts[columns]
    found = full.contacts[full.contacts["step"] <= coarse.steps_run][columns]
    if told.tolist() != found.tolist():
        raise RecordError(
            f"{coarse.path}: simulated again from the world inside, the contacts are not those of "
            f"the record ({len(found)} rows instead of {len(told)}); made by another version?"
        )


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
