"""Which jobs a reproduction consists of, and which follow from which."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from physim.errors import PhysimError, nearest
from physim.reproduction.claims import Part, measures, parts
from physim.reproduction.claims.effort import WORDS
from physim.reproduction.jobs import PAPER, Film, Job, PicturedRun, Plot, Run, StudyPlot
from physim.reproduction.studies import studies
from physim.reproduction.study import Arm, Measures, Study

SEEDS, QUICK_SEEDS = 100, 5
"""of each world of the paper"""
FLOW_CHART = "5"
PICTURES = "figures"
"""Folder of the pictures, beside the pages."""


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

    def seeds_of(self, study: Study) -> int:
        """Seeds of each arm of a study, from 0."""
        return study.quick_seeds if self.quick else study.seeds

    @property
    def worlds(self) -> tuple[str, ...]:
        """Worlds of the paper's figures, the longest runs first."""
        return tuple(dict.fromkeys(part.world for part in reversed(self.parts)))

    def jobs(self, folder: Path) -> Iterator[tuple[Any, Job]]:
        """Runs with their keys: those for pictures first, each run once whoever needs it."""
        for world in self.worlds:
            yield ("record", world), PicturedRun(world, folder / world / "record.h5")
        runs: dict[Any, Run] = {}
        for tag, arm, seed, find in self._wanted():
            key = run_key(arm, seed)
            run = runs.setdefault(key, Run(arm, seed, {}))
            runs[key] = replace(run, measure={**run.measure, tag: find})
        yield from runs.items()

    def _wanted(self) -> Iterator[tuple[str, Arm, int, Any]]:
        for world in self.worlds:
            for seed in range(self.seeds):
                yield PAPER, Arm("", world), seed, measures
        for world in dict.fromkeys(part.world for part in self.parts if part.null):
            for seed in range(self.seeds):
                yield PAPER, without_avoidance(world), seed, measures
        for study in self.studies:
            for seed in range(self.seeds_of(study)):
                for arm in study.arms:
                    yield study.name, arm, seed, study.measure


def without_avoidance(world: str) -> Arm:
    """A world of the paper with avoidance switched off."""
    return Arm("", world, ("controller.avoidance=none",))


class Followers:
    """Jobs that results make possible: pictures and films of records, plots of whole studies."""

    def __init__(self, plan: Plan, folder: Path) -> None:
        self.plan, self.folder = plan, folder
        self.found: dict[Any, Any] = {}

    def __call__(self, key: Any, result: Any) -> Iterable[tuple[Any, Job]]:
        """Jobs that follow from the result of a job."""
        self.found[key] = result
        if key[0] == "record":
            yield from self._of_record(key[1])
        if key[0] == "run":
            for study in self.plan.studies:
                if study.name in result and (table := study_table(self.plan, study, self.found)):
                    path = self.folder / study_picture(study)
                    yield ("study", study.name), StudyPlot(study.name, table, path)

    def _of_record(self, world: str) -> Iterator[tuple[Any, Job]]:
        record = self.folder / world / "record.h5"
        mine = [part for part in self.plan.parts if part.world == world]
        if self.plan.films and any(part.film for part in mine):
            yield ("film", world), Film(record, self.folder / film_of(world))
        for part in mine:
            for name in part.pictures:
                file = picture_of(part, name)
                yield ("picture", file), Plot(record, name, self.folder / file, part.snapshots)


def run_key(arm: Arm, seed: int) -> Any:
    """Key of a run: arms that differ in their labels alone are the same run."""
    return "run", replace(arm, label=""), seed


def study_table(
    plan: Plan, study: Study, found: dict[Any, Any]
) -> Sequence[Sequence[Measures]] | None:
    """Figures of a study, a row an arm, a column a seed; None when a run is missing."""
    seeds = range(plan.seeds_of(study))
    keys = [[run_key(arm, seed) for seed in seeds] for arm in study.arms]
    if any(key not in found for row in keys for key in row):
        return None
    return [[found[key][study.name] for key in row] for row in keys]


def picture_of(part: Part, name: str) -> str:
    """File of a picture, relative to the page."""
    return f"{PICTURES}/{part.figure}-{name}.png"


def study_picture(study: Study) -> str:
    """File of the plot of a study, relative to the page."""
    return f"{PICTURES}/study-{study.name}.png"


def film_of(world: str) -> str:
    """File of a video, relative to the page."""
    return f"{world}/video.mp4"


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
        told = f'--figure "{figure[:100]}": not a figure; allowed: {", ".join(known)}'
        raise PhysimError(told + hint)
    return tuple(found)
