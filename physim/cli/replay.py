"""``physim replay``: a run of a campaign again, with record and video."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import click

from physim.cli.output import FILES, run_folder
from physim.cli.parser import Options, command, flag, option
from physim.cli.pictures import write_video
from physim.cli.progress import interrupts
from physim.cli.signals import INTERRUPTED
from physim.cli.values import PATH
from physim.errors import PhysimError
from physim.escaping import escaped

DISAGREE = 3


@command("replay", "one run of a sweep again: record and video")
@click.argument(
    "run", metavar="DIR:ROW",
    help="a folder of physim sweep, and the number of a row in its results.parquet, from 0, or the "
    "digits in its column run, as many as are needed",
)  # fmt: skip
@option("-o", "--output", type=PATH, metavar="DIR", help="output folder (default: runs/WORLD-SEED)")
@option(
    "--controller", metavar="NAME",
    help="the row's own controller, where that is a class of yours: code is only run when named",
)  # fmt: skip
@flag("--force", "overwrite an earlier run in the output folder")
@flag("--no-video", "make no video")
@flag("--quiet", "print neither progress nor result")  # fmt: skip
def replay(options: Options) -> int:
    """Run one row of a sweep again, and write its record.h5 and video.mp4. The record is the same
    bit for bit; it is held against the row.

    exit codes:
      0    the same run again
      2    bad input, or the run would not be the same: versions or the controller's source differ
      3    it came out otherwise than in its row: something is wrong
      130  interrupted (Ctrl-C)

    examples:
      physim replay sweeps/ten_robots:0
      physim replay sweeps/ten_robots:4f1c -o worst
    """
    from physim.campaigns.folder import Folder
    from physim.campaigns.replay import check, find_row, replay, spec_of_row
    from physim.record import Record

    place, colon, which = options.run.rpartition(":")
    if not colon or not place or "\n" in place:
        raise PhysimError(f"{escaped(options.run)}: is not DIR:ROW, as sweeps/ten_robots:0")
    campaign = Folder(place)
    row = find_row(campaign, which)
    spec = spec_of_row(campaign, row, options.controller)
    folder = options.output or usual_folder(row.world, row.seed, row.run)
    with run_folder(folder, options.force), interrupts() as interrupt:
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
            if not options.no_video and not interrupt():
                write_video(record, folder / "video.mp4", options.quiet, interrupt)
            ended, seconds = record.ended, record.steps_run * record.dt
    if not options.quiet:
        if broke and not differing:
            print(f"broke off: {broke}", file=sys.stderr)
        print(f"run {row.run}: {spec.note}; ended {ended} after {seconds:g} s")
        print(f"written to {folder}/: {', '.join(n for n in FILES if (folder / n).exists())}")
    for line in differing:
        print(f"NOT THE SAME  {line}", file=sys.stderr)
    if interrupt():
        return INTERRUPTED
    return DISAGREE if differing else 0


def usual_folder(world: str, seed: int, run: str) -> Path:
    """Where a run goes that is given no folder: in ``runs``, whatever its world is called."""
    return Path("runs") / re.sub(r"[^\w-]+", "_", f"{world}-{seed}-{run[:6]}")
