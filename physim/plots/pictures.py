"""Draw the named pictures of a record into a folder."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from physim.errors import PhysimError, nearest
from physim.plots.collision_times import collision_times
from physim.plots.deviation import deviation
from physim.plots.distances import distances
from physim.plots.formation import formation
from physim.plots.modes import modes
from physim.plots.prediction import prediction
from physim.plots.speeds import speeds
from physim.plots.style import styled
from physim.plots.trajectories import trajectories
from physim.plots.width import width
from physim.record import Record

FORMATS = ("png", "svg", "pdf")
PICTURES: dict[str, Callable[[Record], Any]] = {
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
"""Each makes a figure of a record."""
NAMES = tuple(PICTURES)


def draw(
    record: Record,
    folder: str | os.PathLike[str],
    *,
    only: Sequence[str] = NAMES,
    format: str = "png",
    force: bool = False,
    snapshots: float | None = None,
    stop: Callable[[], bool] | None = None,
) -> tuple[Path, ...]:
    """Draw pictures of a record as ``folder/NAME.FORMAT``; returns the files.

    ``stop()`` is asked after each picture; once True, no more are drawn.

    ``snapshots`` [s] is the time between the snapshots of ``trajectories``. The same record gives
    the same file. Raises PhysimError for an unknown name or format, for a
    file that exists unless ``force`` is set, and where the folder cannot be written.
    """
    for name in only:
        if name not in PICTURES:
            told = f'no picture is called "{name}"; there are {", ".join(NAMES)}'
            raise PhysimError(told + nearest(name[:100], list(NAMES)))
    if format not in FORMATS:
        raise PhysimError(f'format "{format}" given; allowed: {", ".join(FORMATS)}')
    paths = tuple(Path(folder) / f"{name}.{format}" for name in dict.fromkeys(only))
    for path in paths:
        if os.path.lexists(path) and not force:
            raise PhysimError(
                f"{path}: exists; use --force to write over it, or -o for another folder"
            )
    drawn = 0
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
        for path in paths:
            _save(record, path, format, snapshots)
            drawn += 1
            if stop is not None and stop():
                break
    except OSError as error:
        raise PhysimError(f"{folder}: cannot be written ({error.strerror})") from None
    return paths[:drawn]


def _save(record: Record, path: Path, format: str, snapshots: float | None) -> None:
    """Write one picture, whole or not at all, without the date that would make files differ."""
    dates = {"png": {}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
    part = path.with_name(f".{path.name}.part")
    with styled(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")  # names in any script
        if path.stem == "trajectories":
            figure = trajectories(record, snapshots)
        else:
            figure = PICTURES[path.stem](record)
        try:
            figure.savefig(part, format=format, metadata=dates[format])
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
