"""Kernels that are compiled first: what for, how often, and about how long it takes."""

from __future__ import annotations

import sys


def announce_compiling(what: str, seconds: int, quiet: bool) -> None:
    """Print one line on standard error; ``seconds`` is what it took on two quiet cores."""
    if not quiet:
        text = f"compiling {what} (once after an installation or an edit, about {seconds} s) ..."
        print(text, file=sys.stderr, flush=True)
