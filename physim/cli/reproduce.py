"""``physim reproduce``: the paper's figures again, reported beside measured."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

from physim.cli.options import Output, Workers
from physim.cli.output import Target, alone, remove, writing
from physim.cli.pictures import files_written
from physim.cli.progress import Bar
from physim.errors import PhysimError
from physim.files import write_text
from physim.terminal import INTERRUPTED, interrupts

PICTURE = re.compile(r"(\d[a-z]?|study)-[a-z_]+\.png")
"""Name of a picture that a reproduction drew"""


def reproduce(
    *,
    paper: str | None = None,
    figure: str | None = None,
    study: str | None = None,
    output: Output = Path('reproduction'),
    quick: bool = False,
    no_video: bool = False,
    workers: Workers | None = None,
    force: bool = False,
    quiet: bool = False,
) -> int:  # fmt: skip
    """Repeat the experiments of a paper, draw its figures and make videos. Compare what the paper
    reports with what is measured, with a verdict for every claim.

    options:
      --paper NAME  mode_switching, the paper that physim implements, or polytope_vo, the one on
                    polytope velocity obstacles (mode_switching)
      --figure N  run only what this figure of the paper needs
      --study NAME  run only this study, of a claim that the paper makes in words
      -o, --output DIR  folder to write to (reproduction)
      --quick  use few seeds: takes some minutes instead of half an hour
      --no-video  make no videos
      --workers N  processes (as many as cores, at most 8)
      --force  overwrite an earlier reproduction in DIR
      --quiet  print no progress and no verdicts

    figures: 1, 2, 3, 3a, 4, 6, 7, 8 (5 is the flow chart of the rules)
    studies: alpha, energy, bends, routes, avoidance, switching, hysteresis,
             thresholds, updates, operation
    studies of polytope_vo: eight, corridor, turnaround, random

    written to DIR:
      reproduction.html   one page with everything in it; videos beside it
      REPRODUCTION.md     the same as Markdown
      reproduction.json   the same as values
      figures/, WORLD/    pictures; record, video and page of each world

    exit codes:
      0    done, whatever the verdicts
      2    bad input
      130  interrupted (Ctrl-C): the pages have what was done until then

    examples:
      physim reproduce --quick
      physim reproduce --figure 6 -o fig6
      physim reproduce --paper polytope_vo -o velocity_obstacles
    """
    if figure is not None and study is not None:
        raise PhysimError("--study: cannot be combined with --figure")
    from physim.campaigns.pool import worker_count
    from physim.record.lock import check_unwritten
    from physim.reproduction.page import JSON, PAGES, pages, verdicts
    from physim.reproduction.run import PICTURES, make_plan
    from physim.reproduction.run import reproduce as run_all

    given = [("--paper", paper), ("--figure", figure), ("--study", study)]
    command = ["physim", "reproduce", *(word for one in given if one[1] for word in one if word)]
    plan = make_plan(figure, study, quick, not no_video, paper)
    check_unwritten(output / JSON)
    made = [output / name for name in (PICTURES, *plan.worlds, *PAGES)]
    Target(output, force).folder(made, empty=True)
    with alone(output / JSON), interrupts() as interrupt:
        drawn = [one for one in (output / PICTURES).glob("*.png") if PICTURE.fullmatch(one.name)]
        remove([*drawn, *(output / name for name in PAGES)])
        with writing(output):
            for name in (PICTURES, *plan.worlds):
                (output / name).mkdir(exist_ok=True)
        with Bar("reproduce", 1.0, "jobs", quiet) as bar:
            report = run_all(
                plan, output, workers=workers or worker_count(), stop=interrupt,
                command=shlex.join(command + ["--quick"] * quick), progress=bar.count,
            )  # fmt: skip
        for name, text in pages(report, output).items():
            write_text(output / name, text)
    if not quiet:
        print(verdicts(report), end="")
        print(files_written(output, PAGES))
    return INTERRUPTED if report.interrupted else 0
