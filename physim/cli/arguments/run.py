"""Arguments of ``physim run``."""

from __future__ import annotations

import argparse
from pathlib import Path

from physim.cli.arguments.commands import Commands, lazy
from physim.cli.arguments.types import whole

EPILOG = """\
exit codes:
  0    ran, and everything under "expect:" in the world held
  1    ran, but an expectation failed
  2    bad input: one message says what and where
  130  interrupted (Ctrl-C): record and video so far are complete and readable

examples:
  physim run ten_robots
  physim run ten_robots --seed 3 --no-video -o /tmp/seed3
  physim run my_world.yaml --set time.duration=20.0 --set controller.beta=0.3
  physim run my_world.yaml --controller my_module:MyController
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    run = commands.add_parser(
        "run",
        help="run a world: record, video and summary",
        description="Run a world and write DIR/record.h5, DIR/video.mp4 and DIR/summary.json.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    run.add_argument("world", metavar="WORLD", help="a world file, or the name of a shipped world")
    run.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="output folder (default: runs/NAME-SEED)"
    )
    run.add_argument("--force", action="store_true", help="write over an earlier run in DIR")
    run.add_argument("--seed", type=whole, metavar="N", help="seed, instead of the world's own")
    run.add_argument(
        "--controller",
        metavar="NAME",
        help="a registered controller (physim list) or your own as module:Class",
    )
    run.add_argument(
        "--set",
        dest="overrides",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="change one value of the world, e.g. robots.0.limits.v=1.2, or leave "
        "one out, e.g. formation=null (may be repeated)",
    )
    run.add_argument("--no-video", action="store_true", help="leave the video out")
    run.add_argument("--quiet", action="store_true", help="no progress bar and no table")
    run.set_defaults(action=lazy("physim.cli.run", "run"))
