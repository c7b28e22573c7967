"""A worker process: the jobs that it is given, one after the other, and what comes of them.

The system's own timer ends it where a job goes on beyond its limit, also one that is in native
code, or whose parent is gone.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

from physim.campaigns.kinship import ENDING, end_with_parent, settle
from physim.errors import PhysimError
from physim.streams import gates

Stop = Callable[[], bool]
"""Whether to end early."""
READY, BEGINS = "ready", "begins"
"""What a worker says first, and when the time of a job begins to count"""


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

    def do(self, stop: Stop) -> Any:
        """Result of the work."""
        return self.work(*self.given, stop)


def do_jobs(pipe: Connection, halt: Any) -> None:
    """Do jobs until the other end of the pipe is closed or gone."""
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)  # it reaches all; the parent says what follows
    settle()  # for what a job begins in turn
    own = os.getpid()
    threading.Thread(target=end_with_parent, daemon=True).start()
    with gates(), redirect_stdout(sys.stderr):  # the parent alone writes to standard output
        with suppress(OSError):
            pipe.send(READY)
        while True:
            try:
                job: Job = pipe.recv()
            except (EOFError, OSError):
                if any(not one.daemon for one in threading.enumerate()[1:]):
                    os._exit(0)  # threads that the user's code left behind would go on for ever
                return
            except Exception as error:  # a function that is not there
                answer: tuple[bool, Any] = False, RuntimeError(f"{type(error).__name__}: {error}")
            else:
                if job.first is not None:
                    with suppress(Exception):  # the job itself will say what is wrong
                        job.first()
                if job.limit is not None:
                    with suppress(OSError):
                        pipe.send(BEGINS)
                with limited(job.limit):
                    answer = _answer(job, lambda: bool(halt.value))
                if os.getpid() != own:  # a copy that the job forked and let go on: not asked
                    os._exit(0)
            with suppress(OSError):
                pipe.send(answer)


def _answer(job: Job, stop: Stop) -> tuple[bool, Any]:
    """Whether a job was done, and its result or error."""
    try:
        return True, job.do(stop)
    except PhysimError as error:
        return False, PhysimError(str(error))
    except OSError as error:  # disk full, folder gone
        return False, PhysimError(f"{job.note}: {error.strerror or error}")
    except KeyboardInterrupt:  # its own: that of the terminal does not reach a worker
        return False, LostError(f"{job.note}: it raised KeyboardInterrupt")
    except Exception:
        return False, RuntimeError(f"{job.note}:\n{traceback.format_exc()}")


@contextmanager
def limited(seconds: float | None) -> Iterator[None]:
    """Let the system end this process when a block takes longer."""
    if seconds is None or not hasattr(signal, "setitimer"):
        yield
        return
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
