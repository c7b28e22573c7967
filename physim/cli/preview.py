"""``physim preview``: a world in, a picture out; again on every save with ``--watch``."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import click

from physim.cli.output import inputs, new_file
from physim.cli.parser import Options, changes, command, flag, option
from physim.cli.progress import INTERRUPTED, interrupts
from physim.cli.watching import watch
from physim.errors import PhysimError, WorldError

if TYPE_CHECKING:
    from physim.scene import Layout


@command("preview", "draw a world before it is run")
@click.argument("world", metavar="WORLD", help="a world file, or the name of a shipped world")
@option(
    "-o",
    "--output",
    type=Path,
    metavar="FILE",
    help="picture, ending in .png or .svg (default: the world's file name with .png, here)",
)
@flag("--watch", "draw again whenever the world is saved, until Ctrl-C")
@flag("--force", "write over an existing picture")
@changes(controller=False)  # fmt: skip
def preview(options: Options) -> int:
    """Draw one picture of a world: boundaries, safe and danger area, paths, robots at the start,
    the narrowest place, and the width along the reference path.

    exit codes:
      0    drawn
      2    bad input: every fault of the world with its place in the file
      130  interrupted (Ctrl-C), as --watch always ends

    examples:
      physim preview ten_robots
      physim preview my_world.yaml -o my_world.svg
      physim preview my_world.yaml --watch       keep the picture open beside the editor
    """
    from physim.preview import save_preview

    path = _picture(options)
    if options.watch:
        return _draw_on_save(options, path)
    layout = _laid_out(options)
    with interrupts() as interrupt:  # the picture is whole in any case
        save_preview(layout, path)
    print(path)
    if interrupt():
        print("interrupted when the picture was drawn", file=sys.stderr)
        return INTERRUPTED
    return 0


def _picture(options: Options) -> Path:
    """Where to draw. Raises PhysimError for another ending and an existing file."""
    from physim.preview import FORMATS
    from physim.world_file.shipped import find_world

    path: Path = options.output or Path(f"{find_world(options.world).stem}.png")
    if not path.is_dir() and path.suffix.lower()[1:] not in FORMATS:
        raise PhysimError(f"{path}: a picture ends in .png or .svg")
    new_file(path, options.force, *inputs(options.world))
    return path


def _laid_out(options: Options) -> Layout:
    """Read and check the world; every fault with its place in the file."""
    from physim.layout import lay_out
    from physim.world_file import located, read_world

    world, document = read_world(options.world, overrides=options.overrides)
    try:
        return lay_out(world, options.seed)
    except WorldError as error:
        raise located(error.faults, document) from None


def _draw_on_save(options: Options, path: Path) -> int:
    """Draw on every save and print what `physim check` finds; with faults the picture stays."""
    from physim.checking import check_world
    from physim.preview import save_preview
    from physim.world_file.shipped import find_world

    def draw() -> None:
        try:
            save_preview(_laid_out(options), path)
        except PhysimError as error:
            print(error, file=sys.stderr)
            _log(f"{path} stays as it is until the faults are mended", sys.stderr)
        else:
            _log(f"{path} drawn", sys.stdout)
            found = check_world(options.world, overrides=options.overrides, seed=options.seed)
            for kind, group in (("error", found.errors), ("warning", found.warnings)):
                for finding in group:
                    print(f"{kind}: {finding}", file=sys.stderr, flush=True)

    return watch([find_world(options.world)], draw)


def _log(text: str, to: TextIO) -> None:
    print(f"{time.strftime('%H:%M:%S')}  {text}", file=to, flush=True)
