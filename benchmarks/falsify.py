"""Does the search of `physim falsify` find more than chance does, at the same number of runs?

python -m benchmarks.falsify [WORLD ...] [--budget N] [--seconds T] [--controllers A,B]
python -m benchmarks.falsify --planted TRIALS [--draws N]

The first prints a row for each world and controller: the least signed swept clearance that CMA-ES
and random search reach with N runs of at most T seconds each, and the run of their first failure.
Starts and headings are varied. Without names: every shipped world of at most 20 robots.

The second looks for a fault that was planted (`benchmarks/planted.py`), TRIALS times with up to
5,000 runs each, and draws N worlds at random to see how often chance would hit it. Its runs are
made by a twin of the simulator; each failure is run in the simulator, too.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
from collections.abc import Sequence

import numpy as np

import physim
from benchmarks.planted import Twin, planted_world
from physim.campaigns.falsify.evaluate import accepted, in_this_process, judge_world
from physim.campaigns.falsify.search import Hunt, hunt
from physim.campaigns.falsify.space import Space
from physim.errors import PhysimError
from physim.world.file.files import shipped_worlds

MOST_ROBOTS = 20
MOST_RUNS = 5000
CONTROLLERS = ("mode_switching", "path_following")
"""Of the shipped ones; by the third, constant, robots stand where a world gives no commands."""
HEAD = (
    "| world | controller | clearance of the world itself | CMA-ES: least clearance, first failure "
    "| at random: least clearance, first failure |\n|---|---|---|---|---|"
)


def compare(name: str, controller: str, budget: int, seconds: float) -> str:
    """Row of the table: both searches in one world, each with its whole budget."""
    world = physim.load_world(name, controller=controller)
    time = {"step": world.time.step, "duration": min(world.time.duration, seconds)}
    space = Space(world.changed(time=time, expect=None))
    found = [
        hunt(
            space, in_this_process(), accepted(controller), budget=budget, at_random=at_random,
            whole_budget=True,
        )
        for at_random in (False, True)
    ]  # fmt: skip
    return (
        f"| {name} | {controller} | {found[0].first:.3f} m | {outcome(found[0])} "
        f"| {outcome(found[1])} |"
    )


def outcome(found: Hunt) -> str:
    """Least clearance of a search and its first failure, of all runs."""
    assert found.judged is not None
    failed = next((run for run, value, _ in found.history if value <= 0.0), None)
    first = "none" if failed is None else f"run {failed}, {found.failures} in all"
    return f"{found.judged.clearance:.3f} m, {first}"


def trials(count: int) -> None:
    """Look for the planted fault with one seed after the other."""
    space, runs, missed, refuted = Space(planted_world()), [], 0, 0
    twin, accepts = Twin(space.world), accepted(space.world.controller.type)
    for seed in range(count):
        found = hunt(space, twin.evaluate, accepts, budget=MOST_RUNS, seed=seed)
        if found.failed and found.world is not None:
            runs.append(found.run)
            refuted += not judge_world(found.world).failed
        else:
            missed += 1
        print(json.dumps({"seed": seed, "found": found.failed, "runs": found.runs}), flush=True)
    print(
        f"found in {len(runs)} of {count} trials within {MOST_RUNS} runs, {refuted} of them not "
        f"so in the simulator; runs: median {statistics.median(runs):g}, largest {max(runs)}",
        flush=True,
    )


def chance(draws: int) -> None:
    """How often a world drawn at random has the planted fault."""
    space = Space(planted_world())
    twin, random, hits = Twin(space.world), np.random.default_rng(1), 0
    for _ in range(draws):
        hits += twin.judge(space.at(random.random(len(space.dimensions))).world).failed
    print(f"{hits} of {draws} worlds drawn at random fail")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("worlds", nargs="*", metavar="WORLD")
    parser.add_argument("--budget", type=int, default=30)
    parser.add_argument("--seconds", type=float, default=15.0)
    parser.add_argument("--controllers", default=",".join(CONTROLLERS))
    parser.add_argument("--planted", type=int, metavar="TRIALS")
    parser.add_argument("--draws", type=int, default=0)
    given = parser.parse_args(arguments)
    if given.planted is not None:
        trials(given.planted)
        if given.draws:
            chance(given.draws)
        return 0
    names = given.worlds or [
        name for name in shipped_worlds() if physim.load_world(name).robot_count <= MOST_ROBOTS
    ]
    print(HEAD, flush=True)
    for name in names:
        for controller in given.controllers.split(","):
            try:
                row = compare(name, controller, given.budget, given.seconds)
            except PhysimError as error:
                row = f"| {name} | {controller} | refused | {str(error)[:90]}… | |"
            print(row, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
