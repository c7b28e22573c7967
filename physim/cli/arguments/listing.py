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
  physim run three_robots --observer NAME    NAME as listed under observers
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    listing = commands.add_parser(
        "list",
        help="list the worlds that come with physim, controllers and other parts",
        description="List the shipped worlds and, a line each, what is registered: controllers, "
        "sensing stages, filters, disturbances, observers; of metrics and plots those of other "
        "packages.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    listing.add_argument("--json", action="store_true", help="print JSON instead of a table")
    listing.set_defaults(action=lazy("physim.cli.listing", "listing"))
