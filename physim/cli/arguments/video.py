"""Arguments of ``physim video``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, lazy
from physim.cli.arguments.types import positive, whole


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    video = commands.add_parser(
        "video", help="make the video of a record", description="Make the video of a record."
    )
    video.add_argument("record", metavar="RECORD", type=Path, help="record.h5 of a run")
    video.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="default: video.mp4 beside the record"
    )
    video.add_argument("--force", action="store_true", help="write over an existing file")
    video.add_argument("--fps", type=whole, default=25, metavar="N", help="frames a second (25)")
    video.add_argument(
        "--speed",
        type=positive,
        metavar="X",
        help="simulated seconds a second of video (default: chosen to last at most 80 s)",
    )
    video.add_argument("--quiet", action="store_true", help="no progress bar")
    video.set_defaults(action=lazy("physim.cli.video", "video"))
