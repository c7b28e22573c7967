"""One HTML file of one run or several: `write_page`, and `Page` for a notebook."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from physim._version import __version__
from physim.analysis.parting import Parting, is_branch, parting
from physim.analysis.summary import summarise, table_rows
from physim.analysis.validation import Validation
from physim.drawing.drivers import drivers_of, key_of
from physim.drawing.labels import clean
from physim.drawing.page.colours import asset, schemes, script, styles
from physim.drawing.page.data import run_data
from physim.drawing.page.findings import contact_table, findings_section, opening
from physim.errors import PhysimError, plural
from physim.files import write_text
from physim.html import Html, table, tag, text, together
from physim.html import page as whole_page
from physim.record import Record
from physim.world.differences import differences, key_in_words, stages_apart

MOST_RUNS = 6
"""Runs in one page"""
MARK = re.compile(r"\{\{(\w+)\}\}")
MOST_DIFFERENCES = 3
"""between two worlds, that are named"""
HEIGHT = 760
"""[px] of a page in a notebook"""


@dataclass(frozen=True, repr=False)
class Page:
    """A page as text; in a notebook it shows itself."""

    html: str

    def __repr__(self) -> str:
        """How large it is."""
        return f"<Page of {len(self.html.encode()) / 1e6:.2f} MB; write(path) makes a file of it>"

    def _repr_html_(self) -> str:
        """The page in a frame of its own, which reaches nothing outside of it."""
        return (
            f'<iframe srcdoc="{escape(self.html)}" sandbox="allow-scripts" '
            f'style="width:100%;height:{HEIGHT}px;border:0" title="physim"></iframe>'
        )

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Write it to a file, whole or not at all. Raises PhysimError when it cannot be written."""
        write_text(target := Path(path), self.html)
        return target


def write_page(
    records: Sequence[Record],
    path: str | os.PathLike[str],
    validation: Validation | None = None,
) -> Path:
    """Write the page of one run or several to a file, in place of an earlier one.

    ``validation`` is that of the one run, and is told in the page, each finding with a link to its
    moment. Raises PhysimError where there are no records, too many, or more than the one that was
    validated, for a record without samples or robots, and when the file cannot be written.
    """
    return page(*records, validation=validation).write(path)


def page(*records: Record, validation: Validation | None = None) -> Page:
    """Make the page of one run or several, shown in step.

    ``validation`` is that of the one run, and is told in the page. Raises PhysimError where there
    are no records, too many, or more than the one that was validated, and for a record without
    samples or robots.
    """
    if validation is not None and len(records) != 1:
        raise PhysimError(f"a validation is of one record; given {len(records)}")
    if not 1 <= len(records) <= MOST_RUNS:
        raise PhysimError(f"a page shows 1 to {MOST_RUNS} records; given {len(records)}")
    if validation is not None and not validation.is_of(records[0]):
        raise PhysimError(f"{validation!r} is of another run than {records[0]!r}; validate that")
    summaries = [summarise(record) for record in records]
    branching = len(records) == 2 and is_branch(records[1], records[0])
    parted = parting(records[0], records[1]) if branching else None
    packed = [run_data(*pair, validation, parted) for pair in zip(records, summaries, strict=True)]
    runs = [tag("script", Html(run), type="text/plain", class_="run") for run in packed]
    labels = ["original", f"branch at {records[1].begun:g} s"] if branching else _labels(records)
    about = _about_branch(records, parted) if branching else _about(records)
    name = ", ".join(dict.fromkeys(clean(record.name) for record in records))
    tables = [] if validation is None else [findings_section(validation, summaries[0])]
    for run, (label, summary) in enumerate(zip(labels, summaries, strict=True)):
        rows = ((tag("th", label, scope="row"), words) for label, words in table_rows(summary))
        tables += [
            tag("h2", label if len(labels) > 1 else "Summary"),
            table([], rows, caption=tag("span", "What was measured", class_="unseen")),
            contact_table(summary, run, len(labels)),
        ]
    parts = {
        "verdict": Html() if validation is None else opening(validation, summaries[0]),
        "heading": text(name), "about": text(about), "tables": together(tables),
        "schemes": _json(schemes()), "labels": _json(labels), "runs": together(runs, "\n"),
    }  # fmt: skip
    return Page(
        whole_page(
            f"{name} – physim", Html(MARK.sub(lambda found: parts[found[1]], asset("page.html"))),
            style=styles("page.css"), script=script(), generator=f"physim {__version__}",
            head=tag("link", rel="icon", href="data:,"),
        )
    )  # fmt: skip


def _json(value: Any) -> Html:
    """JSON that ends no element and begins none."""
    return Html(json.dumps(value, ensure_ascii=True).replace("<", "\\u003c"))


def _labels(records: Sequence[Record]) -> list[str]:
    """What each run is called: by that in which they differ, of name, seed, controller, folder."""
    parts = (
        [clean(record.name) for record in records],
        [f"seed {record.seed}" for record in records],
        [clean(record.setup.controller_names) for record in records],
        [clean(record.path.absolute().parent.name) if record.path else "" for record in records],
    )
    if len(records) == 1:
        return parts[0]
    told: list[list[str]] = []
    for part in parts:  # as few as tell them apart
        if len(set(part)) > 1 and len(set(zip(*told, strict=True))) < len(records):
            told.append(part)
    return [
        ", ".join(filter(None, one)) or f"run {k}"
        for k, one in enumerate(zip(*told, strict=True) if told else [()] * len(records), 1)
    ]


def _about(records: Sequence[Record]) -> str:
    """How many robots or runs, and in what two runs differ where that is known."""
    first, told = records[0], []
    controllers = key_of(drivers_of(first)) or first.setup.controller_names
    words = [f"{plural(first.robots, 'robot')}, seed {first.seed}, {controllers}"]
    if len(records) > 1:
        words = [plural(len(records), "run")]
    if len(records) == 2:
        try:
            found, stages = stages_apart(differences(records[0].world, records[1].world))
            told = [" / ".join(pair) for pair in stages]
            told += [f"{key_in_words(key)} {a} / {b}" for key, (a, b) in found.items()]
        except PhysimError:  # of a world that cannot be read nothing is known
            pass
    words += told if len(told) <= MOST_DIFFERENCES else [f"{len(told)} values differ"]
    return "; ".join(filter(None, [*words, drawn_between(records)]))


def _about_branch(records: Sequence[Record], parted: Parting | None) -> str:
    """From when on there is a branch, with what changed, and where it parts from its original."""
    branch = records[1]
    found, stages = stages_apart(branch.origin.changed)
    told = [after for _, after in stages]
    told += [f"{key_in_words(key)} {b} instead of {a}" for key, (a, b) in found.items()]
    if (more := len(told) - MOST_DIFFERENCES) > 0:
        told[MOST_DIFFERENCES:] = [plural(more, "more change")]
    words = [
        f"original, and branch from {branch.begun:g} s on: {', '.join(told) or 'nothing changed'}",
        f"parts {parted}" if parted else "does not part from the original",
        drawn_between(records),
    ]
    return "; ".join(filter(None, words))


def drawn_between(records: Sequence[Record]) -> str:
    """Say how robots are drawn where not every step was recorded; empty where each was."""
    every = max(record.record_every * record.dt for record in records)
    if all(record.record_every == 1 for record in records):
        return ""
    return f"samples every {every:g} s (time.record_every), robots on arcs between them"
