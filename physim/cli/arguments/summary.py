"""Arguments of ``physim summary``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, lazy


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    summary = commands.add_parser(
        "summary",
        help="summarise a record",
        description="Contacts, distances, collision times, formation errors and modes of a record.",
    )
    summary.add_argument(
        "record", metavar="RECORD", nargs="?", type=Path, help="record.h5 of a run"
    )
    summary.add_argument("--json", action="store_true", help="print JSON instead of a table")
    summary.add_argument(
        "--definitions", action="store_true",
        help="print what each metric is, with its unit and equation or figure, and no record",
    )  # fmt: skip
    summary.set_defaults(action=lazy("physim.cli.summary", "summary"))
