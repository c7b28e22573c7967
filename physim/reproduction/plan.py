"""Which jobs a reproduction consists of, and which follow from which: runs, pictures, films.

Jobs are done by worker processes, so all they consist of can be sent to one.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from physim.campaigns.pool import Job, Stop
from physim.drawing.plots.maps import trajectories
from physim.drawing.plots.pictures import PICTURES as PLOTS
from physim.errors import PhysimError, nearest
from physim.record import Record
from physim.reproduction.claims import measures, parts
from physim.reproduction.pictures import pair_times, picture
from physim.reproduction.studies import studies
from physim.reproduction.study import PAIR_TIMES, WORDS, Arm, Measures, Part, Study, Table
from physim.simulation.run import simulate

Measure = Callable[[Record], Measures]


class MeasuredRun(NamedTuple):
    """What is kept of a run."""

    name: str
    seed: int
    measures: Mapping[str, Measures]
    """figures by the name of their function"""


def run(
    arm: Arm, seed: int | None, wanted: Sequence[Measure], path: Path | None, stop: Stop
) -> MeasuredRun | None:
    """Run a world and measure it; None when it was stopped.

    ``seed`` None: that of the world. The record is kept at ``path``, if given. Raises PhysimError
    that names the run.
    """
    try:
        world = arm.load(seed or 0)  # what is to be noted, `Plan.notices`, the command says once
        record = simulate(world, seed=seed, path=path, overwrite=True, stop=stop)
    except PhysimError as error:
        name = " ".join([arm.world, *arm.overrides, f"seed {seed}"])
        raise PhysimError(f"{name}: {error}") from None
    with record:
        if record.ended != "interrupted":
            found = {measure.__name__: dict(measure(record)) for measure in wanted}
            return MeasuredRun(record.name, record.seed, found)
    if path is not None:
        os.unlink(path)
    return None


def draw_plot(file: Path, name: str, snapshots: float | None, path: Path, _: Stop) -> bool:
    """Draw one of `physim.drawing.plots`, or `PAIR_TIMES`, of a record. True: never stopped."""
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
    from physim.drawing.video import render

    with Record.load(file) as record:
        render(record, path, stop=stop)
    return None if stop() else True


def write_run_page(file: Path, path: Path, _: Stop) -> bool:
    """Write the page of a record. True: never stopped."""
    from physim.drawing.page import write_page

    with Record.load(file) as record:
        write_page([record], path)
    return True


SEEDS, QUICK_SEEDS = 100, 5
"""of each world of the paper"""
FLOW_CHART = "5"
PICTURES = "figures"
"""Folder of the pictures, beside the pages."""

Found = Mapping[Any, Any]
"""Results of jobs by key."""


@dataclass(frozen=True)
class Plan:
    """What is to be reproduced, and how thoroughly."""

    parts: tuple[Part, ...]
    studies: tuple[Study, ...]
    quick: bool = False
    films: bool = True

    @property
    def seeds(self) -> int:
        """Seeds of each world of the paper, from 0."""
        return QUICK_SEEDS if self.quick else SEEDS

    def seeds_of(self, experiment: Part | Study) -> int:
        """Seeds of each arm of an experiment, from 0."""
        if isinstance(experiment, Part):
            return self.seeds
        return experiment.quick_seeds if self.quick else experiment.seeds

    @property
    def worlds(self) -> tuple[str, ...]:
        """Worlds of the paper's figures, the longest runs first."""
        return tuple(dict.fromkeys(part.world for part in reversed(self.parts)))

    def notices(self) -> list[str]:
        """What is to be noted about the worlds, for the first seed of each arm."""
        from physim.world.file import warning_lines

        experiments: tuple[Part | Study, ...] = (*self.parts, *self.studies)
        arms = dict.fromkeys(arm for experiment in experiments for arm in experiment.arms)
        return [
            f"{' '.join([arm.world, *arm.overrides])}: {line}"
            for arm in arms
            for line in warning_lines(arm.read(0)[1])
        ]

    def jobs(self, folder: Path) -> Iterator[tuple[Any, Job]]:
        """Runs with their keys: those for pictures first, each run once whoever needs it."""
        for world in self.worlds:
            given = (Arm("", world), None, (measures,), folder / world / "record.h5")
            yield ("record", world), Job(f"{world}, record", run, given)
        wanted: dict[Any, dict[str, Measure]] = {}
        experiments: tuple[Part | Study, ...] = (*reversed(self.parts), *self.studies)
        for experiment in experiments:
            measure = measure_of(experiment)
            for seed in range(self.seeds_of(experiment)):
                for arm in experiment.arms:
                    wanted.setdefault(("run", arm, seed), {})[measure.__name__] = measure
        for key, needed in wanted.items():
            _, arm, seed = key
            given_run = (arm, seed, tuple(needed.values()), None)
            yield key, Job(f"{arm.world} seed {seed}", run, given_run)

    def following(self, folder: Path, key: Any, found: Found) -> Iterator[tuple[Any, Job]]:
        """Jobs that a result makes possible: pictures and film of a record, plots of studies."""
        kind, what, *_ = key
        if kind == "record":
            yield from self._of_record(what, folder)
        for study in self.studies:
            if kind == "run" and what in study.arms and self.is_done(study, found):
                path = folder / picture_of("study", study.name)
                given = (study.name, self.table(study, found), path)
                yield ("study", study.name), Job(f"picture {path.stem}", draw_study, given)

    def _of_record(self, world: str, folder: Path) -> Iterator[tuple[Any, Job]]:
        record = folder / world / "record.h5"
        mine = [part for part in self.parts if part.world == world]
        if self.films and any(part.film for part in mine):
            given = (record, folder / film_of(world))
            yield ("film", world), Job(f"video of {world}", render_film, given)
            given = (record, folder / page_of(world))
            yield ("page", world), Job(f"page of {world}", write_run_page, given)
        for part in mine:
            for name in part.pictures:
                path = folder / (file := picture_of(part.figure, name))
                drawn = (record, name, part.snapshots, path)
                yield ("picture", file), Job(f"picture {path.stem}", draw_plot, drawn)

    def table(self, experiment: Part | Study, found: Found) -> Table:
        """Figures of an experiment, a row an arm, a column a seed, of the runs that are done."""
        name, seeds = measure_of(experiment).__name__, range(self.seeds_of(experiment))
        keys = [[("run", arm, seed) for seed in seeds] for arm in experiment.arms]
        return [[found[key].measures[name] for key in row if key in found] for row in keys]

    def is_done(self, experiment: Part | Study, found: Found) -> bool:
        """Whether all its runs are done."""
        seeds = self.seeds_of(experiment)
        return all(len(row) == seeds for row in self.table(experiment, found))


