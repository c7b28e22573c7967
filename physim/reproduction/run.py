"""What is run for a reproduction, and what comes of it: runs, pictures, films, verdicts."""

from __future__ import annotations

import math
import os
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from physim._version import __version__
from physim.campaigns.pool import Job, Stop, do_all
from physim.drawing.plots.map import trajectories
from physim.drawing.plots.pictures import PICTURES as PLOTS
from physim.errors import PhysimError, nearest, plural
from physim.record import Record
from physim.reproduction.measures import Measures, measures
from physim.reproduction.model import (
    PAIR_TIMES,
    WORDS,
    Arm,
    Measure,
    Part,
    Report,
    Section,
)
from physim.reproduction.papers import FIRST, Paper, papers
from physim.reproduction.pictures import pair_times, picture, study_plot
from physim.reproduction.study import Runs, Study
from physim.simulation.run import simulate
from physim.world.file import load_world

Found = Mapping[Any, "MeasuredRun"]
"""Runs that are done, by the keys of their jobs."""

FLOW_CHART = "5"
PICTURES = "figures"
"""Folder of the pictures, beside the pages."""
MOST_ARMS = 12
"""Arms whose commands are listed."""


class MeasuredRun(NamedTuple):
    """What is kept of a run."""

    name: str
    seed: int
    measures: Mapping[str, Measures]
    """figures by the name of their function"""
    files: tuple[str, ...] = ()
    """pictures, film and page that were made of it"""


def run(arm: Arm, seed: int, wanted: Sequence[Measure], stop: Stop) -> MeasuredRun | None:
    """Run a world and measure it; None when it was stopped. Raises PhysimError with its name."""
    try:
        record = simulate(arm.load(seed), seed=seed, stop=stop)
    except PhysimError as error:
        name = " ".join([arm.world, *arm.overrides, f"seed {seed}"])
        raise PhysimError(f"{name}: {error}") from None
    with record:
        return None if record.ended == "interrupted" else _measured(record, wanted)


def _measured(record: Record, wanted: Sequence[Measure]) -> MeasuredRun:
    found = {measure.__name__: dict(measure(record)) for measure in wanted}
    return MeasuredRun(record.name, record.seed, found)


def show(
    world: str, figures: Sequence[str], folder: Path, films: bool, stop: Stop
) -> MeasuredRun | None:
    """Run a world of the paper with its own seed, keep the record, and draw ``figures`` of it.

    When it is stopped it returns what there is by then: None without a whole run.
    """
    from physim.drawing.page import write_page
    from physim.drawing.video import render

    files, path = [], folder / world / "record.h5"
    mine = [part for part in FIRST.parts() if part.figure in figures]
    with simulate(load_world(world), path=path, overwrite=True, stop=stop) as record:
        if record.ended == "interrupted":
            os.unlink(path)
            return None
        found = _measured(record, (measures,))
        for part in mine:
            for name in part.pictures:
                files.append(picture_of(part.figure, name))
                with picture(folder / files[-1]) as keep:
                    if name == PAIR_TIMES:
                        keep(pair_times(record))
                    elif name == "trajectories":
                        keep(trajectories(record, part.snapshots))
                    else:
                        keep(PLOTS[name](record))
        if films and any(part.film for part in mine) and not stop():
            film, page = shown_of(world)
            write_page([record], folder / page)
            render(record, folder / film, stop=stop)
            files += [page] if stop() else [film, page]
    return found._replace(files=tuple(files))


