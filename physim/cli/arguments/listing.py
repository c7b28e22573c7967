"""Arguments of ``physim list``."""

from __future__ import annotations

from physim.cli.arguments.commands import Commands, lazy


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    listing = commands.add_parser(
        "list",
        help="list shipped worlds and controllers",
        description="List the shipped worlds and the registered controllers, a line each.",
    )
    listing.add_argument("--json", action="store_true", help="print JSON instead of a table")
    listing.set_defaults(action=lazy("physim.cli.listing", "listing"))
