"""``physim sweep``: many runs, each counted once it is on disk."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from physim.cli.parser import Options, command, flag, option
from physim.cli.signals import INTERRUPTED
from physim.cli.sweeping import names_of, run_grid, tell_fixed, usual_folder
from physim.cli.values import PATH, WORLD_HELP, OneOf, Value, number_from, seed_range, whole_from
from physim.errors import PhysimError, plural

if TYPE_CHECKING:
    from physim.campaigns.grid import Grid
    from physim.campaigns.spec import Label
    from physim.campaigns.sweep import Tally
    from physim.statistics import Decision, Goal

MOST_SHARDS = 100_000


def shard(text: str) -> tuple[int, int]:
    """Read I/N. Raises ValueError with what is allowed."""
    first, _, of = text.partition("/")
    number, count = (int(one) if one.isascii() and one.isdigit() else 0 for one in (first, of))
    if not 1 <= number <= count <= MOST_SHARDS:
        raise ValueError("I/N, part I of N, as 1/8 to 8/8")
    return number, count


def goal(text: str) -> Goal:
    """Read a goal. Raises ValueError with what is allowed and where the fault is."""
    from physim.statistics import read_goal

    return read_goal(text)


@command("sweep", "many runs: worlds, seeds, settings, controllers")
@click.argument(
    "worlds",
    nargs=-1,
    required=True,
    metavar="WORLD...",
    help=WORLD_HELP,
)
@option(
    "--seeds", type=Value(seed_range), metavar="A:B",
    help="each world with the seeds A to B - 1 (default: with its own)",
)  # fmt: skip
@option(
    "--set", "axes", multiple=True, metavar="KEY=V1,V2",
    help="each of these values of a world, e.g. controller.beta=0.3,0.5 (of controllers that have "
    "it); may be repeated: every combination is run",
)  # fmt: skip
@option(
    "--controller", metavar="NAME,...",
    help="each of these controllers, registered ones (physim list) or your own as module:Class",
)  # fmt: skip
@option("-o", "--output", type=PATH, metavar="DIR", help="folder (default: sweeps/WORLD)")
@option(
    "--workers", type=whole_from(1, 1024), metavar="N",
    help="processes on this machine (as many as cores, at most 8)",
)  # fmt: skip
@option("--scheduler", metavar="ADDRESS", help="run on a Dask cluster, e.g. tcp://10.0.0.1:8786, "
    "which must answer in 5 s and have a worker in 30 s")  # fmt: skip
@option(
    "--until", type=Value(goal), metavar="GOAL",
    help='stop when it is known: "rate > 0.99" (contact-free and finished; or contact_free, '
    'finished), or the width of the interval of that rate, as 0.02; --seeds says how many at most',
)  # fmt: skip
@option("--shard", type=Value(shard), default=(1, 1), metavar="I/N", help="only part I of N parts")
@option(
    "--keep", type=OneOf(["none", "failed", "all"]), default="none", metavar="WHICH",
    help="records to keep in DIR/records: none, failed (those with contacts), all (none)",
)  # fmt: skip
@option(
    "--limit", type=number_from(0.1, 1e7), metavar="SECONDS",
    help="give a run up after this time (default: 2 min and 1 ms for each robot and step)",
)  # fmt: skip
@flag("--retry", "run those again that failed: by an error, their limit or a kill")
@flag("--yes", "run more than a million")
@flag("--json", "print the counts as JSON instead")
@flag("--quiet", "print neither progress nor counts")  # fmt: skip
def sweep(options: Options) -> int:
    """Run every combination of worlds, seeds, values and controllers, and write a row for each run
    to DIR. What has a row is not run again: the same command goes on where it was interrupted or
    killed, one with more seeds adds to it. Two at once in one DIR need parts of their own: --shard.

    written to DIR:
      results.parquet  a row a run: ended, contacts, distances, times, ... (pandas, polars, DuckDB)
      records/         records that --keep keeps; physim replay makes any other again
      rows/, worlds/   the rows as they come, the worlds as they are run; campaign.json

    a run that fails (an error, beyond its limit, a killed process) is a row with its reason

    exit codes:
      0    all runs have a row, whatever came of them
      2    bad input; nothing that was written is lost
      130  interrupted (Ctrl-C, SIGTERM): what was finished is kept; the same command goes on

    examples:
      physim sweep ten_robots --seeds 1:101
      physim sweep ten_robots nonconvex --seeds 1:101 --controller mode_switching,path_following
      physim sweep my_world.yaml --seeds 0:50 --set formation.gain=0.02,0.05,0.1 -o gains
      physim sweep ten_robots --seeds 0:10000 --until "rate > 0.99"
      physim sweep ten_robots --seeds 0:100000 --scheduler tcp://10.0.0.1:8786
    """
    if options.workers is not None and options.scheduler is not None:
        raise PhysimError("--workers: cannot be combined with --scheduler, which has its own")
    _check_goal(options)
    grid = _grid(options)
    folder = options.output or usual_folder(options.worlds)
    tell_fixed(grid, options.quiet)
    tally, decisions = run_grid(
        grid, folder, workers=options.workers, scheduler=options.scheduler, until=options.until,
        keep=options.keep, retry=options.retry, quiet=options.quiet,
    )  # fmt: skip
    if options.keep != "none" and tally.before:
        print(
            f"{plural(tally.before, 'run')} had a row already: --keep is of runs that are done now "
            "(physim replay makes any other again)", file=sys.stderr,
        )  # fmt: skip
    if options.json or not options.quiet:
        _tell(grid, folder, tally, decisions, options)
    return INTERRUPTED if tally.interrupted else 0


def _tell(
    grid: Grid, folder: Path, tally: Tally, decisions: dict[Label, Decision], options: Options
) -> None:
    """Print what came of it: counts of each cell, and the runs to look at."""
    from physim.campaigns.folder import read
    from physim.campaigns.outcomes import Outcomes
    from physim.campaigns.report.swept import sweep_text, sweep_values

    draws, found = {cell.label: cell.draws for cell in grid.cells}, Outcomes(read(folder))
    if options.json:
        values = sweep_values(folder, found, draws, tally, decisions)
        print(json.dumps(values, indent=2), file=options.stdout)
        return
    print(sweep_text(folder, found, draws, tally), end="")
    for label, one in decisions.items():
        print(f"{', '.join(filter(None, label))}: {_decided(one, options.until)}")


def _check_goal(options: Options) -> None:
    """Raise PhysimError where a goal cannot be decided in the order of seeds."""
    if options.until is None:
        return
    if options.seeds is None:
        raise PhysimError("--until: needs --seeds A:B, the seeds that may be run for it")
    if options.shard[1] > 1:
        raise PhysimError("--until: cannot be combined with --shard, which has not all seeds")


def _decided(one: Decision, goal: Goal) -> str:
    """What came of the goal in a cell."""
    from physim.campaigns.report.text import decision_words
    from physim.units import interval

    text = f"{decision_words(one, goal)}, {goal.rate} in {interval(one.low, one.high)} at any look"
    return text if one.decided else f"{text}; more --seeds may decide it"


def _grid(options: Options) -> Grid:
    from physim.campaigns.grid import MOST_RUNS, Shard, make_grid

    return make_grid(
        options.worlds, None if options.seeds is None else range(*options.seeds), options.axes,
        names_of(options.controller), options.limit, Shard(*options.shard),
        None if options.yes else MOST_RUNS,
    )  # fmt: skip
