"""Calling the command line from tests: in this process, or as a user's shell would."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import imageio.v3 as iio
import pytest

from physim.cli import main

SMALL = """\
name: small
seed: 1
time: {step: 0.02, duration: 2.0}  # [s]
corridor: {centreline: [[0, 0], [20, 0]], width: 8.0}  # [m]
robots:
  - name: a
    footprint: {length: 1.8, width: 1.0}  # [m]
    pose: [6.0, 1.0, 0.0]
    path: {offset: 1.0}
  - name: b
    footprint: {length: 1.4, width: 1.0}
    pose: [3.0, -1.0, 0.3]
    path: {offset: -1.0}
formation: {range: 8.0}
expect: {contacts: 0}
"""
LONG = (
    SMALL.replace("[20, 0]", "[60000, 0]")
    .replace("step: 0.02", "step: 0.0005")
    .replace("duration: 2.0", "duration: 5000.0")
)
"""A run of ten million steps: never over before a test has seen enough, and short to look at."""


class Done(NamedTuple):
    """How a command ended."""

    code: int
    out: str
    err: str


def physim(*arguments: object, capture: pytest.CaptureFixture[str]) -> Done:
    """Run the command line in this process."""
    capture.readouterr()
    try:
        code = main([str(a) for a in arguments])
    except SystemExit as stop:
        code = int(stop.code or 0)
    return Done(code, *capture.readouterr())


def environment(**more: str) -> dict[str, str]:
    """The environment of an ordinary shell: output to a pipe is buffered."""
    kept = {key: value for key, value in os.environ.items() if key != "PYTHONUNBUFFERED"}
    return {**kept, **more}


def shell(*arguments: object, folder: Path, **more: str) -> Done:
    """Run ``python -m physim`` in a folder, its output in pipes."""
    done = subprocess.run(
        command(arguments), cwd=folder, capture_output=True, text=True, timeout=300,
        env=environment(**more),
    )  # fmt: skip
    return Done(done.returncode, done.stdout, done.stderr)


def started(*arguments: object, folder: Path) -> subprocess.Popen[str]:
    """Start ``python -m physim`` in a folder, in a group of its own as a shell does, and go on."""
    return subprocess.Popen(
        command(arguments), cwd=folder, text=True, env=environment(),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip


def command(arguments: Sequence[object]) -> list[str]:
    return [sys.executable, "-m", "physim", *map(str, arguments)]


def frames(path: Path) -> int:
    """Frames of a video, every one decoded."""
    return sum(1 for _ in iio.imiter(path, plugin="FFMPEG"))


def tree(folder: Path) -> dict[str, Any]:
    """Every file below a folder with its bytes; folders and links as what they are."""
    found: dict[str, Any] = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        found[name] = path.read_bytes() if path.is_file() else "folder"
    return found
