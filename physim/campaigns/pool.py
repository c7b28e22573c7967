"""Jobs for worker processes of this machine.

A job that ends its process, or goes on beyond its limit, ends with an error of its own; another
process takes the next job. Each worker has a pipe of its own, so that whatever a job does to it
costs that job alone. Only results are kept: memory does not grow with the number of jobs.
"""

from __future__ import annotations

import math
import multiprocessing
import os
import queue
import signal
import sys
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, Future
from contextlib import contextmanager, redirect_stdout, suppress
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.reduction import ForkingPickler
from multiprocessing.util import Finalize
from operator import index
from typing import Any, NamedTuple, SupportsIndex

from physim.errors import PhysimError
from physim.terminal import gates

Stop = Callable[[], bool]
"""Whether to end early."""
LAST_SECONDS = 10.0
"""[s] A job has to end once it is told to; then its process is killed."""
LOOK_SECONDS = 0.5
"""[s] between looks whether a worker is alive: what it forked may keep its pipe open"""
POLL_SECONDS = 0.1
MOST_WORKERS = 8
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""What ends a command: its first process hears it, and tells the others."""
WORKER = "physim worker"
"""What multiprocessing calls processes of ours"""
SAFE_PATH, BY_US = "PYTHONSAFEPATH", "physim"
"""Variable by which Python leaves the working folder out of its path, and our value of it"""
UNGUARDED = 'a program of your own must be a file, and begin runs under if __name__ == "__main__":'
BEGINS, DONE, FAILED = "begins", "done", "failed"
"""What a worker says: that the time of a job begins to count, and what came of it"""


class LostError(PhysimError):
    """The process that did a job ended before the job did."""


class StartError(PhysimError):
    """No process can be begun: no job will be done."""


class OverdueError(PhysimError):
    """A job took longer than its limit."""


@dataclass(frozen=True)
class Job:
    """A piece of work for a worker process."""

    note: str
    """a few words for a progress bar"""
    work: Callable[..., Any]
    """module-level function of what is given and of a `Stop`; its result is None when stopped"""
    given: tuple[Any, ...] = ()
    limit: float | None = None
    """[s] after which it is given up; it may take as long as it likes where that is None"""
    first: Callable[[], Any] | None = None
    """module-level function that readies a process for such work; its time is not limited"""
    code: str = ""
    """whose code it runs beside that of physim: that may change its process for all that follows,
    so that no job of other code is done there"""
    archive: str = ""
    """file that such code is imported from, where it came to another machine"""

    def do(self, stop: Stop) -> Any:
        """Result of the work."""
        return self.work(*self.given, stop)


def never() -> bool:
    """A `Stop` that does not stop."""
    return False


def worker_count() -> int:
    """Cores that this process may use, at most `MOST_WORKERS`."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return max(1, min(cores or 1, MOST_WORKERS))


def is_importing() -> bool:
    """Whether this process is new and still imports the program that began it.

    multiprocessing itself asks so before it begins a process; it has no public name for it.
    """
    return getattr(multiprocessing.current_process(), "_inheriting", False)


def check_guarded() -> None:
    """Let a program begin no runs while a process that it began only imports it.

    A worker of ours ends there, and who began it says why; raises StartError in one of another.
    """
    if is_importing():
        if multiprocessing.current_process().name == WORKER:
            sys.exit(1)
        raise StartError(f"worker processes cannot be started: {UNGUARDED}")


_STARTS = threading.Lock()