def measure_of(experiment: Part | Study) -> Measure:
    """What is measured of its runs."""
    return measures if isinstance(experiment, Part) else experiment.measure


def picture_of(experiment: str, name: str) -> str:
    """File of a picture, relative to the page."""
    return f"{PICTURES}/{experiment}-{name}.png"


def film_of(world: str) -> str:
    """File of a video, relative to the page."""
    return f"{world}/video.mp4"


def page_of(world: str) -> str:
    """File of the page of a run, relative to the page of the reproduction."""
    return f"{world}/page.html"


def make_plan(
    figure: str | None = None, study: str | None = None, quick: bool = False, films: bool = True
) -> Plan:
    """Plan for everything, for one figure of the paper, or for one study.

    Raises PhysimError, with what is allowed, for one that is not there.
    """
    chosen, experiments = parts(), studies()
    if figure is not None:
        chosen, experiments = _figure(figure.strip(), chosen), ()
    if study is not None:
        names = [one.name for one in experiments]
        if study not in names:
            raise PhysimError(
                f'--study "{study[:100]}": not a study; allowed: {", ".join(names) or "none"}'
                + nearest(study[:100], names)
            )
        chosen = () if figure is None else chosen
        experiments = tuple(one for one in experiments if one.name == study)
    return Plan(chosen, experiments, quick, films)


def _figure(figure: str, chosen: tuple[Part, ...]) -> tuple[Part, ...]:
    """Parts of a figure: with a letter that part, without one all that has its number."""
    name = figure.lower().removeprefix("fig").lstrip(".ure ")
    if name == FLOW_CHART:
        raise PhysimError("--figure 5: Figure 5 is the flow chart of the rules; nothing is run")
    known = [part.figure for part in chosen if part.figure != WORDS]
    found = [part for part in chosen if part.figure == name != WORDS]
    if name.isdigit():
        found = [part for part in chosen if part.figure.rstrip("abcd") == name]
    if not found:
        close = min(known, key=lambda one: (one[:1] != name[:1], known.index(one)))
        hint = f'; did you mean "{close}"?' if close[:1] == name[:1] else ""
        fault = f'--figure "{figure[:100]}": not a figure; allowed: {", ".join(known)}'
        raise PhysimError(fault + hint)
    return tuple(found)
