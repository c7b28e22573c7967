"""Campaigns that stop when a goal is decided: ``physim sweep --until``, and that it was so."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from physim.campaigns.columns import FINISHED, Brief, Row
from physim.campaigns.folder import UNTIL, Folder, check_version
from physim.campaigns.grid import Grid
from physim.campaigns.one_run import never
from physim.campaigns.rows import write_whole
from physim.campaigns.spec import Label
from physim.campaigns.sweep import Tally, sweep
from physim.campaigns.worker import Stop
from physim.errors import PhysimError
from physim.json_text import file_json
from physim.statistics import Goal, Watch, read_goal

FORMAT, VERSION = "physim-until", 1


@dataclass(frozen=True)
class Until:
    """The goal of a campaign, and the seed from which on its runs count, one after the other."""

    goal: Goal
    first: int


class Decided:
    """Whether the goal is decided in every cell: of the rows of a sweep so far, in its order.

    Within a cell the rows are in the order of seeds, so the answer depends on their outcomes alone,
    not on which was done first. Writes `UNTIL` when it is first asked.
    """

    def __init__(self, folder: Path, until: Until, cells: Collection[Label]) -> None:
        self.folder, self.until = folder, until
        self.watches = {label: Watch(until.goal) for label in cells}
        self.seen = 0

    def __call__(self, rows: Sequence[Brief | Row]) -> bool:
        """Take notice of the rows that are new."""
        if not self.seen:
            write_until(self.folder, self.until)
        for row in rows[self.seen :]:
            self.watches[row.world, row.settings, row.controller].add(
                succeeded(row, self.until.goal.rate)
            )
        self.seen = len(rows)
        return all(watch.decided for watch in self.watches.values())


def sweep_until(
    grid: Grid,
    folder: Path,
    executors: Callable[[], AbstractContextManager[Executor]],
    goal: Goal,
    *,
    keep: str = "none",
    retry: bool = False,
    stop: Stop = never,
    progress: Callable[[Tally], None] = lambda tally: None,
) -> tuple[Tally, dict[Label, Watch]]:
    """Do the runs of a grid with seeds, cell after cell, each until the goal is decided in it.

    A cell in which nothing is random is run once and decides nothing. ``executors`` makes one for
    each cell, since it has to give up what is under way when a cell is decided. Returns all counts,
    and what is known of each cell whose runs count. Raises PhysimError as `sweep` does.
    """
    assert grid.seeds is not None
    Folder(folder).open(grid.cells)
    known = Tally(len(grid))
    watches: dict[Label, Watch] = {}
    for k, cell in enumerate(grid.cells):
        drawn = k not in grid.fixed
        part = replace(grid, cells=(cell,), fixed=frozenset(() if drawn else (0,)))
        label = cell.label
        decided = Decided(folder, Until(goal, grid.seeds[0]), [label]) if drawn else None
        watches |= decided.watches if decided is not None else {}
        tell = partial(_tell, progress, known)
        with executors() as executor:
            now = sweep(
                part, folder, executor, keep=keep, retry=retry, stop=stop, progress=tell,
                decided=decided,
            )  # fmt: skip
        known = _sum(known, now)
        if now.interrupted:
            break
    return known, watches


def _tell(progress: Callable[[Tally], None], known: Tally, now: Tally) -> None:
    progress(_sum(known, now))


def _sum(one: Tally, other: Tally) -> Tally:
    """Counts of two sweeps, of which the first knows how much both are asked for."""
    return replace(
        one, before=one.before + other.before, done=one.done + other.done,
        elsewhere=one.elsewhere + other.elsewhere, failed=one.failed + other.failed,
        with_contacts=one.with_contacts + other.with_contacts, interrupted=other.interrupted,
    )  # fmt: skip


def succeeded(row: Brief | Row, rate: str) -> bool:
    """Whether a run counts as a success for a rate of `physim.statistics.RATES`."""
    if rate == "rate":
        return row.safe
    return row.contact_free if rate == "contact_free" else row.ended == FINISHED


def write_until(folder: Path, until: Until) -> None:
    """Say in a campaign's folder what its goal is; runs count from the least first seed on.

    Raises PhysimError where that cannot be written.
    """
    before = read_until(folder)
    first = until.first if before is None else min(until.first, before.first)
    tree = {"format": FORMAT, "version": VERSION, "goal": str(until.goal), "first_seed": first}
    write_whole(folder / UNTIL, json.dumps(tree, indent=1).encode())


def read_until(folder: Path) -> Until | None:
    """Goal of a campaign; None where it had none. Raises PhysimError for a file of another kind."""
    path = folder / UNTIL
    try:
        found = file_json(path)
        if not isinstance(found, dict) or found.get("format") != FORMAT:
            raise ValueError("another format")
        check_version(path, found.get("version"), VERSION)
        first = found.get("first_seed")
        if not isinstance(first, int) or isinstance(first, bool) or not 0 <= first < 2**63:
            raise ValueError("first_seed: must be a whole number from 0")
        return Until(read_goal(str(found.get("goal"))), first)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise PhysimError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise PhysimError(f"{path}: cannot be read ({error})") from None
