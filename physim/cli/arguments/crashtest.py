"""Arguments of ``physim crashtest``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, Wrapped, lazy
from physim.cli.arguments.types import whole, whole_from

MOST_CASES = 10**9

EPILOG = """\
exit codes:
  0    no case is unexplained
  2    bad input
  3    engine and analysis disagree: every unexplained case is told and written as a world
  130  interrupted (Ctrl-C): the cases so far are told and written

examples:
  physim crashtest
  physim crashtest --cases 100000 --seed 1 --json crashtest.json
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    crash = commands.add_parser(
        "crashtest",
        help="throw random shapes at each other: engine against analysis",
        description="Throw random footprints at each other and at walls, at constant (v, omega), "
        "and compare the first physical contact of each throw with its collision time. Every case "
        "on which they differ for no known reason is written as a world that physim run replays.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    crash.add_argument(
        "--cases", type=whole_from(1, MOST_CASES), default=10_000, metavar="N",
        help="number of throws (10000)",
    )  # fmt: skip
    crash.add_argument("--seed", type=whole, default=0, metavar="N", help="seed of the throws (0)")
    crash.add_argument(
        "--json",
        type=Path,
        metavar="FILE",
        help="write the figures to FILE (-: standard output) as JSON",
    )
    crash.add_argument(
        "-o", "--output", type=Path, metavar="DIR",
        help="folder for the worlds of unexplained cases (default: crashtest-SEED)",
    )  # fmt: skip
    crash.add_argument(
        "--force", action="store_true", help="write over FILE, and over the worlds in DIR"
    )
    crash.add_argument("--quiet", action="store_true", help="print neither progress nor table")
    crash.set_defaults(action=lazy("physim.cli.crashtest", "crashtest"))
