"""``physim preview``: a world in, a picture out; again on every save with ``--watch``."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import TextIO

from physim.cli.output import inputs, new_file
from physim.cli.progress import interrupts
from physim.cli.watching import watch
from physim.errors import PhysimError, WorldError
from physim.layout import lay_out
from physim.plots.quick_matplotlib import import_matplotlib
from physim.preview import FORMATS, save_preview
from physim.scene import Layout
from physim.world_file import located, read_world
from physim.world_file.shipped import find_world

INTERRUPTED = 130


def preview(options: argparse.Namespace) -> int:
    """Draw a world; returns the exit code."""
    path = _picture(options)
    if options.watch:
        return _watched(options, path)
    layout = _laid_out(options)
    import_matplotlib()
    with interrupts() as interrupt:  # the picture is whole in any case
        save_preview(layout, path)
    print(path)
    if interrupt():
        print("interrupted when the picture was drawn", file=sys.stderr)
        return INTERRUPTED
    return 0


def _picture(options: argparse.Namespace) -> Path:
    """Where to draw. Raises PhysimError for another ending and an existing file."""
    path: Path = options.output or Path(f"{find_world(options.world).stem}.png")
    if not path.is_dir() and path.suffix.lower()[1:] not in FORMATS:
        raise PhysimError(f"{path}: a picture ends in .png or .svg")
    new_file(path, options.force, *inputs(options.world))
    return path


def _laid_out(options: argparse.Namespace) -> Layout:
    """Read and check the world; every fault with its place in the file."""
    world, document = read_world(options.world, overrides=options.overrides)
    try:
        return lay_out(world, options.seed)
    except WorldError as error:
        raise located(error.faults, document) from None


def _watched(options: argparse.Namespace, path: Path) -> int:
    """Draw on every save and tell what `physim check` finds; with faults the picture stays."""

    from physim.checking import check_world  # here: one picture alone has no need of it

    def draw() -> None:
        try:
            save_preview(_laid_out(options), path)
        except PhysimError as error:
            print(error, file=sys.stderr)
            _tell(f"{path} stays as it is until the faults are mended", sys.stderr)
        else:
            _tell(f"{path} drawn", sys.stdout)
            found = check_world(options.world, overrides=options.overrides, seed=options.seed)
            for kind, group in (("error", found.errors), ("warning", found.warnings)):
                for finding in group:
                    print(f"{kind}: {finding}", file=sys.stderr, flush=True)

    with interrupts() as interrupt:
        watch([find_world(options.world)], draw, interrupt)
    print("interrupted", file=sys.stderr)
    return INTERRUPTED


def _tell(text: str, to: TextIO) -> None:
    print(f"{time.strftime('%H:%M:%S')}  {text}", file=to, flush=True)