@dataclass(frozen=True)
class Plan:
    """What is to be reproduced, and how thoroughly."""

    paper: Paper
    parts: tuple[Part, ...]
    studies: tuple[Study, ...]
    quick: bool = False
    films: bool = True

    @property
    def seeds(self) -> int:
        """Seeds of each world of the paper, from 0."""
        return Part.quick_seeds if self.quick else Part.seeds

    @property
    def experiments(self) -> tuple[Part | Study, ...]:
        """All that has arms and seeds, the longest runs of the paper's figures first."""
        return (*reversed(self.parts), *self.studies)

    def seeds_of(self, experiment: Part | Study) -> int:
        """Seeds of each arm of an experiment, from 0."""
        return experiment.quick_seeds if self.quick else experiment.seeds

    @property
    def worlds(self) -> tuple[str, ...]:
        """Worlds of the paper's figures, the longest runs first."""
        return tuple(dict.fromkeys(part.world for part in reversed(self.parts)))

    def jobs(self, folder: Path) -> Iterator[tuple[Any, Job]]:
        """Runs with their keys: those that are shown first, each run once whoever needs it."""
        for world in self.worlds:
            figures = tuple(part.figure for part in self.parts if part.world == world)
            yield world, Job(f"{world}, pictures", show, (world, figures, folder, self.films))
        wanted: dict[tuple[Arm, int], dict[str, Measure]] = {}
        for one in self.experiments:
            for seed in range(self.seeds_of(one)):
                for arm in one.arms:
                    wanted.setdefault((arm, seed), {})[one.measure.__name__] = one.measure
        for (arm, seed), needed in wanted.items():
            given = (arm, seed, tuple(needed.values()))
            yield (arm, seed), Job(f"{arm.world} seed {seed}", run, given)

    def table(self, experiment: Part | Study, found: Found) -> list[list[Measures]]:
        """Figures of an experiment, a row an arm, a column a seed, of the runs that are done."""
        seeds, name = range(self.seeds_of(experiment)), experiment.measure.__name__
        keys = [[(arm, seed) for seed in seeds] for arm in experiment.arms]
        return [[found[key].measures[name] for key in row if key in found] for row in keys]


def picture_of(experiment: str, name: str) -> str:
    """File of a picture, relative to the page."""
    return f"{PICTURES}/{experiment}-{name}.png"


def shown_of(world: str) -> tuple[str, str]:
    """Files of the video and of the page of a run, relative to the page of the reproduction."""
    return f"{world}/video.mp4", f"{world}/page.html"


def make_plan(
    figure: str | None = None,
    study: str | None = None,
    quick: bool = False,
    films: bool = True,
    paper: str | None = None,
) -> Plan:
    """Plan for everything of a paper, the first unless named, for one figure of it, or one study.

    Raises PhysimError, with what is allowed, for one that is not there.
    """
    known = papers()
    if paper is not None and paper not in known:
        raise PhysimError(
            f'--paper "{paper[:100]}": not a paper; allowed: {", ".join(known)}'
            + nearest(paper[:100], list(known))
        )
    one = known[paper] if paper else FIRST
    chosen, experiments = one.parts(), one.studies()
    if figure is not None and not chosen:
        raise PhysimError(f"--figure: the paper {one.name} has studies only; use --study")
    if figure is not None:
        chosen, experiments = _figure(figure.strip(), chosen), ()
    if study is not None:
        names = [each.name for each in experiments]
        if study not in names:
            raise PhysimError(
                f'--study "{study[:100]}": not a study; allowed: {", ".join(names)}'
                + nearest(study[:100], names)
            )
        chosen, experiments = (), tuple(each for each in experiments if each.name == study)
    return Plan(one, chosen, experiments, quick, films)


def _figure(figure: str, chosen: tuple[Part, ...]) -> tuple[Part, ...]:
    """Parts of a figure: with a letter that part, without one all that has its number."""
    name = figure.lower().removeprefix("fig").lstrip(".ure ")
    if name == FLOW_CHART:
        raise PhysimError("--figure 5: Figure 5 is the flow chart of the rules; nothing is run")
    known = [part.figure for part in chosen if part.figure != WORDS]
    found = [
        part
        for part in chosen
        if part.figure != WORDS and name in (part.figure, part.figure.rstrip("abcd"))
    ]
    if not found:
        raise PhysimError(
            f'--figure "{figure[:100]}": not a figure; allowed: {", ".join(known)}'
            + nearest(name[:100], known)
        )
    return tuple(found)


