"""``physim reproduce``: the paper's figures again, reported beside measured."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from physim.cli.output import empty_folder, write_text, writing
from physim.cli.parser import Options, command, flag, option
from physim.cli.progress import Bar, announce_compiling, interrupts
from physim.cli.signals import INTERRUPTED
from physim.cli.values import PATH, whole_from
from physim.errors import PhysimError, plural

if TYPE_CHECKING:
    from physim.reproduction.plan import Plan
    from physim.reproduction.report import Report

COMPILING = 30
"""[s] about, for all that its jobs need"""
PICTURE = re.compile(r"(\d[a-z]?|study)-[a-z_]+\.png")
"""Name of a picture that a reproduction drew"""


@command("reproduce", "the paper's figures again, reported beside measured")
@option("--figure", metavar="N", help="only what this figure of the paper needs")
@option("--study", metavar="NAME", help="only this study of a claim that the paper makes in words")
@option(
    "-o",
    "--output",
    type=PATH,
    metavar="DIR",
    default=Path("reproduction"),
    help="folder to write to (reproduction)",
)
@flag("--quick", "few seeds: some minutes instead of half an hour")
@flag("--no-video", "make no videos")
@option(
    "--workers",
    type=whole_from(1, 64),
    metavar="N",
    help="processes, 1 to 64 (as many as cores, at most 8)",
)
@flag("--force", "overwrite an existing DIR")
@flag("--quiet", "print neither progress nor verdicts")  # fmt: skip
def reproduce(options: Options) -> int:
    """Run the experiments of the paper, draw its figures, make the videos, and write what it
    reports beside what is measured, with a verdict for every claim.

    figures: 1, 2, 3, 3a, 4, 6, 7, 8 (5 is the flow chart of the rules)
    studies: alpha, energy, bends, routes, avoidance, switching, hysteresis,
             thresholds, updates, operation

    written to DIR:
      reproduction.html   one page with everything in it; videos beside it
      REPRODUCTION.md     the same as Markdown
      reproduction.json   the same as values
      figures/, WORLD/    pictures; record, video and page of each world

    exit codes:
      0    done, whatever the verdicts
      2    bad input
      130  interrupted (Ctrl-C): the pages hold what was done by then

    examples:
      physim reproduce --quick
      physim reproduce --figure 6 -o fig6
    """
    if options.figure is not None and options.study is not None:
        raise PhysimError("--study: cannot be combined with --figure")
    from physim.campaigns.runner import worker_count
    from physim.cli.simulating import tell_notices
    from physim.reproduction.plan import make_plan
    from physim.reproduction.reproduce import PAGES, pages
    from physim.reproduction.reproduce import reproduce as run_all

    plan = make_plan(options.figure, options.study, options.quick, not options.no_video)
    folder = _folder(options.output, plan, options.force)
    tell_notices(plan.notices())

    with interrupts() as interrupt:
        _warm_up(plan, options.quiet)
        with Bar("reproduce", 1.0, "jobs", options.quiet) as bar:
            report = run_all(
                plan, folder, workers=options.workers or worker_count(), command=_command(options),
                stop=interrupt, progress=bar.count,
            )  # fmt: skip
        for name, text in pages(report, folder).items():
            write_text(folder / name, text)
    if not options.quiet:
        print(_verdicts(report), end="")
        print(f"written to {folder}/: {', '.join(PAGES)}")
    return INTERRUPTED if report.interrupted else 0


def _folder(folder: Path, plan: Plan, force: bool) -> Path:
    """Make the folders to write to. Raises PhysimError where there is something already."""
    from physim.reproduction.plan import PICTURES
    from physim.reproduction.reproduce import PAGES

    empty_folder(folder, force, *(folder / name for name in (PICTURES, *plan.worlds, *PAGES)))
    with writing(folder):
        for name in (PICTURES, *plan.worlds):
            (folder / name).mkdir(parents=True, exist_ok=True)
        pictures = (one for one in (folder / PICTURES).iterdir() if PICTURE.fullmatch(one.name))
        for old in (*(folder / name for name in PAGES), *pictures):
            old.unlink(missing_ok=True)
    return folder


def _warm_up(plan: Plan, quiet: bool) -> None:
    """Compile the kernels once, before workers would each do so."""
    from physim.reproduction.reproduce import is_warm, warm_up

    cold = not is_warm()
    if cold:
        announce_compiling("controller, distances and collision times", COMPILING, quiet)
        warm_up()


def _command(options: Options) -> str:
    """The command as it may be typed again."""
    words = ["physim", "reproduce"]
    for name in ("figure", "study"):
        if (value := getattr(options, name)) is not None:
            words += [f"--{name}", value]
    if options.quick:
        words.append("--quick")
    return shlex.join(words)


def _verdicts(report: Report) -> str:
    """A line for every claim that is not met, and the count of all."""
    from physim.reproduction.study import Outcome

    lines = []
    for section in report.sections:
        for row in section.rows:
            if row.outcome is not Outcome.MET:
                line = f"{row.outcome.value:<10}  {section.short}: {row.claim}"
                lines.append(f"{line}: reported {row.reported}, measured {row.measured}")
    rows = report.rows
    count = ", ".join(f"{sum(r.outcome is one for r in rows)} {one.value}" for one in Outcome)
    return "\n".join([*lines, f"{plural(len(rows), 'claim')}: {count}"]) + "\n"
