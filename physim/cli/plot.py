"""``physim plot``."""

from __future__ import annotations

import argparse

from physim.plots import NAMES, draw
from physim.record import Record


def plot(options: argparse.Namespace) -> int:
    """Draw pictures of a record; returns the exit code."""
    only = NAMES
    if options.only is not None:
        only = tuple(name.strip() for name in options.only.split(","))
    folder = options.output or options.record.parent
    with Record.load(options.record) as record:
        files = draw(
            record, folder, only=only, format=options.format, force=options.force,
            snapshots=options.snapshots,
        )  # fmt: skip
    for file in files:
        print(file)
    return 0
