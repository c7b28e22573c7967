"""``physim validate``."""

from __future__ import annotations

import json
import shlex
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from physim.cli.output import alone, inputs, new_json, new_page, write_json
from physim.cli.page import make_page
from physim.cli.parser import Options, changes, command, flag, option
from physim.cli.progress import Bar, announce_compiling, interrupts
from physim.cli.signals import INTERRUPTED
from physim.cli.values import PATH, RECORD_HELP, Value, record_file, seed_range, whole_from
from physim.errors import PhysimError, WorldError

if TYPE_CHECKING:
    from physim.analysis.validation import Validation
    from physim.record import Record
    from physim.world import World
    from physim.world.file import Document

MOST_TOLD = 10
"""Seeds whose verdicts are printed"""
COMPILING = 15
"""[s] about, for the checks"""


@command("validate", "contacts of a run, exact checks, who was responsible")
@click.argument(
    "given",
    metavar="WORLD|RECORD",
    help=f"{RECORD_HELP}; or a world to run first: its file, or the name of a shipped one",
)
@option(
    "--json",
    type=PATH,
    metavar="FILE",
    help="write everything to FILE (-: standard output) as JSON",
)
@option(
    "--page",
    type=PATH,
    metavar="FILE",
    help="write the run as a page for the browser (.html), each finding with a link to its moment",
)
@flag("--force", "overwrite an existing FILE")
@option("--world", metavar="WORLD", help="check that the record was made from WORLD")
@option(
    "--seeds",
    type=Value(seed_range),
    metavar="A:B",
    help="run the world with each of the seeds A to B - 1, and report how many are contact-free",
)
@option(
    "--rerun/--no-rerun",
    default=True,
    help="whether to simulate the world inside RECORD again, too: does it give the same run?",
)
@changes()
@option(
    "--workers",
    type=whole_from(1, 64),
    metavar="N",
    help="with --seeds, processes, 1 to 64 (as many as cores, at most 8)",
)
@flag("--verbose", "with --seeds, print the verdict of every seed as it comes")
@flag("--full", "tell every contact, all tables and near misses, too")
@flag("--quiet", "print only the verdict")  # fmt: skip
def validate_command(options: Options) -> int:
    """Hold the physical contacts of a run against exact distances and collision times, and report
    every contact: who, where, and who was responsible.

    exit codes:
      0    contact-free and as the world expects, and physics and geometry agree at every step
      1    contacts, or not as the world expects
      2    bad input: one message says what and where
      3    the checks disagree: something is wrong with physics, geometry or the record
      130  interrupted (Ctrl-C): with --seeds, the seeds so far are reported and written

    examples:
      physim validate runs/ten_robots-21
      physim validate runs/ten_robots-21/record.h5 --no-rerun --world ten_robots
      physim validate three_robots --controller path_following
      physim validate three_robots --controller path_following --page contacts.html
      physim validate my_world.yaml --seeds 1:101 --json seeds.json
    """
    from physim.cli import simulating as rerun
    from physim.record import Record

    _check(options)
    given = inputs(options.given, options.world)
    new_json(options.json, options.force, *given)
    alone(options.json, options.page)
    if options.page is not None:
        if options.seeds is not None:
            raise PhysimError("--page: is of one run; not with --seeds")
        new_page(options.page, options.force, *given, option="--page")
    if (path := _record(options.given)) is None:
        if options.world is not None:
            raise PhysimError("--world: needs a record; it checks where the record came from")
        if not options.rerun:
            raise PhysimError("--no-rerun: needs a record; a world has to be simulated")
        world, document = rerun.world_given(options, options.given)
        return _validate_world(world, document, options)
    with Record.load(path) as record:
        return _validate_record(record, options)


def _check(options: Options) -> None:
    """Raise PhysimError for options that do not go together."""
    if options.seeds is not None and not options.rerun:
        raise PhysimError("--no-rerun: is of one record; not with --seeds")
    if options.seeds is not None and options.full:
        raise PhysimError("--full: is of one run; not with --seeds")
    for name, value in (("--workers", options.workers), ("--verbose", options.verbose)):
        if options.seeds is None and value:
            raise PhysimError(f"{name}: needs --seeds A:B, the seeds to run")


def _record(given: str) -> Path | None:
    """Record that an argument names; None where it names a world."""
    from physim.world.file.files import find_world, is_record

    try:
        path = record_file(str(find_world(given)))
    except WorldError:  # there is neither
        path = Path(given)
    return path if path.suffix in (".h5", ".hdf5") or is_record(path) else None


def _validate_record(record: Record, options: Options) -> int:
    from physim.analysis.validation.origin import check_made_from
    from physim.analysis.validation.validation import NOT_ASKED, missing
    from physim.cli import simulating as rerun

    if options.world is not None:
        world, _ = rerun.world_given(options, options.world)
        check_made_from(record, world, options.world)
    if options.seeds is not None:
        return _validate_world(*rerun.world_given(options, str(record.path)), options)
    if options.seed is not None:
        raise PhysimError("--seed: needs a world; a record has its own seed")
    lacking = missing(record)
    if lacking and not options.rerun:
        raise PhysimError(f"--no-rerun: {record.path} has to be simulated again: {lacking}")
    if options.overrides and options.world is None:
        raise PhysimError("--set: needs a world or --world; a record is run again as it was made")
    if options.controller and not options.rerun and options.world is None:
        raise PhysimError("--controller: needs a world, or a record that is simulated again")
    again = rerun.run_of_record(record, options, bool(lacking)) if options.rerun else NOT_ASKED
    if isinstance(again, str):
        return _report(_judged(record, None, again, str(record.path), options), options, record)
    with again:
        found = _judged(record, again, "", str(record.path), options)
        return _report(found, options, again if lacking else record)


