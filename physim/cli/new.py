"""``physim new``, a world or a project to begin with; ``physim schema``, for editors."""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path

from physim.cli.options import File, Output, Whole, quoted
from physim.cli.output import WORLD, Target, inputs, writing
from physim.errors import PhysimError
from physim.files import write_text


def check_files(world: Path, force: bool, *inputs: Path) -> None:
    """Raise PhysimError where a world and its schema cannot be written: over an input, too."""
    from physim.world.file.schema import FILE

    if world.name == FILE:
        raise PhysimError(f"{world}: is the name of the schema; choose another one")
    Target(world, force, inputs).file(ends=WORLD)
    if force:
        Target(world.with_name(FILE), True, inputs).file()


def write_schema(world: Path, force: bool) -> str:
    """Write the schema into the folder of a world; returns what to print of it all.

    That is: what was written, and the commands that come next. A schema that is there already
    stays, unless ``force``, and a line says so where it is another than that of this version.
    """
    from physim.world.file.schema import FILE, schema_text

    schema, text = world.with_name(FILE), schema_text()
    lines = [f"written: {world}"]
    if force or not os.path.lexists(schema):
        write_text(schema, text)
        lines = [f"written: {world}, {schema}"]
    elif not schema.is_file() or schema.read_bytes() != text.encode():
        lines += [f"{schema}: kept, though it differs from this version's; --force overwrites it"]
    file = shlex.quote(str(world))
    steps = ", ".join(f"physim {step} {file}" for step in ("check", "preview", "run"))
    return "\n".join([*lines, f"next: {steps}"])


def schema(
    *,
    output: Output | None = None,
    force: bool = False,
) -> int:  # fmt: skip
    """Print the JSON Schema of world files: every key with its unit and meaning.

    options:
      -o, --output FILE  write it to a file instead
      --force  overwrite an existing file

    An editor that knows YAML schemas (VS Code with the YAML extension, or any that uses
    yaml-language-server) completes keys and shows units and meanings, if the world begins with

      # yaml-language-server: $schema=world.schema.json

    where the path is relative to the world. It needs no network. The schema has every registered
    controller with its settings, also those of your own packages.

    exit codes:
      0    printed or written
      2    bad input: one message says what and where

    examples:
      physim schema -o worlds/world.schema.json
    """
    from physim.world.file.schema import schema_text

    if output is None:
        if force:
            raise PhysimError("--force: needs -o FILE; without it nothing is overwritten")
        print(schema_text(), end="")
        return 0
    write_text(Target(output, force).file(), schema_text())
    print(f"written to {output}")
    return 0


def new(
    name: str | None = None, /, *,
    like: str | None = None,
    robots: Whole | None = None,
    seed: Whole | None = None,
    output: Output | None = None,
    project: File | None = None,
    force: bool = False,
) -> int:  # fmt: skip
    """Write NAME.yaml, a world that runs as it is, with a comment on every key. Also write
    world.schema.json beside it: editors use it to complete keys and to show what they mean.

    arguments:
      [NAME]  name of the world and of its file (with --project: default is that of the folder)

    options:
      --like WORLD  copy this world (default: straight; with --project: a corridor)
      --robots N  number of robots, if that world has one group
      --seed N  if that world has corridor.random: write the road that this seed draws
      -o, --output FILE  file to write (default: NAME.yaml)
      --project DIR  make a folder with worlds/, an example in controllers/, and a README that leads
          from the first run to a comparison of two controllers
      --force  overwrite existing files

    worlds to begin with, among others:
      straight    two robots, the smallest     s_bend          a turn left and a turn right
      doorway     a door one robot wide        crossing        two roads cross
      merging     two roads become one         roundabout      robots go round it
      warehouse   aisles between shelves       hundred_robots  one group: --robots says how many
      random_road bends and obstacles that the seed draws, beside a clear passage

    exit codes:
      0    written; the world runs as it is
      2    bad input: one message says what and where, and nothing is written

    examples:
      physim new my_corridor
      physim new my_fleet --like hundred_robots --robots 20
      physim new --project my_study
      physim new my_road --like random_road --seed 7
                                                 the road that this seed draws, as a plain world
    """
    from physim.authoring.new import corridor_text, drawn_text, new_project, new_text
    from physim.world.file.schema import schema_text

    if robots is not None and seed is not None:
        raise PhysimError("--robots: cannot be combined with --seed, which keeps the robots")
    if project is not None and output is not None:
        raise PhysimError("--project: names a folder, and -o a file; give one of them")
    if name is None and output is None and project is None:
        raise PhysimError("physim new: NAME is missing, as in physim new my_corridor")
    is_usual = project is not None and like is None and robots is None and seed is None
    like = like or "straight"
    place = Path(like) if project is None else Path(os.path.abspath(project))
    title, stem = _named(name if name is not None else (output or place).name)
    file = output or Path(f"{stem}.yaml")
    if project is None:
        check_files(file, force, *inputs(like))
    if is_usual:
        text = corridor_text(title)
    else:
        text = new_text(title, like, robots) if seed is None else drawn_text(title, like, seed)
    if project is None:
        written = write_schema(file, force)  # first: without the world nothing is new
        write_text(file, text)
        print(written)
        return 0
    files = new_project(title, stem, text, schema_text())
    made = [project / one for one in files]
    Target(project, force, option="--project").folder(made, empty=True)
    with writing(project):
        for path, content in zip(made, files.values(), strict=True):
            path.parent.mkdir(parents=True, exist_ok=True)
            write_text(path, content)
    print(f"written to {project}/: {', '.join(files)}")
    print(f"next: cd {shlex.quote(str(project))}, and the commands of its README.md")
    return 0


def _named(given: str) -> tuple[str, str]:
    """Name of a world and of its file without ending. Raises PhysimError for one that is bad."""
    from physim.world.file.files import SUFFIXES
    from physim.world.kinds import MOST_NAME

    name = given
    for suffix in SUFFIXES:
        name = name.removesuffix(suffix)
    sound = re.search(r"\w", name) and name.isprintable() and name == name.strip(" ").lstrip("-.")
    if not sound or len(name) > MOST_NAME or "/" in name or "\\" in name:
        raise PhysimError(
            f"{quoted(given)}: cannot name a world; use letters and digits, at most {MOST_NAME}, "
            "as in my_corridor (-o takes a path)"
        )
    return name, re.sub(r"[^\w-]+", "_", name).strip("_") or "world"
