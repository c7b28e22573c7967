"""``physim sweep``: many runs, each counted once it is on disk."""

from __future__ import annotations

import json
import shlex
import sys
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from physim.cli.parser import Options, command, flag, option
from physim.cli.progress import Bar, announce_compiling, interrupts
from physim.cli.signals import INTERRUPTED
from physim.cli.values import OneOf, Value, number_from, seed_range, whole_from
from physim.errors import PhysimError, plural

if TYPE_CHECKING:
    from physim.campaigns.grid import Grid
    from physim.campaigns.spec import Label
    from physim.campaigns.sweep import Tally
    from physim.statistics.goal import Decision, Goal

COMPILING = 30
"""[s] about, for all that runs need"""
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
    from physim.statistics.goal import read_goal

    return read_goal(text)


@command("sweep", "many runs: worlds, seeds, settings, controllers")
@click.argument(
    "worlds",
    nargs=-1,
    required=True,
    metavar="WORLD...",
    help="a world file, or the name of a shipped world",
)
@option(
    "--seeds", type=Value(seed_range), metavar="A:B",
    help="each world with the seeds A to B - 1 (default: with its own)",
)  # fmt: skip
@option(
    "--set", "axes", multiple=True, metavar="KEY=V1,V2",
    help="each of these values of a world, e.g. controller.beta=0.3,0.5; may be repeated: every "
    "combination is run",
)  # fmt: skip
@option(
    "--controller", metavar="NAME,...",
    help="each of these controllers, registered ones (physim list) or your own as module:Class",
)  # fmt: skip
@option("-o", "--output", type=Path, metavar="DIR", help="folder (default: sweeps/WORLD)")
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
    killed, one with more seeds adds to it, several may work in one DIR.

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
    folder = options.output or _usual_folder(options.worlds)
    for line in grid.warnings:
        print(f"WARNING  {line}", file=sys.stderr)
    if options.seeds is not None:
        for k in sorted(grid.fixed):
            cell = grid.cells[k]
            changed = f" with {cell.settings}" if cell.settings else ""
            _say(f"Nothing in {cell.world}{changed} is random: it is run once.", options)
    tally, decisions = _run(grid, folder, options)
    if options.json:
        print(json.dumps(_as_json(folder, grid, tally, decisions), indent=2))
    elif not options.quiet:
        print(_text(folder, grid, tally), end="")
        for label, one in decisions.items():
            print(f"{', '.join(filter(None, label))}: {_decided(one, options.until)}")
    if tally.interrupted:
        left = tally.asked - tally.known
        print(
            f"interrupted: {tally.known:,} of {plural(tally.asked, 'run')} done, {left:,} to go; "
            f"the same command goes on ({folder})", file=sys.stderr,
        )  # fmt: skip
        return INTERRUPTED
    return 0


def _run(grid: Grid, folder: Path, options: Options) -> tuple[Tally, dict[Label, Decision]]:
    """Do all runs, or until the goal is decided: then what it came to in each cell."""
    from physim.campaigns.executors import executor
    from physim.campaigns.sweep import sweep as run_all
    from physim.campaigns.until import sweep_until

    def workers() -> AbstractContextManager[Executor]:
        return executor(options.workers, options.scheduler)

    with interrupts() as interrupt, Bar("sweep", len(grid), "runs", options.quiet) as bar:
        how: dict[str, Any] = {
            "keep": options.keep, "retry": options.retry, "stop": interrupt,
            "progress": lambda now: bar.count(now.known, now.asked, now.note),
        }  # fmt: skip
        if options.until is not None:
            if options.scheduler is None:
                _warm_up(options)
            tally, watches = sweep_until(grid, folder, workers, options.until, **how)
            return tally, {label: watch.decision for label, watch in watches.items()}
        with workers() as team:
            if options.scheduler is None:
                _warm_up(options)
            return run_all(grid, folder, team, **how), {}


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
    from physim.campaigns.report.wording import decision_words, interval

    text = f"{decision_words(one, goal)}, {goal.rate} in {interval(one.low, one.high)} at any look"
    return text if one.decided else f"{text}; more --seeds may decide it"


