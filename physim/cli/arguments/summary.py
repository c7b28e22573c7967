"""Arguments of ``physim summary``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, Wrapped, lazy

EPILOG = """\
exit codes:
  0    told, whatever it says
  2    bad input: one message says what and where

examples:
  physim summary runs/ten_robots-21/record.h5
  physim summary out/record.h5 --json > figures.json
  physim summary --definitions
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    summary = commands.add_parser(
        "summary",
        help="figures of a record: contacts, distances, collision times",
        description="Print contacts, distances, collision times, formation errors and modes of a "
        "record, and whether what its world expects held.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    summary.add_argument(
        "record", metavar="RECORD", nargs="?", type=Path, help="record.h5 of a run"
    )
    summary.add_argument("--json", action="store_true", help="print everything as JSON instead")
    summary.add_argument(
        "--definitions", action="store_true",
        help="print what each metric means instead, with its unit and equation or figure",
    )  # fmt: skip
    summary.set_defaults(action=lazy("physim.cli.summary", "summary"))
