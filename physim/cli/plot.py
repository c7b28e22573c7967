"""``physim plot``."""

from __future__ import annotations

import argparse
import sys

from physim.cli.mistakes import shown
from physim.cli.output import a_folder, new_file
from physim.cli.progress import interrupts
from physim.errors import PhysimError, nearest, plural
from physim.plots import draw, names, not_replaced
from physim.record import Record

INTERRUPTED = 130


def plot(options: argparse.Namespace) -> int:
    """Draw pictures of a record; returns the exit code."""
    known = only = names()
    if options.only is not None:
        only = tuple(name.strip() for name in options.only.split(","))
    folder = options.output or options.record.parent
    for name in only:
        if name not in known:
            close = nearest(name[:100], list(known))
            raise PhysimError(f"--only {shown(name)}: must be one of {', '.join(known)}{close}")
    a_folder(folder)
    for name in only:
        new_file(folder / f"{name}.{options.format}", options.force, options.record,
                 another="folder")  # fmt: skip
    for fault in not_replaced(only):
        print(f"WARNING  {fault}", file=sys.stderr)
    with interrupts() as interrupt, Record.load(options.record) as record:
        files = draw(
            record, folder, only=only, format=options.format, force=options.force,
            snapshots=options.snapshots, stop=interrupt,
        )  # fmt: skip
    for file in files:
        print(file)
    if len(files) < len(set(only)):
        print(f"interrupted after {len(files)} of {plural(len(set(only)), 'picture')}",
              file=sys.stderr)  # fmt: skip
        return INTERRUPTED
    return 0
