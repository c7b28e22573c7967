"""``physim report``: what a campaign says."""

from __future__ import annotations

from pathlib import Path

from physim.cli.options import File, JsonFile, Out, Output
from physim.cli.output import PAGE as PAGES
from physim.cli.output import STDOUT, Target, check_json, inputs, write_json
from physim.cli.progress import Bar
from physim.errors import PhysimError
from physim.files import check_regular, write_text
from physim.json_text import json_text
from physim.terminal import INTERRUPTED, interrupts

PAGE = "report.html"


def spare(path: Path | None, option: str, *folders: Path) -> None:
    """Raise PhysimError where a file to be written is a part of a campaign that is read."""
    from physim.campaigns.folder import is_part

    for folder in folders:
        if path is not None and is_part(path, folder):
            raise PhysimError(
                f"{path}: is a part of the campaign in {folder}; {option} takes another file"
            )


def report(
    folder: File, /, *,
    output: Output | None = None,
    json: JsonFile | None = None,
    videos: bool = False,
    pages: bool = False,
    no_pictures: bool = False,
    controller: tuple[str, ...] = (),
    explain: bool = False,
    force: bool = False,
    quiet: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Report a campaign as a table and as one HTML page. For each cell (world, settings,
    controller) it gives the rates of runs that were contact-free, finished, and both, with
    intervals; distances and times; the worst runs and the runs that did not finish, with pictures;
    and runs that crashed.

    arguments:
      DIR  folder of a campaign (physim sweep)

    options:
      -o, --output FILE  page to write (default: DIR/report.html, replaced each time)
      --videos  also make videos of the runs with pictures, with links to them
      --pages  also make pages of these runs for the browser, with links to the moments
      --no-pictures  make no pictures; they need the runs to be run again
      --controller NAME  your own class, if runs of DIR used one, so that they can be run again for
          their pictures: physim runs your code only if you name it (may be repeated)
      --explain  say which kind of intervals these are, and when they are valid
      --force  overwrite an existing FILE, or a DIR/report.html of another kind
      --quiet  print no table

    intervals:
      Exact (Clopper-Pearson) if the number of runs was fixed in advance; a confidence sequence,
      which is valid at every look, if the campaign was made with sweep --until.

    exit codes:
      0    reported, whatever the rates
      2    bad input: one message says what and where
      130  interrupted (Ctrl-C): the page has the pictures made until then

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

    page = output or folder / PAGE
    if no_pictures and (videos or pages):
        made = "--videos" if videos else "--pages"
        raise PhysimError(f"{made}: cannot be combined with --no-pictures")
    spare(json, "--json", folder)
    spare(output, "-o", folder)
    check_json(json, force, [*inputs(folder), page])
    if output is not None:
        Target(page, force).file(ends=PAGES)
    asked = Folder(folder).asked()
    draws = {cell.label: cell.draws for cell in Folder(folder).cells()}
    check_regular(page)
    if page.exists() and not is_report(page):
        Target(page, force).file()
    until = read_until(folder)
    goal, first = (None, None) if until is None else (until.goal, until.first)
    found = report_of(Outcomes(read(folder)), str(folder), goal, first, asked, draws)
    with interrupts() as interrupt, Bar("pictures", 1.0, "runs", quiet) as bar:
        shown = pictures(
            found, folder, page, controller, videos=videos, pages=pages, stills=not no_pictures,
            progress=bar.count, stop=interrupt,
        )  # fmt: skip
        write_text(page, report_page(found, shown))
        if json is not None:
            write_json(json, json_text(report_values(found)), out)
        if not quiet:
            print(report_text(found, explain), end="")
        if json != STDOUT or not quiet:
            print(f"written to {page}")
        return INTERRUPTED if interrupt() else 0
