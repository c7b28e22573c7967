"""Arguments of ``physim reproduce``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, Wrapped, lazy
from physim.cli.arguments.types import whole_from

EPILOG = """\
figures: 1, 2, 3, 3a, 4, 6, 7, 8 (5 is the flow chart of the rules)
studies: alpha, energy, bends, routes, avoidance, switching, hysteresis,
         thresholds, updates, operation

written to DIR:
  reproduction.html   one page with everything in it; videos beside it
  REPRODUCTION.md     the same as Markdown
  reproduction.json   the same as values
  figures/, WORLD/    pictures; record and video of each world

exit codes:
  0    done, whatever the verdicts
  2    bad input
  130  interrupted (Ctrl-C): the pages tell what was done by then

examples:
  physim reproduce --quick
  physim reproduce --figure 6 -o fig6
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    command = commands.add_parser(
        "reproduce",
        help="make the paper's figures again, reported beside measured",
        description="Run the experiments of the paper, draw its figures, make the videos, and "
        "write what it reports beside what is measured, with a verdict for every claim.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    only = command.add_mutually_exclusive_group()
    only.add_argument("--figure", metavar="N", help="only what this figure of the paper needs")
    only.add_argument(
        "--study", metavar="NAME", help="only this study of a claim that the paper makes in words"
    )
    command.add_argument(
        "-o", "--output", type=Path, metavar="DIR", default=Path("reproduction"),
        help="folder to write to (reproduction)",
    )  # fmt: skip
    command.add_argument(
        "--quick", action="store_true", help="few seeds: some minutes instead of half an hour"
    )
    command.add_argument("--no-video", action="store_true", help="leave the videos out")
    command.add_argument(
        "--workers", type=whole_from(1, 64), metavar="N",
        help="processes, 1 to 64 (as many as cores, at most 8)",
    )  # fmt: skip
    command.add_argument("--force", action="store_true", help="write over an existing DIR")
    command.add_argument("--quiet", action="store_true", help="print neither progress nor verdicts")
    command.set_defaults(action=lazy("physim.cli.reproduce", "reproduce"))
