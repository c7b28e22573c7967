"""``physim plot`` and ``physim video``: pictures and videos of a record."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from physim.cli.output import CUT_SHORT, a_folder, new_file, regular
from physim.cli.parser import Options, command, flag, option
from physim.cli.progress import Bar, interrupts
from physim.cli.signals import INTERRUPTED
from physim.cli.values import POSITIVE, OneOf, not_among, number_from, whole_from
from physim.errors import PhysimError, plural

if TYPE_CHECKING:
    from physim.record import Record


@command("plot", "draw the figures of a record")
@click.argument("record", metavar="RECORD", type=Path, help="record.h5 of a run")
@option(
    "--only",
    metavar="NAMES",
    help="figures to draw, as listed below, with commas between (default: all)",
)
@option(
    "-o",
    "--output",
    type=Path,
    metavar="DIR",
    help="folder for the pictures (default: that of the record)",
)
@option(
    "--format", type=OneOf(("png", "svg", "pdf")), default="png", help="kind of the pictures (png)"
)
@flag("--force", "overwrite existing pictures")
@option(
    "--snapshots", type=POSITIVE, metavar="S",
    help="simulated seconds between the robots in trajectories (default: about ten in the run)",
)  # fmt: skip
def plot(options: Options) -> int:
    """Draw the figures of the paper, and more, from a record alone.

    figures (docs/FIGURES.md says what each shows and how it is computed):
      trajectories     paths, trajectories and snapshots on the map (Figs. 1a, 2a, 3a, 6a, 6b)
      deviation        deviation of each robot from its path (Figs. 1b, 2c, 7d)
      speeds           rotational and forward speeds averaged over 10 s (Figs. 1c, 7b, 7c)
      formation        formation errors and energy (Figs. 2b, 7a)
      width            corridor width along the path of the first robot (Fig. 4)
      distances        distances between robots, and to walls (Figs. 3b, 6c)
      collision_times  collision times at the decisions (Figs. 3c, 6d)
      modes            modes of each robot over time (Fig. 8)
      prediction       predicted against actual time to contact
    and those that installed packages register as physim.plots

    exit codes:
      0    drawn
      2    bad input: one message says what and where
      130  interrupted (Ctrl-C): pictures that were done by then stay, no half ones

    examples:
      physim plot runs/ten_robots-21/record.h5
      physim plot out/record.h5 --only modes,trajectories --snapshots 21 --format pdf -o figures
    """
    from physim.drawing.plots import draw, names, not_replaced
    from physim.record import Record

    known = only = names()
    if options.only is not None:
        only = tuple(name.strip() for name in options.only.split(","))
    folder = options.output or options.record.parent
    for name in only:
        if name not in known:
            raise PhysimError(f"--only {not_among(name, list(known))}")
    a_folder(folder)
    for name in only:
        new_file(folder / f"{name}.{options.format}", options.force, options.record,
                 another="folder")  # fmt: skip
    for fault in not_replaced(only):
        print(f"WARNING  {fault}", file=sys.stderr)
    with interrupts() as interrupt, Record.load(options.record) as record:
        files = draw(
            record, folder, only=only, format=options.format, force=options.force,
            snapshots=options.snapshots, stop=interrupt,
        )  # fmt: skip
    for file in files:
        print(file)
    if len(files) < len(set(only)):
        print(f"interrupted after {len(files)} of {plural(len(set(only)), 'picture')}",
              file=sys.stderr)  # fmt: skip
        return INTERRUPTED
    return 0


@command("video", "make the video of a record, slower or faster")
@click.argument("record", metavar="RECORD", type=Path, help="record.h5 of a run")
@option(
    "-o",
    "--output",
    type=Path,
    metavar="FILE",
    help="video file, ending in .mp4 (default: video.mp4 beside the record, or beside.mp4)",
)
@option(
    "--beside",
    type=Path,
    metavar="RECORD",
    help="another run, shown on the right; titles say in what the two worlds differ",
)
@option(
    "--from",
    "start",
    type=number_from(0.0, 1e9),
    default=0.0,
    metavar="T",
    help="simulated time at which the video begins [s] (0)",
)
@option(
    "--to",
    "end",
    type=number_from(0.0, 1e9),
    default=math.inf,
    metavar="T",
    help="simulated time at which it ends [s] (default: the end of the run)",
)
@flag("--force", "overwrite an existing file")
@option(
    "--fps",
    type=whole_from(1, 240),
    default=25,
    metavar="N",
    help="frames a second of video, 1 to 240 (25)",
)
@option(
    "--speed",
    type=number_from(0.001, 1e6),
    metavar="X",
    help="simulated seconds a second of video, 0.001 to 1000000 (default: chosen so that the "
    "video lasts at most 80 s)",
)
@flag("--quiet", "no progress bar")  # fmt: skip
def video(options: Options) -> int:
    """Make the video of a record: 1280 x 720, H.264 in MP4.

    exit codes:
      0    the video is made
      2    bad input: one message says what and where
      130  interrupted (Ctrl-C): the video so far is kept as video.cut_short.mp4

    examples:
      physim video runs/ten_robots-21/record.h5 --force
      physim video out/record.h5 --speed 1 -o slow.mp4
      physim video with/record.h5 --beside without/record.h5    # with/beside.mp4
      physim video out/record.h5 --from 40 --to 75 -o part.mp4
    """
    from physim.record import Record

    inputs = [options.record] if options.beside is None else [options.record, options.beside]
    name = "video.mp4" if options.beside is None else "beside.mp4"
    output = options.output or options.record.parent / name
    new_file(output, options.force, *inputs)
    with interrupts() as interrupt, ExitStack() as opened:
        records = [opened.enter_context(Record.load(path)) for path in inputs]
        _check_times(options.start, options.end, records)
        made = write_video(
            records[0], output, options.quiet, interrupt, fps=options.fps, speed=options.speed,
            start=options.start, end=options.end, beside=records[1] if len(records) > 1 else None,
        )  # fmt: skip
    if made != output:
        print(f"interrupted; the video so far is {made}", file=sys.stderr)
        return INTERRUPTED
    if not options.quiet:
        print(output)
    return 0


def _check_times(start: float, end: float, records: list[Record]) -> None:
    """Raise PhysimError unless --from comes before --to, and before the end of the longest run."""
    over = max([0.0, *(float(time) for record in records for time in record.time[-1:])])
    last = min(end, over)
    if not start < last and (start, last) != (0.0, 0.0):
        to = "" if math.isinf(end) else f", --to {end:g}"
        raise PhysimError(
            f"--from {start:g}{to}: nothing to show; --from must be before --to, and before the "
            f"end of the run at {over:g} s"
        )


def write_video(
    record: Record, path: Path, quiet: bool, stop: Callable[[], bool], **film: Any
) -> Path:
    """Render with a progress bar; returns the file. ``film`` goes to `physim.drawing.video.render`.

    ``stop`` ends it early: then a video that plays, under another name that says that it is cut
    short, and ``path`` stays as it was.
    """
    from physim.drawing.video import render

    short = path.with_name(f"{path.stem}{CUT_SHORT}{path.suffix}")
    regular(short)
    with Bar("video", 1.0, "frames", quiet) as bar:
        render(record, path, progress=bar.count, stop=stop, cut_short=short, **film)
    return path if bar.complete else short
