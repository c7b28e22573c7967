"""How large a run is, before it is made: bytes of its record, memory, and time.

What is certain is told apart from what is rough. Every recorded sample has a known size, and a run
that goes on for its whole duration has all of them; how often robots decide, and how many others
they consider, only the run shows.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from physim.errors import RecordError
from physim.record.layout import OPTIONAL, OTHERS, STEPS, row_types
from physim.world.scene import Scene

DECISION_SECONDS = 0.1
"""[s] from one decision of a robot to the next, roughly"""
CONSIDERED = 20
"""Robots that are considered in a decision, roughly; no more than there are others."""
STEP_SECONDS, ROBOT_SECONDS = 5e-5, 3e-6
"""[s] of computing that a step takes, and each robot in it, roughly"""
LONG_SECONDS, LARGE_BYTES = 60.0, 1e9
"""A run of which more is expected is told of before it starts."""


@dataclass(frozen=True)
class Size:
    """How large a run is that goes on for its whole duration."""

    robots: int
    steps: int
    every: int
    """[steps] from one recorded sample to the next"""
    duration: float
    """[s] simulated"""
    samples: int
    """[bytes] of the samples alone: certain"""
    decisions: int
    """[bytes] of the tables of decisions, roughly"""

    @property
    def record(self) -> int:
        """[bytes] roughly."""
        return self.samples + self.decisions

    @property
    def seconds(self) -> float:
        """[s] of computing, roughly."""
        return self.steps * (STEP_SECONDS + self.robots * ROBOT_SECONDS)

    @property
    def is_large(self) -> bool:
        """Whether one should know before it starts."""
        return self.seconds > LONG_SECONDS or self.record > LARGE_BYTES

    def line(self) -> str:
        """One line: how large, and how long it takes."""
        return (
            f"{self.robots:,} robot{'' if self.robots == 1 else 's'}, {self.steps:,} steps: "
            f"roughly {_time(self.seconds)} of "
            f"computing and {_bytes(self.record)} of record, {_bytes(self.samples)} of it samples"
        )


def size_of(scene: Scene, every: int, columns: int = 0, tables: Sequence[str] = OPTIONAL) -> Size:
    """Size of a run of a scene with a sample every ``every`` steps.

    ``columns`` are those that the controller declares, ``tables`` those of `OPTIONAL` that are
    kept.
    """
    robots = scene.robots
    types = row_types(robots, [f"column{k}" for k in range(columns)])
    row = sum(types[path].itemsize for path in STEPS)
    decision = types["/updates"].itemsize * ("updates" in tables)
    if "considered" in tables:
        others = types[OTHERS].itemsize * min(robots - 1, CONSIDERED)
        decision += types["/considered"].itemsize + others
    duration = scene.steps * scene.dt
    decided = robots * min(scene.steps, round(duration / DECISION_SECONDS))
    samples = (scene.steps // every + 2) * row
    return Size(robots, scene.steps, every, duration, samples, decided * decision)


def check_room(size: Size, path: str | os.PathLike[str] | None) -> None:
    """Raise RecordError where the samples of a run surely do not fit on the disk or in memory.

    ``path`` is the file of the record; with None it stays in memory.
    """
    if path is None:
        room, where = memory(), "memory"
    else:
        folder = Path(path).absolute().parent
        while not folder.exists():
            folder = folder.parent
        disk, where = shutil.disk_usage(folder), str(folder)
        room = disk.free if disk.total else float("inf")  # no disk: /proc and the like
    if size.samples > room:
        raise RecordError(
            f"{where}: no room for the record: there are {_bytes(room)}, and its samples alone "
            f"take {_bytes(size.samples)}: {size.robots:,} robots, time.duration "
            f"{size.duration:g} s, time.record_every {size.every}; make the run "
            "smaller, or record less often"
        )


def memory() -> float:
    """Bytes of memory that this machine has; inf where it does not say."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return float("inf")


def _bytes(size: float) -> str:
    """A size in three digits: ``1.23 GB``."""
    for unit in ("B", "kB", "MB", "GB"):
        if size < 999.5:
            return f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:,.3g} TB" if size < 999.5 else f"{size:,.0f} TB"


def _time(seconds: float) -> str:
    """A time in one unit."""
    for unit, length in (("days", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * length:
            return f"{seconds / length:.0f} {unit}"
    return f"{seconds:.0f} s"