def _grid(options: Options) -> Grid:
    from physim.campaigns.grid import MOST_RUNS, Shard, make_grid

    given = (options.controller or "").split(",") if options.controller is not None else []
    if "" in (names := [name.strip() for name in given]):
        raise PhysimError("--controller: a name is missing between its commas")
    return make_grid(
        options.worlds, None if options.seeds is None else range(*options.seeds), options.axes,
        names, options.limit, Shard(*options.shard), None if options.yes else MOST_RUNS,
    )  # fmt: skip


def _usual_folder(worlds: tuple[str, ...]) -> Path:
    """``sweeps/`` and the names of the worlds."""
    stems = list(dict.fromkeys(Path(one).stem for one in worlds))
    name = "+".join(stems) if len(stems) <= 3 else f"{stems[0]}+{len(stems) - 1}"
    return Path("sweeps") / name


def _warm_up(options: Options) -> None:
    """Compile the kernels once, before workers would each do so."""
    from physim.campaigns.one_run import ready
    from physim.simulation.run import is_warm

    if not is_warm():
        announce_compiling("controller and distances", COMPILING, options.quiet)
        ready()


def _say(text: str, options: Options) -> None:
    if not options.quiet:
        print(text, file=sys.stderr, flush=True)


def _counts(folder: Path, grid: Grid) -> list[dict[str, Any]]:
    """What came of every cell, with all rows that the folder has of it."""
    from physim.campaigns.rows import FAILED, Shards

    found = {(one.world, one.settings, one.controller): _none(one) for one in grid.cells}
    for row in Shards(folder).read():
        count = found.get((row.world, row.settings, row.controller))
        if count is not None:
            count["runs"] += 1
            count["contact_free"] += row.contact_free
            count["finished"] += row.ended == "finished"
            count["failed"] += row.failed
            if row.ended in FAILED:
                count[row.ended] += 1
    return list(found.values())


def _none(cell: Any) -> dict[str, Any]:
    labels = {"world": cell.world, "settings": cell.settings, "controller": cell.controller}
    counts = ("runs", "contact_free", "finished", "failed", "error", "timeout", "killed")
    return {**labels, **dict.fromkeys(counts, 0)}


def _as_json(
    folder: Path, grid: Grid, tally: Tally, decisions: dict[Label, Decision]
) -> dict[str, Any]:
    cells = _counts(folder, grid)
    for one in cells:
        found = decisions.get((one["world"], one["settings"], one["controller"]))
        one["decision"] = None if found is None else asdict(found)
    return {
        "format": "physim-sweep",
        "version": 1,
        "folder": str(folder),
        "asked": tally.asked,
        "there_before": tally.before,
        "run_now": tally.done,
        "run_elsewhere_meanwhile": tally.elsewhere,
        "interrupted": tally.interrupted,
        "cells": cells,
    }


def _text(folder: Path, grid: Grid, tally: Tally) -> str:
    """A line for each cell, and where the rows are."""
    lines = []
    counts = _counts(folder, grid)
    for one in counts:
        label = ", ".join(one[key] for key in ("world", "settings", "controller") if one[key])
        reasons = [f"{one[key]} {key}" for key in ("error", "timeout", "killed") if one[key]]
        failed = f", {one['failed']} failed ({', '.join(reasons)})" if one["failed"] else ""
        lines.append(
            f"{label}: {plural(one['runs'], 'run')}, {one['contact_free']} contact-free, "
            f"{one['finished']} finished{failed}"
        )
    before = f" ({tally.before} were there before)" if tally.before else ""
    where = shlex.quote(str(folder))
    lines.append(f"{plural(tally.known, 'run')}{before}; rows in {folder}/results.parquet")
    if any(one["contact_free"] < one["runs"] for one in counts):
        lines.append(f"one of them watched: physim replay {where}:ROW")
    return "\n".join(lines) + "\n"
