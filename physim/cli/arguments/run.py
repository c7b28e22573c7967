"""Arguments of ``physim run``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, Wrapped, add_changes, lazy

EPILOG = """\
exit codes:
  0    ran, and everything under "expect:" in the world held
  1    ran, but an expectation failed
  2    bad input: one line a fault says what and where
  130  interrupted (Ctrl-C): the record so far is whole, and so is its video; a second Ctrl-C
       cuts the video short, which is then kept as video.cut_short.mp4

keys for --set: worlds/README.md tells all; physim new writes a world with each explained

examples:
  physim run ten_robots
  physim run ten_robots --seed 3 --no-video -o /tmp/seed3
  physim run my_world.yaml --set time.duration=20.0 --set controller.beta=0.3
  physim run my_world.yaml --controller my_module:MyController
  physim run my_world.yaml --observer my_module:MyObserver
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    run = commands.add_parser(
        "run",
        help="run a world: record, video and summary",
        description="Run a world and write DIR/record.h5, DIR/video.mp4 and DIR/summary.json.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    run.add_argument("world", metavar="WORLD", help="a world file, or the name of a shipped world")
    run.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="output folder (default: runs/NAME-SEED)"
    )
    run.add_argument("--force", action="store_true", help="write over an earlier run in DIR")
    add_changes(run)
    run.add_argument(
        "--observer",
        dest="observers",
        action="append",
        default=[],
        metavar="NAME",
        help="let a registered observer (physim list) or your own, as module:Class, look on (may "
        "be repeated)",
    )
    run.add_argument("--no-video", action="store_true", help="leave the video out")
    run.add_argument("--quiet", action="store_true", help="print neither progress nor table")
    run.set_defaults(action=lazy("physim.cli.run", "run"))
