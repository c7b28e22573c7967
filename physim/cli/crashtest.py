"""``physim crashtest``."""

from __future__ import annotations

import re
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from physim.cli.output import new_json, remove_earlier, write_json
from physim.cli.parser import Options, command, flag, option
from physim.cli.progress import Bar, announce_compiling, interrupts
from physim.cli.signals import INTERRUPTED
from physim.cli.values import PATH, WHOLE, whole_from

if TYPE_CHECKING:
    from physim.analysis.crashtest.report import CrashReport

DISAGREE = 3
COMPILING = 15
"""[s] about, for the collision checks"""
CASE = re.compile(r"case-\d{6,}\.yaml")
"""Name of a world that a crash test wrote"""


@command("crashtest", "random shapes: does the engine agree with analysis?")
@option(
    "--cases",
    type=whole_from(1, 10**9),
    default=10_000,
    metavar="N",
    help="number of random cases (10000)",
)
@option("--seed", type=WHOLE, default=0, metavar="N", help="seed of the cases (0)")
@option(
    "--json",
    type=PATH,
    metavar="FILE",
    help="write the figures to FILE (-: standard output) as JSON",
)
@option(
    "-o",
    "--output",
    type=PATH,
    metavar="DIR",
    help="folder for the worlds of unexplained cases (default: crashtest-SEED)",
)
@flag("--force", "overwrite FILE, and the worlds in DIR")
@flag("--quiet", "print neither progress nor table")  # fmt: skip
def crashtest(options: Options) -> int:
    """Throw random footprints at each other and at walls, at constant (v, omega), and compare the
    first physical contact of each throw with its collision time. Every case on which they differ
    for no known reason is written as a world that physim run replays.

    exit codes:
      0    no case is unexplained
      2    bad input
      3    engine and analysis disagree: every unexplained case is reported and written as a world
      130  interrupted (Ctrl-C): the cases so far are reported and written

    examples:
      physim crashtest
      physim crashtest --cases 100000 --seed 1 --json crashtest.json
    """
    from physim.analysis.crashtest.prediction import is_warm
    from physim.analysis.crashtest.report import text

    folder = options.output or Path(f"crashtest-{options.seed}")
    new_json(options.json, options.force)
    earlier = [file for file in sorted(folder.glob("case-*.yaml")) if CASE.fullmatch(file.name)]
    remove_earlier(folder, earlier, options.force, what="worlds of an earlier crash test")
    if not is_warm():
        announce_compiling("the collision checks", COMPILING, options.quiet)
    report = _simulate_throws(options, folder)
    write_json(options, report.to_json())
    if not options.quiet:
        if report.interrupted:
            cut = f"interrupted after {report.cases:,} of {report.asked:,} cases"
            print(f"{cut}; the results so far:", file=sys.stderr, flush=True)
        print(text(report), end="")
    if report.interrupted:
        return INTERRUPTED
    return DISAGREE if report.unexplained else 0


def _simulate_throws(options: Options, folder: Path) -> CrashReport:
    from physim.analysis.crashtest import crash_test

    started = time.monotonic()

    def progress(done: int) -> None:
        bar.update(done, lambda: f"{done / (time.monotonic() - started):.0f}/s")

    quiet = options.quiet
    with interrupts() as interrupt, Bar("crash test", options.cases, "cases", quiet) as bar:
        return crash_test(
            options.cases, options.seed, folder=folder, progress=progress, stop=interrupt
        )
