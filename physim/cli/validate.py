"""``physim validate``: a record, a world that is run first, or many seeds of one."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable
from dataclasses import asdict, replace
from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TextIO

from cyclopts import Parameter

from physim.cli.options import AS_IT_IS, Changes, File, JsonFile, Out, Seeds, Workers, record_file
from physim.cli.output import PAGE, Target, check_json, inputs, write_json
from physim.cli.page import make_page
from physim.cli.progress import Bar
from physim.errors import PhysimError, WorldError
from physim.terminal import INTERRUPTED, interrupts

if TYPE_CHECKING:
    from physim.analysis.validation import Validation
    from physim.campaigns.rows import Row
    from physim.record import Record
    from physim.world import World
    from physim.world.file import Document

    Report = Callable[[Validation, Record], int]

MOST_TOLD = 10
"""Seeds whose verdicts are printed"""


def validate(
    given: str, /, *,
    json: JsonFile | None = None,
    page: File | None = None,
    force: bool = False,
    world: str | None = None,
    seeds: Seeds | None = None,
    rerun: Annotated[bool, Parameter(negative="--no-rerun")] = True,
    changes: Changes = AS_IT_IS,
    workers: Workers | None = None,
    verbose: bool = False,
    full: bool = False,
    quiet: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Hold the physical contacts of a run against exact distances and collision times, and report
    every contact: who, where, and who was responsible.

    arguments:
      WORLD|RECORD  a run: its folder or its record.h5; or a world to run first: its file, or the
          name of a shipped one

    options:
      --page FILE  write the run as a page for the browser (.html), each finding with a link to its
          moment
      --force  overwrite an existing FILE
      --world WORLD  check that the record was made from WORLD
      --seeds A:B  run the world with each of the seeds A to B - 1, and report how many are
          contact-free
      --rerun  whether to simulate the world inside RECORD again, too: does it give the same run?
      --workers N  with --seeds: processes, 1 to 64 (as many as cores, at most 8)
      --verbose  with --seeds, print the verdict of every seed as it comes
      --full  tell every contact, all tables and near misses, too
      --quiet  print only the verdict

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
    from physim.analysis.validation import report as report_text
    from physim.analysis.validation import warning_lines
    from physim.analysis.validation.origin import check_made_from
    from physim.analysis.validation.validation import json_of_validation
    from physim.cli.simulating import world_given
    from physim.record import Record

    many = {"--page": page, "--no-rerun": not rerun, "--full": full, "--seed": changes.seed}
    one = {"--workers": workers, "--verbose": verbose}
    for name, value in (one if seeds is None else many).items():
        if value not in (None, False):
            why = "needs --seeds A:B, the seeds to run" if seeds is None else "not with --seeds"
            raise PhysimError(f"{name}: {why}")
    read = inputs(given, world)
    check_json(json, force, read if page is None else [*read, page])
    if page is not None:
        Target(page, force, read, "--page").file(ends=PAGE)

    def report(found: Validation, record: Record) -> int:
        """Write and tell what was found in a run."""
        if page is not None:
            make_page([record], page, quiet, found)
            if not quiet:
                print(f"the run, its findings linked to their moments: {page}", file=sys.stderr)
        write_json(json, json_of_validation(found), out)
        short = "\n".join([*warning_lines(found), f"verdict: {found.verdict}"]) + "\n"
        print(short if quiet else report_text(found, full), end="")
        return found.code

    if (file := _record(given)) is not None:
        with Record.load(file) as record:
            if world is not None:
                check_made_from(record, world_given(world, changes)[0], world)
            if seeds is None:
                return _of_record(record, world, rerun, changes, quiet, report)
    elif world is not None:
        raise PhysimError("--world: needs a record; it checks where the record came from")
    elif not rerun:
        raise PhysimError("--no-rerun: needs a record; a world has to be simulated")
    to_run, document = world_given(str(file or given), changes)
    if seeds is None or not _varies(to_run):
        return _of_world(to_run, document, changes, quiet, report)
    again = ["physim", "validate", given, *changes.words]
    _warm_up(to_run, document, replace(changes, seed=seeds[0]), quiet)
    rows, stopped = _runs_of(to_run, seeds, workers, verbose, quiet)
    return _report_seeds(to_run, seeds, rows, stopped, json, out, quiet, again)


def _record(given: str) -> Path | None:
    """Record that an argument names; None where it names a world."""
    from physim.world.file.files import find_world, is_record

    try:
        file = record_file(str(find_world(given)))
    except WorldError:  # there is neither
        file = Path(given)
    return file if file.suffix in (".h5", ".hdf5") or is_record(file) else None


def _of_record(
    record: Record, world: str | None, rerun: bool, changes: Changes, quiet: bool, report: Report
) -> int:
    """Validate a record, and the same run made again."""
    from physim.analysis.validation.validation import NOT_ASKED, missing
    from physim.cli.simulating import run_of_record

    if changes.seed is not None:
        raise PhysimError("--seed: needs a world; a record has its own seed")
    lacking = missing(record)
    if lacking and not rerun:
        raise PhysimError(f"--no-rerun: {record.path} has to be simulated again: {lacking}")
    if changes.set and world is None:
        raise PhysimError("--set: needs a world or --world; a record is run again as it was made")
    if changes.controller and not rerun and world is None:
        raise PhysimError("--controller: needs a world, or a record that is simulated again")
    again: Record | str = NOT_ASKED
    if rerun:
        again = run_of_record(record, changes.controller, quiet, bool(lacking))
    if isinstance(again, str):
        return report(_judged(record, None, again, str(record.path), quiet), record)
    with again:
        found = _judged(record, again, "", str(record.path), quiet)
        return report(found, again if lacking else record)


def _varies(world: World) -> bool:
    """Whether runs of a world differ by their seed; what is to be said of that is told."""
    from physim.cli.simulating import tell
    from physim.world.layout.scene_builder import TO_DRAW, may_vary, seeds_note

    if not may_vary(world):
        print(
            "Nothing in this world is random: every seed gives the same run, so there is one run "
            f"and no rate; {TO_DRAW}.\n",
        )
        return False
    if note := seeds_note(world):
        tell([note])
    return True


def _of_world(
    world: World, document: Document, changes: Changes, quiet: bool, report: Report
) -> int:
    """Run a world once and validate that."""
    from physim.cli.simulating import run_world

    with run_world(world, document, changes, quiet) as record:
        source = f"simulated just now from {document.source}"
        return report(_judged(record, None, "", source, quiet), record)


def _judged(
    record: Record, again: Record | None, why_not: str, source: str, quiet: bool
) -> Validation:
    from physim.analysis.validation import judge
    from physim.cli.progress import checks_ready

    checks_ready(quiet)
    return judge(record, again, why_not, source=source)


def _warm_up(world: World, document: Document, changes: Changes, quiet: bool) -> None:
    """Compile the kernels once, before workers would each do so."""
    from physim.analysis.validation import is_warm as checks_are_warm
    from physim.simulation.run import is_warm

    if not (is_warm() and checks_are_warm()):
        short = world.changed(time={"step": world.time.step, "duration": world.time.step})
        _of_world(short, document, changes, quiet, lambda found, record: 0)


def _runs_of(
    world: World, seeds: Seeds, workers: int | None, verbose: bool, quiet: bool
) -> tuple[list[Row], bool]:
    """Run and validate every seed; rows by seed, and whether Ctrl-C ended that early."""
    from physim.campaigns.cluster import executor
    from physim.campaigns.spec import spec_of
    from physim.campaigns.sweep import runs

    rows: list[Row] = []
    with (
        interrupts() as interrupt,
        Bar(world.name, len(seeds), "seeds", quiet) as bar,
        executor(workers) as team,
    ):
        specs = (spec_of(world, seed, name=world.name) for seed in seeds)
        for _, row in runs(specs, team, interrupt, judged=True):
            rows.append(row)
            bar.update(len(rows))
            if verbose:
                print(f"seed {row.seed:>6}: {row.verdict or row.reason}", flush=True)
    return sorted(rows, key=lambda row: row.seed), interrupt()


def _report_seeds(
    world: World, seeds: Seeds, rows: list[Row], stopped: bool, json: Path | None, out: TextIO,
    quiet: bool, again: list[str],
) -> int:  # fmt: skip
    """Tell how many seeds are contact-free and which are not; the exit code."""
    from physim.analysis.validation.validation import CONTACTS, DISAGREE, FREE
    from physim.campaigns.outcomes import Outcomes
    from physim.campaigns.report.contents import report_of
    from physim.campaigns.report.text import report_text, report_values
    from physim.campaigns.rows import table_of
    from physim.campaigns.spec import spec_of

    cell = spec_of(world, seeds[0], name=world.name)
    found = report_of(Outcomes(table_of(rows)), world.name, draws={cell.label: cell.draws})
    if not quiet:
        cells = tuple(replace(one, worst=()) for one in found.cells)  # there is nothing to replay
        print(report_text(replace(found, cells=cells)))
    wrong = [row for row in rows if row.verdict.startswith("checks disagree")]
    told = wrong or [row for row in rows if row.verdict != "contact-free"]
    for row in told[:MOST_TOLD]:
        print(f"seed {row.seed}: {row.verdict or row.reason}")
    if told and not quiet:
        words = [*again, "--seed", str(told[0].seed)]
        print(f"the first of them in full: {shlex.join(words)}")
    code = INTERRUPTED if stopped else DISAGREE if wrong else CONTACTS if told else FREE
    values = {**report_values(found), "exit_code": code, "seeds": [asdict(row) for row in rows]}
    write_json(json, dumps(values, indent=2, ensure_ascii=False, allow_nan=False) + "\n", out)
    if stopped:
        print(f"interrupted after {len(rows)} of {len(seeds)} seeds", file=sys.stderr)
    if failed := next((row for row in rows if row.failed), None):
        raise PhysimError(f"seed {failed.seed}: {failed.reason}")
    return code
