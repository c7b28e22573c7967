"""Run the experiments of the paper, judge its claims, write the pages."""

from __future__ import annotations

import math
import shlex
from collections.abc import Callable
from functools import partial
from pathlib import Path

from physim._version import __version__
from physim.analysis.metrics.distances import shortest_pair_collision_time
from physim.campaigns.pool import do_all
from physim.compiled import is_cached
from physim.errors import plural
from physim.geometry.queries import fill_times
from physim.parts.registry import CONTROLLER, make_part
from physim.reproduction.claims import measures
from physim.reproduction.page import TITLE, html, markdown
from physim.reproduction.plan import Found, Plan, film_of, page_of, picture_of
from physim.reproduction.report import Report, Section
from physim.reproduction.study import PAIR_TIMES, WORDS, Part, Study
from physim.simulation.run import is_warm as runs_are_warm
from physim.simulation.run import simulate
from physim.simulation.run import warm_up as warm_up_runs
from physim.world.file import load_world
from physim.world.layout.scene_builder import build_scene

WORLD = "three_robots"
SECONDS = 0.2
"""[s] simulated"""


def is_warm() -> bool:
    """Whether all kernels lie compiled on disk."""
    return runs_are_warm() and is_cached(fill_times)


def warm_up() -> None:
    """Take a run that is thrown away."""
    world = load_world(WORLD, overrides=[f"time.duration={SECONDS}"])
    choice = world.controller
    warm_up_runs(build_scene(world), make_part(CONTROLLER, choice.type, choice.settings))
    with simulate(world) as record:
        shortest_pair_collision_time(record)


MARKDOWN, HTML, JSON = "REPRODUCTION.md", "reproduction.html", "reproduction.json"
PAGES = (MARKDOWN, HTML, JSON)
MOST_ARMS = 12
"""Arms whose commands are listed."""


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
    found = do_all(plan.jobs(folder), partial(plan.following, folder), workers, stop, progress)
    sections = [_part_section(part, plan, found) for part in plan.parts]
    sections += [_study_section(study, plan, found) for study in plan.studies]
    pictured = {
        world: found[("record", world)].measures[measures.__name__]
        for world in reversed(plan.worlds)
        if ("record", world) in found
    }
    figures = {
        world: {name: value for name, value in run.items() if math.isfinite(value)}
        for world, run in pictured.items()
    }
    return Report(__version__, command, plan.seeds, tuple(sections), figures, stop())


def pages(report: Report, folder: Path) -> dict[str, str]:
    """Texts of the files that present the report, by name; pictures are read from ``folder``."""
    text = markdown(report)
    return {MARKDOWN: text, HTML: html(text, TITLE, folder), JSON: report.to_json()}


def _part_section(part: Part, plan: Plan, found: Found) -> Section:
    """A figure of the paper: its claims, judged by the pictured run and by all seeds."""
    if ("record", part.world) not in found:
        return Section(part.figure, part.title, "", (), (), missing="Interrupted before its run.")
    name, seed, by_function = found[("record", part.world)]
    pictured = by_function[measures.__name__]
    runs, *bare = plan.table(part, found)
    pictures = [
        (file, f"{part.title.split(':')[0]}, {what.replace('_', ' ')}: {name}, seed {seed}")
        for what in part.pictures
        if ("picture", file := picture_of(part.figure, what)) in found
    ]
    kinds = (("film", film_of), ("page", page_of)) if part.film else ()
    films = tuple(file(part.world) for kind, file in kinds if (kind, part.world) in found)
    about = f"World {part.world}. Measured: seed {seed}, as in the pictures. Over seeds: "
    few = (
        "none was run." if not runs else f"{plural(len(runs), 'run')}, seeds 0 to {len(runs) - 1}."
    )
    option = "" if part.figure == WORDS else f" --figure {part.figure}"
    commands = [f"physim reproduce{option}", f"physim run {part.world} --seed {seed} -o out"]
    if plots := [name for name in part.pictures if name != PAIR_TIMES]:
        every = f" --snapshots {part.snapshots:g}" if part.snapshots else ""
        commands.append(f"physim plot out/record.h5 --only {','.join(plots)}{every}")
    return Section(
        part.figure, part.title, about + few, tuple(commands),
        tuple(claim.verdict(pictured, runs, bare[0] if bare else ()) for claim in part.claims),
        tuple(file for file, _ in pictures), tuple(caption for _, caption in pictures),
        films,
        "" if len(runs) == plan.seeds else "Interrupted before all seeds were run.",
    )  # fmt: skip


def _study_section(study: Study, plan: Plan, found: Found) -> Section:
    """An experiment: its verdicts and its plot."""
    done, drawn = plan.is_done(study, found), ("study", study.name) in found
    return Section(
        study.name, f"Study: {study.title}",
        f"{study.claim} Seeds 0 to {plan.seeds_of(study) - 1} in each of {len(study.arms)} arms.",
        (f"physim reproduce --study {study.name}", *_arms(study)),
        tuple(study.conclude(plan.table(study, found))) if done else (),
        (picture_of("study", study.name),) if drawn else (), (study.title,) if drawn else (),
        missing="" if done else "Interrupted before all was run.",
    )  # fmt: skip


def _arms(study: Study) -> list[str]:
    """Commands that run the arms of a study, as long as their worlds are shipped ones."""
    lines = []
    for arm in study.arms:
        if arm.text is None:
            sets = "".join(f" --set {shlex.quote(one)}" for one in arm.overrides)
            label = " ".join(arm.label.split())
            lines.append(f"physim run {arm.world}{sets} --seed 0  # {label}")
    return lines if len(lines) <= MOST_ARMS else []
