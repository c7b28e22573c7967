"""Work for the runner's tests: worker processes import it from here."""

from __future__ import annotations

import errno
import os
import time

from physim.errors import PhysimError
from physim.reproduction.runner import Stop


def echo(value: int, stop: Stop) -> int:
    """Gives back what it has."""
    return value


def process(stop: Stop) -> int:
    """Says which process does it."""
    time.sleep(0.05)
    return os.getpid()


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
