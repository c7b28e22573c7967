"""Runs in great number: each is done once, and counted when its row is on disk."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from physim.campaigns.cluster import Cluster
from physim.campaigns.folder import UNTIL, Folder, read, read_tree, write_results
from physim.campaigns.grid import Grid
from physim.campaigns.one_run import KEEP, Taken, one_line, ready, row_without_run, take
from physim.campaigns.pool import (
    Job,
    LostError,
    Outcome,
    OverdueError,
    StartError,
    Stop,
    Workers,
    check_guarded,
    never,
    outcomes,
)
from physim.campaigns.rows import ERROR, KILLED, TIMEOUT, Came, Row
from physim.campaigns.spec import Label, RunSpec
from physim.errors import PhysimError
from physim.files import write_text, write_whole
from physim.json_text import json_text
from physim.statistics import CONFIDENCE, Decision, Goal, Watch, read_goal

FLUSH_SECONDS = 0.2
"""[s] after which a row is on disk at the latest"""

Decided = Callable[[Came], bool]
"""Whether enough is known, told what came of one run after the other, in the order of specs"""
Turn = Callable[[Mapping[int, Decision]], int | None]
"""Number of the cell that is next, given what came of the goal in others; None when all is done"""


@dataclass
class Tally:
    """What is known of a sweep."""

    asked: int
    before: int = 0
    """runs whose rows were there already"""
    done: int = 0
    """runs that were done now"""
    with_contacts: int = 0
    failed: int = 0
    interrupted: bool = False
    began: float = field(default_factory=time.monotonic)

    @property
    def known(self) -> int:
        """Runs that have a row."""
        return self.before + self.done

    @property
    def note(self) -> str:
        """Rate, contacts and failures so far, in a few words."""
        rate = self.done / max(time.monotonic() - self.began, 1e-9)
        return f"{rate:.1f} runs/s, {self.with_contacts} with contact, {self.failed} failed"


def silent(_: Tally) -> None:
    """Show no progress."""


def sweep(
    specs: Iterable[RunSpec],
    folder: str | os.PathLike[str],
    executor: Workers,
    *,
    keep: str = "none",
    judged: bool = False,
    retry: bool = False,
    stop: Stop = never,
    progress: Callable[[Tally], None] = silent,
    decided: Decided | None = None,
    beside: bool = False,
) -> Tally:
    """Do all runs that have no row in a folder yet, and write their rows there.

    ``specs`` is gone through several times, so an iterator is listed first; a `Grid` makes its runs
    as they are needed, so that memory does not depend on how many are asked for. ``keep`` is one of
    `physim.campaigns.one_run.KEEP`; with ``judged`` each run is validated, too, those that have a
    row without a verdict again; with ``retry`` runs that failed are done again. ``decided`` is
    asked after every run in the order of ``specs``, whoever was done first; when it says True no
    more runs are begun. ``beside``: the folder may have cells that are not among the specs, and
    lack some that are. A program must call it under ``if __name__ == "__main__":``, since its
    worker processes import it. Raises StartError where it does not, ValueError for another
    ``keep``, TypeError for what is no `RunSpec` or no executor, PhysimError for two worlds that are
    called alike, for the folder of another campaign or one in which another sweep is at work, for
    rows in it that are of none of its runs, and where it cannot be written.
    """
    check_guarded()
    if keep not in KEEP:
        raise ValueError(f"keep = {keep!r}; allowed: {', '.join(KEEP)}")
    if not isinstance(executor, Workers):
        raise TypeError(f"executor = {executor!r}; it must be Processes(2), or as many as you like")
    specs = specs if isinstance(specs, Grid) else _each_once(specs)
    place, tally = Folder(folder), Tally(len(specs))
    asked = specs.asked if isinstance(specs, Grid) and decided is None else None
    place.open(_cells(specs), asked, specs.shard if isinstance(specs, Grid) else (1, 1), beside)
    try:
        _work(place, specs, executor, keep, judged, retry, stop, progress, decided, tally)
        write_results(place.path)
    finally:
        place.close()
    return tally


def sweep_until(
    grid: Grid,
    folder: Path,
    executors: Callable[[], AbstractContextManager[Workers]],
    goal: Goal,
    *,
    confidence: float = CONFIDENCE,
    turn: Turn | None = None,
    keep: str = "none",
    judged: bool = False,
    retry: bool = False,
    stop: Stop = never,
    progress: Callable[[Tally], None] = silent,
) -> tuple[Tally, dict[int, Decision]]:
    """Do the runs of a grid with seeds, cell after cell, each until the goal is decided in it.

    A cell in which nothing is random is run once and decides nothing. ``executors`` makes one for
    each cell, since it has to give up what is under way when a cell is decided. ``turn`` chooses
    the cells; without it all have their turn. ``confidence`` is that of each decision. Returns all
    counts, and what came of the goal in each cell whose runs count, by its number in the grid.
    Raises PhysimError as `sweep` does.
    """
    assert grid.seeds is not None
    place, tally = Folder(folder), Tally(len(grid))
    watches: dict[int, Watch] = {}
    cells = iter(range(len(grid.cells)))
    place.open(grid.cells, None, grid.shard)
    try:
        if len(grid.fixed) < len(grid.cells):
            write_until(folder, Until(goal, grid.seeds[0]))
        while not tally.interrupted:
            known = {k: watch.decision for k, watch in watches.items()}
            k = next(cells, None) if turn is None else turn(known)
            if k is None:
                break
            is_fixed = k in grid.fixed
            part = replace(grid, cells=(grid.cells[k],), fixed=frozenset((0,) if is_fixed else ()))
            watch = None if is_fixed else Watch(goal, confidence)
            if watch is not None:
                watches[k] = watch
            decided = None if watch is None else partial(_decides, watch)
            with executors() as executor:
                _work(place, part, executor, keep, judged, retry, stop, progress, decided, tally)
        write_results(place.path)
    finally:
        place.close()
    return tally, {k: watch.decision for k, watch in watches.items()}


def _decides(watch: Watch, came: Came) -> bool:
    return watch.add(getattr(came, watch.goal.rate))


def _each_once(specs: Iterable[RunSpec]) -> Collection[RunSpec]:
    """The runs in their order, none of them twice."""
    if isinstance(specs, RunSpec | str) or not isinstance(specs, Iterable):
        raise TypeError(f"specs = {specs!r}; it must be a list of what spec_of gives")
    found: dict[tuple[str, Label], RunSpec] = {}
    for spec in specs:
        if not isinstance(spec, RunSpec):
            raise TypeError(f"specs: {spec!r}; each must be what spec_of(world, seed) gives")
        found.setdefault((spec.key, spec.label), spec)
    return found.values()


def _cells(specs: Iterable[RunSpec]) -> Collection[RunSpec]:
    """One spec of each world, settings and controller.

    Raises PhysimError where two are called alike, or one by two names.
    """
    if isinstance(specs, Grid):
        return specs.cells
    cells: dict[Label, RunSpec] = {}
    names: dict[str, Label] = {}
    for one in specs:
        called = ", ".join(filter(None, one.label))
        if cells.setdefault(one.label, one).identity != one.identity:
            raise PhysimError(
                f"two worlds are called {called}, though they, or the code that they run, are not "
                "the same; give each a name or settings of its own, such as "
                'spec_of(world, seed, settings="gain=0.1")'
            )
        if (known := names.setdefault(one.identity, one.label)) != one.label:
            raise PhysimError(
                f"{', '.join(filter(None, known))} and {called} are the same world and "
                "controller, so that their runs would be the same; leave one of them out"
            )
    return cells.values()


def _taken(outcome: Outcome) -> Taken | None:
    """What came of a run, whatever became of its process; None when it was stopped."""
    spec, error = outcome.key, outcome.error
    if error is None:
        taken: Taken | None = outcome.result
        return taken
    if isinstance(error, StartError):
        raise error
    if isinstance(error, OverdueError):
        return Taken(row_without_run(spec, TIMEOUT, f"not done after {spec.limit:g} s"))
    lost = isinstance(error, LostError) or type(error).__name__ == "KilledWorker"
    return Taken(row_without_run(spec, KILLED if lost else ERROR, one_line(error)))


def _work(
    place: Folder, specs: Collection[RunSpec], executor: Workers, keep: str, judged: bool,
    retry: bool, stop: Stop, progress: Callable[[Tally], None], decided: Decided | None,
    tally: Tally,
) -> None:  # fmt: skip
    """Do the runs that have no row, and write their rows, until ``decided`` says that it knows."""
    have: set[str] = set()
    turn = iter(specs if decided is not None else ())
    waits = next(turn, None)  # whose turn it is to decide
    came: dict[str, Came] = {}
    enough = False

    def count(run: str, one: Came) -> None:
        nonlocal waits, enough
        have.add(run)
        tally.failed += one.failed
        tally.with_contacts += not one.failed and not one.contact_free
        if decided is not None:
            came[run] = one
            while not enough and waits is not None and waits.key in came:
                enough = decided(came.pop(waits.key))
                waits = next(turn, None)

    keys = set() if isinstance(specs, Grid) else {spec.key for spec in specs}
    for row in read(place.path):
        label = row.world, row.settings, row.controller
        in_grid = isinstance(specs, Grid) and specs.has(label, row.seed, row.run)
        again = retry if row.failed else judged and not row.verdict
        if (in_grid or row.run in keys) and not again:
            tally.before += 1
            count(row.run, row.came)

    if isinstance(executor, Cluster):  # modules of one's own go to other machines
        executor.carry([source for cell in _cells(specs) for source in cell.sources])
    records = place.records if executor.here else None
    unwritten: list[Row] = []
    written = time.monotonic()

    def jobs() -> Iterator[tuple[RunSpec, Job]]:
        for spec in specs:
            if stop():  # there may be very many that are done
                return
            if spec.key not in have:
                given = spec, keep, records, judged
                yield spec, Job(spec.note, take, given, spec.timer, ready, spec.code)

    def flush(now: bool = False) -> None:
        nonlocal written
        if unwritten and (now or time.monotonic() - written > FLUSH_SECONDS):
            place.rows.write(unwritten)
            unwritten.clear()
            written = time.monotonic()

    def idle(busy: int) -> None:
        flush()
        progress(tally)

    try:
        for outcome in outcomes(jobs(), executor, lambda: stop() or enough, idle):
            if (taken := _taken(outcome)) is not None:
                if taken.image is not None:
                    write_whole(place.path / taken.row.record, taken.image)
                unwritten.append(taken.row)
                tally.done += 1
                count(taken.row.run, taken.row.came)
                idle(0)
    finally:
        flush(now=True)
    progress(tally)
    tally.interrupted = not enough and stop()


FORMAT, VERSION = "physim-until", 1


@dataclass(frozen=True)
class Until:
    """The goal of a campaign, and the seed from which on its runs count, one after the other."""

    goal: Goal
    first: int


def write_until(folder: Path, until: Until) -> None:
    """Say in a campaign's folder what its goal is; runs count from the least first seed on.

    Raises PhysimError where that cannot be written.
    """
    before = read_until(folder)
    first = until.first if before is None else min(until.first, before.first)
    tree = {"format": FORMAT, "version": VERSION, "goal": str(until.goal), "first_seed": first}
    write_text(folder / UNTIL, json_text(tree))


def read_until(folder: Path) -> Until | None:
    """Goal of a campaign; None where it had none. Raises PhysimError for a file of another kind."""
    found = read_tree(folder / UNTIL, FORMAT, VERSION)
    if found is None:
        return None
    first = found.get("first_seed")
    try:
        if not isinstance(first, int) or isinstance(first, bool) or not 0 <= first < 2**63:
            raise ValueError("first_seed: must be a whole number from 0")
        return Until(read_goal(str(found.get("goal"))), first)
    except ValueError as error:
        raise PhysimError(f"{folder / UNTIL}: cannot be read ({error})") from None
