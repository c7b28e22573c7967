"""What ties a process to its parent: it ends with it, and what ends a command reaches the parent.

A terminal sends Ctrl-C, and its end, to all processes of a command at once; Python looks for the
first modules of a new process in the working folder; a daemon may have children, too.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from multiprocessing.connection import wait
from multiprocessing.spawn import get_preparation_data
from pathlib import Path
from typing import Any

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""What ends a command: its first process hears it, and tells the others."""

HOME = str(Path(__file__).resolve().parents[2])
"""Folder in which physim stands"""
WORKER, WARMING = "physim worker", "physim warming"
"""What multiprocessing calls processes of ours: those of campaigns, and one that compiles"""
SAFE_PATH, BY_US = "PYTHONSAFEPATH", "physim"
"""Variable by which Python leaves the working folder out of its path, and our value of it"""


@contextmanager
def begun_apart() -> Iterator[None]:
    """Processes that this thread begins in the block are deaf to `ENDING`, until they `settle`.

    From the very first, while they import what they need: there it would end them in a traceback,
    and what they were to do would count as lost. Nor do they import from the working folder, which
    may hold a ``struct.py`` of a stranger, before they have the path of their parent; and physim is
    the same as here, where that path has a ``physim.py`` of another before it.
    """
    known = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = known or BY_US
    sys.path.insert(0, HOME)
    try:
        resource_tracker.ensure_running()  # as it begins, it lets this thread hear again
        before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
    finally:
        sys.path.remove(HOME)
        if not known:
            os.environ.pop(SAFE_PATH, None)


def settle() -> None:
    """Hear `ENDING`, each as its handler has it, in a process that was `begun_apart`.

    And import as its parent does.
    """
    if sys.path[:1] == [HOME]:
        del sys.path[0]
    if os.environ.get(SAFE_PATH) == BY_US:
        del os.environ[SAFE_PATH]  # what it begins is its own affair
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)


def is_importing() -> bool:
    """Whether this process is new and still imports the program that began it.

    multiprocessing itself asks so before it begins a process; it has no public name for it.
    """
    return getattr(multiprocessing.current_process(), "_inheriting", False)


def end_if_importing() -> None:
    """End a process of ours that is to begin runs while it still imports the program it is of.

    At once, with exit code 1, and not by an exception that the program may catch, to go on and wait
    for runs that its parent has claimed. Who began the process says why.
    """
    if is_importing() and multiprocessing.current_process().name in (WORKER, WARMING):
        sys.exit(1)


def no_file() -> str:
    """Say that new processes cannot import the program that begins them; nothing where they can.

    They import what its ``__file__`` says, which may be ``<stdin>``.
    """
    path = get_preparation_data("").get("init_main_from_path")
    if path is None or os.path.exists(path):
        return ""
    return (
        f"; they import the program that begins them, and {os.path.basename(path)} is no file: "
        "save the program as one and run that"
    )


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
