"""Worlds, controllers and specs for the tests of campaigns."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from physim.campaigns import Row, RunSpec, spec_of
from physim.world.file import parse_world
from tests.helpers import inside

Rows, read_rows, each_once = inside("physim.campaigns", "Rows", "read_rows", "each_once")

WORLD = """\
name: small
seed: 1
time: {step: 0.02, duration: 1.0}  # [s]
corridor: {centreline: [[0, 0], [20, 0]], width: 8.0}  # [m]
robots:
  - name: a
    footprint: {length: 1.8, width: 1.0}  # [m]
    pose: [6.0, 1.0, random]
    path: {offset: 1.0}
  - name: b
    footprint: {length: 1.4, width: 1.0}
    pose: [3.0, -1.0, random]
    path: {offset: -1.0}
"""
FIXED = WORLD.replace("random", "0.0").replace("name: small", "name: fixed")

CONTROLLER = '''\
"""Does what it is told."""

import ctypes
import os
import signal

from pydantic import BaseModel

from helper import SPEED
from physim import Decision


class Awkward:
    class Settings(BaseModel):
        how: str = "fine"

    def __init__(self, settings):
        self.how = settings.how

    def decide(self, observation, memory):
        if observation.time > 0.3:
            if self.how == "raise":
                raise ValueError("as it was told")
            if self.how == "exit":
                os._exit(7)
            if self.how == "kill":
                os.kill(os.getpid(), signal.SIGKILL)
            if self.how == "leave":
                raise SystemExit("away")
            if self.how == "address":
                raise LookupError(f"no {object()!r}")
            while self.how == "hang":
                try:
                    pass
                except BaseException:
                    pass
            if self.how == "native":
                ctypes.PyDLL(None).sleep(100000)  # holds the lock of the interpreter
        return Decision(v=SPEED, omega=0.0, hold=0.1)
'''
HELPER = "SPEED = 0.5\n"


def write(folder: Path) -> None:
    """A world, a controller and what it imports."""
    (folder / "small.yaml").write_text(WORLD)
    (folder / "fixed.yaml").write_text(FIXED)
    (folder / "awkward.py").write_text(CONTROLLER)
    (folder / "helper.py").write_text(HELPER)


def specs(count: int, text: str = WORLD) -> list[RunSpec]:
    """Runs of the small world with seeds from 0 on."""
    world = parse_world(text)
    return [spec_of(world, seed) for seed in range(count)]


def rows_in(folder: Path) -> list[Row]:
    """Rows of a folder, each run once, in the order of seeds, whatever its campaign.json tells.

    None where it has not been made yet.
    """
    files = Rows(folder).files() if (folder / "rows").is_dir() else []
    return each_once(row for file in files for row in read_rows(file))


def without_times(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """All columns but those of the clock."""
    return [
        {
            k: v
            for k, v in asdict(row).items()
            if not k.endswith("_seconds") and not k.startswith("decision_")
        }
        for row in rows
    ]


def lines_on_disk(folder: Path) -> int:
    """Rows in all files; more than runs where some stand there twice."""
    files = (folder / "rows").glob("*.jsonl")
    return sum(len(file.read_bytes().splitlines()) for file in files)
