"""``physim schema``."""

from __future__ import annotations

from pathlib import Path

from physim.cli.output import new_file, write_text
from physim.cli.parser import Options, command, flag, option


@command("schema", "the JSON Schema of world files, for editors")
@option("-o", "--output", type=Path, metavar="FILE", help="write it to a file instead")
@flag("--force", "write over an existing file")
def schema(options: Options) -> int:
    """Print the JSON Schema of world files: every key with its unit and meaning.

    An editor that knows YAML schemas (VS Code with the YAML extension, and all others that use
    yaml-language-server) completes keys and shows units and meanings where a world begins with

      # yaml-language-server: $schema=world.schema.json

    the path of the schema as seen from the world. It works without a network. The schema holds
    every registered controller with its settings, those of your own packages too.

    exit codes:
      0    printed or written
      2    bad input: one message says what and where

    examples:
      physim schema -o worlds/world.schema.json
    """
    from physim.world_file.schema import schema_text

    if options.output is None:
        print(schema_text(), end="")
        return 0
    new_file(options.output, options.force)
    write_text(options.output, schema_text())
    print(f"written to {options.output}")
    return 0
