"""A record to damage."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py

from tests.edges.shell import Shell
from tests.helpers.records import make_record


def damaged(shell: Shell, change: Callable[[h5py.File], object]) -> Path:
    """Write a short record and change it."""
    path = shell.folder / "record.h5"
    make_record(path, seconds=1.0).close()
    with h5py.File(path, "r+") as file:
        change(file)
    return path
