"""``physim validate``."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from physim.cli import rerun
from physim.cli.compiling import tell_compiling
from physim.cli.output import inputs, new_json, people, write_json
from physim.cli.progress import interrupts
from physim.errors import PhysimError
from physim.record import Record
from physim.scene_builder import is_random
from physim.validation import Validation, is_warm, report, validate, warning_lines
from physim.validation.as_json import json_of_seeds, json_of_validation
from physim.validation.rerun import compare_runs
from physim.validation.seeds import SeedResult, SeedStudy, seed_line, seeds_text
from physim.validation.validation import missing, validate_again
from physim.world import World
from physim.world_file.nodes import Document
from physim.world_file.shipped import SUFFIXES

INTERRUPTED = 130
COMPILING = 15
"""[s] about, for the checks"""


def validate_command(options: argparse.Namespace) -> int:
    """Validate a world or a record; returns the exit code."""
    new_json(options.json, options.force, *inputs(options.given, options.world))
    if not is_record(options.given):
        if options.world is not None:
            raise PhysimError("--world: goes with a record: it checks where the record came from")
        if options.rerun:
            raise PhysimError("--rerun: goes with a record: a world is simulated anyway")
        world, document = rerun.world_given(options, options.given)
        return _validate_world(world, document, options)
    with Record.load(Path(options.given)) as record:
        return _validate_record(record, options)


def is_record(given: str) -> bool:
    """Whether an argument names a record rather than a world."""
    path = Path(given)
    if path.suffix in SUFFIXES:
        return False
    if path.is_file():
        try:
            with path.open("rb") as stream:
                return stream.read(4) == b"\x89HDF" or path.suffix in (".h5", ".hdf5")
        except OSError:
            return True  # opening it says why not
    return path.suffix in (".h5", ".hdf5") or path.is_dir()


def _validate_record(record: Record, options: argparse.Namespace) -> int:
    if options.world is not None:
        world, _ = rerun.world_given(options, options.world)
        rerun.check_origin(record, world, options.world)
    if options.seeds is not None:
        return _validate_world(*rerun.world_inside(options, record), options)
    if options.seed is not None:
        raise PhysimError("--seed: goes with a world: a record has its own seed")
    lacking = missing(record)
    again = options.rerun or bool(lacking)
    changes = options.overrides or (options.controller and not again)
    if changes and options.world is None:
        raise PhysimError("--set, --controller: go with a world, with --world, or --rerun")
    if not again:
        return _told(_judged(record, str(record.path), options), options)
    with rerun.run_of_record(record, options) as full:
        if lacking:
            return _told(validate_again(record, full, str(record.path)), options)
        found = _judged(record, str(record.path), options)
        return _told(replace(found, rerun=compare_runs(record, full)), options)


def _validate_world(world: World, document: Document, options: argparse.Namespace) -> int:
    if options.seeds is None:
        return _told(_run_and_validate(world, document, options.seed, options), options)
    if options.seed is not None:
        raise PhysimError("--seed: does not go together with --seeds")
    if not is_random(world):
        found = _run_and_validate(world, document, None, options)
        print(
            "Nothing in this world is random: every seed gives the same run, so there is one run "
            "and no rate.\n",
            file=people(options.json),
        )
        return _told(found, options)
    return _validate_seeds(world, document, options)


def _validate_seeds(world: World, document: Document, options: argparse.Namespace) -> int:
    """Validate every seed; an interrupt (Ctrl-C) ends the study with what is known by then."""
    first, last = options.seeds
    results: list[SeedResult] = []
    worst: Validation | None = None
    with interrupts() as interrupt:
        for seed in range(first, last):
            with rerun.run_world(world, document, seed, options, stop=interrupt) as record:
                if interrupt():  # half a run says nothing about its seed
                    break
                found = _judged(record, f"simulated just now from {document.source}", options)
            results.append(SeedResult.of(seed, found))
            if worst is None or found.code > worst.code:
                worst = found
            if not options.quiet:
                print(seed_line(results[-1]), flush=True, file=people(options.json))
            if interrupt():
                break
    study = SeedStudy(world.name, tuple(results), last - first)
    if study.interrupted:
        below = "; the results so far:" if results else ""
        print(f"interrupted after {len(results)} of {study.asked} seeds{below}", file=sys.stderr)
    if results:
        _tell_study(study, worst, options)
    return INTERRUPTED if interrupt() else study.code


def _tell_study(study: SeedStudy, worst: Validation | None, options: argparse.Namespace) -> None:
    out = people(options.json)
    if worst is not None and worst.code and not options.quiet:
        print("\n" + report(worst), end="", file=out)
    print(("" if options.quiet else "\n") + seeds_text(study), end="", file=out)
    write_json(options.json, json_of_seeds(study))


def _run_and_validate(
    world: World, document: Document, seed: int | None, options: argparse.Namespace
) -> Validation:
    with rerun.run_world(world, document, seed, options) as record:
        return _judged(record, f"simulated just now from {document.source}", options)


def _judged(record: Record, source: str, options: argparse.Namespace) -> Validation:
    if not is_warm():
        tell_compiling("the checks of the validation", COMPILING, options.quiet)
    return validate(record, source=source)


def _told(found: Validation, options: argparse.Namespace) -> int:
    write_json(options.json, json_of_validation(found))
    short = [*warning_lines(found), f"verdict: {found.verdict}"]
    told = "\n".join(short) + "\n" if options.quiet else report(found)
    print(told, end="", file=people(options.json))
    return found.code
