"""``physim new``: a world or a project to begin with."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import click

from physim.cli.output import empty_folder, new_file, write_text, writing
from physim.cli.parser import Options, command, flag, option
from physim.cli.schema_file import check_schema, write_schema
from physim.cli.values import WHOLE, OneOf
from physim.errors import PhysimError

TEMPLATES = ("corridor", "bend", "doorway", "s_bend", "roundabout", "warehouse")


@command("new", "a world to begin with, every key explained")
@click.argument("name", metavar="[NAME]", required=False, help="name of the world, and of its file")
@option("--template", type=OneOf(TEMPLATES), default=TEMPLATES[0], help="the road (corridor)")
@option("--robots", type=WHOLE, default=3, metavar="N", help="how many, in lanes and rows (3)")
@option("-o", "--output", type=Path, metavar="FILE", help="file to write (default: NAME.yaml)")
@option(
    "--project",
    type=Path,
    metavar="DIR",
    help="make a folder with worlds/, controllers/ with an example, media/ and a README",
)
@flag("--force", "write over existing files")  # fmt: skip
def new(options: Options) -> int:
    """Write NAME.yaml, a world that runs as it is, with a comment on every key, and beside it
    world.schema.json, by which editors complete keys and show what they mean.

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
    from physim.world_file.schema import FILE

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
    print(write_schema(file, options.force))
    return 0


def _project(options: Options) -> int:
    from physim.templates import new_project
    from physim.world_file.schema import schema_text

    folder: Path = options.project
    if options.output is not None:
        raise PhysimError("--project: names a folder, and -o a file; give one of them")
    name, stem = _named(options.name if options.name is not None else options.template)
    title = folder.resolve().name or name
    files = new_project(title, stem, _world(name, options), schema_text())
    empty_folder(folder, options.force, *(folder / place for place in files), option="--project")
    with writing(folder):
        for place, text in files.items():
            (folder / place).parent.mkdir(parents=True, exist_ok=True)
            write_text(folder / place, text)
    print(f"written to {folder}/: {', '.join(files)}")
    print(f"next: cd {shlex.quote(str(folder))}, and the three commands of its README.md")
    return 0


def _named(given: str) -> tuple[str, str]:
    """Name of a world and of its file without ending. Raises PhysimError for one that is bad."""
    from physim.world.kinds import MOST_NAME
    from physim.world_file.shipped import SUFFIXES

    name = given
    for suffix in SUFFIXES:
        name = name.removesuffix(suffix)
    printable = "".join(c if c.isprintable() else "�" for c in given[:MOST_NAME])
    if len(name) > MOST_NAME:
        raise PhysimError(
            f'"{printable[:20]}…": a name has at most {MOST_NAME} characters; given {len(name)}'
        )
    if (
        not re.search(r"\w", name)
        or not name.isprintable()
        or name[0] in "-."
        or name != name.strip()
    ):
        raise PhysimError(
            f'"{printable}": cannot name a world; use letters and digits, as in my_corridor'
        )
    if "/" in name or "\\" in name:
        raise PhysimError(f'"{printable}": names a place, not a world; -o takes a path')
    stem = re.sub(r"[^\w-]+", "_", name).strip("_")
    return name, stem or "world"


def _world(name: str, options: Options) -> str:
    from physim.templates import most_robots, world_text

    template, robots = options.template, options.robots
    most = most_robots(template)
    if not 1 <= robots <= most:
        raise PhysimError(f"--robots {robots}: the template {template} has room for 1 to {most}")
    return world_text(name, template, robots)