def reproduce(
    plan: Plan,
    folder: Path,
    *,
    workers: int,
    command: str,
    stop: Callable[[], bool],
    progress: Callable[[int, int, str], None],
) -> Report:
    """Do all jobs of a plan; records, pictures and films go to ``folder``, which must exist.

    Raises PhysimError when a run fails. When ``stop`` says True the report holds what is done.
    """
    found = do_all(plan.jobs(folder), workers, stop, progress)
    sections = [_part_section(part, plan, found) for part in plan.parts]
    sections += [_study_section(study, plan, found, folder) for study in plan.studies]
    figures = {
        world: {
            name: value
            for name, value in found[world].measures[measures.__name__].items()
            if math.isfinite(value)
        }
        for world in reversed(plan.worlds)
        if world in found
    }
    return Report(
        __version__, command, plan.seeds, tuple(sections), figures, stop(), plan.paper.name
    )


def _part_section(part: Part, plan: Plan, found: Found) -> Section:
    """A figure of the paper: its claims, judged by the pictured run and by all seeds."""
    if part.world not in found:
        return Section(part.figure, part.title, "", (), (), missing="Interrupted before its run.")
    name, seed, by_function, made = found[part.world]
    pictured = by_function[measures.__name__]
    runs, *bare = plan.table(part, found)
    short = part.title.split(":")[0]
    pictures = tuple(picture_of(part.figure, what) for what in part.pictures)
    films = shown_of(part.world) if part.film else ()
    few = (
        "none was run." if not runs else f"{plural(len(runs), 'run')}, seeds 0 to {len(runs) - 1}."
    )
    option = "" if part.figure == WORDS else f" --figure {part.figure}"
    commands = [f"physim reproduce{option}", f"physim run {part.world} --seed {seed} -o out"]
    if plots := [name for name in part.pictures if name != PAIR_TIMES]:
        every = f" --snapshots {part.snapshots:g}" if part.snapshots else ""
        commands.append(f"physim plot out/record.h5 --only {','.join(plots)}{every}")
    return Section(
        part.figure, part.title,
        f"World {part.world}. Measured: seed {seed}, as in the pictures. Over seeds: {few}",
        tuple(commands),
        tuple(claim.verdict(pictured, runs, *bare) for claim in part.claims),
        pictures,
        tuple(f"{short}, {what.replace('_', ' ')}: {name}, seed {seed}" for what in part.pictures),
        tuple(file for file in films if file in made),
        "" if len(runs) == plan.seeds else "Interrupted before all seeds were run.",
    )  # fmt: skip


def _study_section(study: Study, plan: Plan, found: Found, folder: Path) -> Section:
    """An experiment: its verdicts and its plot, which is drawn here."""
    table = plan.table(study, found)
    of = "" if plan.paper is FIRST else f" --paper {plan.paper.name}"
    commands = [f"physim reproduce{of} --study {study.name}"]
    if len(study.arms) <= MOST_ARMS and all(arm.text is None for arm in study.arms):
        for arm in study.arms:
            sets = "".join(f" --set {shlex.quote(one)}" for one in arm.overrides)
            label = " ".join(arm.label.split())
            commands.append(f"physim run {arm.world}{sets} --seed 0  # {label}")
    seeds, title = plan.seeds_of(study), f"Study: {study.title}"
    about = f"{study.claim} Seeds 0 to {seeds - 1} in each of {len(study.arms)} arms."
    if any(len(row) < seeds for row in table):
        missing = "Interrupted before all was run."
        return Section(study.name, title, about, tuple(commands), (), missing=missing)
    arms, file = [Runs(row) for row in table], picture_of("study", study.name)
    with picture(folder / file) as keep:
        keep(study_plot(study, arms))
    return Section(
        study.name, title, about, tuple(commands), tuple(study.conclude(arms)), (file,),
        (study.title,),
    )  # fmt: skip
