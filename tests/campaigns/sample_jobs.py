"""Work for the runner's tests: worker processes import it from here."""

from __future__ import annotations

import ctypes
import errno
import os
import signal
import stat
import sys
import time
from contextlib import suppress

from physim.errors import PhysimError
from tests.helpers import inside

Stop = inside("physim.campaigns", "Stop")


def echo(value: int, stop: Stop) -> int:
    """Gives back what it has."""
    return value


def leave_behind(name: str, stop: Stop) -> tuple[int, str | None]:
    """Changes its process for good, if it has a name; says which it is, and what it found."""
    found = os.environ.get("PHYSIM_TEST_LEFT")
    if name:
        os.environ["PHYSIM_TEST_LEFT"] = name
    return os.getpid(), found


def endless(stop: Stop) -> None:
    """Goes on until it is stopped."""
    while not stop():
        time.sleep(0.01)


def refused(stop: Stop) -> None:
    """Bad input."""
    raise PhysimError("what was given is wrong")


def disk_full(stop: Stop) -> None:
    """Nothing can be written any more."""
    raise OSError(errno.ENOSPC, "No space left on device")


def faulty(stop: Stop) -> float:
    """A fault of the program."""
    return 1 // 0


def killed(stop: Stop) -> None:
    """Its process goes, as when memory runs out."""
    os._exit(9)


def writes_everywhere(_: Stop) -> None:
    """Writes what is no answer into all pipes that are open, its worker's among them, and goes on.

    Not into files: one is the memory in which the test's own process tells workers to end early.
    """
    for descriptor in range(3, 64):
        with suppress(OSError):
            kind = os.fstat(descriptor).st_mode
            if stat.S_ISSOCK(kind) or stat.S_ISFIFO(kind):
                os.write(descriptor, b"\x00\x00\x00\x08no answer")
    time.sleep(1000.0)


def leaves_a_copy(seconds: float, code: int | None, stop: Stop) -> None:
    """Forks a process that lives on for a while; then ends with a code, or not at all."""
    if os.fork() == 0:
        time.sleep(seconds)
        os._exit(0)
    if code is not None:
        os._exit(code)
    hangs(stop)


def raises_as_ctrl_c_does(stop: Stop) -> None:
    raise KeyboardInterrupt


def killed_by_the_system(stop: Stop) -> None:
    """Its process is killed."""
    os.kill(os.getpid(), signal.SIGKILL)


def hangs(stop: Stop) -> None:
    """Cannot be broken off from within."""
    while True:
        with suppress(BaseException):
            time.sleep(0.001)


def hangs_in_native_code(stop: Stop) -> None:
    """Holds the lock of the interpreter."""
    ctypes.PyDLL(None).sleep(100_000)


def writes_into_pipes(stop: Stop) -> None:
    """Writes what is no answer wherever it can."""
    for number in range(3, 64):
        with suppress(OSError):
            if stat.S_ISSOCK(os.fstat(number).st_mode):
                os.write(number, b"\0\0\0\x05hello")


def unpicklable(stop: Stop) -> object:
    """Gives back what cannot be sent."""
    return lambda: 1


def prints(stop: Stop) -> None:
    """Says on both outputs what would act on a terminal."""
    for stream in (sys.stdout, sys.stderr):
        print("red \x1b[31m \u202e", file=stream, flush=True)
