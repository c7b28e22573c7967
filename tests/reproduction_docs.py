"""docs/explanation/reproduction.md and its count: ``python -m tests.reproduction_docs [DIR]``.

Without DIR everything is run, which takes about half an hour on two cores; DIR is what
``physim reproduce -o DIR`` wrote.
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from dataclasses import replace
from pathlib import Path

from physim.blocks import markdown
from physim.cli import main as physim
from tests.helpers import inside

Report, JSON, content = inside("physim.reproduction", "Report", "JSON", "content")
Outcome = inside("physim.reproduction", "Outcome")

DOCS = Path(__file__).parents[1] / "docs"
PAGE = DOCS / "explanation/reproduction.md"
PICTURES = PAGE.parent / "reproduction"
REPORT = PICTURES / JSON
INDEX = DOCS / "index.md"
BEGIN, END = "<!-- claims -->\n", "<!-- end of claims -->"


def text_of(report: Report) -> str:
    """The page of a report, its pictures in docs/explanation/reproduction/, without videos.

    Its commands are marked: they take too long for the test that runs those of all pages.
    """
    sections = tuple(
        replace(one, pictures=tuple(f"reproduction/{Path(p).name}" for p in one.pictures))
        for one in report.sections
    )
    text = markdown(content(replace(report, sections=sections)))
    return text.replace("\n```sh\n", "\n<!-- not run: takes long -->\n```sh\n")


def write(folder: Path) -> None:
    """Take page, report and pictures from a folder that a reproduction wrote."""
    report = Report.from_json((folder / JSON).read_text(encoding="utf-8"))
    without_films = tuple(replace(one, films=()) for one in report.sections)
    report = replace(report, command="physim reproduce", sections=without_films)
    PICTURES.mkdir(exist_ok=True)
    for old in PICTURES.glob("*.png"):
        old.unlink()
    for section in report.sections:
        for file in section.pictures:
            (PICTURES / Path(file).name).write_bytes((folder / file).read_bytes())
    REPORT.write_text(report.to_json(), encoding="utf-8")
    PAGE.write_text(text_of(report), encoding="utf-8")
    text = INDEX.read_text(encoding="utf-8")
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    INDEX.write_text(before + BEGIN + claims(report) + END + after, encoding="utf-8")


def claims(report: Report) -> str:
    """How many claims of a report are met, partly met, not met: what the front page says of it."""
    count = Counter(row.outcome for row in report.rows)
    counts = ", ".join(f"{count[one]} {one}" for one in Outcome)
    return f"Of {len(report.rows)} claims: {counts}.\n"


def main() -> None:
    """Write the page anew."""
    if len(sys.argv) > 1:
        write(Path(sys.argv[1]))
        return
    with tempfile.TemporaryDirectory() as folder:
        code = physim(["reproduce", "--no-video", "--force", "-o", folder])
        if code:
            sys.exit(code)
        write(Path(folder))


if __name__ == "__main__":
    main()
