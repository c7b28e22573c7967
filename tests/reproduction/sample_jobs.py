"""Jobs for the runner's tests: worker processes import them from here."""

from __future__ import annotations

import errno
import os
import time
from collections.abc import Callable
from dataclasses import dataclass

from physim.errors import PhysimError


@dataclass(frozen=True)
class Echo:
    """Gives back what it has."""

    value: int
    note: str = "echo"

    def do(self, stop: Callable[[], bool]) -> int:
        return self.value


@dataclass(frozen=True)
class Process(Echo):
    """Tells which process does it."""

    def do(self, stop: Callable[[], bool]) -> int:
        time.sleep(0.05)
        return os.getpid()


@dataclass(frozen=True)
class Endless(Echo):
    """Goes on until it is stopped."""

    def do(self, stop: Callable[[], bool]) -> int | None:  # type: ignore[override]
        while not stop():
            time.sleep(0.01)
        return None


@dataclass(frozen=True)
class Refused(Echo):
    """Bad input."""

    def do(self, stop: Callable[[], bool]) -> int:
        raise PhysimError("what was given is wrong")


@dataclass(frozen=True)
class DiskFull(Echo):
    """Nothing can be written any more."""

    def do(self, stop: Callable[[], bool]) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")


@dataclass(frozen=True)
class Faulty(Echo):
    """A fault of the program."""

    def do(self, stop: Callable[[], bool]) -> int:
        return 1 // 0


@dataclass(frozen=True)
class Killed(Echo):
    """Its process goes, as when memory runs out."""

    def do(self, stop: Callable[[], bool]) -> int:
        os._exit(9)
