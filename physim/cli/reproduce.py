"""``physim reproduce``: the paper's figures again, reported beside measured."""

from __future__ import annotations

import re
import shlex
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from physim.cli.options import Output, Workers
from physim.cli.output import Target, alone, writing
from physim.cli.progress import Bar, announce_compiling
from physim.errors import PhysimError, plural
from physim.files import write_text
from physim.terminal import INTERRUPTED, interrupts

if TYPE_CHECKING:
    from physim.reproduction.model import Report
    from physim.reproduction.run import Plan

PICTURE = re.compile(r"(\d[a-z]?|study)-[a-z_]+\.png")
"""Name of a picture that a reproduction drew"""
NEW, PARTIAL = ".reproducing-", "interrupted"
"""Folders of new results while there are earlier ones, and after an interrupt"""


def reproduce(
    *,
    figure: str | None = None,
    study: str | None = None,
    output: Output = Path('reproduction'),
    quick: bool = False,
    no_video: bool = False,
    workers: Workers | None = None,
    force: bool = False,
    quiet: bool = False,
) -> int:  # fmt: skip
    """Run the experiments of the paper, draw its figures, make the videos, and write what it
    reports beside what is measured, with a verdict for every claim.

    options:
      --figure N  only what this figure of the paper needs
      --study NAME  only this study of a claim that the paper makes in words
      -o, --output DIR  folder to write to (reproduction)
      --quick  few seeds: some minutes instead of half an hour
      --no-video  make no videos
      --workers N  processes, 1 to 64 (as many as cores, at most 8)
      --force  overwrite an existing DIR
      --quiet  print neither progress nor verdicts

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
      130  interrupted (Ctrl-C): the pages hold what was done by then; where DIR has earlier ones,
           these stay, and the new ones are in DIR/interrupted

    examples:
      physim reproduce --quick
      physim reproduce --figure 6 -o fig6
    """
    if figure is not None and study is not None:
        raise PhysimError("--study: cannot be combined with --figure")
    from physim.campaigns.pool import worker_count
    from physim.reproduction.page import PAGES, pages
    from physim.reproduction.run import is_warm, make_plan, warm_up
    from physim.reproduction.run import reproduce as run_all

    given = [("--figure", figure), ("--study", study)]
    command = ["physim", "reproduce", *(word for one in given if one[1] for word in one if word)]
    plan = make_plan(figure, study, quick, not no_video)
    with _new_results(output, plan, force) as new:
        with interrupts() as interrupt:
            if not is_warm():  # once, before workers would each do so
                announce_compiling("controller, distances and collision times", quiet)
                warm_up()
            with Bar("reproduce", 1.0, "jobs", quiet) as bar:
                report = run_all(
                    plan, new, workers=workers or worker_count(), stop=interrupt,
                    command=shlex.join(command + ["--quick"] * quick), progress=bar.count,
                )  # fmt: skip
            for name, text in pages(report, new).items():
                write_text(new / name, text)
        folder = _put(new, output, report.interrupted)
    if not quiet:
        print(_verdicts(report), end="")
        print(f"written to {folder}/: {', '.join(PAGES)}")
    return INTERRUPTED if report.interrupted else 0


@contextmanager
def _new_results(folder: Path, plan: Plan, force: bool) -> Iterator[Path]:
    """Where to write to: ``folder``, or a new one in it while it holds results already.

    Raises PhysimError where there is something already that is not to be overwritten, and where
    another reproduction is writing there.
    """
    from physim.record.lock import check_unwritten
    from physim.reproduction.page import JSON, PAGES
    from physim.reproduction.run import PICTURES

    check_unwritten(folder / JSON)
    made = [folder / name for name in (PICTURES, *plan.worlds, *PAGES)]
    Target(folder, force).folder(made, empty=True)
    new = folder
    with alone(folder / JSON):
        with writing(folder):
            for left in folder.glob(f"{NEW}*"):  # by one that was killed
                shutil.rmtree(left)
            if any((folder / name).exists() for name in PAGES):
                new = Path(tempfile.mkdtemp(prefix=NEW, dir=folder))
            else:
                _remove_pictures(folder / PICTURES)
            for name in (PICTURES, *plan.worlds):
                (new / name).mkdir(exist_ok=True)
        try:
            yield new
        finally:
            if new != folder:
                shutil.rmtree(new, ignore_errors=True)


def _remove_pictures(folder: Path) -> None:
    for old in folder.iterdir() if folder.exists() else ():
        if PICTURE.fullmatch(old.name):
            old.unlink()


def _put(new: Path, folder: Path, interrupted: bool) -> Path:
    """Put new results in the place of earlier ones, or, where they are not whole, beside them.

    Returns where they are then.
    """
    from physim.reproduction.run import PICTURES

    if new == folder:
        return folder
    with writing(folder):
        if interrupted:
            shutil.rmtree(folder / PARTIAL, ignore_errors=True)
            return new.rename(folder / PARTIAL)
        _remove_pictures(folder / PICTURES)
        for file in sorted(new.rglob("*")):
            goal = folder / file.relative_to(new)
            if file.is_dir():
                goal.mkdir(exist_ok=True)
            else:
                file.replace(goal)
    return folder


def _verdicts(report: Report) -> str:
    """A line for every claim that is not met, and the count of all."""
    from physim.reproduction.model import Outcome

    lines = []
    for section in report.sections:
        for row in section.rows:
            if row.outcome is not Outcome.MET:
                line = f"{row.outcome.value:<10}  {section.short}: {row.claim}"
                lines.append(f"{line}: reported {row.reported}, measured {row.measured}")
    rows = report.rows
    count = ", ".join(f"{sum(r.outcome is one for r in rows)} {one.value}" for one in Outcome)
    return "\n".join([*lines, f"{plural(len(rows), 'claim')}: {count}"]) + "\n"
