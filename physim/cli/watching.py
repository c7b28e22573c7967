"""Watching a file for changes by looking at it now and then: it works on every file system."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

EVERY = 0.15
"""[s] between two looks"""


def watch(path: Path, changed: Callable[[], None], stop: Callable[[], bool]) -> None:
    """Call ``changed`` now and after every change of a file, until ``stop``.

    A change counts when the file stays as it is from one look to the next, so that a file is
    seldom read half-written; when it is nonetheless, its completion is the next change.
    """
    handled: object = None
    before = state(path)
    while not stop():
        now = state(path)
        if now == before and (handled is None or now != handled):
            handled = now  # before the call: what is saved meanwhile is a change
            changed()
        before = now
        time.sleep(EVERY)


def state(path: Path) -> tuple[int, ...]:
    """What changes with the content of a file; () while there is none."""
    try:
        status = path.stat()
    except (OSError, ValueError):
        return ()
    return status.st_mtime_ns, status.st_size, status.st_ino
