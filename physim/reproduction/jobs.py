"""Pieces of work that a worker process does: runs, pictures, films. All can be sent to it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from physim.errors import PhysimError
from physim.record import Record
from physim.reproduction.claims import PAIR_TIMES, measures
from physim.reproduction.study import Arm, Measures, Study

Stop = Callable[[], bool]

PAPER = "paper"
"""Tag of the figures that the claims of the paper are judged by."""


@dataclass(frozen=True)
class Run:
    """One run and what to measure of it: a function by tag; several studies may share it."""

    arm: Arm
    seed: int
    measure: Mapping[str, Callable[[Record], Measures]]

    @property
    def note(self) -> str:
        """A few words for a progress bar."""
        return f"{self.arm.world} seed {self.seed}"

    def do(self, stop: Stop) -> Mapping[str, Measures] | None:
        """Figures by tag; None when it was stopped."""
        record = _simulated(self.arm, self.seed, stop)
        if record is None:
            return None
        with record:
            return {tag: dict(find(record)) for tag, find in self.measure.items()}


@dataclass(frozen=True)
class PicturedRun:
    """A run that is kept as a record file, for pictures and film: a world with its own seed."""

    world: str
    path: Path

    @property
    def note(self) -> str:
        """A few words for a progress bar."""
        return f"{self.world}, record"

    def do(self, stop: Stop) -> tuple[str, int, Measures] | None:
        """Name and seed of the run and its figures; None when it was stopped."""
        arm = Arm("", self.world)
        record = _simulated(arm, None, stop, self.path)
        if record is None:
            return None
        with record:
            return record.name, record.seed, dict(measures(record))


@dataclass(frozen=True)
class Plot:
    """A picture of a record."""

    record: Path
    name: str
    """of `physim.plots`, or `PAIR_TIMES`"""
    path: Path
    snapshots: float | None = None

    @property
    def note(self) -> str:
        """A few words for a progress bar."""
        return f"picture {self.path.stem}"

    def do(self, stop: Stop) -> bool:
        """Draw it; True, since it is not stopped."""
        from physim.plots.pictures import PICTURES
        from physim.plots.trajectories import trajectories
        from physim.reproduction.pair_times import pair_times
        from physim.reproduction.pictures import picture

        with Record.load(self.record) as record, picture(self.path) as keep:
            if self.name == PAIR_TIMES:
                keep(pair_times(record))
            elif self.name == "trajectories":
                keep(trajectories(record, self.snapshots))
            else:
                keep(PICTURES[self.name](record))
        return True


@dataclass(frozen=True)
class StudyPlot:
    """The plot of a study, found again by its name: its functions need not be sent."""

    name: str
    results: Sequence[Sequence[Measures]]
    path: Path

    @property
    def note(self) -> str:
        """A few words for a progress bar."""
        return f"picture {self.path.stem}"

    def do(self, stop: Stop) -> bool:
        """Draw it; True, since it is not stopped."""
        from matplotlib.figure import Figure

        from physim.plots.style import NARROW
        from physim.reproduction.pictures import picture
        from physim.reproduction.studies import studies

        study: Study = next(one for one in studies() if one.name == self.name)
        with picture(self.path) as keep:
            figure = Figure(figsize=(NARROW, 3.2), layout="constrained")
            study.draw(figure, self.results)
            keep(figure)
        return True


@dataclass(frozen=True)
class Film:
    """The video of a record."""

    record: Path
    path: Path

    @property
    def note(self) -> str:
        """A few words for a progress bar."""
        return f"video of {self.path.parent.name}"

    def do(self, stop: Stop) -> bool | None:
        """Render it; None when it was stopped."""
        from physim.video import render

        with Record.load(self.record) as record:
            render(record, self.path, stop=stop)
        return None if stop() else True


Job = Run | PicturedRun | Plot | StudyPlot | Film


def _simulated(arm: Arm, seed: int | None, stop: Stop, path: Path | None = None) -> Record | None:
    """Record of a run; None when it was stopped. Raises PhysimError that names the run."""
    from physim.recording import simulate

    try:
        world = arm.load(0 if seed is None else seed)
        record = simulate(world, seed=seed, path=path, overwrite=True, stop=stop)
    except PhysimError as error:
        told = f"{arm.world} {' '.join(arm.overrides)} seed {seed}".replace("  ", " ")
        raise PhysimError(f"{told}: {error}") from None
    if record.ended == "interrupted":
        record.close()
        if path is not None:
            os.unlink(path)
        return None
    return record


__all__ = ["PAPER", "Film", "Job", "PicturedRun", "Plot", "Run", "Stop", "StudyPlot"]
