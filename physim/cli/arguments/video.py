"""Arguments of ``physim video``."""

from __future__ import annotations

import math
from pathlib import Path

from physim.cli.arguments.commands import Commands, Wrapped, lazy
from physim.cli.arguments.types import number_from, whole_from

EPILOG = """\
exit codes:
  0    the video is made
  2    bad input: one message says what and where
  130  interrupted (Ctrl-C): the film so far is kept as video.cut_short.mp4

examples:
  physim video runs/ten_robots-21/record.h5 --force
  physim video out/record.h5 --speed 1 -o slow.mp4
  physim video with/record.h5 --beside without/record.h5    # with/beside.mp4
  physim video out/record.h5 --from 40 --to 75 -o part.mp4
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    video = commands.add_parser(
        "video",
        help="make the video of a record, slower or faster",
        description="Make the video of a record: 1280 x 720, H.264 in MP4.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    video.add_argument("record", metavar="RECORD", type=Path, help="record.h5 of a run")
    video.add_argument(
        "-o", "--output", type=Path, metavar="FILE",
        help="film, ending in .mp4 (default: video.mp4 beside the record, or beside.mp4)",
    )  # fmt: skip
    video.add_argument(
        "--beside", type=Path, metavar="RECORD",
        help="another run, shown on the right; titles say in what the two worlds differ",
    )  # fmt: skip
    video.add_argument(
        "--from", dest="start", type=number_from(0.0, 1e9), default=0.0, metavar="T",
        help="simulated time at which the film begins [s] (0)",
    )  # fmt: skip
    video.add_argument(
        "--to", dest="end", type=number_from(0.0, 1e9), default=math.inf, metavar="T",
        help="simulated time at which it ends [s] (default: the end of the run)",
    )  # fmt: skip
    video.add_argument("--force", action="store_true", help="write over an existing file")
    video.add_argument(
        "--fps", type=whole_from(1, 240), default=25, metavar="N",
        help="frames a second of video, 1 to 240 (25)",
    )  # fmt: skip
    video.add_argument(
        "--speed",
        type=number_from(0.001, 1e6),
        metavar="X",
        help="simulated seconds a second of video, 0.001 to 1000000 (default: chosen so that the "
        "video lasts at most 80 s)",
    )
    video.add_argument("--quiet", action="store_true", help="no progress bar")
    video.set_defaults(action=lazy("physim.cli.video", "video"))