@contextmanager
def begun_apart() -> Iterator[None]:
    """Processes that are begun in the block are deaf to `ENDING`, until they `settle`.

    From the very first, while they import what they need: there it would end them in a traceback,
    and what they were to do would count as lost. Nor do they import from the working folder, which
    may hold a ``struct.py`` of the user, before they have the path of their parent. And a worker of
    Dask, a daemon, may begin them.
    """
    with _STARTS:
        known = os.environ.get(SAFE_PATH)
        os.environ[SAFE_PATH] = known or BY_US
        config: dict[str, Any] = getattr(multiprocessing.current_process(), "_config", {})
        daemon = config.pop("daemon", None)
        resource_tracker.ensure_running()  # as it begins, it lets this thread hear again
        before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
            if daemon is not None:
                config["daemon"] = daemon
            if not known:
                os.environ.pop(SAFE_PATH, None)


def settle() -> None:
    """Hear `ENDING` in a process that was `begun_apart`, each as its handler has it."""
    if os.environ.get(SAFE_PATH) == BY_US:
        del os.environ[SAFE_PATH]  # what it begins is its own affair
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)


class Workers:
    """Whoever does jobs: `Processes` of this machine, or those of a cluster."""

    workers: int
    """jobs that are done at a time"""
    here = True
    """on this machine: jobs can be told to end early, and write and import its files"""

    def begin(self, job: Job) -> Future[Any]:
        """Have a job done. Its future may raise `LostError`, `OverdueError` or what it raised."""
        raise NotImplementedError

    def halt(self) -> None:
        """Tell all jobs to end early."""


class Processes(Workers):
    """Up to ``workers`` processes at work, begun when there is work and ended by `shutdown`.

    One that has run a controller of one's own waits for more of the same: another controller's runs
    would not be what they are alone where the first has changed a library, or a limit. Raises
    ValueError for less than one process.
    """

    def __init__(self, workers: int) -> None:
        if not isinstance(workers, SupportsIndex) or isinstance(workers, bool) or workers < 1:
            raise ValueError(f"workers = {workers!r}; it must be a whole number of processes")
        self.workers = index(workers)
        self._halt = multiprocessing.get_context("spawn").RawValue("b", 0)
        self._lock = threading.Lock()
        self._jobs: queue.SimpleQueue[tuple[Future[Any], Job] | None] = queue.SimpleQueue()
        self._threads: list[threading.Thread] = []
        self._free: list[_Worker] = []
        self._at_exit: Finalize | None = None
        self._ends = False

    def begin(self, job: Job) -> Future[Any]:
        """Have a job done. Its future may raise `LostError`, `OverdueError` or what it raised."""
        check_guarded()
        future: Future[Any] = Future()
        with self._lock:
            if self._ends:
                raise RuntimeError("the executor was shut down")
            self._jobs.put((future, job))
            if len(self._threads) < self.workers:
                self._threads.append(threading.Thread(target=self._serve, daemon=True))
                self._threads[-1].start()
            if self._at_exit is None:  # without a `shutdown` it ends with the program
                self._at_exit = Finalize(None, self.shutdown, (True,), exitpriority=0)
        return future

    def halt(self) -> None:
        """Tell all jobs to end early."""
        self._halt.value = 1

    def shutdown(self, cancel_futures: bool = False) -> None:
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
            with suppress(queue.Empty):
                while found := self._jobs.get_nowait():
                    found[0].cancel()
        for _ in self._threads:
            self._jobs.put(None)
        for thread in self._threads:
            thread.join()

    def _serve(self) -> None:
        """Have jobs done, one after the other; the last of the threads to end ends the workers."""
        while (found := self._jobs.get()) is not None:
            future, job = found
            if not future.set_running_or_notify_cancel():
                continue
            try:
                worker = self._worker_for(job.code)
                try:
                    result = worker.do(job)
                finally:
                    with self._lock:
                        self._free.append(worker)
                future.set_result(result)
            except BaseException as error:
                future.set_exception(error)
        with self._lock:
            left, self._free = self._free, []
        for one in left:
            one.end(LAST_SECONDS)

    def _worker_for(self, code: str) -> _Worker:
        """A process without a job that runs this code and no other."""
        late: _Worker | None = None
        with self._lock:
            self._free = [one for one in self._free if one.process.is_alive()]
            found = next((one for one in self._free if one.code == code), None)
            if found is not None:
                self._free.remove(found)
            elif len(self._free) > self.workers:
                late = self._free.pop(0)
        if late is not None:
            late.end(LAST_SECONDS)
        if found is None:
            try:
                found = _Worker(self._halt, code)
            except OSError as error:  # of files, processes or memory there are no more
                text = error.strerror or error
                raise StartError(f"worker processes cannot be started ({text})") from None
        return found


