"""docs/explanation/reproduction.md and its count: ``python -m tests.reproduction_docs [DIR]``.

Without DIR everything is run, which takes about half an hour on two cores; DIR is what
``physim reproduce -o DIR`` wrote, of whichever paper. The page of the second paper is
docs/explanation/reproduction-polytope-vo.md.
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
PAGES = {
    "mode_switching": DOCS / "explanation/reproduction.md",
    "polytope_vo": DOCS / "explanation/reproduction-polytope-vo.md",
}
INDEX = DOCS / "index.md"
BEGIN, END = "<!-- claims -->\n", "<!-- end of claims -->"


def pictures_of(paper: str) -> Path:
    """Folder of a page's pictures, beside it and of its name; the report is there, too."""
    return PAGES[paper].with_suffix("")


def report_of(paper: str) -> Report:
    """The report that a page was written from."""
    return Report.from_json((pictures_of(paper) / JSON).read_text(encoding="utf-8"))


def text_of(report: Report) -> str:
    """The page of a report, without videos.

    Its commands are marked: they take too long for the test that runs those of all pages.
    """
    folder = pictures_of(report.paper).name
    sections = tuple(
        replace(one, pictures=tuple(f"{folder}/{Path(p).name}" for p in one.pictures))
        for one in report.sections
    )
    text = markdown(content(replace(report, sections=sections)))
    return text.replace("\n```sh\n", "\n<!-- not run: takes long -->\n```sh\n")


def write(folder: Path) -> None:
    """Take page, report and pictures from a folder that a reproduction wrote."""
    report = Report.from_json((folder / JSON).read_text(encoding="utf-8"))
    without_films = tuple(replace(one, films=()) for one in report.sections)
    named = f" --paper {report.paper}" if report.paper != "mode_switching" else ""
    report = replace(report, command=f"physim reproduce{named}", sections=without_films)
    pictures = pictures_of(report.paper)
    pictures.mkdir(exist_ok=True)
    for old in pictures.glob("*.png"):
        old.unlink()
    for section in report.sections:
        for file in section.pictures:
            (pictures / Path(file).name).write_bytes((folder / file).read_bytes())
    (pictures / JSON).write_text(report.to_json(), encoding="utf-8")
    PAGES[report.paper].write_text(text_of(report), encoding="utf-8")
    if report.paper != "mode_switching":
        return
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
    for paper in PAGES:
        with tempfile.TemporaryDirectory() as folder:
            code = physim(["reproduce", "--paper", paper, "--no-video", "--force", "-o", folder])
            if code:
                sys.exit(code)
            write(Path(folder))


if __name__ == "__main__":
    main()
