"""Watching files for changes by looking at them now and then: it works on every file system."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from physim.cli.progress import INTERRUPTED, interrupts

EVERY = 0.15
"""[s] between two looks"""


def watch(paths: Sequence[Path], changed: Callable[[], object]) -> int:
    """Call ``changed`` now and after every change of the files, until Ctrl-C; returns its code.

    A change counts when the files stay as they are from one look to the next, so that a file is
    seldom read half-written; when it is nonetheless, its completion is the next change.
    """
    handled: object = None
    before = [state(path) for path in paths]
    with interrupts() as interrupt:
        while not interrupt():
            now = [state(path) for path in paths]
            if now == before and (handled is None or now != handled):
                handled = now  # before the call: what is saved meanwhile is a change
                changed()
            before = now
            time.sleep(EVERY)
    print("interrupted", file=sys.stderr)
    return INTERRUPTED


def state(path: Path) -> tuple[int, ...]:
    """What changes with the content of a file; () while there is none."""
    try:
        status = path.stat()
    except (OSError, ValueError):
        return ()
    return status.st_mtime_ns, status.st_size, status.st_ino
