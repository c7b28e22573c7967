"""The JSON Schema beside a world that is written, for the editor that opens it."""

from __future__ import annotations

import os
import shlex
from pathlib import Path

from physim.cli.output import regular, write_text
from physim.errors import PhysimError


def check_schema(world: Path, force: bool) -> None:
    """Raise PhysimError where `write_schema` would not write: where something odd stands."""
    from physim.world_file.schema import FILE

    schema = world.with_name(FILE)
    if force and schema.is_dir():
        raise PhysimError(f"{schema}: is a folder; the schema of worlds goes there")
    if force:
        regular(schema)


def write_schema(world: Path, force: bool) -> str:
    """Write the schema into the folder of a world; returns what to print of it all.

    That is: what was written, and the commands that come next. A schema that is there already
    stays, unless ``force``, and a line says so where it is another than that of this version.
    """
    from physim.world_file.schema import FILE, schema_text

    schema, text = world.with_name(FILE), schema_text()
    files, kept = [world, schema], ""
    if force or not os.path.lexists(schema):
        write_text(schema, text)
    else:
        files.remove(schema)
        if not _holds(schema, text):
            kept = f"{schema}: kept, though another than this version's; --force writes over it"
    quoted = shlex.quote(str(world))
    steps = ", ".join(f"physim {step} {quoted}" for step in ("check", "preview", "run"))
    lines = [f"written: {', '.join(map(str, files))}", kept, f"next: {steps}"]
    return "\n".join(line for line in lines if line)


def _holds(file: Path, text: str) -> bool:
    try:
        return file.is_file() and file.read_text(encoding="utf-8") == text
    except (OSError, ValueError):
        return False
