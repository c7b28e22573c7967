"""Settings of controllers for the league, found with one budget for all.

python -m benchmarks.tuning [CONTROLLER ...] [--jobs N] [-o DIR]

For every controller, the paper's too, `SETTINGS` settings are tried: the defaults, which are those
of its source, and draws from the ranges of `drawn`, by one rule for all. Each drives `FIRST` seeds
of every world of ``worlds/training``, none of which is in the league; the `BEST` of them, and the
defaults, also `MORE` seeds. The best of these over all their runs is written, with what it came
to, to ``worlds/league/tuned.json``, and printed as an entrant of ``worlds/league/league.yaml``.

Better is who has more runs that are contact-free and finished, then who is faster: the mean of the
time to finish as a share of the run's duration, 1 where it did not come to that.

A run that has a row in DIR is not done again. Exit codes: 0 fine, 2 bad input, 130 interrupted.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args, get_origin

import numpy as np
from pydantic import BaseModel, ValidationError

import physim
from physim.campaigns import Processes, Row, RunSpec, read, spec_of, sweep
from physim.errors import PhysimError
from physim.parts.registry import CONTROLLER, find_part, part_names, settings_model
from physim.randomness import stream
from physim.world.file.files import shipped_folder, shipped_worlds

SETTINGS = 32
"""Settings tried of each controller, the defaults among them"""
FIRST, MORE = range(4), range(4, 16)
"""Seeds that all of them drive, and those that the best drive beside"""
BEST = 6
SEED = 55
"""By which settings are drawn"""
SHARE = 0.5
"""[-] of the settings that a draw changes, on average"""
FACTOR = 3.0
"""Numbers are drawn between a third of their default and three times that, evenly in logarithm"""
FROM_ZERO = {"margin": 0.2, "nudge": 0.05}
"""Greatest values of those whose default may be 0, from which no factor leads"""
ABSENT = {"horizon": (1.0, 30.0)}
"""Range of those that are absent by default; of polytope_vo, whose cones end nowhere without it"""
SAME = ("speed", "look_ahead", "update_period", "arrival_tolerance")
"""Settings that are the same for all controllers in the league, as their defaults are"""
NOT_TUNED = ("constant", "path_following", "learned")
"""Controllers that look at nobody, or are trained"""
TUNED = shipped_folder() / "league" / "tuned.json"

Settings = Mapping[str, Any]


class Score(NamedTuple):
    """What came of settings; the greater the better."""

    solved: int
    """runs that were contact-free and finished"""
    quickness: float
    """[-] minus the mean time to finish, as a share of the duration"""
    runs: int


def tried(controller: str) -> list[Settings]:
    """The settings to try of a controller: none, which are the defaults, and what is drawn."""
    model = settings_model(find_part(CONTROLLER, controller))
    if model is None:
        raise PhysimError(f"{controller}: has no settings to tune")
    return [{}, *(drawn(model, controller, k) for k in range(1, SETTINGS))]


def drawn(model: type[BaseModel], controller: str, number: int) -> Settings:
    """Draw settings: numbers about their defaults, one of several words, yes or no.

    Others that are absent by default, and lists, stay. What the controller refuses is drawn again.
    """
    rng = stream(SEED, f"tuning {controller}", number)
    while True:
        found: dict[str, Any] = {}
        for name, field in model.model_fields.items():
            kind, default = field.annotation, field.default
            if name in SAME or rng.random() >= SHARE:
                continue
            if get_origin(kind) is Literal:
                found[name] = str(rng.choice(get_args(kind)))
            elif isinstance(default, bool):
                found[name] = bool(rng.random() < 0.5)
            elif default is None and name in ABSENT:
                found[name] = rounded(np.exp(rng.uniform(*np.log(ABSENT[name]))))
            elif name in FROM_ZERO:
                found[name] = rounded(rng.uniform(0.0, FROM_ZERO[name]))
            elif isinstance(default, int | float):
                value = default * np.exp(rng.uniform(-1.0, 1.0) * np.log(FACTOR))
                found[name] = round(value) if isinstance(default, int) else rounded(value)
        try:
            model(**found)
        except ValidationError:
            continue
        if found:
            return found


def rounded(value: float) -> float:
    """Three digits of a number."""
    return float(f"{value:.3g}")


def specs_of(controller: str, some: Sequence[Settings], seeds: range) -> Iterator[RunSpec]:
    """The runs of settings on all worlds for training."""
    for name in shipped_worlds("training"):
        for settings in some:
            world = physim.load_world(name).changed(controller={"type": controller, **settings})
            for seed in seeds:
                yield spec_of(world, seed, name=name, settings=written(settings))


def written(settings: Settings) -> str:
    """Settings as rows have them."""
    return "; ".join(f"controller.{key}={json.dumps(value)}" for key, value in settings.items())


def scored(rows: Sequence[Row], settings: Settings) -> Score:
    """The score of settings over all their runs."""
    mine = [row for row in rows if row.settings == written(settings)]
    duration = {name: physim.load_world(name).time.duration for name in {r.world for r in mine}}
    shares = [
        row.time_to_finish / duration[row.world]
        if row.came.rate and row.time_to_finish is not None
        else 1.0
        for row in mine
    ]
    return Score(sum(row.came.rate for row in mine), -float(np.mean(shares)), len(mine))


def tune(controller: str, folder: Path, jobs: int) -> dict[str, Any]:
    """Find the settings of a controller: as `TUNED` has them."""
    some = tried(controller)
    executor = Processes(jobs)
    try:
        sweep(list(specs_of(controller, some, FIRST)), folder, executor)
        rows = [row for row in read(folder) if row.seed in FIRST]
        order = sorted(some, key=lambda one: scored(rows, one), reverse=True)
        last = [some[0], *(one for one in order if one)][: BEST + 1]
        sweep(list(specs_of(controller, last, MORE)), folder, executor)
    finally:
        executor.shutdown()
    rows = read(folder)
    best = max(last, key=lambda one: scored(rows, one))
    return {
        "settings": best,
        **{
            name: {"solved": score.solved, "runs": score.runs, "time": rounded(-score.quickness)}
            for name, score in (("tuned", scored(rows, best)), ("defaults", scored(rows, some[0])))
        },
        "runs": len(rows),
        "cpu_seconds": round(sum(row.cpu_seconds or 0.0 for row in rows)),
    }


def main() -> int:
    """Run the program; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.tuning", description=__doc__.splitlines()[0]
    )
    known = [name for name in part_names(CONTROLLER) if name not in NOT_TUNED]
    parser.add_argument("controllers", nargs="*", metavar="CONTROLLER", help=", ".join(known))
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("-o", dest="folder", type=Path, default=Path("tuning"), metavar="DIR")
    options = parser.parse_args()
    try:
        for controller in options.controllers or known:
            found = tune(controller, options.folder / controller, options.jobs)
            tuned = json.loads(TUNED.read_text("utf-8")) if TUNED.exists() else {}
            tuned[controller] = found
            TUNED.write_text(json.dumps(tuned, indent=1, sort_keys=True) + "\n", "utf-8")
            entrant = {"name": f"{controller} tuned", "controller": controller}
            print(json.dumps({**entrant, "settings": found["settings"]}))
            print(json.dumps({key: one for key, one in found.items() if key != "settings"}))
    except PhysimError as error:
        print(error, file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
