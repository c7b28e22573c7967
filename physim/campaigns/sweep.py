"""Runs in great number: by any executor, each once, each counted when its row is on disk."""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

from physim.campaigns.columns import ERROR, KILLED, TIMEOUT, Brief, Row, briefs
from physim.campaigns.folder import Claims, Folder
from physim.campaigns.grid import Grid
from physim.campaigns.one_run import KEEP, Taken, never, one_line, ready, row_without_run, take
from physim.campaigns.processes import Processes, check_guarded
from physim.campaigns.reading import check_rows, write_results
from physim.campaigns.rows import write_whole
from physim.campaigns.runner import POLL_SECONDS, Outcome, outcomes
from physim.campaigns.spec import Label, RunSpec
from physim.campaigns.worker import Job, LostError, OverdueError, StartError, Stop
from physim.errors import PhysimError
from physim.escaping import escaped

FLUSH_SECONDS = 0.2
"""[s] after which a row is on disk at the latest"""

Decided = Callable[[list[Brief | Row]], bool]
"""Whether enough is known: of the rows of the first specs, in their order"""


@dataclass
class Tally:
    """What is known of a sweep."""

    asked: int
    before: int = 0
    """runs whose rows were there already"""
    done: int = 0
    """runs that were done now"""
    elsewhere: int = 0
    """runs that another sweep did meanwhile"""
    with_contacts: int = 0
    failed: int = 0
    interrupted: bool = False
    decided: int | None = None
    """how many of the first runs decided what was asked"""
    began: float = field(default_factory=time.monotonic)

    def add(self, row: Brief | Row) -> None:
        """Count a row."""
        self.failed += row.failed
        self.with_contacts += not row.failed and not row.contact_free

    @property
    def known(self) -> int:
        """Runs that have a row."""
        return self.before + self.done + self.elsewhere

    @property
    def note(self) -> str:
        """Rate, contacts and failures so far, in a few words."""
        rate = self.done / max(time.monotonic() - self.began, 1e-9)
        return f"{rate:.1f} runs/s, {self.with_contacts} with contact, {self.failed} failed"


def runs(
    specs: Iterable[RunSpec], executor: Executor, stop: Stop = never
) -> Iterator[tuple[RunSpec, Row]]:
    """Rows of runs, in the order in which they end; nothing is written.

    ``specs`` may be a generator that makes the next run of what was found before.
    """
    jobs = ((spec, job_of(spec, "none", None)) for spec in specs)
    for outcome in outcomes(jobs, executor, stop):
        taken = _taken(outcome)
        if taken is not None:
            yield outcome.key, taken.row


def sweep(
    specs: Iterable[RunSpec],
    folder: str | os.PathLike[str],
    executor: Executor,
    *,
    keep: str = "none",
    retry: bool = False,
    stop: Stop = never,
    progress: Callable[[Tally], None] = lambda tally: None,
    decided: Decided | None = None,
) -> Tally:
    """Do all runs that have no row in a folder yet, and write their rows there.

    ``specs`` is gone through several times, so an iterator is listed first; a `Grid` makes its runs
    as they are needed, so that memory does not depend on how many are asked for. ``keep`` is one of
    `physim.campaigns.one_run.KEEP`; with ``retry`` runs that failed are done again. ``decided`` is
    asked after every row in the order of ``specs``, whoever was done first; when it says True no
    more runs are begun. A
    program must call it under ``if __name__ == "__main__":``, since its worker processes import it.
    Raises StartError where it does not, ValueError for another ``keep``, TypeError for what is no
    `RunSpec` or no executor, PhysimError for two worlds that are called alike, for the
    folder of another campaign, for rows in it that are of none of its runs, and where it cannot be
    written.
    """
    check_guarded()
    if keep not in KEEP:
        raise ValueError(f"keep = {keep!r}; allowed: {', '.join(KEEP)}")
    if not isinstance(executor, Executor):
        raise TypeError(f"executor = {executor!r}; it must be one, such as Processes(2)")
    specs = specs if isinstance(specs, Grid) else _each_once(specs)
    place = Folder(folder)
    asked = specs.asked if isinstance(specs, Grid) and decided is None else None
    place.open(_cells(specs), asked)
    check_rows(place)
    work = _Sweep(place, specs, executor, keep, retry, decided)
    try:
        work.go(stop, progress)
    finally:
        work.close()
    write_results(place.path)  # it checks the rows, of which each run keeps one
    place.shards.put_together()
    return work.tally


def job_of(spec: RunSpec, keep: str, records: Path | None) -> Job:
    """A run as a job for a worker."""
    return Job(spec.note, take, (spec, keep, records), spec.timer, ready, spec.code)


def _each_once(specs: Iterable[RunSpec]) -> Collection[RunSpec]:
    """The runs in their order, none of them twice."""
    if isinstance(specs, RunSpec | str) or not isinstance(specs, Iterable):
        raise TypeError(f"specs = {specs!r}; it must be a list of what spec_of gives")
    runs: dict[tuple[str, Label], RunSpec] = {}
    for spec in specs:
        if not isinstance(spec, RunSpec):
            raise TypeError(f"specs: {spec!r}; each must be what spec_of(world, seed) gives")
        runs.setdefault((spec.key, spec.label), spec)
    return runs.values()


def _cells(specs: Iterable[RunSpec]) -> Iterable[RunSpec]:
    """One spec of each world, settings and controller.

    Raises PhysimError where two are called alike, or one by two names.
    """
    if isinstance(specs, Grid):
        return specs.cells
    cells: dict[Label, RunSpec] = {}
    names: dict[str, Label] = {}
    for one in specs:
        called = escaped(", ".join(filter(None, one.label)))
        if cells.setdefault(one.label, one).identity != one.identity:
            raise PhysimError(
                f"two worlds are called {called}, though they, or the code that they run, are not "
                "the same; give each a name or settings of its own, such as "
                'spec_of(world, seed, settings="gain=0.1")'
            )
        if (known := names.setdefault(one.identity, one.label)) != one.label:
            raise PhysimError(
                f"{escaped(', '.join(filter(None, known)))} and {called} are the same world and "
                "controller, so that their runs would be the same; leave one of them out"
            )
    return cells.values()


