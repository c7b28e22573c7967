"""``physim reproduce``: the paper's figures again, reported beside measured."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path

from physim.cli.compiling import tell_compiling
from physim.cli.output import a_folder, regular, write_text
from physim.cli.progress import Bar, interrupts
from physim.errors import PhysimError, plural
from physim.reproduction.plan import PICTURES, Plan, make_plan
from physim.reproduction.report import Report
from physim.reproduction.reproduce import PAGES, pages
from physim.reproduction.reproduce import reproduce as run_all
from physim.reproduction.runner import worker_count
from physim.reproduction.study import Outcome

INTERRUPTED = 130
COMPILING = 30
"""[s] about, for all that its jobs need"""


def reproduce(options: argparse.Namespace) -> int:
    """Reproduce the paper, or one figure of it; returns the exit code."""
    plan = make_plan(options.figure, options.study, options.quick, not options.no_video)
    folder = _folder(options.output, plan, options.force)
    bar = Bar("reproduce", 1.0, "jobs", options.quiet)

    def progress(done: int, total: int, note: str) -> None:
        bar.total(total)
        bar.update(done, note)

    with interrupts() as interrupt:
        _warm_up(plan, options.quiet)
        try:
            report = run_all(
                plan, folder, workers=options.workers or worker_count(), command=_command(options),
                stop=interrupt, progress=progress,
            )  # fmt: skip
        finally:
            bar.close()
        for name, text in pages(report, folder).items():
            write_text(folder / name, text)
    if not options.quiet:
        print(_verdicts(report), end="")
        print(f"written to {folder}/: {', '.join(PAGES)}")
    return INTERRUPTED if report.interrupted else 0


def _folder(folder: Path, plan: Plan, force: bool) -> Path:
    """Make the folders to write to. Raises PhysimError where there is something already."""
    a_folder(folder)
    for name in (PICTURES, *plan.worlds, *PAGES):
        regular(folder / name)
    if folder.is_dir() and any(folder.iterdir()) and not force:
        raise PhysimError(
            f"{folder}: is not empty; use --force to write over it, or -o for another folder"
        )
    try:
        for name in (PICTURES, *plan.worlds):
            (folder / name).mkdir(parents=True, exist_ok=True)
        for old in (*(folder / name for name in PAGES), *(folder / PICTURES).glob("*.png")):
            old.unlink(missing_ok=True)
    except OSError as error:
        raise PhysimError(f"{folder}: cannot be written ({error.strerror})") from None
    return folder


def _warm_up(plan: Plan, quiet: bool) -> None:
    """Compile the kernels once, before workers would each do so."""
    from physim.reproduction.warm_up import is_warm, warm_up

    cold = not is_warm()
    if cold:
        tell_compiling("controller, distances and collision times", COMPILING, quiet)
        warm_up()


def _command(options: argparse.Namespace) -> str:
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
    lines = []
    for section in report.sections:
        for row in section.rows:
            if row.outcome is not Outcome.MET:
                told = f"{row.outcome.value:<10}  {section.short}: {row.claim}"
                lines.append(f"{told}: reported {row.reported}, measured {row.measured}")
    rows = report.rows
    count = ", ".join(f"{sum(r.outcome is one for r in rows)} {one.value}" for one in Outcome)
    return "\n".join([*lines, f"{plural(len(rows), 'claim')}: {count}"]) + "\n"
