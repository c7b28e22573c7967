"""Arguments of ``physim list``."""

from __future__ import annotations

from physim.cli.arguments.commands import Commands, Wrapped, lazy

EPILOG = """\
exit codes:
  0    listed
  2    bad input

examples:
  physim list
  physim run NAME                            NAME as listed under worlds
  physim run three_robots --controller NAME  NAME as listed under controllers
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    listing = commands.add_parser(
        "list",
        help="list the worlds and controllers that come with physim",
        description="List the shipped worlds and the registered controllers, a line each.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    listing.add_argument("--json", action="store_true", help="print JSON instead of a table")
    listing.set_defaults(action=lazy("physim.cli.listing", "listing"))
