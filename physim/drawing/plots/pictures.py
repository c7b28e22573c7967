"""Draw the named pictures of a record into a folder.

Packages may register pictures of their own, classes in the entry point group ``physim.plots``; the
name of the entry point is that of the picture and of its file::

    class Speeds:
        def draw(self, record):  # a physim.Record
            figure = matplotlib.figure.Figure()
            ...
            return figure

What fails in it is reported in one line.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from physim.analysis.metrics import own_part
from physim.analysis.metrics.registered import taken_name
from physim.drawing.plots.collision_times import collision_times, prediction
from physim.drawing.plots.curves import deviation, formation, speeds
from physim.drawing.plots.distances import distances
from physim.drawing.plots.frame import Paper, nothing_in
from physim.drawing.plots.map import trajectories, width
from physim.drawing.plots.modes import modes
from physim.drawing.plots.style import load_matplotlib, save_figure
from physim.drawing.printed import printed_width
from physim.errors import PhysimError, RecordError, WorldError, nearest
from physim.installed import registered
from physim.parts.user_code import naming
from physim.record import Record, check_record

__all__ = ["FORMATS", "NAMES", "draw", "names", "not_replaced"]

FORMATS = ("png", "svg", "pdf")
PICTURES: dict[str, Callable[..., Any]] = {
    "trajectories": trajectories,
    "deviation": deviation,
    "speeds": speeds,
    "formation": formation,
    "width": width,
    "distances": distances,
    "collision_times": collision_times,
    "modes": modes,
    "prediction": prediction,
}
"""Each makes a figure of a record, and of the paper it is for."""
NAMES = tuple(PICTURES)


def names() -> tuple[str, ...]:
    """All pictures: physim's own, then those that packages registered."""
    return (*NAMES, *(name for name in _registered() if name not in PICTURES))


def not_replaced(only: Sequence[str]) -> tuple[str, ...]:
    """A line for each registered picture of ``only`` that has a name of physim's own."""
    found = (name for name in _registered() if name in PICTURES and name in only)
    return tuple(taken_name(_plot(), name) for name in found)


def _registered() -> list[str]:
    return sorted(registered("physim.plots"))


def draw(
    record: Record,
    folder: str | os.PathLike[str],
    *,
    only: Sequence[str] | None = None,
    format: str = "png",
    force: bool = False,
    snapshots: float | None = None,
    stop: Callable[[], bool] | None = None,
    title: bool = True,
    width: float | str | None = None,
    left_out: Callable[[str, str], None] | None = None,
) -> tuple[Path, ...]:
    """Draw pictures of a record, all or ``only`` some, as ``folder/NAME.FORMAT``.

    Returns the files. Of all pictures those are left out in which there is nothing to see:
    ``left_out(name, why)`` is told, and with ``force`` an earlier one is removed. Without
    ``title`` neither that nor the run is written; ``width`` is that in print: "column", "page", or
    inches. ``stop()`` is asked after each picture; once True, no more are drawn. ``snapshots`` [s]
    is the time between the snapshots of ``trajectories``. The same record gives the same file.
    Raises PhysimError for an unknown name, format or width, for a record with a fault, of which no
    picture stays, for a file that exists unless ``force`` is set, where the folder cannot be
    written, and where a picture that a package registered fails.
    """
    check_record(record)
    known, every = names(), only is None
    if isinstance(only, str):  # a text is a sequence, of its letters
        only = (only,)
    only = known if only is None else only
    for name in only:
        if name not in known:
            close = nearest(name[:100], list(known))
            raise PhysimError(f'no figure is called "{name}"; allowed: {", ".join(known)}{close}')
    load_matplotlib()  # the module of a picture that a package registered may import it
    own = {name: own_part(_plot(), name, NAMES) for name in only if name not in PICTURES}
    try:
        paper = Paper(None if width is None else printed_width(width), title)
    except ValueError as allowed:
        raise PhysimError(f"width {width!r} given; allowed: {allowed}") from None
    if format not in FORMATS:
        raise PhysimError(f'format "{format}" given; allowed: {", ".join(FORMATS)}')
    paths = tuple(Path(folder) / f"{name}.{format}" for name in dict.fromkeys(only))
    for path in paths:
        if os.path.lexists(path) and not force:
            raise PhysimError(
                f"{path}: exists; use --force (force=True) to overwrite it, or -o for another "
                "folder"
            )

    def figure(name: str) -> Any:
        """A picture by name; None of one of all pictures in which there is nothing to see."""
        if name in own:
            return _own_figure(name, own[name], record, paper)
        more = {"every": snapshots} if name == "trajectories" else {}
        drawn = PICTURES[name](record, paper=paper, **more)
        why = nothing_in(drawn) if every else None
        if why is not None and left_out is not None:
            left_out(name, why)
        return drawn if why is None else None

    drawn: list[Path] = []
    try:
        for path in paths:
            if save_figure(path, format, partial(figure, path.stem)):
                drawn.append(path)
            else:
                path.unlink(missing_ok=True)
            if stop is not None and stop():
                break
    except (RecordError, WorldError):  # of a record that is refused nothing is left
        for path in drawn:
            path.unlink(missing_ok=True)
        raise
    except OSError as error:
        raise PhysimError(f"{folder}: cannot be written ({error.strerror})") from None
    return tuple(drawn)


def _plot() -> Any:
    from physim.parts.registry import PLOT  # only here: it brings the models of worlds along

    return PLOT


def _own_figure(name: str, part: Any, record: Record, paper: Paper) -> Any:
    """Figure of a registered picture. Raises PhysimError, one line, where it fails."""
    with naming(f'plot "{name}" fails', part.draw):
        figure = part.draw(record)
    if not callable(getattr(figure, "savefig", None)):
        raise PhysimError(
            f'plot "{name}" gives a {type(figure).__name__}; it must give a matplotlib Figure'
        )
    if paper.width is not None:
        wide, high = figure.get_size_inches()
        figure.set_size_inches(paper.width, high * max(paper.width / wide, 0.9))
    if not paper.title:
        figure.suptitle("")
    return figure
