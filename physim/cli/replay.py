"""``physim replay``: a run of a campaign again, with record and video."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from physim.cli.options import Output, quoted
from physim.cli.output import run_folder
from physim.cli.pictures import files_written, write_video
from physim.errors import PhysimError
from physim.terminal import INTERRUPTED, interrupts

DISAGREE = 3


def replay(
    run: str, /, *,
    output: Output | None = None,
    controller: str | None = None,
    force: bool = False,
    no_video: bool = False,
    quiet: bool = False,
) -> int:  # fmt: skip
    """Repeat the run of one row of a sweep, and write its record.h5 and video.mp4. The record is
    the same, bit for bit; its figures are compared with the row.

    arguments:
      DIR:ROW  folder of a campaign (physim sweep), and a row of its results.csv: its number, from
          0, or the first digits in its column run

    options:
      -o, --output DIR  output folder (default: runs/WORLD-SEED)
      --controller NAME  your own class, if the row used one: physim runs your code only if you name
          it
      --force  overwrite an earlier run in the output folder
      --no-video  make no video
      --quiet  print no progress and no result

    exit codes:
      0    the run is the same
      2    bad input; or the run cannot be the same: versions or the controller's source differ
      3    the run differs from its row: something is wrong
      130  interrupted (Ctrl-C)

    examples:
      physim replay sweeps/ten_robots:0
      physim replay sweeps/ten_robots:4f1c -o worst
    """
    from physim.campaigns.folder import Folder
    from physim.campaigns.replay import check, find_row, replay, spec_of_row
    from physim.record import Record

    place, _, which = run.rpartition(":")
    if not place or "\n" in place:
        raise PhysimError(f"{quoted(run)}: is not DIR:ROW, for example sweeps/ten_robots:0")
    campaign = Folder(place)
    row = find_row(campaign, which)
    spec = spec_of_row(campaign, row, controller)
    usual = re.sub(r"[^\w-]+", "_", f"{row.world}-{row.seed}-{row.run[:6]}")
    folder = output or Path("runs") / usual
    with run_folder(folder, force), interrupts() as interrupt:
        path = folder / "record.h5"
        broke = replay(spec, path, interrupt)
        if not path.exists():
            if interrupt():
                print("interrupted before anything was recorded", file=sys.stderr)
                return INTERRUPTED
            raise PhysimError(f"run {row.run}: {broke or 'nothing was recorded'}")
        with Record.load(path) as record:
            differing = [] if interrupt() else check(record, row)
            if broke and not row.failed and differing:
                differing = [f"broke off here: {broke}"]  # the figures follow from it
            if not no_video and not interrupt():
                write_video(record, folder / "video.mp4", quiet, interrupt)
            ended, seconds = record.ended, record.steps_run * record.dt
    if not quiet:
        if broke and not differing:
            print(f"broke off: {broke}", file=sys.stderr)
        print(f"run {row.run}: {spec.note}; ended {ended} after {seconds:g} s")
        print(files_written(folder))
    for line in differing:
        print(f"NOT THE SAME  {line}", file=sys.stderr)
    if interrupt():
        return INTERRUPTED
    return DISAGREE if differing else 0
