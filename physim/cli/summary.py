"""``physim summary``."""

from __future__ import annotations

import argparse

from physim.record import Record
from physim.summary import summarise, table


def summary(options: argparse.Namespace) -> int:
    """Print the summary of a record; returns the exit code."""
    with Record.load(options.record) as record:
        found = summarise(record)
    print(found.to_json() if options.json else table(found), end="")
    return 0
