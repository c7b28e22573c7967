"""What worker processes do: runs, pictures, films. All can be sent to them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from physim.errors import PhysimError
from physim.plots.pictures import PICTURES as PLOTS
from physim.plots.trajectories import trajectories
from physim.record import Record
from physim.recording import simulate
from physim.reproduction.claims.claim import PAIR_TIMES
from physim.reproduction.pair_times import pair_times
from physim.reproduction.pictures import picture
from physim.reproduction.runner import Stop
from physim.reproduction.studies import studies
from physim.reproduction.study import Arm, Measures, Table

Measure = Callable[[Record], Measures]


class Run(NamedTuple):
    """What is kept of a run."""

    name: str
    seed: int
    measures: Mapping[str, Measures]
    """figures by the name of their function"""


def run(
    arm: Arm, seed: int | None, wanted: Sequence[Measure], path: Path | None, stop: Stop
) -> Run | None:
    """Run a world and measure it; None when it was stopped.

    ``seed`` None: that of the world. The record is kept at ``path``, if given. Raises PhysimError
    that names the run.
    """
    try:
        world = arm.load(seed or 0)
        record = simulate(world, seed=seed, path=path, overwrite=True, stop=stop)
    except PhysimError as error:
        name = " ".join([arm.world, *arm.overrides, f"seed {seed}"])
        raise PhysimError(f"{name}: {error}") from None
    with record:
        if record.ended != "interrupted":
            found = {measure.__name__: dict(measure(record)) for measure in wanted}
            return Run(record.name, record.seed, found)
    if path is not None:
        os.unlink(path)
    return None


def draw_plot(file: Path, name: str, snapshots: float | None, path: Path, _: Stop) -> bool:
    """Draw a picture of a record: one of `physim.plots`, or `PAIR_TIMES`. True: never stopped."""
    with Record.load(file) as record, picture(path) as keep:
        if name == PAIR_TIMES:
            keep(pair_times(record))
        elif name == "trajectories":
            keep(trajectories(record, snapshots))
        else:
            keep(PLOTS[name](record))
    return True


def draw_study(name: str, table: Table, path: Path, _: Stop) -> bool:
    """Draw the plot of a study, found by its name: its functions need not be sent. True."""
    from matplotlib.figure import Figure

    study = next(one for one in studies() if one.name == name)
    with picture(path) as keep:
        figure = Figure()
        study.draw(figure, study.labels, table)
        keep(figure)
    return True


def render_film(file: Path, path: Path, stop: Stop) -> bool | None:
    """Render the video of a record; None when it was stopped."""
    from physim.video import render

    with Record.load(file) as record:
        render(record, path, stop=stop)
    return None if stop() else True
