"""Sweeps for commands: workers, progress, Ctrl-C."""

from __future__ import annotations

import sys
from collections import Counter
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from physim.cli.progress import Bar, announce_compiling
from physim.errors import PhysimError, plural
from physim.terminal import interrupts

if TYPE_CHECKING:
    from physim.campaigns.grid import Grid
    from physim.campaigns.pool import Workers
    from physim.campaigns.spec import Label
    from physim.campaigns.sweep import Tally
    from physim.statistics import Decision, Goal


def run_grid(
    grid: Grid,
    folder: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    until: Goal | None = None,
    keep: str = "none",
    retry: bool = False,
    quiet: bool = False,
) -> tuple[Tally, dict[Label, Decision]]:
    """Do all runs, or until the goal is decided: then what it came to in each cell.

    An interrupted sweep says on standard error what is done, whatever ``quiet`` is.
    """
    from physim.campaigns.cluster import executor
    from physim.campaigns.sweep import sweep, sweep_until

    def team() -> AbstractContextManager[Workers]:
        return executor(workers, scheduler)

    decisions: dict[Label, Decision] = {}
    with interrupts() as interrupt, Bar("sweep", len(grid), "runs", quiet) as bar:
        how: dict[str, Any] = {
            "keep": keep, "retry": retry, "stop": interrupt,
            "progress": lambda now: bar.count(now.known, now.asked, now.note),
        }  # fmt: skip
        if until is not None:
            if scheduler is None:
                _warm_up(quiet)
            tally, watches = sweep_until(grid, folder, team, until, **how)
            decisions = {label: watch.decision for label, watch in watches.items()}
        else:
            with team() as members:
                if scheduler is None:
                    _warm_up(quiet)
                tally = sweep(grid, folder, members, **how)
    if tally.interrupted:
        left = tally.asked - tally.known
        print(
            f"interrupted: {tally.known:,} of {plural(tally.asked, 'run')} done, {left:,} to go; "
            f"the same command goes on ({folder})", file=sys.stderr,
        )  # fmt: skip
    return tally, decisions


def usual_folder(worlds: tuple[str, ...]) -> Path:
    """``sweeps/`` and the names of the worlds."""
    from physim.world.file.files import stem_of

    stems = list(dict.fromkeys(map(stem_of, worlds)))
    name = "+".join(stems) if len(stems) <= 3 else f"{stems[0]}+{len(stems) - 1}"
    return Path("sweeps") / name


def spare(path: Path | None, option: str, *folders: Path) -> None:
    """Raise PhysimError where a file to be written is a part of a campaign that is read."""
    from physim.campaigns.folder import is_part

    for folder in folders:
        if path is not None and is_part(path, folder):
            raise PhysimError(
                f"{path}: is a part of the campaign in {folder}; {option} takes another file"
            )


def tell_fixed(grid: Grid, quiet: bool) -> None:
    """Say what is to be noted of the worlds, and in which nothing is random."""
    from physim.world.layout.scene_builder import TO_DRAW

    for line in grid.warnings:
        print(f"WARNING  {line}", file=sys.stderr)
    if grid.seeds is None or quiet:
        return
    if fixed := Counter(grid.cells[k].world for k in grid.fixed):
        cells = ", ".join(f"{world} ({plural(n, 'cell')})" for world, n in sorted(fixed.items()))
        print(f"Nothing random in {cells}, run once each; {TO_DRAW}.", file=sys.stderr)


def _warm_up(quiet: bool) -> None:
    """Compile the kernels once, before workers would each do so."""
    from physim.campaigns.one_run import ready
    from physim.simulation.run import is_warm

    if not is_warm():
        announce_compiling("controller and distances", quiet)
        ready()
