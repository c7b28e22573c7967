"""``physim schema``."""

from __future__ import annotations

import argparse

from physim.cli.output import new_file, write_text
from physim.world_file.schema import schema_text


def schema(options: argparse.Namespace) -> int:
    """Print the schema of world files, or write it."""
    if options.output is None:
        print(schema_text(), end="")
        return 0
    new_file(options.output, options.force)
    write_text(options.output, schema_text())
    print(f"written to {options.output}")
    return 0
