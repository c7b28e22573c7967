"""``physim import``."""

from __future__ import annotations

import argparse
from pathlib import Path

from physim.checking import Finding, check_world
from physim.cli.output import its_folder, new_file, write_text
from physim.cli.schema_file import check_schema, put_schema, written
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
        told = [
            _report(source, imported),
            *_doubts(output, options.lanes or 1),
            written(output, schema, kept),
        ]
        print("\n".join(told))
    return 0


def _check_output(source: Path, output: Path, force: bool) -> None:
    if not output.is_dir() and output.suffix.lower() not in (".yaml", ".yml"):
        raise PhysimError(f"{output}: a world file ends in .yaml")
    new_file(output, force, source)
    its_folder(output)
    check_schema(output, force)


def _report(source: Path, imported: Imported) -> str:
    lines = [f"{source}: {imported.kind}"]
    lines += [f"  {fact}" for fact in imported.facts]
    if imported.changes:
        lines += ["dropped or repaired:", *(f"  {change}" for change in imported.changes)]
    else:
        lines.append("dropped or repaired: nothing")
    return "\n".join(lines)


def _doubts(world: Path, lanes: int) -> list[str]:
    """What `physim check` says of a world just written, what concerns the whole group first."""
    found = check_world(world)
    order = ("formation", "robots")

    def rank(finding: Finding) -> int:
        return next((k for k, key in enumerate(order) if finding.key.startswith(key)), len(order))

    said = [*found.errors, *sorted(found.warnings, key=rank)]
    told = [f"  {one}" for one in said]
    if lanes > 1 and any(one.key.startswith("formation") for one in said):
        told.append("  --lanes 1 has fewer places where paths come close")
    return ["the check of the world says:", *told] if told else []
