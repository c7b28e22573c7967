"""``physim import``."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from physim.cli.output import write_text
from physim.cli.schema_file import put_schema, written
from physim.errors import PhysimError
from physim.importing import Imported, Options, import_world

ASKED = (
    "format", "scale", "tolerance", "specks", "start", "gap", "origin", "goal", "robots", "lanes",
    "robot", "name",
)  # fmt: skip


def import_command(options: argparse.Namespace) -> int:
    """Make a world of a source; returns the exit code."""
    source, output = options.source, options.output
    _check_output(source, output, options.force)
    imported = import_world(source, Options(**{key: getattr(options, key) for key in ASKED}))
    write_text(output, imported.text)
    schema, kept = put_schema(output, options.force)
    if not options.quiet:
        print(_report(source, imported), written(output, schema, kept), sep="\n")
    return 0


def _check_output(source: Path, output: Path, force: bool) -> None:
    if output.is_dir():
        raise PhysimError(f"{output}: is a folder; -o takes the world file to write")
    if source.exists() and output.exists() and os.path.samefile(source, output):
        raise PhysimError(f"{output}: is the source itself; give another file to write")
    if output.suffix.lower() not in (".yaml", ".yml"):
        raise PhysimError(f"{output}: a world file ends in .yaml")
    if os.path.lexists(output) and not force:
        raise PhysimError(f"{output}: exists; use --force to write over it, or -o for another file")
    if not output.parent.is_dir():
        raise PhysimError(f"{output}: there is no folder {output.parent}")


def _report(source: Path, imported: Imported) -> str:
    lines = [f"{source}: {imported.kind}"]
    lines += [f"  {fact}" for fact in imported.facts]
    if imported.changes:
        lines += ["dropped or repaired:", *(f"  {change}" for change in imported.changes)]
    else:
        lines.append("dropped or repaired: nothing")
    return "\n".join(lines)
