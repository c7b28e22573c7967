"""Arguments of ``physim new``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, Wrapped, lazy
from physim.cli.arguments.types import whole

TEMPLATES = ("corridor", "bend", "doorway", "s_bend", "roundabout", "warehouse")

EPILOG = """\
templates:
  corridor    straight, 8 m wide           s_bend      a turn left and a turn right
  bend        a quarter turn               roundabout  in, three quarters round, out
  doorway     a door one robot wide        warehouse   a path through aisles between shelves

exit codes:
  0    written; the world runs as it is
  2    bad input: one message says what and where, and nothing is written

examples:
  physim new my_corridor
  physim new my_door --template doorway --robots 5
  physim new --project my_study --template warehouse
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    new = commands.add_parser(
        "new",
        help="write a world to begin with, every key explained; or a whole project",
        description="Write NAME.yaml, a world that runs as it is, with a comment on every key, and "
        "beside it world.schema.json, by which editors complete keys and show what they mean.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    new.add_argument("name", metavar="NAME", nargs="?", help="name of the world, and of its file")
    new.add_argument(
        "--template", choices=TEMPLATES, default=TEMPLATES[0], help="the road (corridor)"
    )
    new.add_argument(
        "--robots", type=whole, default=3, metavar="N", help="how many, in lanes and rows (3)"
    )
    new.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="file to write (default: NAME.yaml)"
    )
    new.add_argument(
        "--project", type=Path, metavar="DIR",
        help="make a folder with worlds/, controllers/ with an example, media/ and a README",
    )  # fmt: skip
    new.add_argument("--force", action="store_true", help="write over existing files")
    new.set_defaults(action=lazy("physim.cli.new", "new"))
