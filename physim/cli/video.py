"""``physim video``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from physim.cli.output import CUT_SHORT, new_file, regular
from physim.cli.progress import Bar, interrupts
from physim.record import Record
from physim.video import render

INTERRUPTED = 130


def video(options: argparse.Namespace) -> int:
    """Make the video of a record; returns the exit code."""
    inputs = [options.record] if options.beside is None else [options.record, options.beside]
    name = "video.mp4" if options.beside is None else "beside.mp4"
    output = options.output or options.record.parent / name
    new_file(output, options.force, *inputs)
    with interrupts() as interrupt, ExitStack() as opened:
        records = [opened.enter_context(Record.load(path)) for path in inputs]
        film = partial(
            render, fps=options.fps, speed=options.speed, start=options.start, end=options.end,
            beside=records[1] if len(records) > 1 else None,
        )  # fmt: skip
        made = write_video(records[0], output, options.quiet, interrupt, film)
    if made != output:
        print(f"interrupted; the film so far is {made}", file=sys.stderr)
        return INTERRUPTED
    if not options.quiet:
        print(output)
    return 0


def write_video(
    record: Record,
    path: Path,
    quiet: bool,
    stop: Callable[[], bool],
    film: Callable[..., int] = render,
) -> Path:
    """Render with a progress bar; returns the file. ``film`` is `render`, or a partial of it.

    ``stop`` ends it early: then a film that plays, under another name that says that it is cut
    short, and ``path`` stays as it was.
    """
    short = path.with_name(f"{path.stem}{CUT_SHORT}{path.suffix}")
    regular(short)
    bar = Bar("video", 1.0, "frames", quiet)
    done, of = 0, 1

    def progress(now: int, total: int) -> None:
        nonlocal done, of
        done, of = now, total
        bar.total(total)
        bar.update(now)

    try:
        film(record, path, progress=progress, stop=stop, cut_short=short)
    finally:
        bar.close()
    return path if done == of else short
