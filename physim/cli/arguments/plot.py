"""Arguments of ``physim plot``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, lazy


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    plot = commands.add_parser(
        "plot",
        help="draw pictures of a record",
        description="Draw distances and collision times over time, and predicted against actual "
        "times to contact, from a record.",
    )
    plot.add_argument("record", metavar="RECORD", type=Path, help="record.h5 of a run")
    plot.add_argument(
        "--only", metavar="NAMES",
        help="pictures to draw, with commas between: distances, prediction (default: all)",
    )  # fmt: skip
    plot.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="default: the folder of the record"
    )
    plot.add_argument("--format", choices=("png", "svg", "pdf"), default="png", help="(png)")
    plot.add_argument("--force", action="store_true", help="write over existing pictures")
    plot.set_defaults(action=lazy("physim.cli.plot", "plot"))