def _validate_world(world: World, document: Document, options: Options) -> int:
    from physim.world.layout.scene_builder import TO_DRAW, may_vary, seeds_note

    if options.seeds is None:
        return _report(_run_and_validate(world, document, options.seed, options), options)
    if options.seed is not None:
        raise PhysimError("--seed: cannot be combined with --seeds")
    if not may_vary(world):
        found = _run_and_validate(world, document, None, options)
        print(
            "Nothing in this world is random: every seed gives the same run, so there is one run "
            f"and no rate; {TO_DRAW}.\n",
        )
        return _report(found, options)
    if note := seeds_note(world):
        print(f"WARNING  {note}", file=sys.stderr)
    return _validate_seeds(world, document, options)


def _validate_seeds(world: World, document: Document, options: Options) -> int:
    """Run every seed and validate it; Ctrl-C ends that, and what is known by then is reported."""
    from physim.analysis.validation.validation import CONTACTS, DISAGREE, FREE
    from physim.campaigns.cluster import executor
    from physim.campaigns.outcomes import Outcomes
    from physim.campaigns.report.contents import report_of
    from physim.campaigns.report.text import report_text, report_values
    from physim.campaigns.rows import table_of
    from physim.campaigns.spec import spec_of
    from physim.campaigns.sweep import runs

    first, last = options.seeds
    rows = []
    _warm_up(world, document, options)
    with (
        interrupts() as interrupt,
        Bar(world.name, last - first, "seeds", options.quiet) as bar,
        executor(options.workers) as workers,
    ):
        specs = (spec_of(world, seed, name=world.name) for seed in range(first, last))
        for _, row in runs(specs, workers, interrupt, judged=True):
            rows.append(row)
            bar.update(len(rows))
            if options.verbose:
                print(f"seed {row.seed:>6}: {row.verdict or row.reason}", flush=True)
    rows.sort(key=lambda row: row.seed)
    cell = spec_of(world, first, name=world.name)
    found = report_of(Outcomes(table_of(rows)), world.name, draws={cell.label: cell.draws})
    if not options.quiet:
        cells = tuple(replace(one, worst=()) for one in found.cells)  # there is nothing to replay
        print(report_text(replace(found, cells=cells)))
    wrong = [row for row in rows if row.verdict.startswith("checks disagree")]
    told = wrong or [row for row in rows if row.verdict != "contact-free"]
    for row in told[:MOST_TOLD]:
        print(f"seed {row.seed}: {row.verdict or row.reason}")
    if told and not options.quiet:
        again = ["physim", "validate", options.given, "--seed", str(told[0].seed)]
        again += [word for one in options.overrides for word in ("--set", one)]
        again += ["--controller", options.controller] if options.controller else []
        print(f"the first of them in full: {shlex.join(again)}")
    code = INTERRUPTED if interrupt() else DISAGREE if wrong else CONTACTS if told else FREE
    values = {**report_values(found), "exit_code": code, "seeds": [asdict(row) for row in rows]}
    write_json(options, json.dumps(values, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
    if interrupt():
        print(f"interrupted after {len(rows)} of {last - first} seeds", file=sys.stderr)
    if failed := next((row for row in rows if row.failed), None):
        raise PhysimError(f"seed {failed.seed}: {failed.reason}")
    return code


def _warm_up(world: World, document: Document, options: Options) -> None:
    """Compile the kernels once, before workers would each do so."""
    from physim.analysis.validation import is_warm as checks_are_warm
    from physim.simulation.run import is_warm

    if not (is_warm() and checks_are_warm()):
        short = world.changed(time={"step": world.time.step, "duration": world.time.step})
        _run_and_validate(short, document, options.seeds[0], options)


def _run_and_validate(
    world: World, document: Document, seed: int | None, options: Options
) -> Validation:
    from physim.cli import simulating as rerun

    with rerun.run_world(world, document, seed, options) as record:
        source = f"simulated just now from {document.source}"
        found = _judged(record, None, "", source, options)
        _write_page(found, record, options)
        return found


def _judged(
    record: Record, again: Record | None, why_not: str, source: str, options: Options
) -> Validation:
    from physim.analysis.validation import is_warm, judge
    from physim.cli.warming import finish

    if not is_warm():
        finish(options.quiet)
    if not is_warm():
        announce_compiling("the checks of the validation", COMPILING, options.quiet)
    return judge(record, again, why_not, source=source)


def _write_page(found: Validation, record: Record, options: Options) -> None:
    if options.page is not None:
        make_page([record], options.page, options.quiet, found)
        if not options.quiet:
            print(f"the run, its findings linked to their moments: {options.page}", file=sys.stderr)


def _report(found: Validation, options: Options, record: Record | None = None) -> int:
    """Tell what was found; with a record its page is written first, where one is asked for."""
    from physim.analysis.validation import report, warning_lines
    from physim.analysis.validation.validation import json_of_validation

    if record is not None:
        _write_page(found, record, options)
    write_json(options, json_of_validation(found))
    short = [*warning_lines(found), f"verdict: {found.verdict}"]
    text = "\n".join(short) + "\n" if options.quiet else report(found, options.full)
    print(text, end="")
    return found.code
