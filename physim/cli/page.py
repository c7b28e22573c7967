"""``physim page``: a run in the browser, in one file."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from physim.cli.options import Output, RecordFile
from physim.cli.output import PAGE, Target
from physim.cli.simulating import tell

if TYPE_CHECKING:
    from physim.analysis.validation import Validation
    from physim.record import Record

NAME = "page.html"


def page(
    *records: Annotated[RecordFile, Parameter(required=True)],
    output: Output | None = None,
    force: bool = False,
    quiet: bool = False,
) -> int:  # fmt: skip
    """Write one HTML file that shows a run in a browser. It needs no network.

    arguments:
      RECORD...  a run: its folder or its record.h5; several runs play side by side

    options:
      -o, --output FILE  file, ending in .html (default: page.html beside the first record)
      --force  overwrite an existing file
      --quiet  do not print the name of the file

    In the page you play the run, move through its time and zoom. Click a robot to see what it
    sensed and why it decided as it did; click a contact to see what physim validate says about it.

    exit codes:
      0    the page is written
      2    bad input: one message says what and where
      130  interrupted (Ctrl-C): nothing is written

    keys for the browser: listed in the page; page.html#t=57.4&robot=r9 opens it at a moment

    examples:
      physim page runs/ten_robots-21
      physim page with/record.h5 without/record.h5 -o both.html
    """
    from physim.record import Record

    file = Target(output or records[0].parent / NAME, force, records).file(ends=PAGE)
    with ExitStack() as opened:
        make_page([opened.enter_context(Record.load(path)) for path in records], file, quiet)
    if not quiet:
        print(file)
    return 0


def make_page(
    records: Sequence[Record], output: Path, quiet: bool, found: Validation | None = None
) -> None:
    """Write the page of some records.

    ``found`` is the validation of the one record, where it was validated.
    """
    from physim.drawing.page import drawn_between, write_page

    write_page(records, output, found)
    if between := drawn_between(records):
        tell([f"{output}: {between}: contacts may be drawn slightly off"])
