"""``physim sweep``: many runs, each counted once it is on disk."""

from __future__ import annotations

import sys
from collections import Counter
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from physim.cli.options import Out, Output, Seeds, Words, Workers, Worlds, kind, real
from physim.cli.progress import Bar
from physim.cli.simulating import tell
from physim.errors import PhysimError, plural
from physim.json_text import json_text
from physim.terminal import INTERRUPTED, interrupts

if TYPE_CHECKING:
    from physim.campaigns.spec import Label
    from physim.statistics import Decision

DISAGREE = 3
MOST_SHARDS = 100_000


def shard(text: str) -> tuple[int, int]:
    """Read I/N. Raises ValueError with what is allowed."""
    first, _, of = text.partition("/")
    number, count = (int(one) if one.isascii() and one.isdigit() else 0 for one in (first, of))
    if not 1 <= number <= count <= MOST_SHARDS:
        raise ValueError("I/N, part I of N, as 1/8 to 8/8")
    return number, count


def goal(text: str) -> object:
    """Read a goal. Raises ValueError with what is allowed and where the fault is."""
    from physim.statistics import read_goal

    return read_goal(text)


def sweep(
    *worlds: Worlds,
    seeds: Seeds | None = None,
    set: tuple[str, ...] = (),
    controller: Words = (),
    output: Output | None = None,
    workers: Workers | None = None,
    scheduler: str | None = None,
    until: Annotated[Any, kind(goal)] = None,
    shard: Annotated[tuple[int, int], kind(shard)] = (1, 1),
    keep: Literal['none', 'failed', 'all'] = 'none',
    limit: Annotated[float | None, kind(real(0.1, 1e7))] = None,
    validate: bool = False,
    retry: bool = False,
    yes: bool = False,
    parquet: bool = False,
    json: bool = False,
    quiet: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Run every combination of worlds, seeds, values and controllers, and write one row for each
    run to DIR. Runs that have a row are not run again: repeat the command to continue after an
    interruption, or with more seeds to add runs. Several sweeps at once in one DIR need --shard.

    options:
      --seeds A:B  run each world with the seeds A to B - 1 (default: its own seed)
      --set KEY=V1,V2  run with each of these values, e.g. controller.beta=0.3,0.5 (for controllers
          that have this key); may be repeated: every combination is run
      --controller NAME,...  run with each of these controllers: registered ones (physim list), or
          your own as module:Class
      -o, --output DIR  folder (default: sweeps/WORLD)
      --workers N  processes on this machine (as many as cores, at most 8)
      --scheduler ADDRESS  run on a Dask cluster, e.g. tcp://10.0.0.1:8786, which must answer in 5 s
          and have a worker in 30 s
      --until GOAL  stop when the answer is known: is "rate > 0.99"? (rate: contact-free and
          finished; also contact_free, finished); or when the interval of rate is narrow enough,
          e.g. 0.02 wide; --seeds is the maximum
      --shard I/N  run only part I of N parts
      --keep WHICH  which records to keep in DIR/records: none, failed (with contacts), all (none)
      --limit SECONDS  end a run that takes longer (default: 2 min plus 1 ms for each robot and
          step)
      --validate  check every run as physim validate does, and write the columns verdict and
          unexplained
      --retry  run again the runs that crashed: by an error, at their limit, or killed
      --yes  allow more than a million runs
      --parquet  also write results.parquet (needs physim[study]); without this option an old
          results.parquet is removed
      --json  print the counts as JSON instead
      --quiet  print no progress and no counts

    written to DIR:
      results.csv     one row per run: ended, contacts, distances, ... (for spreadsheet, pandas, R)
      records/        the records kept by --keep; physim replay makes any other one again
      rows/, worlds/  rows in the order in which runs end; the worlds that were run; campaign.json

    a run that crashes (by an error, at its limit, killed) has a row, too, with the reason

    exit codes:
      0    all runs have a row, whatever the results
      2    bad input; nothing that was written is lost
      3    with --validate: the checks disagree in some run
      130  interrupted (Ctrl-C, SIGTERM): finished runs are kept; the same command continues

    examples:
      physim sweep ten_robots --seeds 1:101
      physim sweep ten_robots nonconvex --seeds 1:101 --controller mode_switching,path_following
      physim sweep my_world.yaml --seeds 0:50 --set formation.gain=0.02,0.05,0.1 -o gains
      physim sweep ten_robots --seeds 0:10000 --until "rate > 0.99"
      physim sweep ten_robots --seeds 0:100000 --scheduler tcp://10.0.0.1:8786
    """
    from physim.campaigns.cluster import executor
    from physim.campaigns.folder import PARQUET, read
    from physim.campaigns.grid import MOST_RUNS, Shard, make_grid
    from physim.campaigns.outcomes import Outcomes
    from physim.campaigns.report.swept import decided_text, disagreeing, sweep_text, sweep_values
    from physim.campaigns.sweep import sweep as do_runs
    from physim.campaigns.sweep import sweep_until
    from physim.world.file.files import stem_of
    from physim.world.layout.scene_builder import TO_DRAW

    if parquet:
        from physim.campaigns.parquet import write_parquet  # where it cannot be had nothing is run
    if workers is not None and scheduler is not None:
        raise PhysimError("--workers: cannot be combined with --scheduler, which has its own")
    if until is not None and seeds is None:
        raise PhysimError("--until: needs --seeds A:B, the seeds that may be run for it")
    if until is not None and shard[1] > 1:
        raise PhysimError(
            "--until: cannot be combined with --shard, which runs only some of the seeds"
        )
    grid = make_grid(
        worlds, seeds, set, controller, limit, Shard(*shard), None if yes else MOST_RUNS
    )
    stems = list(dict.fromkeys(map(stem_of, worlds)))
    name = "+".join(stems) if len(stems) <= 3 else f"{stems[0]}+{len(stems) - 1}"
    folder = output or Path("sweeps") / name
    tell(grid.warnings)
    fixed = Counter(grid.cells[k].world for k in grid.fixed)
    if fixed and seeds is not None and not quiet:
        cells = ", ".join(f"{world} ({plural(n, 'cell')})" for world, n in sorted(fixed.items()))
        print(f"Nothing is random in {cells}: each runs once; {TO_DRAW}.", file=sys.stderr)
    decisions: dict[Label, Decision] = {}
    with interrupts() as interrupt, Bar("sweep", len(grid), "runs", quiet) as bar:
        team = partial(executor, workers, scheduler)
        how: dict[str, Any] = {
            "keep": keep, "judged": validate, "retry": retry, "stop": interrupt,
            "progress": lambda now: bar.count(now.known, now.asked, now.note),
        }  # fmt: skip
        if until is None:
            with team() as members:
                tally = do_runs(grid, folder, members, **how)
        else:
            tally, by_number = sweep_until(grid, folder, team, until, **how)
            decisions = {grid.cells[k].label: one for k, one in by_number.items()}
    if tally.interrupted:
        print(
            f"interrupted: {tally.known:,} of {plural(tally.asked, 'run')} done, "
            f"{tally.asked - tally.known:,} to go; the same command goes on ({folder})",
            file=sys.stderr,
        )
    if keep != "none" and tally.before:
        print(
            f"{plural(tally.before, 'run')} had a row already: --keep is of runs that are done now "
            "(physim replay makes any other again)", file=sys.stderr,
        )  # fmt: skip
    draws, found = {cell.label: cell.draws for cell in grid.cells}, Outcomes(read(folder))
    if parquet:
        write_parquet(found.rows, folder / PARQUET)
    if json:
        values = sweep_values(folder, found, draws, tally, decisions)
        print(json_text(values), end="", file=out)
    elif not quiet:
        print(sweep_text(folder, found, draws, tally), end="")
        print("".join(decided_text(label, one, until) for label, one in decisions.items()), end="")
    wrong = disagreeing(found) if validate else []
    for line in wrong:
        print(line, file=sys.stderr)
    if validate and not (wrong or json or quiet):
        judged = sum(bool(row.verdict) for row in found.rows)
        which = (
            "every run" if judged == len(found) else f"{judged:,} of {plural(len(found), 'run')}"
        )
        agree = f"physics and geometry agree in {which}" if judged else "no run came to its end"
        print(f"validated: {agree}")
    return INTERRUPTED if tally.interrupted else DISAGREE if wrong else 0
