"""``physim crashtest``."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from physim.cli.compiling import tell_compiling
from physim.cli.output import a_folder, new_file, new_json, people, write_json
from physim.cli.progress import Bar, interrupts
from physim.crashtest import crash_test
from physim.crashtest.foresight import is_warm
from physim.crashtest.report import CrashReport, text
from physim.errors import PhysimError

DISAGREE, INTERRUPTED = 3, 130
COMPILING = 15
"""[s] about, for the collision checks"""


def crashtest(options: argparse.Namespace) -> int:
    """Throw cases and tell how engine and analysis agree; returns the exit code."""
    folder = options.output or Path(f"crashtest-{options.seed}")
    new_json(options.json, options.force)
    _clear(folder, options.force)
    if not is_warm():
        tell_compiling("the collision checks", COMPILING, options.quiet)
    report = _thrown(options, folder)
    write_json(options.json, report.to_json())
    if not options.quiet:
        if report.interrupted:
            print(f"{_cut(report)}; the results so far:", file=sys.stderr, flush=True)
        print(text(report), end="", file=people(options.json))
    if report.interrupted:
        return INTERRUPTED
    return DISAGREE if report.unexplained else 0


def _thrown(options: argparse.Namespace, folder: Path) -> CrashReport:
    bar = Bar("crash test", options.cases, "cases", options.quiet)
    started = time.monotonic()

    def progress(done: int) -> None:
        bar.update(done, lambda: f"{done / (time.monotonic() - started):.0f}/s")

    with interrupts() as interrupt:
        try:
            return crash_test(
                options.cases, options.seed, folder=folder, progress=progress, stop=interrupt
            )
        finally:
            bar.close()


def _clear(folder: Path, force: bool) -> None:
    """Take away the worlds of an earlier test. Raises PhysimError without ``force``."""
    a_folder(folder)
    earlier = sorted(folder.glob("case-*.yaml"))
    for file in earlier:
        new_file(file, True)
    if earlier and not force:
        raise PhysimError(
            f"{folder}: holds worlds of an earlier crash test ({earlier[0].name}); "
            "use --force to write over them, or -o for another folder"
        )
    try:
        for file in earlier:
            file.unlink()
    except OSError as error:
        raise PhysimError(f"{folder}: cannot be written ({error.strerror})") from None


def _cut(report: CrashReport) -> str:
    return f"interrupted after {report.cases:,} of {report.asked:,} cases"
