"""``physim validate``."""

from __future__ import annotations

import argparse
from pathlib import Path

from physim.record import Record
from physim.validation import report, validate


def validate_command(options: argparse.Namespace) -> int:
    """Validate a world or a record; returns the exit code."""
    with Record.load(Path(options.given)) as record:
        found = validate(record)
    print(report(found), end="")
    return found.code
