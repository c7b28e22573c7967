"""Saying that kernels are compiled: of what, how often, and about how long it takes."""

from __future__ import annotations

import sys


def tell_compiling(what: str, seconds: int, quiet: bool) -> None:
    """Print one line on standard error; ``seconds`` is what it took on two quiet cores."""
    if not quiet:
        told = f"compiling {what} (once after an installation or an edit, about {seconds} s) ..."
        print(told, file=sys.stderr, flush=True)
