"""An environment for each peer, made from its package; one that cannot be had is told."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Peer:
    """A simulator that is compared with."""

    name: str
    packages: tuple[str, ...]
    lacks: str
    """what it does not do that physim does, in words"""
    does: str
    """what it does that physim does not"""
    optional: bool = False


PEERS = (
    Peer(
        "navground",
        ("navground==0.7.0", "moviepy", "cairosvg", "Jinja2"),
        "discs only; contacts at step ends, separated without forces; passes through thin walls; "
        "no collision times; no formation",
        "HRVO and social forces, sensors (lidar), experiments on several threads",
    ),
    Peer(
        "irsim",
        ("ir-sim==2.12.0", "imageio[ffmpeg]"),
        "no substeps and no swept check: passes through thin walls; no record, no command line; "
        "no collision times; no formation",
        "lidar and other sensors, Ackermann and omnidirectional drives, pushing of loose objects",
    ),
    Peer(
        "pyrvo",
        ("pyrvo==0.4.3",),
        "no simulator but the rule of avoidance alone: points with a radius that turn at once, no "
        "contacts, no headings, no record",
        "–",
    ),
    Peer(
        "vmas",
        ("vmas==1.5.2",),
        "contacts are penalties; no record, no command line; no formation",
        "many environments at once, on graphics cards, differentiable",
        optional=True,
    ),
)


@dataclass(frozen=True)
class Environment:
    """A peer with the Python that it is installed for, or why there is none."""

    peer: Peer
    python: str
    failed: str = ""
    seconds: float = 0.0
    """[s] that the installation took by the wall clock"""
    size: float = 0.0
    """[MB] on disk"""


def environment(peer: Peer, folder: Path) -> Environment:
    """Make the environment of a peer, or use the one that is there."""
    place = folder / peer.name
    python, note = place / "bin" / "python", place / "installed.json"
    if not note.exists():
        failed, seconds = _make(peer, place)
        if failed:
            return Environment(peer, str(python), failed)
        note.write_text(json.dumps({"seconds": seconds, "size": size_of(place)}))
    return Environment(peer, str(python), **json.loads(note.read_text()))


def _make(peer: Peer, place: Path) -> tuple[str, float]:
    """Why it cannot be made, or how long it took."""
    began = time.perf_counter()
    python = str(place / "bin" / "python")
    commands = (
        [sys.executable, "-m", "venv", "--clear", str(place)],
        [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *peer.packages],
    )
    for command in commands:
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=600)
        except (OSError, subprocess.TimeoutExpired) as error:
            return f"cannot be installed: {type(error).__name__}", 0.0
        if done.returncode:
            said = [line for line in done.stderr.splitlines() if line.strip()]
            reason = next((line for line in said if line.startswith("ERROR")), (said or ["?"])[-1])
            return f"cannot be installed: {reason[:160]}", 0.0
    return "", time.perf_counter() - began


def size_of(folder: Path) -> float:
    """[MB] of the files in a folder."""
    files = (Path(at) / name for at, _, names in os.walk(folder) for name in names)
    return sum(file.lstat().st_size for file in files) / 1e6
