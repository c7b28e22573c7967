"""Stills, videos and pages of some runs: from kept records, else run again."""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Collection
from contextlib import closing
from pathlib import Path
from urllib.parse import urlencode

from physim.analysis.metrics import Figures, Metric, Moment
from physim.campaigns.folder import PAGES, STILLS, VIDEOS, Folder
from physim.campaigns.one_run import simulation_of
from physim.campaigns.replay import check, spec_of_row
from physim.campaigns.report.contents import Report
from physim.campaigns.report.page import Shown
from physim.campaigns.report.text import pair_and_time
from physim.campaigns.rows import Row
from physim.errors import PhysimError
from physim.record import Record
from physim.simulation.run import record_run


def pictures(
    report: Report,
    folder: Path,
    page: Path,
    controllers: Collection[str] = (),
    *,
    stills: bool = True,
    videos: bool = False,
    pages: bool = False,
    progress: Callable[[int, int, str], None] = lambda done, total, note: None,
    stop: Callable[[], bool] = lambda: False,
) -> list[Shown]:
    """How `Report.pictured` are shown on a page: what is not there yet is made, into ``folder``.

    A run of which there is no record is run again; see `record_of` for ``controllers``. One that
    cannot be is shown without, and why. When ``stop`` says True the rest are shown without. Raises
    PhysimError where a picture cannot be written.
    """
    found, every = [], report.pictured
    for done, (index, moment) in enumerate(every):
        row = report.outcomes.rows[index]
        progress(done, len(every), f"seed {row.seed}")
        if not stills or stop():
            found.append(Shown())
            continue
        still, video, own = (
            folder / place / f"{row.run}{end}"
            for place, end in ((STILLS, f"-{moment}.png"), (VIDEOS, ".mp4"), (PAGES, ".html"))
        )
        wanted = [still] + [video] * videos + [own] * pages
        missing = [file for file in wanted if not file.is_file()]
        if missing:
            try:
                record = record_of(folder, row, controllers)
            except PhysimError as error:
                found.append(Shown(fault=str(error).partition("\n")[0]))
                continue
            with closing(record):
                _make(record, missing, moment)
        links = [
            os.path.relpath(file, page.absolute().parent).replace(os.sep, "/")
            if file.is_file() else ""
            for file in (video, own)
        ]  # fmt: skip
        links[1] += _opened_at(row, moment) if links[1] else ""
        found.append(Shown(still.read_bytes(), *links))
    progress(len(every), len(every), "")
    return found


def film_of(folder: Path, row: Row, controllers: Collection[str] = ()) -> str:
    """Film of a run, made where it is not there yet; its place in the folder. As `record_of`."""
    file = folder / VIDEOS / f"{row.run}.mp4"
    if not file.is_file():
        with closing(record_of(folder, row, controllers)) as record:
            _make(record, [file], "end")
    return f"{VIDEOS}/{file.name}"


def record_of(folder: Path, row: Row, controllers: Collection[str] = ()) -> Record:
    """The kept record of a run, or the run again, in this process: it came to its end before.

    Code of one's own is imported only where it is among ``controllers``. Raises PhysimError where
    the run failed, or would not be the same.
    """
    if row.failed:
        raise PhysimError("the run failed")
    kept = folder / "records" / f"{row.run}.h5"
    if row.record and kept.is_file():
        record, what = Record.load(kept), f"{kept.name} is the record of another run; delete it"
    else:
        given = row.controller if row.controller in controllers else None
        if ":" in row.controller and given is None:
            again = shlex.join(["physim", "report", str(folder), "--controller", row.controller])
            raise PhysimError(f"its controller is code of your own; {again} runs it and draws this")
        record = record_run(simulation_of(spec_of_row(Folder(folder), row, given)))
        what = "made again it is another run"  # as of a controller that draws, or reads a file
    if differing := check(record, row):
        record.close()
        raise PhysimError(f"{what}: {differing[0]}")
    return record


def _opened_at(row: Row, moment: str) -> str:
    """What opens the page of a run at a moment, and asks the first robot of it why."""
    robots, time = pair_and_time(row)
    if moment == "end":
        robots, time = row.stood or row.not_arrived, row.seconds
    asked = {"robot": robots.partition(", ")[0]}
    return f"#{urlencode(asked if time is None else {**asked, 't': f'{time:.3f}'})}"


def _make(record: Record, files: Collection[Path], moment: str) -> None:
    """Draw a run into files, each by the ending of its name."""
    from physim.drawing.page import page
    from physim.drawing.video import render

    for file in files:
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise PhysimError(f"{file.parent}: cannot be written: {error.strerror}") from None
        if file.suffix == ".mp4":
            render(record, file)
        elif file.suffix == ".html":
            page(record).write(file)
        else:
            _draw(record, file, moment)


def _draw(record: Record, path: Path, moment: str) -> None:
    """A close-up at a moment of `Report.pictured`, with the two that it is of marked."""
    from physim.drawing.video import close_up, save_still

    one: Moment | Metric | None = None
    if moment == "contact":
        one = Figures(record).metric("closing_speed")
    if moment != "end":
        one = one or Figures(record).least
    time = record.steps_run * record.dt if one is None else one.time or 0.0
    within = max(0.0, min(time, (record.steps_run - 1) * record.dt))  # a film ends far away
    between = None if one is None or len(one.bodies) < 2 else (one.bodies[0], one.bodies[1])
    save_still(path, close_up(record, within, between))
