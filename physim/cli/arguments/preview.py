"""Arguments of ``physim preview``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, Wrapped, add_overrides, lazy
from physim.cli.arguments.types import whole

EPILOG = """\
exit codes:
  0    drawn
  2    bad input: every fault of the world with its place in the file
  130  interrupted (Ctrl-C), as --watch always ends

examples:
  physim preview ten_robots
  physim preview my_world.yaml -o my_world.svg
  physim preview my_world.yaml --watch       keep the picture open beside the editor
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    preview = commands.add_parser(
        "preview",
        help="draw a world before it is run",
        description="Draw one picture of a world: boundaries, safe and danger area, paths, robots "
        "at the start, the narrowest place, and the width along the reference path.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    preview.add_argument(
        "world", metavar="WORLD", help="a world file, or the name of a shipped world"
    )
    preview.add_argument(
        "-o", "--output", type=Path, metavar="FILE",
        help="picture, ending in .png or .svg (default: the world's file name with .png, here)",
    )  # fmt: skip
    preview.add_argument(
        "--watch", action="store_true", help="draw again whenever the world is saved, until Ctrl-C"
    )
    preview.add_argument("--force", action="store_true", help="write over an existing picture")
    preview.add_argument("--seed", type=whole, metavar="N", help="seed, instead of the world's own")
    add_overrides(preview)
    preview.set_defaults(action=lazy("physim.cli.preview", "preview"))
