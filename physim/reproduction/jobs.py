"""What worker processes do: runs, pictures, films. All can be sent to them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from physim.errors import PhysimError
from physim.record import Record
from physim.reproduction.claims import measures
from physim.reproduction.claims.claim import PAIR_TIMES
from physim.reproduction.runner import Stop
from physim.reproduction.study import Arm, Measures, Table

Measure = Callable[[Record], Measures]


def measure_run(
    arm: Arm, seed: int, wanted: Sequence[Measure], stop: Stop
) -> Mapping[str, Measures] | None:
    """Figures of one run by the name of their function; None when it was stopped."""
    record = _simulated(arm, seed, stop)
    if record is None:
        return None
    with record:
        return {measure.__name__: dict(measure(record)) for measure in wanted}


def keep_record(world: str, path: Path, stop: Stop) -> tuple[str, int, Measures] | None:
    """Run a world with its own seed and keep the record, for pictures and film.

    Name and seed of the run and its figures; None when it was stopped.
    """
    record = _simulated(Arm("", world), None, stop, path)
    if record is None:
        return None
    with record:
        return record.name, record.seed, dict(measures(record))


def draw_plot(file: Path, name: str, snapshots: float | None, path: Path, _: Stop) -> bool:
    """Draw a picture of a record: one of `physim.plots`, or `PAIR_TIMES`. True: never stopped."""
    from physim.plots.pictures import PICTURES
    from physim.plots.trajectories import trajectories
    from physim.reproduction.pair_times import pair_times
    from physim.reproduction.pictures import picture

    with Record.load(file) as record, picture(path) as keep:
        if name == PAIR_TIMES:
            keep(pair_times(record))
        elif name == "trajectories":
            keep(trajectories(record, snapshots))
        else:
            keep(PICTURES[name](record))
    return True


def draw_study(name: str, table: Table, path: Path, _: Stop) -> bool:
    """Draw the plot of a study, found by its name: its functions need not be sent. True."""
    from matplotlib.figure import Figure

    from physim.reproduction.pictures import picture
    from physim.reproduction.studies import studies

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


def _simulated(arm: Arm, seed: int | None, stop: Stop, path: Path | None = None) -> Record | None:
    """Record of a run; None when it was stopped. Raises PhysimError that names the run."""
    from physim.recording import simulate

    try:
        world = arm.load(0 if seed is None else seed)
        record = simulate(world, seed=seed, path=path, overwrite=True, stop=stop)
    except PhysimError as error:
        run = " ".join([arm.world, *arm.overrides, f"seed {seed}"])
        raise PhysimError(f"{run}: {error}") from None
    if record.ended == "interrupted":
        record.close()
        if path is not None:
            os.unlink(path)
        return None
    return record
