"""What avoidance does: every shipped world as it is, and beside it with avoidance switched off.

Worlds with sensing stages or disturbances also run without these, avoidance on.

python -m benchmarks.avoidance [WORLD ...] [--seeds A:B] [--jobs N] [--check | --write]

Counts runs without a contact and finished ones, the share of decisions by (12) and (13), distances,
and what contacts there are. ``--write`` puts them into docs/gallery/rates.json, from which the
gallery of the site shows them; ``--check`` compares them with those that stand there, and holds the
worlds that claim to show avoidance to their claim: contacts without it in at least half of their
seeds, none with it in at least 95 %. Without ``--seeds`` as many as stand there, from 0; 100 of a
new world. Exit codes: 0 fine, 1 a claim or a figure does not hold, 2 bad input, 130 interrupted.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import statistics
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import physim
from physim.analysis import metrics
from physim.campaigns.pool import Job, do_all
from physim.cli.options import seed_range
from physim.contacts import Phase
from physim.errors import PhysimError
from physim.record import Record
from physim.reproduction.measures import figures
from physim.reproduction.model import Arm
from physim.reproduction.run import run
from physim.reproduction.study import rule_shares
from physim.world.file.files import shipped_worlds
from physim.world.layout.scene_builder import is_random

SHOWS_AVOIDANCE = (
    "ten_robots", "crowded_start", "three_robots", "nonconvex", "random_road", "sliding_door",
    "crossing_cart", "cars", "noisy_ten_robots", "lossy_ten_robots",
)  # fmt: skip
"""Worlds in which avoidance is at work, most often enough."""
HARD = ("crossing_cart",)
"""Those of them that say that it is not enough in some runs."""
WITHOUT = "controller.avoidance=none"
UNDISTURBED = ("sensing.stages=[]", "disturbances=[]")
CONTACTS_WITHOUT, FREE_WITH = 0.5, 0.95
"""[-] What such a world must reach: shares of its seeds"""
RATES = Path(__file__).parents[1] / "docs/gallery/rates.json"
SEEDS = 100

Figures = Mapping[str, float]
Rates = dict[str, Any]
"""Of one world: ``version``, ``seeds``, and by arm, ``with``, ``without`` and ``undisturbed``, runs
that are contact-free and finished, and what `with_it` or `without_it` gives. A world that is
shipped without avoidance has no arm ``with``, one without disturbances none ``undisturbed``."""


def measure(record: Record) -> Figures:
    """Outcome of one run, from its record alone."""
    rows, found = record.contacts, metrics.Figures(record)
    touching = np.unique(rows["step"][rows["phase"] != Phase.ENDED])
    return {
        "contacts": float(len(found.episodes) + len(found.grazes)),
        "finished": float(record.ended == "finished"),
        **rule_shares(record),
        "depth": float(rows["depth"].max()) if len(rows) else 0.0,
        "in_contact": len(touching) * record.dt,
        **figures(record, "shortest_distance"),
    }


def measured(name: str, seeds: Iterable[int], jobs: int) -> Rates:
    """Run a world over the seeds. Raises PhysimError where it cannot be run."""
    world = physim.load_world(name)
    drawn = list(seeds) if is_random(world) else [world.seed]
    arms = [Arm("with", name), Arm("without", name, (WITHOUT,))]
    if world.controller.settings.get("avoidance") == "none":
        arms = [Arm("without", name)]
    if world.sensing.stages or world.disturbances:
        arms.append(Arm("undisturbed", name, UNDISTURBED))
    work = {
        (arm.label, seed): Job(f"{name} seed {seed}", run, (arm, seed, (measure,)))
        for arm in arms
        for seed in drawn
    }
    found = do_all(work.items(), jobs, lambda: False, progress)
    rates: Rates = {"version": physim.__version__, "seeds": len(drawn)}
    for arm in arms:
        runs = [found[arm.label, seed].measures[measure.__name__] for seed in drawn]
        rates[arm.label] = {
            "contact_free": sum(r["contacts"] == 0.0 for r in runs),
            "finished": sum(r["finished"] > 0.0 for r in runs),
            **(without_it(runs) if arm.label == "without" else with_it(runs)),
        }
    return rates


def with_it(runs: Sequence[Figures]) -> dict[str, float | None]:
    """Shares of decisions [-] by (12) and (13), and distances between two robots [m].

    Of the runs' shortest distances the median and the minimum, null for one robot.
    """
    near = [r["shortest_distance"] for r in runs if math.isfinite(r["shortest_distance"])]
    return {
        "by_distance": round(statistics.mean(r["by_distance"] for r in runs), 4),
        "by_time": round(statistics.mean(r["by_time"] for r in runs), 3),
        "shortest_distance": round(statistics.median(near), 2) if near else None,
        "least_distance": round(min(near), 2) if near else None,
    }


def without_it(runs: Sequence[Figures]) -> dict[str, float | None]:
    """Greatest depth [m], and median time in contact [s] of the runs that have contacts."""
    lasts = [r["in_contact"] for r in runs if r["contacts"]]
    return {
        "deepest_contact": round(max(r["depth"] for r in runs), 4),
        "time_in_contact": round(statistics.median(lasts), 1) if lasts else 0.0,
    }


def broken_claims(rates: Mapping[str, Rates]) -> list[str]:
    """What worlds claim and do not hold, one line each."""
    lines = []
    for name in (name for name in SHOWS_AVOIDANCE if name in rates):
        seeds = rates[name]["seeds"]
        free, bare = (rates[name][arm]["contact_free"] for arm in ("with", "without"))
        if free < FREE_WITH * seeds and name not in HARD:
            lines.append(f"{name}: {free} of {seeds} contact-free; {FREE_WITH:.0%} are claimed")
        if seeds - bare < CONTACTS_WITHOUT * seeds:
            lines.append(f"{name}: without avoidance {bare} of {seeds} are contact-free, too")
    return lines


def progress(done: int, of: int, note: str) -> None:
    """One line on the terminal; nothing in a pipe."""
    if sys.stderr.isatty():
        print(f"\r{done} of {of}, {note:40.40}", end="", file=sys.stderr)


def main() -> int:
    """Run the program; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.avoidance", description=__doc__.splitlines()[0]
    )
    parser.add_argument("worlds", nargs="*", metavar="WORLD", help="shipped worlds (all)")
    parser.add_argument("--seeds", type=seed_range, metavar="A:B")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--check", action="store_true", help="against docs/gallery/rates.json")
    what.add_argument("--write", action="store_true", help="into docs/gallery/rates.json")
    options = parser.parse_args()
    names = options.worlds or list(shipped_worlds())
    known: dict[str, Rates] = json.loads(RATES.read_text(encoding="utf-8"))
    rates, wrong = {}, []
    try:
        for name in names:
            seeds = options.seeds or range(known.get(name, {"seeds": SEEDS})["seeds"])
            rates[name] = measured(name, seeds, options.jobs)
            print(json.dumps({name: rates[name]}), flush=True)
            if options.write:
                known[name] = rates[name]
                RATES.write_text(json.dumps(known, indent=1, sort_keys=True) + "\n", "utf-8")
            elif options.check and {**rates[name], "version": ""} != {
                **known.get(name, {}),
                "version": "",
            }:
                wrong.append(f"{name}: {RATES.name} has {json.dumps(known.get(name))}")
    except PhysimError as error:
        print(error, file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    for line in (*broken_claims(rates), *wrong):
        print(line, file=sys.stderr)
    return 1 if wrong or broken_claims(rates) else 0


if __name__ == "__main__":
    sys.exit(main())
