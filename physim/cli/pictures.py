"""``physim plot`` and ``physim video``: pictures and videos of a record."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from physim.cli.output import CUT_SHORT, a_folder, new_file
from physim.cli.parser import Options, command, flag, option
from physim.cli.progress import Bar, interrupts
from physim.cli.signals import INTERRUPTED
from physim.cli.values import (
    PATH,
    POSITIVE,
    PRINTED,
    RECORD,
    RECORD_HELP,
    OneOf,
    not_among,
    number_from,
    whole_from,
)
from physim.drafts import check_regular
from physim.errors import PhysimError, plural

if TYPE_CHECKING:
    from physim.record import Record


SNAPSHOTS = "trajectories"
"""The figure with robots at several times"""


@command("plot", "draw the figures of a record")
@click.argument("record", metavar="RECORD", type=RECORD, help=RECORD_HELP)
@option(
    "--only",
    metavar="NAMES",
    help="figures to draw, as listed below, with commas between (default: all)",
)
@option(
    "-o",
    "--output",
    type=PATH,
    metavar="DIR",
    help="folder for the pictures (default: that of the record)",
)
@option(
    "--format", type=OneOf(("png", "svg", "pdf")), default="png", help="kind of the pictures (png)"
)
@flag("--force", "overwrite existing pictures")
@flag("--no-title", "without title and name of the run, for a paper with captions")
@option(
    "--width",
    type=PRINTED,
    metavar="IN",
    help="width in print: column (3.5 in), page (7.16 in), or inches; writing keeps its size",
)
@option(
    "--snapshots", type=POSITIVE, metavar="S",
    help="simulated seconds between the robots in trajectories (default: about ten in the run, "
    "fewer of long clusters)",
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
      physim plot runs/ten_robots-21
      physim plot out/record.h5 --only modes,trajectories --snapshots 21 --format pdf -o figures
      physim plot out/record.h5 --only distances --no-title --width column --format pdf
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
    if options.snapshots is not None and SNAPSHOTS not in only:
        raise PhysimError(f"--snapshots: is of {SNAPSHOTS}, which --only leaves out")
    a_folder(folder)
    for name in only:
        new_file(folder / f"{name}.{options.format}", options.force, options.record,
                 another="folder")  # fmt: skip
    for fault in not_replaced(only):
        print(f"WARNING  {fault}", file=sys.stderr)
    left_out: list[str] = []
    with interrupts() as interrupt, Record.load(options.record) as record:
        files = draw(
            record, folder, only=None if options.only is None else only, format=options.format,
            force=options.force, snapshots=options.snapshots, stop=interrupt,
            title=not options.no_title, width=options.width,
            left_out=lambda name, why: left_out.append(f"{name} is left out: {why}"),
        )  # fmt: skip
    for file in files:
        print(file)
    for line in left_out:
        print(line, file=sys.stderr)
    if len(files) + len(left_out) < len(set(only)):
        print(f"interrupted after {len(files)} of {plural(len(set(only)), 'picture')}",
              file=sys.stderr)  # fmt: skip
        return INTERRUPTED
    return 0


@command("video", "films and stills of a record, or of two")
@click.argument("record", metavar="RECORD", type=RECORD, help=RECORD_HELP)
@click.argument(
    "other", metavar="[RECORD]", required=False, type=RECORD, help="another run, as by --beside"
)
@option(
    "-o",
    "--output",
    type=PATH,
    metavar="FILE",
    help="file, ending in .mp4, .gif, .webp, or .png for a still (default: video.mp4 beside the "
    "record, or beside.mp4; frame.png)",
)
@option(
    "--beside",
    type=RECORD,
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
@option(
    "--at",
    type=number_from(0.0, 1e9),
    metavar="T",
    help="a still of this simulated time [s] instead of a film",
)
@flag("--force", "overwrite an existing file")
@option(
    "--fps",
    type=whole_from(1, 240),
    metavar="N",
    help="frames a second of video, 1 to 240 (25; GIF, which cannot hold all: 20)",
)
@option(
    "--width",
    type=whole_from(160, 1280, "an even number from 160 to 1280", step=2),
    metavar="PX",
    help="width of the picture (1280; GIF and WebP: 800); the height goes with it",
)
@option(
    "--speed",
    type=number_from(0.001, 1e6),
    metavar="X",
    help="simulated seconds a second of video, 0.001 to 1000000 (default: chosen so that the "
    "video lasts at most 80 s, GIF and WebP 20 s, and 1.5 s on the last picture)",
)
@flag("--quiet", "no progress bar")  # fmt: skip
def video(options: Options) -> int:
    """Make a film of a record, MP4 (H.264), GIF or WebP, or with --at a still.

    exit codes:
      0    the video is made
      2    bad input: one message says what and where
      130  interrupted (Ctrl-C): the video so far is kept as video.cut_short.mp4

    examples:
      physim video out/record.h5 --speed 1 -o slow.mp4
      physim video out/record.h5 -o merge.gif --from 44 --to 54 --width 640
      physim video out/record.h5 --at 47.2 -o frame.png
      physim video with/record.h5 without/record.h5 -o both.mp4 --to 40
    """
    from physim.record import Record

    if options.other is not None and options.beside is not None:
        raise PhysimError(f"--beside {options.beside}: there is a second record, {options.other}")
    beside = options.other or options.beside
    inputs = [options.record] if beside is None else [options.record, beside]
    name = "video.mp4" if beside is None else "beside.mp4"
    output = options.output or options.record.parent / (name if options.at is None else "frame.png")
    _check_kind(options, output)
    new_file(output, options.force, *inputs)
    with interrupts() as interrupt, ExitStack() as opened:
        records = [opened.enter_context(Record.load(path)) for path in inputs]
        how = {
            "beside": records[1] if len(records) > 1 else None,
            "speed": options.speed,
            "width": options.width,
        }
        for record in records:
            _tell_spacing(record, options.at)
        if options.at is not None:
            made = _still(records, output, options.at, how)
        else:
            _check_times(options.start, options.end, records)
            made = write_video(
                records[0], output, options.quiet, interrupt, fps=options.fps,
                start=options.start, end=options.end, **how,
            )  # fmt: skip
    if made != output:
        print(f"interrupted; the video so far is {made}", file=sys.stderr)
        return INTERRUPTED
    if not options.quiet:
        print(output)
    return 0


def _check_kind(options: Options, output: Path) -> None:
    """Raise PhysimError where the file is of no kind there is, or of another than asked for."""
    from physim.drawing.video.film import STILL, check_still, kind_of, named, rate

    suffix = output.suffix.lower()
    if options.at is None:
        if suffix == STILL:
            raise PhysimError(f"{output}: is a still; --at T says of which simulated time")
        rate(kind_of(output), options.fps, "--fps")
        return
    film = {"--from": options.start != 0.0, "--to": options.end != math.inf,
            "--fps": options.fps is not None}  # fmt: skip
    for name, given in film.items():
        if given:
            raise PhysimError(f"{name}: is of a film; --at {options.at:g} makes a still")
    if suffix != STILL:
        raise PhysimError(
            f"--at {options.at:g}: makes a still, which {output} cannot be; did you mean "
            f'"{named(output, STILL)}"?'
        )
    check_still(output)


def _still(records: list[Record], output: Path, time: float, how: dict[str, Any]) -> Path:
    """Write a still. Raises PhysimError for a time after the end of the longest run."""
    from physim.drawing.video import still

    over = _over(records)
    if time > over:
        raise PhysimError(f"--at {time:g}: the run ends at {over:.15g} s")
    still(records[0], output, time, **how)
    return output


def _tell_spacing(record: Record, at: float | None) -> None:
    """Say of a coarse record that pictures show the samples that it has."""
    from physim.drawing.timeline import coarse_spacing, samples_before

    times = record.time
    if not (spacing := coarse_spacing(times)):
        return
    every = f"{record.path} has a sample every {spacing:g} s (time.record_every)"
    if at is None:
        print(f"WARNING  {every}: the film goes from one to the next", file=sys.stderr)
    elif (shown := times[samples_before(times, at)]) < min(at, times[-1]) - 1e-6:
        print(f"WARNING  {every}: the picture shows that of {shown:g} s", file=sys.stderr)


def _over(records: list[Record]) -> float:
    """End of the longest run [s]."""
    return max([0.0, *(float(time) for record in records for time in record.time[-1:])])


def _check_times(start: float, end: float, records: list[Record]) -> None:
    """Raise PhysimError unless --from comes before --to, and before the end of the longest run."""
    over = _over(records)
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
    check_regular(short)
    with Bar("video", 1.0, "frames", quiet) as bar:
        render(record, path, progress=bar.count, stop=stop, cut_short=short, **film)
    return path if bar.complete else short
