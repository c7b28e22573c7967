"""The command line: ``physim run``, ``video``, ``summary``, ``validate``, ``crashtest``,
``plot``, ``preview``, ``import``, ``list``."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code.

    0 fine, 1 ran but an expectation failed or there was contact, 2 bad input, 3 checks disagree,
    130 interrupted.
    """
    try:
        try:
            return _main(arguments)
        finally:
            sys.stdout.flush()
    except BrokenPipeError:  # the reader has gone; say nothing more
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _main(arguments: Sequence[str] | None) -> int:
    from physim.cli.parser import build_parser
    from physim.errors import PhysimError, WorldError

    options = build_parser().parse_args(arguments)
    try:
        code: int = options.action(options)
    except PhysimError as error:
        placed = isinstance(error, WorldError) and bool(error.positions)
        print(error if placed else f"physim: {error}", file=sys.stderr)  # file:line:column first
        return 2
    except KeyboardInterrupt:
        print("physim: interrupted", file=sys.stderr)
        return 130
    return code
