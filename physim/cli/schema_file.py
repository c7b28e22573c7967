"""The JSON Schema beside a world that is written, for the editor that opens it."""

from __future__ import annotations

import os
import shlex
from pathlib import Path

from physim.cli.output import regular, write_text
from physim.errors import PhysimError
from physim.world_file.schema import FILE, schema_text


def check_schema(world: Path, force: bool) -> None:
    """Raise PhysimError where `put_schema` would not write: where something odd stands."""
    schema = world.with_name(FILE)
    if force and schema.is_dir():
        raise PhysimError(f"{schema}: is a folder; the schema of worlds goes there")
    if force:
        regular(schema)


def put_schema(world: Path, force: bool) -> tuple[list[Path], str]:
    """Write the schema into the folder of a world.

    One that is there already stays, unless ``force``. Returns the files written, and a line to
    tell where another one than that of this version stays.
    """
    schema = world.with_name(FILE)
    text = schema_text()
    if not force and os.path.lexists(schema):
        kept = f"{schema}: kept, though another than this version's; --force writes over it"
        return [], "" if _same(schema, text) else kept
    write_text(schema, text)
    return [schema], ""


def written(world: Path, schema: list[Path], kept: str) -> str:
    """What was written, and the commands that come next."""
    quoted = shlex.quote(str(world))
    steps = ", ".join(f"physim {step} {quoted}" for step in ("check", "preview", "run"))
    lines = [f"written: {', '.join(map(str, [world, *schema]))}", kept, f"next: {steps}"]
    return "\n".join(line for line in lines if line)


def _same(file: Path, text: str) -> bool:
    try:
        return file.is_file() and file.read_text(encoding="utf-8") == text
    except (OSError, ValueError):
        return False
