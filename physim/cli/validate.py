"""``physim validate``: a record, or a world that is run first."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from physim.cli.options import AS_IT_IS, Changes, File, JsonFile, Out, record_file
from physim.cli.output import PAGE, Target, check_json, inputs, write_json
from physim.cli.page import make_page
from physim.cli.simulating import ready, tell, to_the_end
from physim.errors import PhysimError

if TYPE_CHECKING:
    from physim.parts.controller import Controller
    from physim.record import Record


def validate(
    given: str, /, *,
    json: JsonFile | None = None,
    page: File | None = None,
    force: bool = False,
    world: str | None = None,
    rerun: Annotated[bool, Parameter(negative="--no-rerun")] = True,
    changes: Changes = AS_IT_IS,
    full: bool = False,
    quiet: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Compare the physical contacts of a run with exact distances and collision times, and report
    every contact: which bodies touched, where, and who was responsible.

    arguments:
      WORLD|RECORD  a run: its folder or its record.h5; or a world to run first: its file, or the
          name of a shipped one

    options:
      --page FILE  write the run as a page for the browser (.html), with a link to each finding
      --force  overwrite an existing FILE
      --world WORLD  check that the record was made from WORLD
      --rerun  simulate the world in RECORD again, and check that the run is the same (default)
      --full  also print every contact, all tables and near misses
      --quiet  print only the verdict

    exit codes:
      0    contact-free and as the world expects; physics and geometry agree at every step
      1    contacts, not as the world expects, or the run broke off with an error
      2    bad input: one message says what and where
      3    the checks disagree: something is wrong with physics, geometry or the record
      130  interrupted (Ctrl-C)

    many seeds: physim sweep WORLD --seeds A:B --validate

    examples:
      physim validate runs/ten_robots-21
      physim validate runs/ten_robots-21/record.h5 --no-rerun --world ten_robots
      physim validate three_robots --controller path_following
      physim validate three_robots --controller path_following --page contacts.html
    """
    from physim.analysis.validation import judge, warning_lines
    from physim.analysis.validation import report as report_text
    from physim.analysis.validation.origin import check_made_from
    from physim.analysis.validation.undisturbed import disturbing, undisturbed
    from physim.analysis.validation.validation import NOT_ASKED, json_of_validation, missing
    from physim.record import Record
    from physim.simulation.recorder import SaveAt
    from physim.simulation.run import record_run
    from physim.world.file import read_world
    from physim.world.file.files import is_record

    read = inputs(given, world)
    named = record_file(str(next(iter(inputs(given)), given)))
    file = named if named.suffix in (".h5", ".hdf5") or is_record(named) else None
    check_json(json, force, read if page is None else [*read, page])
    if page is not None:
        Target(page, force, read, "--page").file(ends=PAGE)
    _check(file is not None, world, rerun, changes)
    with ExitStack() as opened:
        again: Record | str = ""
        if file is None:
            simulation = ready(given, changes, quiet)
            controller = simulation.parts.all[0].made
            scene, run = simulation.scene, partial(record_run, simulation, save=SaveAt(every=1))
            title = f"{scene.world.name}, seed {scene.seed}"
            record = opened.enter_context(to_the_end(run, title, scene.steps * scene.dt, quiet))
            source = f"simulated just now from {read[0]}"
        else:
            record, source = opened.enter_context(Record.load(file)), str(file)
            if world is not None:
                check_made_from(record, read_world(world, **changes.reading)[0], world)
            controller = _controller(file, changes) if rerun else None
            again = _run_again(record, controller, quiet) if rerun else NOT_ASKED
        whole = record
        if isinstance(again, Record):
            opened.enter_context(again)
            whole = again if missing(record) else record
        without = None
        if rerun and disturbing(whole) and len(whole.contacts):
            make = partial(undisturbed, whole, controller=controller)
            title = f"{record.name}, seed {record.seed}, without disturbances"
            without = to_the_end(make, title, record.steps_run * record.dt, quiet)
        if isinstance(again, Record):
            found = judge(record, again, source=source, without=without)
        else:
            found = judge(record, None, again, source=source, without=without)
        if page is not None:
            make_page([whole], page, quiet, found)
            if not quiet:
                print(f"the run, with a link to each finding: {page}", file=sys.stderr)
    write_json(json, json_of_validation(found), out)
    short = "\n".join([*warning_lines(found), f"verdict: {found.verdict}"]) + "\n"
    print(short if quiet else report_text(found, full), end="")
    return found.code


def _check(is_record: bool, world: str | None, rerun: bool, changes: Changes) -> None:
    """Raise PhysimError for an option that would have no effect."""
    if not is_record and world is not None:
        raise PhysimError("--world: needs a record; it checks from which world that was made")
    if not is_record and not rerun:
        raise PhysimError("--no-rerun: needs a record; a world has to be simulated")
    if is_record and changes.seed is not None:
        raise PhysimError("--seed: needs a world; a record has its own seed")
    if is_record and changes.set and world is None:
        raise PhysimError("--set: needs a world or --world; a record is run again as it was made")
    if is_record and changes.controller and not rerun and world is None:
        raise PhysimError("--controller: needs a world, or a record that is simulated again")


def _controller(file: Path, changes: Changes) -> Controller | None:
    """The controller that is given with a record, to stand for a class that it names."""
    from physim.parts.registry import made_controller
    from physim.world.file import read_world

    if changes.controller is None:
        return None
    world, document = read_world(file, controller=changes.controller)
    tell(document.lines(document.warnings))
    return made_controller(world, trusted=True)


def _run_again(record: Record, controller: Controller | None, quiet: bool) -> Record | str:
    """The run of a record simulated again, as far as it goes; or why it cannot be.

    Raises PhysimError where it has to be, for what the record lacks.
    """
    from physim.analysis.validation.rerun import run_again
    from physim.analysis.validation.validation import missing
    from physim.simulation.again import AgainError, simulation_again

    try:
        simulation = simulation_again(record, controller=controller)
        title = f"{record.name}, seed {record.seed}"
        run = partial(run_again, record, simulation)
        return to_the_end(run, title, record.steps_run * record.dt, quiet)
    except AgainError as error:
        if missing(record):
            raise
        return error.why
