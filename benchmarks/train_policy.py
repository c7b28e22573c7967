"""Train the policy of the controller `learned`: ``python -m benchmarks.train_policy [-o FILE]``.

An evolution strategy (CMA-ES) over the numbers of the policy, 24. Each generation tries `MANY`
policies, each in every training world with the same `RUNS` seeds, others in each generation. A run
is worth, on average over its robots: 1 for arriving, and the share of the way made; less 2 for a
robot that touched anything, 0.1 for each second of touch, and what is closer than `CLOSE`. The
budget is a number of generations, so the result depends on nothing but the seed: ten minutes on two
quiet cores. Of the last means the one that does best on other seeds is kept.
"""

from __future__ import annotations

import argparse
import functools
import json
import multiprocessing
import time
from pathlib import Path
from typing import Any

import cma
import numpy as np
from numpy.typing import NDArray

import physim
from physim.controllers.learned import FEATURES, SCALES, Learned, LearnedSettings, Policy

SEED, MANY, RUNS, GENERATIONS, KEPT, CLOSE = 1, 14, 1, 40, 5, 0.2
STALLED = 60  # actions in which nobody got on: the rest of the run is not waited for
SHAPES: tuple[Any, ...] = (
    {"length": 1.7, "width": 0.9},
    [[0.9, 0.0], [-0.7, 0.5], [-0.7, -0.5]],
    {"length": 1.4, "width": 1.1},
    [[0.9, 0.0], [0.4, 0.5], [-0.6, 0.5], [-0.8, 0.0], [-0.6, -0.5], [0.4, -0.5]],
)


def world(name: str, routes: Any, boundaries: Any, formation: Any = None) -> physim.World:
    """A world whose robots start somewhere around the beginnings of their routes."""
    robots = [
        {
            "name": f"r{k + 1}", "footprint": SHAPES[k % len(SHAPES)], "path": route,
            "start": {"region": box(*route[0], 1.5), "heading": "random"},
        }
        for k, route in enumerate(routes)
    ]  # fmt: skip
    told: dict[str, Any] = {
        "name": name, "time": {"step": 0.05, "duration": 40.0}, "boundaries": boundaries,
        "reference_path": routes[0], "robots": robots,
    }  # fmt: skip
    told |= {"formation": formation} if formation else {}
    return physim.parse_world(json.dumps(told))  # which is YAML, too


def box(x: float, y: float, half: float, high: float | None = None) -> list[list[float]]:
    """Corners of a rectangle around a place."""
    high = half if high is None else high
    return [[x - half, y - high], [x + half, y - high], [x + half, y + high], [x - half, y + high]]


def closed(points: list[list[float]]) -> list[list[list[float]]]:
    """A boundary round an area."""
    return [[*points, points[0]]]


@functools.cache
def training_worlds() -> list[physim.World]:
    """Places to meet: a ring, two ways of a corridor, a gate, crossing streams, a bend."""
    angles = np.arange(6) * np.pi / 3.0
    ends = np.round(9.0 * np.stack((np.cos(angles), np.sin(angles)), axis=1), 3).tolist()
    ring = [[ends[k], ends[(k + 3) % 6]] for k in range(6)]
    places = (-10.0, 0.6), (-13.0, -0.6), (-16.0, 0.6)
    both = [[[x, y], [x + 25.0, y]] for x, y in places]
    both += [[[-x, y], [-x - 25.0, y]] for x, y in places]
    hall = [[-20.0, -6.0], [-1.0, -6.0], [-1.0, -1.3], [1.0, -1.3], [1.0, -6.0], [20.0, -6.0]]
    hall += [[-x, -y] for x, y in hall]
    gate = [
        [[x, y], [-6.0, y], [-3.0, 0.0], [3.0, 0.0], [6.0, y], [x + 23.0, y]]
        for x, y in ((-9.0, 0.0), (-10.0, 3.5), (-10.5, -3.5), (-13.0, 0.0), (-14.0, 3.5))
    ]
    streams = [[[-9.0 - 3.0 * k, 1.5 * k - 1.5], [13.0 - 3.0 * k, 1.5 * k - 1.5]] for k in range(3)]
    streams += [
        [[1.5 * k - 1.5, -9.0 - 3.0 * k], [1.5 * k - 1.5, 13.0 - 3.0 * k]] for k in range(3)
    ]
    bend = [[-3.0, -3.5], [23.5, -3.5], [23.5, 20.0], [16.5, 20.0], [16.5, 3.5], [-3.0, 3.5]]
    lanes = [
        [[x, y], [20.0 - y, y], [20.0 - y, 5.0 + x]]
        for x, y in ((12.0, 1.9), (9.5, -1.9), (6.5, 0.0), (3.5, 1.9), (1.0, -1.9))
    ]
    return [
        world("ring", ring, closed(box(0.0, 0.0, 13.0))),
        world("both ways", both, closed(box(0.0, 0.0, 20.0, 3.6))),
        world("gate", gate, closed(hall)),
        world("streams", streams, closed(box(0.0, 0.0, 18.0))),
        world("bend", lanes, closed(bend), {"speed": 1.0, "spacing": "initial"}),
    ]


