"""What ties a process to its parent: it ends with it, and what ends a command reaches the parent.

A terminal sends Ctrl-C, and its end, to all processes of a command at once; a daemon may have
children, too.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from multiprocessing.connection import wait
from typing import Any

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""What ends a command: its first process hears it, and tells the others."""


@contextmanager
def begun_deaf() -> Iterator[None]:
    """Processes that this thread begins in the block do not hear `ENDING` until they `hear_again`.

    From the very first, while they import what they need: there it would end them in a traceback,
    and what they were to do would count as lost.
    """
    resource_tracker.ensure_running()  # as it begins, it lets this thread hear again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def hear_again() -> None:
    """Hear `ENDING`, each as its handler has it, in a process that was `begun_deaf`."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)


@contextmanager
def children_allowed() -> Iterator[None]:
    """Workers of Dask are daemons, which multiprocessing refuses children; ours end with them."""
    config: dict[str, Any] = getattr(multiprocessing.current_process(), "_config", {})
    before = config.pop("daemon", None)
    try:
        yield
    finally:
        if before is not None:
            config["daemon"] = before


def end_with_parent() -> None:
    """End this process when the one that began it is gone."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
