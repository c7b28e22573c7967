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
from physim.campaigns.folder import PAGES, STILLS, VIDEOS, Folder
from physim.campaigns.one_run import simulation_of
from physim.campaigns.replay import check, spec_of_row
from physim.campaigns.report.contents import Report
from physim.campaigns.report.page import Shown
from physim.campaigns.report.wording import pair_and_time
from physim.campaigns.rows import COLUMNS, DONE, Row
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

Remake = Callable[[dict[str, Any]], Record]
"""Makes the record of a row again. Raises PhysimError."""
Progress = Callable[[int, int, str], None]


def command(folder: Path, row: dict[str, Any]) -> str:
    """How to make record and video of a run again; code of one's own is run only when named."""
    name = f"{folder}:{row['run']}"
    own = row["controller"] if ":" in row["controller"] else ""
    return shlex.join(["physim", "replay", name, *(["--controller", own] if own else [])])


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
    remake: Remake,
    *,
    stills: bool = True,
    videos: bool = False,
    pages: bool = False,
    progress: Progress = lambda done, total, note: None,
    stop: Callable[[], bool] = lambda: False,
) -> list[Shown]:
    """How `Report.pictured` are shown on a page: what is not there yet is made, into ``folder``.

    A run that cannot be made again is shown without, and why. When ``stop`` says True the rest are
    shown without. Raises PhysimError where a picture cannot be written.
    """
    found = []
    for done, (index, moment) in enumerate(report.pictured):
        row = report.outcomes.row(index)
        again = command(folder, row)
        progress(done, len(report.pictured), f"seed {row['seed']}")
        if not (stills or videos or pages) or stop():
            found.append(Shown(again))
        elif not KEY.fullmatch(str(row["run"])):
            found.append(Shown(again, fault="the run has no key"))
        else:
            found.append(_shown(row, moment, again, folder, page, remake, videos, pages))
    progress(len(report.pictured), len(report.pictured), "")
    return found


def _shown(
    row: dict[str, Any], moment: str, again: str, folder: Path, page: Path, remake: Remake,
    videos: bool, pages: bool = False,
) -> Shown:  # fmt: skip
    still = folder / STILLS / f"{row['run']}-{moment}.png"
    video = folder / VIDEOS / f"{row['run']}.mp4"
    own = folder / PAGES / f"{row['run']}.html"
    left_out = ""
    wanted = [still, *([video] if videos else []), *([own] if pages else [])]
    if not all(file.is_file() for file in wanted):
        try:
            record = _record(row, folder, remake)
        except PhysimError as error:
            return Shown(again, fault=str(error).partition("\n")[0])
        with closing(record):
            _draw(record, moment, still, video if videos else None)
            if pages and not own.is_file():
                left_out = _write_page(record, own)
    links = [
        os.path.relpath(file, page.absolute().parent).replace(os.sep, "/") if file.is_file() else ""
        for file in (video, own)
    ]
    if links[1]:
        links[1] += _opened_at(row, moment)
    with still.open("rb") as file:
        picture = file.read(MOST_STILL + 1)
    if not picture.startswith(PNG) or len(picture) > MOST_STILL:
        return Shown(again, fault=f"{still.name} is no picture; delete it to have it drawn again")
    return Shown(again, picture, links[0], page=links[1], left_out=left_out)


def _opened_at(row: dict[str, Any], moment: str) -> str:
    """What opens the page of a run at a moment, and asks the first robot of it why."""
    if moment == "end":
        robots, time = row["stood"] or row["not_arrived"], row["seconds"]
    else:
        robots, time = pair_and_time(row)
    asked = {"robot": (robots or "").partition(", ")[0]}
    if time is not None:
        asked["t"] = f"{time:.3f}"
    return f"#{urlencode(asked)}"


def _write_page(record: Record, path: Path) -> str:
    """Write the page of a run; why not, where it would be too large."""
    from physim.drawing.page import page

    made = page(record)
    if (size := len(made.html.encode())) > MOST_PAGE:
        return f"its page would have {size / 1e6:.1f} MB, more than {MOST_PAGE / 1e6:.0f}"
    _its_folder(path)
    made.write(path)
    return ""


def _record(row: dict[str, Any], folder: Path, remake: Remake) -> Record:
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


def _draw(record: Record, moment: str, still: Path, video: Path | None) -> None:
    from physim.drawing.video import render

    for file in (still, video):
        if file is not None:
            _its_folder(file)
    if not still.is_file():
        _draw_view(record, still, moment)
    if video is not None and not video.is_file():
        render(record, video)


def _its_folder(file: Path) -> None:
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise PhysimError(f"{file.parent}: cannot be written: {error.strerror}") from None


def _draw_view(record: Record, path: Path, moment: str) -> None:
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
