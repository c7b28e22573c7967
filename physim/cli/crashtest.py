"""``physim crashtest``."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from physim.cli.output import write_text
from physim.cli.progress import Bar, interrupts
from physim.crashtest import crash_test
from physim.crashtest.foresight import is_warm
from physim.crashtest.report import text
from physim.errors import PhysimError

DISAGREE, INTERRUPTED = 3, 130


def crashtest(options: argparse.Namespace) -> int:
    """Throw cases and tell how engine and analysis agree; returns the exit code."""
    if options.cases < 1:
        raise PhysimError("--cases 0: at least one case is needed")
    folder = options.output or Path(f"crashtest-{options.seed}")
    if folder.exists() and not folder.is_dir():
        raise PhysimError(f"{folder}: is a file; -o takes a folder")
    if options.json is not None and not options.json.parent.is_dir():
        raise PhysimError(f"{options.json}: its folder does not exist")
    if not is_warm() and not options.quiet:
        told = "compiling the kernels, once after an installation or an edit ..."
        print(told, file=sys.stderr, flush=True)
    bar = Bar("crash test", options.cases, "cases", options.quiet)
    started = time.monotonic()

    def progress(done: int) -> None:
        bar.update(done, lambda: f"{done / (time.monotonic() - started):.0f}/s")

    with interrupts() as interrupt:
        try:
            report = crash_test(
                options.cases, options.seed, folder=folder, progress=progress, stop=interrupt
            )
        finally:
            bar.close()
    if options.json is not None:
        write_text(options.json, report.to_json())
    if not options.quiet:
        print(text(report), end="")
    if report.stopped:
        return INTERRUPTED
    return DISAGREE if report.unexplained else 0
