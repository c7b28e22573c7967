"""``physim new``: a world or a project to begin with."""

from __future__ import annotations

import argparse
import re
import shlex
from pathlib import Path

from physim.cli.output import a_folder, new_file, regular, write_text
from physim.cli.schema_file import check_schema, put_schema, written
from physim.errors import PhysimError
from physim.templates import most_robots, new_project, world_text
from physim.world.kinds import MOST_NAME
from physim.world_file.schema import FILE, schema_text
from physim.world_file.shipped import SUFFIXES


def new(options: argparse.Namespace) -> int:
    """Write a world, or a project with one; returns the exit code."""
    if options.project is not None:
        return _project(options)
    if options.name is None and options.output is None:
        raise PhysimError("physim new: NAME is missing, as in physim new my_corridor")
    name, stem = _named(options.name if options.name is not None else options.output.name)
    file = options.output or Path(f"{stem}.yaml")
    if file.name == FILE:
        raise PhysimError(f"{file}: is the name of the schema; choose another one")
    new_file(file, options.force)
    check_schema(file, options.force)
    write_text(file, _world(name, options))
    schema, kept = put_schema(file, options.force)
    print(written(file, schema, kept))
    return 0


def _project(options: argparse.Namespace) -> int:
    folder: Path = options.project
    if options.output is not None:
        raise PhysimError("--project: names a folder, and -o a file; give one of them")
    name, stem = _named(options.name if options.name is not None else options.template)
    a_folder(folder, "--project")
    title = folder.resolve().name or name
    files = new_project(title, stem, _world(name, options), schema_text())
    try:
        if folder.exists() and any(folder.iterdir()) and not options.force:
            raise PhysimError(f"{folder}: is not empty; choose another folder, or use --force")
        for place in files:
            regular(folder / place)
        for place, text in files.items():
            (folder / place).parent.mkdir(parents=True, exist_ok=True)
            write_text(folder / place, text)
    except OSError as error:
        raise PhysimError(f"{folder}: cannot be written ({error.strerror})") from None
    print(f"written to {folder}/: {', '.join(files)}")
    print(f"next: cd {shlex.quote(str(folder))}, and the three commands of its README.md")
    return 0


def _named(given: str) -> tuple[str, str]:
    """Name of a world and of its file without ending. Raises PhysimError for one that is bad."""
    name = given
    for suffix in SUFFIXES:
        name = name.removesuffix(suffix)
    told = "".join(c if c.isprintable() else "�" for c in given[:MOST_NAME])
    if len(name) > MOST_NAME:
        raise PhysimError(
            f'"{told[:20]}…": a name has at most {MOST_NAME} characters; given {len(name)}'
        )
    if (
        not re.search(r"\w", name)
        or not name.isprintable()
        or name[0] in "-."
        or name != name.strip()
    ):
        raise PhysimError(
            f'"{told}": cannot name a world; use letters and digits, as in my_corridor'
        )
    if "/" in name or "\\" in name:
        raise PhysimError(f'"{told}": names a place, not a world; -o takes a path')
    stem = re.sub(r"[^\w-]+", "_", name).strip("_")
    return name, stem or "world"


def _world(name: str, options: argparse.Namespace) -> str:
    template, robots = options.template, options.robots
    most = most_robots(template)
    if not 1 <= robots <= most:
        raise PhysimError(f"--robots {robots}: the template {template} has room for 1 to {most}")
    return world_text(name, template, robots)