START: tuple[dict[str, float], dict[str, float]] = (
    {
        "one": 0.0, "near": 0.0, "near_ahead": 0.0, "threat": 0.0, "threat_ahead": -0.5,
        "wall_near": 0.0, "wall_near_ahead": 0.0, "wall_threat": 0.0, "wall_threat_ahead": 0.0,
    },
    {
        "turn": 0.0, "near": 0.0, "near_left": -0.2, "threat": -0.2, "threat_ahead": 0.0,
        "threat_left": -0.2, "threat_side": 0.0, "wall_near_left": -0.2, "wall_threat_left": 0.0,
    },
)  # fmt: skip
"""Weights of v and omega that are searched, and where the search begins: brake for what is met
ahead, turn away from what is near, and to the right of what is met. The others are 0: what is left
or right of it does not slow a robot, and it turns the same way for the mirrored scene but for that.
"""


def policy_of(numbers: NDArray[Any]) -> Policy:
    """A policy from what is searched: logarithms of scales, then weights."""
    weights, rest = np.zeros((2, len(FEATURES))), iter(numbers[len(SCALES) :])
    for row, names in zip(weights, START, strict=True):
        for name in names:
            row[FEATURES.index(name)] = next(rest)
    return Policy(np.exp(numbers[: len(SCALES)]), weights)


def first() -> NDArray[Any]:
    """Where the search begins."""
    scales = np.log([0.5, 0.5, 2.0, 0.3, 0.3, 1.0])
    return np.concatenate((scales, *(list(names.values()) for names in START)))


def worth(asked: tuple[NDArray[Any], int, int]) -> tuple[float, bool, bool]:
    """What a run of some numbers in a world with a seed is worth; contact-free? finished?"""
    numbers, which, seed = asked
    learned = Learned(LearnedSettings(), policy_of(numbers))
    run = physim.Simulation(training_worlds()[which], seed, learned)
    robots, start = run.scene.robots, run.now.station
    touched, close = np.zeros(robots), np.zeros(robots)
    cycles = run.scene.steps // 2
    before = start
    for cycle in range(cycles):
        run.step(steps=2)
        for row in run.contacts:
            touched[[k for k in (row["a"], row["b"]) if k < robots]] += 0.1
        near = run.arrays(1, 1, ())
        gaps = np.where(near.others_mask, near.others[..., 6], 9.0).min(axis=1)
        walls = np.where(near.walls_mask, near.walls[..., 2], 9.0).min(axis=1)
        close += np.clip(1.0 - np.minimum(gaps, walls) / CLOSE, 0.0, 1.0) / cycles
        way, on = run.now.station, cycle % STALLED
        if run.finished or (on == 0 and cycle and (way - before).max() < 0.1):
            break
        before = way if on == 0 else before
    made = np.clip((run.now.station - start) / (run.scene.stop_station - start), 0.0, 1.0)
    each = run.arrived + made - 2.0 * (touched > 0.0) - np.minimum(0.1 * touched, 1.0) - 2.0 * close
    return float(each.mean()), not touched.any(), run.finished


def written(file: Path, numbers: NDArray[Any]) -> None:
    """Write a policy."""
    scales, weights = policy_of(numbers)
    told: dict[str, Any] = {"scales": dict(zip(SCALES, scales.round(4).tolist(), strict=True))}
    for key, row in zip(("v", "omega"), weights.round(4).tolist(), strict=True):
        told[key] = dict(zip(FEATURES, row, strict=True))
    file.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")


def main() -> None:
    """Train, and write the policy."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.train_policy", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("controllers/learned.json"))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--generations", type=int, default=GENERATIONS)
    given = parser.parse_args()
    began, worlds = time.perf_counter(), range(len(training_worlds()))
    options = {"seed": SEED, "popsize": MANY, "verbose": -9}
    search = cma.CMAEvolutionStrategy(first(), 0.2, options)
    means: list[NDArray[Any]] = []

    def tried(all_numbers: list[NDArray[Any]], seeds: list[int]) -> list[list[Any]]:
        jobs = [(numbers, k, seed) for numbers in all_numbers for k in worlds for seed in seeds]
        found = pool.map(worth, jobs, chunksize=2)
        size = len(found) // len(all_numbers)
        return [found[k : k + size] for k in range(0, len(found), size)]

    with multiprocessing.Pool(given.workers) as pool:
        for generation in range(given.generations):
            numbers = search.ask()
            found = tried(numbers, [10_000 + RUNS * generation + k for k in range(RUNS)])
            means_worth = [float(np.mean([one[0] for one in runs])) for runs in found]
            search.tell(numbers, [-one for one in means_worth])
            means.append(search.mean.copy())
            written(given.output, search.mean)  # for who stops it before its end
            flat = [one for runs in found for one in runs]
            print(
                f"{generation + 1:3d}  worth {max(means_worth):6.3f}, mean "
                f"{np.mean(means_worth):6.3f}  contact-free {np.mean([one[1] for one in flat]):.2f}"
                f"  finished {np.mean([one[2] for one in flat]):.2f}"
                f"  {time.perf_counter() - began:5.0f} s", flush=True,
            )  # fmt: skip
        last = means[-KEPT:]
        held = tried(last, list(range(20_000, 20_006)))
    rated = [float(np.mean([one[0] for one in runs])) for runs in held]
    written(given.output, last[int(np.argmax(rated))])
    print(given.output, f"worth {max(rated):.3f} on other seeds")


if __name__ == "__main__":
    main()
