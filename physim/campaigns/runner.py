"""The runner of all that consists of many jobs: it has them done by an executor, whichever it is.

Jobs are begun a few at a time, so that others may come first or follow from what was found, and
only results are kept: memory does not grow with the number of jobs.
"""

from __future__ import annotations

import functools
import os
import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, Executor, Future
from typing import Any, NamedTuple

from physim.campaigns.processes import Processes, worker_count
from physim.campaigns.worker import Job, Stop
from physim.errors import PhysimError

POLL_SECONDS = 0.1
USUAL_SLOTS = 16
"""Jobs that an executor has at a time, where it does not say how many it can do"""

Follow = Callable[[Any, dict[Any, Any]], Iterable[tuple[Any, Job]]]
"""Jobs with their keys that a result makes possible: of its key and all results so far."""


class Outcome(NamedTuple):
    """What came of a job: a result, or an error."""

    key: Any
    job: Job
    result: Any
    """None where it was stopped"""
    error: BaseException | None = None


def outcomes(
    jobs: Iterator[tuple[Any, Job]],
    executor: Executor,
    stop: Stop,
    idle: Callable[[int], None] = lambda busy: None,
) -> Iterator[Outcome]:
    """What comes of jobs, in the order in which they end.

    ``jobs`` is asked for the next one when there is room, until it has none while nothing is under
    way. When ``stop`` says True no job is begun and those under way end early. ``idle`` is called
    now and then with how many are under way.
    """
    ended: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()
    under_way: dict[Future[Any], tuple[Any, Job]] = {}
    room = slots(executor)
    stopped = False
    try:
        while True:
            if not stopped and stop():
                stopped = True
                _halt(executor, under_way)
            while not stopped and len(under_way) < room:
                found = next(jobs, None)
                if found is None:
                    break
                future = begin(executor, found[1])
                under_way[future] = found
                future.add_done_callback(ended.put)
            if not under_way or (stopped and not isinstance(executor, Processes)):
                return
            idle(len(under_way))
            try:
                future = ended.get(timeout=POLL_SECONDS)
            except queue.Empty:
                continue
            key, job = under_way.pop(future)
            outcome = _outcome(key, job, future)
            if outcome is not None:
                yield outcome
            elif not stopped:
                raise PhysimError(
                    "the executor gave up its jobs: is its cluster gone? What is done is kept; the "
                    "same command goes on from there"
                )
    finally:
        for future in under_way:
            future.cancel()


def _halt(executor: Executor, under_way: Iterable[Future[Any]]) -> None:
    """Begin nothing more; what is under way is to end early."""
    for future in list(under_way):
        future.cancel()
    if isinstance(executor, Processes):
        executor.halt()


def _outcome(key: Any, job: Job, future: Future[Any]) -> Outcome | None:
    try:
        return Outcome(key, job, future.result())
    except CancelledError:
        return None
    except Exception as error:
        return Outcome(key, job, None, error)


def slots(executor: Executor) -> int:
    """How many jobs to have under way: as many as are done at a time, and as many in wait."""
    workers = getattr(executor, "workers", None) or getattr(executor, "_max_workers", None)
    return 2 * workers if isinstance(workers, int) else USUAL_SLOTS


def begin(executor: Executor, job: Job) -> Future[Any]:
    """Have a job done, by a process that it may end, whatever the executor is."""
    if isinstance(executor, Processes):
        return executor.begin(job)
    return executor.submit(elsewhere, job)


def elsewhere(job: Job) -> Any:
    """Do a job in a process of the worker that this is called in: that is not ours to end."""
    return _child(os.getpid(), threading.get_ident()).begin(job).result()


@functools.cache
def _child(process: int, thread: int) -> Processes:
    """The process of one thread of a worker, which a fork has not; it stays for the next job."""
    return Processes(1)


def do_all(
    jobs: Iterable[tuple[Any, Job]],
    follow: Follow,
    workers: int,
    stop: Stop,
    progress: Callable[[int, int, str], None],
) -> dict[Any, Any]:
    """Results of jobs by key, with those that follow from them, which come first.

    When ``stop`` says True no job is begun, those in progress end early, and what is done is
    returned. ``progress`` gets done, total and a note. Raises the error of a job, or PhysimError
    where a worker was killed.
    """
    waiting, done = deque(jobs), dict[Any, Any]()
    note = waiting[0][1].note if waiting else ""

    def tell(busy: int) -> None:
        progress(len(done), len(done) + busy + len(waiting), note)

    executor = Processes(min(workers, max(1, len(waiting))))
    try:
        for key, job, result, error in outcomes(_Queue(waiting), executor, stop, tell):
            note = job.note
            if error is not None:
                raise error
            if result is not None:
                done[key] = result
                waiting.extendleft(reversed(list(follow(key, done))))
    finally:
        executor.shutdown(cancel_futures=True)
    return done


class _Queue(Iterator[tuple[Any, Job]]):
    """Takes from the front of a queue that may have more after it was empty."""

    def __init__(self, waiting: deque[tuple[Any, Job]]) -> None:
        self.waiting = waiting

    def __next__(self) -> tuple[Any, Job]:
        """The next one."""
        if not self.waiting:
            raise StopIteration
        return self.waiting.popleft()


class Rate:
    """How many jobs are done a second, since it began."""

    def __init__(self) -> None:
        self.began = time.monotonic()
        self.done = 0

    def __str__(self) -> str:
        """``12.3 a second``."""
        return f"{self.done / max(time.monotonic() - self.began, 1e-9):.1f} a second"


__all__ = ["Job", "Outcome", "Rate", "Stop", "do_all", "elsewhere", "outcomes", "worker_count"]
