"""Worker processes on this machine, as an `Executor` that outlives its workers.

A job that kills its process, or that goes on beyond its limit, ends with an error of its own;
another process takes the next job.

A `ProcessPoolExecutor` is broken by the first worker that is killed, and knows no limits."""

from __future__ import annotations

import math
import multiprocessing
import os
import signal
import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import Executor, Future
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.reduction import ForkingPickler
from multiprocessing.util import Finalize
from operator import index
from typing import Any, SupportsIndex

from physim.campaigns.kinship import (
    WORKER,
    begun_apart,
    children_allowed,
    end_if_importing,
    is_importing,
    no_file,
)
from physim.campaigns.worker import (
    BEGINS,
    READY,
    Job,
    LostError,
    OverdueError,
    StartError,
    Stop,
    do_jobs,
)
from physim.errors import PhysimError

LAST_SECONDS = 10.0
"""[s] A worker has to end once it is asked to; then it is killed."""
LOOK_SECONDS = 1.0
"""[s] between looks whether the busy are alive: what they forked may keep their pipes open"""
POLL_SECONDS = 0.01
GRACE_SECONDS = 5.0
"""[s] beyond its limit a worker is killed from outside, where its own timer did not end it."""
MOST_WORKERS = 8
NOT_STARTED = "worker processes cannot be started"
UNGUARDED = '; in a program of your own the runs must be begun under if __name__ == "__main__":'


