"""``physim plot``."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from physim.cli.output import a_folder, new_file
from physim.cli.parser import Options, command, flag, option
from physim.cli.progress import INTERRUPTED, interrupts
from physim.cli.values import POSITIVE, OneOf, not_among
from physim.errors import PhysimError, plural


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
@flag("--force", "write over existing pictures")
@option(
    "--snapshots", type=POSITIVE, metavar="S",
    help="simulated seconds between the robots in trajectories (default: about ten in the run)",
)  # fmt: skip
def plot(options: Options) -> int:
    """Draw the figures of the paper, and more, from a record alone.

    figures (docs/FIGURES.md tells what each shows and how it is worked out):
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
    from physim.plots import draw, names, not_replaced
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
