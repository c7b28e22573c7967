"""Stills, videos and pages of some runs: from kept records, else run again."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Callable, Collection
from contextlib import closing
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from physim.analysis.metrics import Figures, Metric, Moment
from physim.campaigns.columns import COLUMNS, Row
from physim.campaigns.folder import PAGES, STILLS, VIDEOS, Folder
from physim.campaigns.one_run import simulation_of
from physim.campaigns.outcomes import DONE
from physim.campaigns.replay import check, spec_of_row
from physim.campaigns.report.contents import Report
from physim.campaigns.report.page import Shown
from physim.campaigns.report.text import pair_and_time
from physim.errors import PhysimError
from physim.record import Record
from physim.simulation.run import record_run

PNG = b"\x89PNG"
"""How every picture begins"""
MOST_STILL = 3_000_000
"""[bytes] of a picture of so many pixels; a file that is larger is none"""
MOST_PAGE = 8_000_000
"""[bytes] of the page of a run; a larger one is not kept, and that is told"""
KEY = re.compile(r"[0-9a-f]{20}")


def remake(folder: Path, row: dict[str, Any], controllers: Collection[str] = ()) -> Record:
    """Record of a run again, in this process: it came to its end before, so it will again.

    Code of one's own is imported only where it is among ``controllers``. Raises PhysimError where
    the run failed, or would not be the same.
    """
    if row["ended"] not in DONE:
        raise PhysimError("the run failed")
    given = row["controller"] if row["controller"] in controllers else None
    if ":" in row["controller"] and given is None:
        again = shlex.join(["physim", "report", str(folder), "--controller", row["controller"]])
        raise PhysimError(f"its controller is code of your own; {again} runs it and draws this")
    one = Row(**{name: row[name] for name in COLUMNS if name in row})
    record = record_run(simulation_of(spec_of_row(Folder(folder), one, given)))
    if differing := check(record, one):  # as of a controller that draws, or reads a file
        record.close()
        raise PhysimError(f"made again it is another run: {differing[0]}")
    return record


def pictures(
    report: Report,
    folder: Path,
    page: Path,
    remake: Callable[[dict[str, Any]], Record],
    *,
    stills: bool = True,
    videos: bool = False,
    pages: bool = False,
    progress: Callable[[int, int, str], None] = lambda done, total, note: None,
    stop: Callable[[], bool] = lambda: False,
) -> list[Shown]:
    """How `Report.pictured` are shown on a page: what is not there yet is made, into ``folder``.

    ``remake`` makes the record of a row again. A run of which that raises PhysimError is shown
    without, and why. When ``stop`` says True the rest are shown without. Raises PhysimError where a
    picture cannot be written.
    """
    found = []
    for done, (index, moment) in enumerate(report.pictured):
        row = report.outcomes.row(index)
        progress(done, len(report.pictured), f"seed {row['seed']}")
        if not (stills or videos or pages) or stop():
            found.append(Shown())
        elif not KEY.fullmatch(str(row["run"])):
            found.append(Shown(fault="the run has no key"))
        else:
            found.append(_shown(row, moment, folder, page, remake, videos, pages))
    progress(len(report.pictured), len(report.pictured), "")
    return found


def _shown(
    row: dict[str, Any], moment: str, folder: Path, page: Path,
    remake: Callable[[dict[str, Any]], Record], videos: bool, pages: bool,
) -> Shown:  # fmt: skip
    from physim.drawing.page import page as page_of
    from physim.drawing.video import render

    still = folder / STILLS / f"{row['run']}-{moment}.png"
    video, own = folder / VIDEOS / f"{row['run']}.mp4", folder / PAGES / f"{row['run']}.html"
    left_out = ""
    wanted = [still, *[video] * videos, *[own] * pages]
    missing = [file for file in wanted if not file.is_file()]
    if missing:
        try:
            record = _record(row, folder, remake)
        except PhysimError as error:
            return Shown(fault=str(error).partition("\n")[0])
        with closing(record):
            for file in missing:
                try:
                    file.parent.mkdir(parents=True, exist_ok=True)
                except OSError as error:
                    raise PhysimError(
                        f"{file.parent}: cannot be written: {error.strerror}"
                    ) from None
            if still in missing:
                _draw(record, still, moment)
            if video in missing:
                render(record, video)
            if own in missing:
                made = page_of(record)
                if (size := len(made.html.encode())) <= MOST_PAGE:
                    made.write(own)
                else:
                    most = f"more than {MOST_PAGE / 1e6:.0f}"
                    left_out = f"its page would have {size / 1e6:.1f} MB, {most}"
    there, opened = (
        os.path.relpath(file, page.absolute().parent).replace(os.sep, "/") if file.is_file() else ""
        for file in (video, own)
    )
    with still.open("rb") as opened_still:
        picture = opened_still.read(MOST_STILL + 1)
    if not picture.startswith(PNG) or len(picture) > MOST_STILL:
        return Shown(fault=f"{still.name} is no picture; delete it to have it drawn again")
    opened += _opened_at(row, moment) if opened else ""
    return Shown(picture, there, page=opened, left_out=left_out)


def _opened_at(row: dict[str, Any], moment: str) -> str:
    """What opens the page of a run at a moment, and asks the first robot of it why."""
    robots, time = pair_and_time(row)
    if moment == "end":
        robots, time = row["stood"] or row["not_arrived"], row["seconds"]
    asked = {"robot": (robots or "").partition(", ")[0]}
    return f"#{urlencode(asked if time is None else {**asked, 't': f'{time:.3f}'})}"


def _record(
    row: dict[str, Any], folder: Path, remake: Callable[[dict[str, Any]], Record]
) -> Record:
    """The kept record of a run, or the run again. PhysimError where it is that of another run."""
    kept = folder / "records" / f"{row['run']}.h5"
    if not row["record"] or not kept.is_file():
        return remake(row)
    record = Record.load(kept)
    if record.digest() != row["digest"]:
        record.close()
        raise PhysimError(
            f"{kept.name} is the record of another run; delete it to have it run again"
        )
    return record


def _draw(record: Record, path: Path, moment: str) -> None:
    """A close-up at a moment of `Report.pictured`, with the two that it is of marked."""
    from physim.drawing.video import close_up
    from physim.drawing.video.animation import save_still

    one: Moment | Metric | None = None
    if moment == "contact":
        one = Figures(record).metric("closing_speed")
    if moment != "end":
        one = one or Figures(record).least
    time = record.steps_run * record.dt if one is None else one.time or 0.0
    within = max(0.0, min(time, (record.steps_run - 1) * record.dt))  # a film ends far away
    between = None if one is None or len(one.bodies) < 2 else (one.bodies[0], one.bodies[1])
    save_still(path, close_up(record, within, between))
