"""``physim plot`` and ``physim video``: pictures and videos of a record."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from physim.cli.options import (
    Output,
    Positive,
    Record,
    RecordFile,
    Seconds,
    Words,
    kind,
    print_width,
    real,
    whole,
)
from physim.cli.output import CUT_SHORT, FILES, Target
from physim.cli.progress import Bar
from physim.cli.simulating import tell
from physim.errors import PhysimError, plural
from physim.files import check_regular
from physim.terminal import INTERRUPTED, interrupts

if TYPE_CHECKING:
    from physim.record import Record as Opened


SNAPSHOTS = "trajectories"
"""The figure with robots at several times"""


def plot(
    record: Record, /, *,
    only: Words | None = None,
    output: Output | None = None,
    format: Literal['png', 'svg', 'pdf'] = 'png',
    force: bool = False,
    no_title: bool = False,
    width: Annotated[float | None, kind(print_width)] = None,
    snapshots: Positive | None = None,
) -> int:  # fmt: skip
    """Draw figures from a record: those of the paper, and more.

    options:
      --only NAMES  figures to draw, as listed below, with commas between (default: all)
      -o, --output DIR  folder for the pictures (default: that of the record)
      --format  file format (png)
      --force  overwrite existing pictures
      --no-title  leave out the title and the name of the run, for a paper with captions
      --width IN  width in print: column (3.5 in), page (7.16 in), or inches; text keeps its size
      --snapshots S  in trajectories, simulated time from one drawing of the robots to the next [s]
          (default: about ten in the run, fewer for long clusters)

    figures (physim summary --definitions says how their quantities are computed):
      trajectories     paths, trajectories and snapshots on the map (Figs. 1a, 2a, 3a, 6a, 6b)
      deviation        deviation of each robot from its path (Figs. 1b, 2c, 7d)
      speeds           rotational and forward speeds averaged over 10 s (Figs. 1c, 7b, 7c)
      formation        formation errors and energy (Figs. 2b, 7a)
      width            corridor width along the path of the first robot (Fig. 4)
      distances        distances between robots, and to walls (Figs. 3b, 6c)
      collision_times  collision times at the decisions (Figs. 3c, 6d)
      modes            modes of each robot over time (Fig. 8)
      prediction       predicted against actual time to contact
    and figures that installed packages register as physim.plots

    exit codes:
      0    drawn
      2    bad input: one message says what and where
      130  interrupted (Ctrl-C): finished pictures are kept

    examples:
      physim plot runs/ten_robots-21
      physim plot out/record.h5 --only modes,trajectories --snapshots 21 --format pdf -o figures
      physim plot out/record.h5 --only distances --no-title --width column --format pdf
    """
    from physim.drawing.plots import draw, names, not_replaced
    from physim.record import Record as Opened

    chosen = names() if only is None else only
    if snapshots is not None and SNAPSHOTS not in chosen:
        raise PhysimError(f"--snapshots: is of {SNAPSHOTS}, which --only leaves out")
    folder = Target(output or record.parent, force).folder()
    tell(not_replaced(chosen))
    left_out: list[str] = []
    with interrupts() as interrupt, Opened.load(record) as opened:
        files = draw(
            opened, folder, only=only, format=format, force=force, snapshots=snapshots,
            stop=interrupt, title=not no_title, width=width,
            left_out=lambda name, why: left_out.append(f"{name} is left out: {why}"),
        )  # fmt: skip
    for file in files:
        print(file)
    for line in left_out:
        print(line, file=sys.stderr)
    of = len(set(chosen))
    if len(files) + len(left_out) < of:
        print(f"interrupted after {len(files)} of {plural(of, 'picture')}", file=sys.stderr)
        return INTERRUPTED
    return 0


WIDTH = whole(160, 1280, "an even number from 160 to 1280", step=2)


def video(
    record: Record, other: RecordFile | None = None, /, *,
    output: Output | None = None,
    from_: Seconds = 0.0,
    to: Seconds = math.inf,
    at: Seconds | None = None,
    force: bool = False,
    fps: Annotated[int | None, kind(whole(1, 240))] = None,
    width: Annotated[int | None, kind(WIDTH)] = None,
    speed: Annotated[float | None, kind(real(0.001, 1e6))] = None,
    quiet: bool = False,
) -> int:  # fmt: skip
    """Make a film of a record (MP4 in H.264, GIF or WebP), or a still with --at.

    arguments:
      [RECORD]  another run, shown on the right; the titles say how the two worlds differ

    options:
      -o, --output FILE  file, ending in .mp4, .gif, .webp, or .png for a still (default: video.mp4
          beside the record, or beside.mp4; frame.png)
      --from T  simulated time at which the video begins [s] (0)
      --to T  simulated time at which it ends [s] (default: the end of the run)
      --at T  make a still at this simulated time [s] instead of a film
      --force  overwrite an existing file
      --fps N  frames per second, 1 to 240 (25; GIF: 20)
      --width PX  width of the picture (1280; GIF and WebP: 800); it sets the height, too
      --speed X  simulated seconds per second of video, 0.001 to 1000000 (default: so that the video
          lasts at most 80 s, GIF and WebP 20 s; the last picture then stays for 1.5 s)
      --quiet  print no progress

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
    from physim.drawing.timeline import coarse_spacing
    from physim.drawing.video import still
    from physim.drawing.video.film import STILL, check_still, kind_of, rate
    from physim.record import Record as Opened

    inputs = [record] if other is None else [record, other]
    usual = "frame.png" if at is not None else "video.mp4" if other is None else "beside.mp4"
    file = output or record.parent / usual
    if at is None:
        if file.suffix.lower() == STILL:
            raise PhysimError(f"{file}: is a still; give its simulated time by --at T")
        rate(kind_of(file), fps, "--fps")
    else:
        film = {"--from": from_ != 0.0, "--to": to != math.inf, "--fps": fps is not None}
        if one := next((name for name, given in film.items() if given), None):
            raise PhysimError(f"{one}: is of a film; --at {at:g} makes a still")
        check_still(file)
    Target(file, force, inputs).file()
    with interrupts() as interrupt, ExitStack() as opened:
        records = [opened.enter_context(Opened.load(path)) for path in inputs]
        tell(
            f"{one.path}: a sample every {spacing:g} s; between two of them the earlier one is "
            f"shown; for more of them: {_finer(one)}"
            for one in records
            if (spacing := coarse_spacing(one.time))
            and (at is None or abs(one.time - at).min() > 1e-6)
        )
        how: dict[str, Any] = {"beside": records[1] if other else None, "speed": speed}
        how["width"] = width
        if at is not None:
            still(records[0], made := file, at, **how)
        else:
            how |= {"fps": fps, "start": from_, "end": to}
            made = write_video(records[0], file, quiet, interrupt, **how)
    if made != file:
        print(f"interrupted; the video so far is {made}", file=sys.stderr)
        return INTERRUPTED
    if not quiet:
        print(file)
    return 0


def _finer(record: Opened) -> str:
    """How to come by a record with more samples."""
    if record.judged is None:
        return "run it with --set time.record_every=1"
    return f"physim judge {record.judged.source} --world WORLD --every 0.04"


def write_video(
    record: Opened, path: Path, quiet: bool, stop: Callable[[], bool], **film: Any
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


def files_written(folder: Path, files: Iterable[str] = FILES) -> str:
    """A line of those ``files`` that a folder has."""
    return f"written to {folder}/: {', '.join(one for one in files if (folder / one).exists())}"