def _membership(specs: Collection[RunSpec]) -> Callable[[Brief], bool]:
    """Whether a row is of one of the runs; a grid knows that without making them all."""
    if isinstance(specs, Grid):
        return lambda row: specs.has((row.world, row.settings, row.controller), row.seed, row.run)
    keys = {spec.key for spec in specs}
    return lambda row: row.run in keys


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
    if isinstance(error, LostError) or type(error).__name__ == "KilledWorker":
        return Taken(row_without_run(spec, KILLED, one_line(error)))
    return Taken(row_without_run(spec, ERROR, one_line(error)))


class _Sweep:
    """The state of one sweep."""

    def __init__(
        self,
        place: Folder,
        specs: Collection[RunSpec],
        executor: Executor,
        keep: str,
        retry: bool,
        decided: Decided | None,
    ) -> None:
        self.place, self.specs, self.executor, self.keep = place, specs, executor, keep
        self.tally = Tally(len(specs))
        self.asked = decided
        self.claims = Claims(place.path)
        self.unwritten: list[Row] = []
        self.written = time.monotonic()
        self.stop: Stop = never
        self.is_wanted = _membership(specs)
        self.read: set[str] = set()
        """shards that are known"""
        self.have: set[str] = set()
        """keys of runs that need not be done"""
        self.failed: set[str] = set()
        """those of them that failed"""
        self.again = retry
        self.rows: dict[str, Brief | Row] = {}
        """of runs whose turn to decide has not come"""
        self.in_order: list[Brief | Row] = []
        self.turn = iter(specs) if decided is not None else iter(())
        self.next = next(self.turn, None)
        self.theirs: deque[RunSpec] = deque()
        """runs that another sweep has under way"""

    def go(self, stop: Stop, progress: Callable[[Tally], None]) -> None:
        """Do what is to be done; what others have under way is waited for."""
        self.stop = stop
        self._look()
        self.tally.before, self.tally.elsewhere = self.tally.elsewhere, 0
        self.again = False
        todo: Iterator[RunSpec] = iter(self.specs)

        def ends() -> bool:
            return stop() or self.tally.decided is not None

        def idle(busy: int) -> None:
            self._flush()
            progress(self.tally)

        while True:
            jobs = self._jobs(todo)
            for outcome in outcomes(jobs, self.executor, ends, idle):
                taken = _taken(outcome)
                if taken is None:
                    continue
                self._add(taken)
                progress(self.tally)
            self._flush(now=True)
            if ends() or not self.theirs:
                break
            time.sleep(POLL_SECONDS)
            self._look()
            todo, self.theirs = iter(self.theirs), deque()
        progress(self.tally)
        self.tally.interrupted = self.tally.decided is None and stop()

    def close(self) -> None:
        """Write what is left, and let others have what was claimed."""
        try:
            self._flush(now=True)
        finally:
            self.claims.close()

    def _jobs(self, todo: Iterable[RunSpec]) -> Iterator[tuple[RunSpec, Job]]:
        """Runs that nobody has done or has under way; those of others are put aside."""
        records = self.place.records if isinstance(self.executor, Processes) else None
        for spec in todo:
            if self.stop():  # there may be very many that are done
                return
            key = spec.key
            if key in self.have:
                continue
            if not self.claims.take(key):
                self.theirs.append(spec)
                continue
            self._look()  # whoever gave it back may have done it
            if key in self.have:
                self.claims.give_back(key)
                continue
            yield spec, job_of(spec, self.keep, records)

    def _look(self) -> None:
        """Take notice of rows that others wrote."""
        for row in chain.from_iterable(map(briefs, self.place.shards.tables(self.read))):
            if self.stop():
                return
            if not self.is_wanted(row) or (self.again and row.failed):
                continue
            if row.run not in self.have:
                self.tally.elsewhere += 1
                self._count(row)
            elif row.run in self.failed and not row.failed:  # it was done again
                self.tally.failed -= 1
                self._count(row)
        self._decide()

    def _add(self, taken: Taken) -> None:
        row = taken.row
        if taken.image is not None:
            write_whole(self.place.path / row.record, taken.image)
        self.unwritten.append(row)
        self.tally.done += 1
        self._count(row)
        self._decide()
        self._flush()

    def _count(self, row: Brief | Row) -> None:
        self.have.add(row.run)
        (self.failed.add if row.failed else self.failed.discard)(row.run)
        self.tally.add(row)
        if self.asked is not None:
            self.rows[row.run] = row

    def _decide(self) -> None:
        """Ask whether the runs whose turn it is decide."""
        while self.asked is not None and self.next is not None and self.next.key in self.rows:
            self.in_order.append(self.rows.pop(self.next.key))
            self.next = next(self.turn, None)
            if self.tally.decided is None and self.asked(self.in_order):
                self.tally.decided = len(self.in_order)

    def _flush(self, now: bool = False) -> None:
        """Put rows on disk when it is time; the runs are claimed until then."""
        if not self.unwritten or not (now or time.monotonic() - self.written > FLUSH_SECONDS):
            return
        rows, self.unwritten = self.unwritten, []
        self.read.update(self.place.shards.write(rows))
        self.written = time.monotonic()
        for row in rows:
            self.claims.give_back(row.run)


__all__ = ["Tally", "job_of", "runs", "sweep"]
