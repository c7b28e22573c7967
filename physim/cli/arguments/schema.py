"""Arguments of ``physim schema``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.arguments.commands import Commands, Wrapped, lazy

EPILOG = """\
An editor that knows YAML schemas (VS Code with the YAML extension, and all others that use
yaml-language-server) completes keys and shows units and meanings where a world begins with

  # yaml-language-server: $schema=world.schema.json

the path of the schema as seen from the world. It works without a network. The schema holds every
registered controller with its settings, those of your own packages too.

exit codes:
  0    printed or written
  2    bad input: one message says what and where

examples:
  physim schema -o worlds/world.schema.json
"""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    schema = commands.add_parser(
        "schema",
        help="print the JSON Schema of world files, for editors",
        description="Print the JSON Schema of world files: every key with its unit and meaning.",
        epilog=EPILOG,
        formatter_class=Wrapped,
    )
    schema.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="write it to a file instead"
    )
    schema.add_argument("--force", action="store_true", help="write over an existing file")
    schema.set_defaults(action=lazy("physim.cli.schema", "schema"))
