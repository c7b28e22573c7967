"""Do jobs in worker processes; stop cleanly when asked to."""

from __future__ import annotations

import multiprocessing
import os
import signal
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from physim.errors import PhysimError

POLL_SECONDS = 0.1
LAST_SECONDS = 10.0
"""[s] A worker has to end once it is asked to; then it is killed."""
MOST_WORKERS = 8

Stop = Callable[[], bool]
"""Whether to end early."""


@dataclass(frozen=True)
class Job:
    """A piece of work for a worker process."""

    note: str
    """a few words for a progress bar"""
    work: Callable[..., Any]
    """module-level function of what is given and of a `Stop`; its result is None when stopped"""
    given: tuple[Any, ...] = ()

    def do(self, stop: Stop) -> Any:
        """Result of the work."""
        return self.work(*self.given, stop)


Follow = Callable[[Any, dict[Any, Any]], Iterable[tuple[Any, Job]]]
"""Jobs with their keys that a result makes possible: of its key and all results so far."""


def worker_count() -> int:
    """Cores that this process may use, at most `MOST_WORKERS`."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return max(1, min(cores or 1, MOST_WORKERS))


def do_all(
    jobs: Iterable[tuple[Any, Job]],
    follow: Follow,
    workers: int,
    stop: Stop,
    progress: Callable[[int, int, str], None],
) -> dict[Any, Any]:
    """Results of jobs by key, with those that follow from them, which come first.

    A worker has one job at a time and only results are kept, so memory does not grow with the
    number of jobs. When ``stop`` says True no job is begun, those in progress end early, and what
    is done is returned. ``progress`` gets done, total and a note. Raises PhysimError of a job, or
    where a worker was killed.
    """
    waiting, done = deque(jobs), dict[Any, Any]()
    with _workers(min(workers, max(1, len(waiting)))) as (team, halt):
        while any(one.job for one in team) or (waiting and not halt.is_set()):
            for one in team:
                if one.job is None and waiting and not halt.is_set():
                    one.begin(*waiting.popleft())
            busy = [one for one in team if one.job is not None]
            notes = [one.job.note for one in busy if one.job is not None]
            progress(len(done), len(done) + len(busy) + len(waiting), notes[0] if notes else "")
            ready = wait([one.pipe for one in busy], POLL_SECONDS)
            for one in busy:
                if one.pipe in ready:
                    key, result = one.end()
                    if result is not None:
                        done[key] = result
                        waiting.extendleft(reversed(list(follow(key, done))))
            if stop():
                halt.set()
    return done


@dataclass
class _Worker:
    """A process, the pipe to it, and what it does at the moment."""

    process: Any
    pipe: Connection
    key: Any = None
    job: Job | None = None

    def begin(self, key: Any, job: Job) -> None:
        """Give it a job; where its process is gone, `end` says so."""
        self.key, self.job = key, job
        with suppress(OSError):
            self.pipe.send(job)

    def end(self) -> tuple[Any, Any]:
        """Key and result of its job. Raises the error of the job."""
        try:
            answer = self.pipe.recv()
        except (EOFError, OSError):
            note = "" if self.job is None else f" at {self.job.note}"
            raise PhysimError(f"a worker process was killed{note}: out of memory?") from None
        if isinstance(answer, Exception):
            raise answer
        self.job = None
        return self.key, answer


@contextmanager
def _workers(count: int) -> Iterator[tuple[list[_Worker], Any]]:
    """Processes that wait for jobs, and the event that makes them stop; ended on leaving."""
    context = multiprocessing.get_context("spawn")
    halt = context.Event()
    team = []
    try:
        for _ in range(count):
            ours, theirs = context.Pipe()
            process = context.Process(target=_work, args=(theirs, halt), daemon=True)
            process.start()
            theirs.close()
            team.append(_Worker(process, ours))
        yield team, halt
    finally:
        halt.set()
        for one in team:
            one.pipe.close()
        for one in team:
            one.process.join(LAST_SECONDS)
            if one.process.is_alive():
                one.process.kill()


def _work(pipe: Connection, halt: Any) -> None:
    """Do jobs until the other end of the pipe is closed or gone."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)  # Ctrl-C reaches all; the parent says what follows
    while True:
        try:
            job: Job = pipe.recv()
        except (EOFError, OSError):
            return
        answer: Any
        try:
            answer = job.do(halt.is_set)
        except PhysimError as error:
            answer = PhysimError(str(error))
        except OSError as error:  # disk full, folder gone
            answer = PhysimError(f"{job.note}: {error.strerror or error}")
        except Exception:
            answer = RuntimeError(f"{job.note}:\n{traceback.format_exc()}")
        try:
            pipe.send(answer)
        except OSError:
            return