def worker_count() -> int:
    """Cores that this process may use, at most `MOST_WORKERS`."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return max(1, min(cores or 1, MOST_WORKERS))


def check_guarded() -> None:
    """Let a program begin no runs while a process that it began only imports it.

    A worker of ours ends there; raises StartError in a process of another.
    """
    end_if_importing()
    if is_importing():
        raise StartError(NOT_STARTED + UNGUARDED)


class Processes(Executor):
    """Up to ``workers`` processes at work, begun when there is work and ended by `shutdown`.

    One that has run a controller of one's own waits for more of the same: another controller's runs
    would not be what they are alone where the first has changed a library, or a limit. Raises
    ValueError for less than one process.
    """

    def __init__(self, workers: int) -> None:
        if not isinstance(workers, SupportsIndex) or isinstance(workers, bool) or workers < 1:
            raise ValueError(f"workers = {workers!r}; it must be a whole number of processes")
        self.workers = index(workers)
        self._context = multiprocessing.get_context("spawn")
        self._halt = self._context.RawValue("b", 0)
        self._lock = threading.Lock()
        self._waiting: deque[tuple[Future[Any], Job]] = deque()
        self._team: list[_Worker] = []
        self._gone: list[Any] = []
        self._woken, self._wake = self._context.Pipe(duplex=False)
        self._thread: threading.Thread | None = None
        self._at_exit: Finalize | None = None
        self._ends = False

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """As any executor does it; ``fn`` is a module-level function."""
        return self.begin(Job(getattr(fn, "__name__", "a job"), _plainly, (fn, args, kwargs)))

    def begin(self, job: Job) -> Future[Any]:
        """Have a job done. Its future may raise `LostError`, `OverdueError` or what it raised."""
        check_guarded()
        future: Future[Any] = Future()
        with self._lock:
            if self._ends:
                raise RuntimeError("the executor was shut down")
            self._waiting.append((future, job))
            if self._thread is None:
                self._thread = threading.Thread(target=self._serve, daemon=True)
                self._thread.start()
                # without a `shutdown` it ends with the program: workers do not hear TERM
                last = {"cancel_futures": True}
                self._at_exit = Finalize(None, self.shutdown, (), last, exitpriority=0)
        self._wake.send_bytes(b"1")
        return future

    def halt(self) -> None:
        """Tell all jobs to end early."""
        self._halt.value = 1
        with suppress(OSError):
            self._wake.send_bytes(b"2")

    @property
    def ids(self) -> list[int]:
        """Numbers of the worker processes."""
        return [one.process.pid for one in self._team if one.process.pid is not None]

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Begin no more jobs; end the workers after those that were begun, or at once.

        With ``cancel_futures`` jobs under way are told to end early, and their processes killed
        where they do not.
        """
        with self._lock:
            self._ends = True
            if self._at_exit is not None:
                self._at_exit.cancel()
            if cancel_futures:
                self.halt()
                for future, _ in self._waiting:
                    future.cancel()
                self._waiting.clear()
        with suppress(OSError):
            self._wake.send_bytes(b"0")
        if wait and self._thread is not None:
            self._thread.join()

    def _serve(self) -> None:
        """Hand out jobs and collect what came of them, until all is done and no more may come."""
        given_up: float | None = None
        try:
            while True:
                with self._lock:
                    self._hand_out()
                    ends = self._ends and not self._waiting
                busy = [one for one in self._team if one.job is not None]
                if ends and not busy:
                    return
                if self._halt.value:
                    given_up = given_up or time.monotonic() + LAST_SECONDS
                for one in self._ready(busy, given_up):
                    error = one.end(bool(self._halt.value))
                    if isinstance(error, StartError):  # nor could another
                        with self._lock:
                            self._refuse(error)
                    if one.gone:
                        self._team.remove(one)
        finally:
            for one in self._team:
                one.pipe.close()  # then it ends
            for process in (*self._gone, *(one.process for one in self._team)):
                _end(process, LAST_SECONDS)

    def _hand_out(self) -> None:
        """Give jobs to those who have none, and begin processes where there are more jobs."""
        while self._waiting and sum(one.job is not None for one in self._team) < self.workers:
            one = self._free_for(self._waiting[0][1].code)
            if one is not None and not one.process.is_alive():
                self._team.remove(one)
                continue
            if one is None:
                if len(self._team) > 2 * self.workers:
                    self._dismiss(next(one for one in self._team if one.job is None))
                try:
                    one = _Worker.begun(self._context, self._halt)
                except RuntimeError as error:  # as the interpreter ends
                    self._refuse(StartError(f"{NOT_STARTED} ({error})"))
                    return
                except OSError as error:  # of files, processes or memory there are no more
                    if not self._team:  # else those that are there do it later
                        self._refuse(StartError(f"{NOT_STARTED} ({error.strerror or error})"))
                        return
                    if all(one.job is None for one in self._team):
                        self._dismiss(self._team[0])
                        continue
                    return
                self._team.append(one)
            future, job = self._waiting.popleft()
            if not future.set_running_or_notify_cancel():
                continue
            try:
                packed = ForkingPickler.dumps(job)
            except Exception as error:
                future.set_exception(RuntimeError(f"{job.note} cannot be sent: {error}"))
                continue
            one.begin(future, job, packed)

    def _free_for(self, code: str) -> _Worker | None:
        """A process without a job that has run no other code than this, or else none at all."""
        free = [one for one in self._team if one.job is None and one.code in (code, "")]
        return max(free, key=lambda one: one.code == code, default=None)

    def _dismiss(self, one: _Worker) -> None:
        """Let a process without a job go."""
        self._team.remove(one)
        one.pipe.close()
        self._gone.append(one.process)

    def _refuse(self, error: StartError) -> None:
        """Let the jobs that wait fail."""
        while self._waiting:
            future, _ = self._waiting.popleft()
            if future.set_running_or_notify_cancel():
                future.set_exception(error)

    def _ready(self, busy: list[_Worker], given_up: float | None) -> list[_Worker]:
        """Workers that have something to say or are to say nothing more; waits for one."""
        dues = [one.due for one in busy if one.due is not None]
        dues += [] if given_up is None else [given_up]
        dues += [time.monotonic() + LOOK_SECONDS] if busy else []
        left = None if not dues else max(0.0, min(dues) - time.monotonic())
        ready = wait([self._woken, *(one.pipe for one in busy)], left)
        if self._woken in ready:
            self._woken.recv_bytes()
        now = time.monotonic()
        late = [
            one
            for one in busy
            if min(one.due or math.inf, given_up or math.inf) <= now
            or (given_up is not None and not one.ready)  # it still starts: nothing is lost
        ]
        for one in late:
            _end(one.process, 0.0)
        return [one for one in busy if one.pipe in ready or not one.process.is_alive()]