class _Worker:
    """A process and the pipe to it."""

    def __init__(self, halt: Any, code: str) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process: Any = context.Process(
            target=_do_jobs, name=WORKER, args=(theirs, halt), daemon=True
        )
        with begun_apart():
            self.process.start()
        theirs.close()
        self.halt, self.code = halt, code
        self.began = False
        """whether it ever began a job"""

    def do(self, job: Job) -> Any:
        """Result of a job. Raises what it raised; where its process is lost, that."""
        try:
            packed = ForkingPickler.dumps(job)
        except Exception as error:
            raise RuntimeError(f"{job.note} cannot be sent: {error}") from None
        due = last = math.inf
        with suppress(OSError):
            self.pipe.send_bytes(packed)
        while (now := time.monotonic()) < min(due, last):
            if self.halt.value:  # one that still starts loses nothing
                last = min(last, now + (LAST_SECONDS if self.began else 0.0))
            try:
                if not self.pipe.poll(min(LOOK_SECONDS, max(0.0, due - now))):
                    if not self.process.is_alive():
                        break
                    continue
                what, found = self.pipe.recv()
            except Exception:  # it is gone, or what it does wrote into the pipe
                break
            if what == BEGINS:
                self.began = True
                due = time.monotonic() + (job.limit or math.inf)
            elif what == DONE:
                return found
            else:
                raise found
        overdue = time.monotonic() >= due
        self.end(0.0 if overdue else LOOK_SECONDS)
        if self.halt.value:
            return None
        code = self.process.exitcode
        if overdue:
            raise OverdueError(f"{job.note}: not done after {job.limit:g} s")
        if not self.began and code is not None and code >= 0:
            raise StartError(f"worker processes cannot be started (exit code {code}): {UNGUARDED}")
        how = f"exit code {code}" if code is None or code >= 0 else signal.Signals(-code).name
        hint = ": out of memory?" if code in (-signal.SIGKILL, None) else ""
        raise LostError(f"a worker process was killed at {job.note} ({how}){hint}")

    def end(self, within: float) -> None:
        """Return when the process is gone, which is killed unless it ends within some seconds.

        ``join`` would wait for one that goes on without end where what a controller does wrote into
        the pipe by which the process tells of its end; one that was killed it may wait for.
        """
        self.pipe.close()  # then it ends
        until = time.monotonic() + within
        while self.process.is_alive():
            if time.monotonic() >= until:
                self.process.kill()
                self.process.join()
            else:
                time.sleep(0.01)


def _do_jobs(pipe: Connection, halt: Any) -> None:
    """In the process: do jobs until the other end of the pipe is closed or gone."""
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)  # it reaches all; the parent says what follows
    settle()
    own = os.getpid()
    threading.Thread(target=_end_with_parent, daemon=True).start()
    with gates(), redirect_stdout(sys.stderr):  # the parent alone writes to standard output
        while True:
            try:
                job: Job = pipe.recv()
            except (EOFError, OSError):
                break
            except Exception as error:  # a function that is not there
                answer = FAILED, RuntimeError(f"{type(error).__name__}: {error}")
            else:
                if job.archive and job.archive not in sys.path:
                    sys.path.insert(0, job.archive)
                if job.first is not None:
                    with suppress(Exception):  # the job itself will say what is wrong
                        job.first()
                with suppress(OSError):
                    pipe.send((BEGINS, None))
                answer = _answer(job, lambda: bool(halt.value))
                if os.getpid() != own:  # a copy that the job forked and let go on: not asked
                    os._exit(0)
            with suppress(OSError):
                pipe.send(answer)
    sys.stderr.flush()
    os._exit(0)  # threads that the user's code left behind would go on for ever


