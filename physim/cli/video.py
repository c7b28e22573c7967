"""``physim video``."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from pathlib import Path

from physim.cli.progress import Bar, interrupts
from physim.errors import PhysimError
from physim.record import Record
from physim.video import render

INTERRUPTED = 130


def video(options: argparse.Namespace) -> int:
    """Make the video of a record; returns the exit code."""
    output = options.output or options.record.parent / "video.mp4"
    if os.path.lexists(output) and not options.force:
        raise PhysimError(f"{output}: exists; use --force to write over it, or -o for another file")
    with interrupts() as interrupt, Record.load(options.record) as record:
        write_video(record, output, options.quiet, interrupt, options.fps, options.speed)
    if not options.quiet:
        print(output)
    return INTERRUPTED if interrupt.count else 0


def write_video(
    record: Record,
    path: Path,
    quiet: bool,
    stop: Callable[[], bool],
    fps: float = 25.0,
    speed: float | None = None,
) -> None:
    """Render with a progress bar; ``stop`` ends it early, with a complete file."""
    bar = Bar("video", 1.0, "frames", quiet)

    def progress(done: int, total: int) -> None:
        bar.total(total)
        bar.update(done)

    try:
        render(record, path, fps=fps, speed=speed, progress=progress, stop=stop)
    finally:
        bar.close()