@dataclass
class _Worker:
    """A process, the pipe to it, and what it does at the moment."""

    process: Any
    pipe: Connection
    job: Job | None = None
    future: Future[Any] | None = None
    due: float | None = None
    """[s] on the monotonic clock when its job is given up"""
    ready: bool = False
    """it has said that it is there"""
    gone: bool = False
    code: str = ""
    """that of its jobs so far, beside physim's"""

    @classmethod
    def begun(cls, context: Any, halt: Any) -> _Worker:
        """A new process that waits for jobs."""
        ours, theirs = context.Pipe()
        process = context.Process(target=do_jobs, name=WORKER, args=(theirs, halt), daemon=True)
        with children_allowed(), begun_apart():
            process.start()
        theirs.close()
        return cls(process, ours)

    def begin(self, future: Future[Any], job: Job, packed: Any) -> None:
        """Give it a job; where its process is gone, `end` says so."""
        self.future, self.job, self.code = future, job, job.code
        with suppress(OSError):
            self.pipe.send_bytes(packed)

    def end(self, halted: bool) -> BaseException | None:
        """Take what came of its job: of one that was lost after a halt, that it was stopped.

        Gives the error that it came to, if any.
        """
        future, job = self.future, self.job
        assert future is not None
        assert job is not None
        try:
            if not self.pipe.poll():  # it is gone, and what it forked keeps its end open
                raise EOFError
            answer = self.pipe.recv()
            if answer == READY:
                self.ready = True
                return None
            if answer == BEGINS:
                limit = job.limit or 0.0
                self.due = time.monotonic() + limit + GRACE_SECONDS
                return None
            done, found = answer
        except Exception:  # it is gone, or what it does wrote into the pipe
            self.gone = True
            _end(self.process, LOOK_SECONDS)
            done, found = (True, None) if halted else (False, self._lost(job))
        self.job = self.future = self.due = None
        if done:
            future.set_result(found)
            return None
        error: BaseException = found
        future.set_exception(error)
        return error

    def _lost(self, job: Job) -> PhysimError:
        """Why a process that did a job is no more."""
        code = self.process.exitcode
        if not self.ready and code is not None and code >= 0:
            return StartError(f"{NOT_STARTED} (exit code {code}){no_file() or UNGUARDED}")
        if job.limit is not None and (
            code == -signal.SIGALRM or (self.due is not None and self.due <= time.monotonic())
        ):
            return OverdueError(f"{job.note}: not done after {job.limit:g} s")
        how = f"exit code {code}" if code is None or code >= 0 else signal.Signals(-code).name
        hint = ": out of memory?" if code in (-signal.SIGKILL, None) else ""
        return LostError(f"a worker process was killed at {job.note} ({how}){hint}")


def _end(process: Any, within: float) -> None:
    """Return when a process is gone, which is killed unless it ends within some seconds.

    ``join`` would wait for one that goes on without end where what a controller does wrote into the
    pipe by which the process tells of its end; one that was killed it may wait for.
    """
    until = time.monotonic() + within
    while process.is_alive():
        if time.monotonic() >= until:
            process.kill()
            process.join()
            return
        time.sleep(POLL_SECONDS)


def _plainly(fn: Callable[..., Any], args: Any, kwargs: Any, _: Stop) -> Any:
    return fn(*args, **kwargs)


__all__ = ["Processes", "check_guarded", "worker_count"]
