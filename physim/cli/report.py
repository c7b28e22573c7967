"""``physim report``: what a campaign says."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from physim.cli.output import (
    STDOUT,
    alone,
    inputs,
    new_file,
    new_json,
    new_page,
    spare,
    write_json,
    write_text,
)
from physim.cli.parser import Options, command, flag, option
from physim.cli.progress import Bar, interrupts
from physim.cli.signals import INTERRUPTED
from physim.cli.values import PATH
from physim.drafts import check_regular
from physim.errors import PhysimError

PAGE = "report.html"


@command("report", "how likely a contact is: rates, intervals, the worst")
@click.argument("folder", metavar="DIR", type=PATH, help="folder of a campaign (physim sweep)")
@option(
    "-o", "--output", type=PATH, metavar="FILE", help=f"page to write (DIR/{PAGE}, again each time)"
)
@option("--json", type=PATH, metavar="FILE", help="write all figures to FILE (-: standard output)")
@flag("--videos", "make the videos of the runs with pictures, and link to them")
@flag("--pages", "make the pages of these runs for the browser, and link to their moments")
@flag("--no-pictures", "do not run any again for their pictures")
@option(
    "--controller", "controllers", multiple=True, metavar="NAME",
    help="a class of yours that runs of DIR had, so that they can be run again for their pictures: "
    "code is only run when named (may be repeated)",
)  # fmt: skip
@flag("--explain", "tell which intervals these are, and when they hold")
@flag("--force", "overwrite an existing FILE, or a DIR/report.html of another kind")
@flag("--quiet", "print no table")  # fmt: skip
def report(options: Options) -> int:
    """Report a campaign as a table and as one page of HTML: for each world, settings and
    controller how many runs were contact-free, finished, and both, with intervals; distances and
    times; the worst runs of each, by the severity of their contacts, and runs that did not finish,
    with pictures; runs that crashed.

    intervals:
      Exact (Clopper-Pearson) for a campaign whose number of runs was fixed in advance; by a
      confidence sequence, which holds at every look, for one made with sweep --until.

    exit codes:
      0    reported, whatever the rates
      2    bad input: one message says what and where
      130  interrupted (Ctrl-C): the page has what was drawn by then

    examples:
      physim report runs/study
      physim report runs/study --videos --pages -o study.html
      physim report runs/study --json - --no-pictures --quiet
    """
    from physim.campaigns.folder import Folder, read
    from physim.campaigns.outcomes import Outcomes
    from physim.campaigns.report.contents import report_of
    from physim.campaigns.report.page import is_report, report_page
    from physim.campaigns.report.pictures import pictures
    from physim.campaigns.report.text import report_text, report_values
    from physim.campaigns.sweep import read_until

    folder: Path = options.folder
    page: Path = options.output or folder / PAGE
    if options.no_pictures and (options.videos or options.pages):
        made = "--videos" if options.videos else "--pages"
        raise PhysimError(f"{made}: cannot be combined with --no-pictures")
    spare(options.json, folder, option="--json")
    spare(options.output, folder)
    new_json(options.json, options.force, *inputs(folder))
    alone(options.json, page)
    if options.output is not None:
        new_page(page, options.force)
    asked = Folder(folder).asked()
    draws = {cell.label: cell.draws for cell in Folder(folder).cells()}
    check_regular(page)
    if page.exists() and not is_report(page):
        new_file(page, options.force)
    until = read_until(folder)
    goal, first = (None, None) if until is None else (until.goal, until.first)
    found = report_of(Outcomes(read(folder)), str(folder), goal, first, asked, draws)
    with interrupts() as interrupt, Bar("pictures", 1.0, "runs", options.quiet) as bar:
        shown = pictures(
            found, folder, page, options.controllers, videos=options.videos, pages=options.pages,
            stills=not options.no_pictures, progress=bar.count, stop=interrupt,
        )  # fmt: skip
        write_text(page, report_page(found, shown))
        if options.json is not None:
            values = json.dumps(report_values(found), indent=2, ensure_ascii=False, allow_nan=False)
            write_json(options, values)
        if not options.quiet:
            sys.stdout.write(report_text(found, options.explain))
        if options.json != STDOUT or not options.quiet:
            sys.stdout.write(f"written to {page}\n")
        return INTERRUPTED if interrupt() else 0
