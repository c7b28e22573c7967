"""Arguments of ``physim plot``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, Wrapped, lazy
from physim.cli.arguments.types import positive

EPILOG = """\
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


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    plot = commands.add_parser(
        "plot",
        help="draw the figures of a record",
        description="Draw the figures of the paper, and more, from a record alone.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    plot.add_argument("record", metavar="RECORD", type=Path, help="record.h5 of a run")
    plot.add_argument(
        "--only",
        metavar="NAMES",
        help="figures to draw, as listed below, with commas between (default: all)",
    )
    plot.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="DIR",
        help="folder for the pictures (default: that of the record)",
    )
    plot.add_argument(
        "--format", choices=("png", "svg", "pdf"), default="png", help="kind of the pictures (png)"
    )
    plot.add_argument("--force", action="store_true", help="write over existing pictures")
    plot.add_argument(
        "--snapshots", type=positive, metavar="S",
        help="simulated seconds between the robots in trajectories (default: about ten in the run)",
    )  # fmt: skip
    plot.set_defaults(action=lazy("physim.cli.plot", "plot"))
