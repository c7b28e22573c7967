"""``physim crashtest``."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Annotated

from physim.cli.options import JsonFile, Out, Output, Whole, kind, whole
from physim.cli.output import Target, check_json, remove, write_json
from physim.cli.progress import Bar
from physim.terminal import INTERRUPTED, interrupts

DISAGREE = 3
CASE = re.compile(r"case-\d{6,}\.yaml")
"""Name of a world that a crash test wrote"""


def crashtest(
    *,
    cases: Annotated[int, kind(whole(1, 10**9))] = 10_000,
    seed: Whole = 0,
    json: JsonFile | None = None,
    output: Output | None = None,
    force: bool = False,
    quiet: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Drive random footprints into each other, into walls, movers and boxes, at constant commands,
    and compare the first physical contact of each case with its collision time. Each case in which
    the two differ for no known reason is written as a world for physim run.

    options:
      --cases N  number of random cases (10000)
      --seed N  seed of the cases (0)
      -o, --output DIR  folder for the worlds of unexplained cases (default: crashtest-SEED)
      --force  overwrite FILE, and the worlds in DIR
      --quiet  print no progress and no table

    exit codes:
      0    no case is unexplained
      2    bad input
      3    engine and geometry disagree: each unexplained case is reported and written as a world
      130  interrupted (Ctrl-C): the cases so far are reported and written

    examples:
      physim crashtest
      physim crashtest --cases 100000 --seed 1 --json crashtest.json
    """
    from physim.analysis.crashtest import crash_test
    from physim.analysis.crashtest.report import text

    folder = output or Path(f"crashtest-{seed}")
    check_json(json, force)
    earlier = [file for file in sorted(folder.glob("case-*.yaml")) if CASE.fullmatch(file.name)]
    Target(folder, force).folder(earlier, "worlds of an earlier crash test")
    remove(earlier)
    with interrupts() as interrupt, Bar("crash test", cases, "cases", quiet) as bar:
        report = crash_test(cases, seed, folder=folder, progress=bar.update, stop=interrupt)
    write_json(json, report.to_json(), out)
    if not quiet:
        if report.interrupted:
            cut = f"interrupted after {report.cases:,} of {report.asked:,} cases"
            print(f"{cut}; the results so far:", file=sys.stderr, flush=True)
        print(text(report), end="")
    if report.interrupted:
        return INTERRUPTED
    return DISAGREE if report.unexplained else 0
