"""Arguments of ``physim check``."""

from __future__ import annotations

from physim.cli.arguments.commands import Commands, Wrapped, add_changes, lazy

EPILOG = """\
exit codes:
  0    no errors; there may be warnings
  2    errors: each with file, line and column
  130  interrupted (Ctrl-C), the way to end --watch

examples:
  physim check my_world.yaml
  physim check worlds/*.yaml --json
  physim check my_world.yaml --watch         keep it running beside the editor
  physim check ten_robots --seed 3 --set corridor.width=6.0
                                             as physim run with these would read it
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    check = commands.add_parser(
        "check",
        help="find every fault of a world before running it",
        description="Read worlds strictly and look at their geometry: all errors and warnings at "
        "once, each with file, line and column, and the room that each robot has on its path.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    check.add_argument(
        "worlds", nargs="+", metavar="WORLD", help="a world file, or the name of a shipped world"
    )
    add_changes(check, each="every world")
    check.add_argument("--json", action="store_true", help="print everything as JSON instead")
    check.add_argument(
        "--watch", action="store_true", help="check again whenever a file is saved, until Ctrl-C"
    )
    check.set_defaults(action=lazy("physim.cli.check", "check_command"))