def _answer(job: Job, stop: Stop) -> tuple[str, Any]:
    """Whether a job was done, and its result or error."""
    try:
        result = job.do(stop)
        ForkingPickler.dumps(result)
        return DONE, result
    except PhysimError as error:
        return FAILED, PhysimError(str(error))
    except OSError as error:  # disk full, folder gone
        return FAILED, PhysimError(f"{job.note}: {error.strerror or error}")
    except KeyboardInterrupt:  # its own: that of the terminal does not reach a worker
        return FAILED, LostError(f"{job.note}: it raised KeyboardInterrupt")
    except Exception:
        return FAILED, RuntimeError(f"{job.note}:\n{traceback.format_exc()}")


def _end_with_parent() -> None:
    """End this process when the one that began it is gone."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


class Outcome(NamedTuple):
    """What came of a job: a result, or an error."""

    key: Any
    job: Job
    result: Any
    """None where it was stopped"""
    error: BaseException | None = None


def outcomes(
    jobs: Iterator[tuple[Any, Job] | None],
    executor: Workers,
    stop: Stop,
    idle: Callable[[int], None] = lambda busy: None,
) -> Iterator[Outcome]:
    """What comes of jobs, in the order in which they end.

    ``jobs`` is asked for the next one when there is room, until it has none, or None, while nothing
    is under way. When ``stop`` says True no job is begun and those under way end early. ``idle`` is
    called now and then with how many are under way.
    """
    ended: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()
    under_way: dict[Future[Any], tuple[Any, Job]] = {}
    stopped = False
    try:
        while True:
            if not stopped and stop():
                stopped = True
                for future in list(under_way):
                    future.cancel()
                executor.halt()
            while not stopped and len(under_way) < 2 * executor.workers:
                found = next(jobs, None)
                if found is None:
                    break
                future = executor.begin(found[1])
                under_way[future] = found
                future.add_done_callback(ended.put)
            if not under_way or (stopped and not executor.here):
                return
            idle(len(under_way))
            try:
                future = ended.get(timeout=POLL_SECONDS)
            except queue.Empty:
                continue
            key, job = under_way.pop(future)
            try:
                outcome = Outcome(key, job, future.result())
            except CancelledError:
                if stopped:
                    continue
                raise PhysimError(
                    "the workers gave up their jobs: is the cluster gone? What is done is kept; "
                    "the same command goes on from there"
                ) from None
            except Exception as error:
                outcome = Outcome(key, job, None, error)
            yield outcome
    finally:
        for future in under_way:
            future.cancel()


def do_all(
    jobs: Iterable[tuple[Any, Job]],
    workers: int,
    stop: Stop,
    progress: Callable[[int, int, str], None],
) -> dict[Any, Any]:
    """Results of jobs by key.

    When ``stop`` says True no job is begun, those in progress end early, and what is done is
    returned. ``progress`` gets done, total and a note. Raises the error of a job, or PhysimError
    where a worker was killed.
    """
    waiting, done = deque(jobs), dict[Any, Any]()
    note = waiting[0][1].note if waiting else ""

    def queued() -> Iterator[tuple[Any, Job]]:
        while waiting:
            yield waiting.popleft()

    def tell(busy: int) -> None:
        progress(len(done), len(done) + busy + len(waiting), note)

    executor = Processes(min(workers, max(1, len(waiting))))
    try:
        for key, job, result, error in outcomes(queued(), executor, stop, tell):
            note = job.note
            if error is not None:
                raise error
            if result is not None:
                done[key] = result
    finally:
        executor.shutdown(cancel_futures=True)
    return done
