"""How each shipped world fares over other seeds: contacts, arrivals, shortest distances.

python benchmarks/seeds.py [WORLD ...] [--seeds A:B]

Without names: every shipped world, seeds 100 to 119. Contacts are told one by one, and so are runs
that do not finish. A world is the name of a shipped one or a file.
"""

from __future__ import annotations

import argparse
import math
import statistics

import physim
from physim.analysis.metrics import contact_episodes, grazes
from physim.cli.values import seed_range
from physim.record import Record
from physim.world.file.files import find_world, shipped_worlds
from physim.world.layout.scene_builder import is_random


def study(name: str, first: int, end: int) -> None:
    """Run a world with the seeds ``first`` to ``end - 1`` and print what came of it."""
    world = physim.load_world(find_world(name))
    random = is_random(world)
    seeds = range(first, end) if random else [world.seed]
    free = finished = 0
    distances, walls = [], []
    for seed in seeds:
        record = physim.simulate(world, seed=seed)
        contacts = told_contacts(record)
        free += not contacts
        finished += record.ended == "finished"
        distances.append(float(record.extremes["clearance"].min()))
        walls.append(float(record.extremes["boundary_clearance"].min()))
        late = [f"not finished after {record.time[-1]:.0f} s"] * (record.ended != "finished")
        for message in contacts + late:
            print(f"  seed {seed}: {message}", flush=True)
    of = f"of {len(seeds)}"
    print(
        f"{name}: {len(world.robots)} robots, {world.time.duration:g} s, "
        f"{free} {of} contact-free, {finished} {of} finished, "
        f"shortest distance {spread(distances)}, to a wall {spread(walls)}"
        f"{'' if random else ', nothing in it is random'}",
        flush=True,
    )


def told_contacts(record: Record) -> list[str]:
    """Who touched whom, when, where and how deep, a line each; touches between samples too."""
    lines = []
    for episode in contact_episodes(record):
        a, b = (record.bodies[i].name for i in (episode.a, episode.b))
        x, y, _ = record.pose[round(episode.time / record.dt), episode.a]
        lines.append(
            f"{a} and {b} at {episode.time:.2f} s near ({x:.0f}, {y:.0f}), "
            f"{1e3 * episode.depth:.1f} mm deep"
        )
    for graze in grazes(record):
        a, b = (record.bodies[i].name for i in (graze.a, graze.b))
        lines.append(
            f"{a} and {b} between samples before {graze.time:.2f} s, "
            f"{1e3 * graze.depth:.3g} mm deep"
        )
    return lines


def spread(values: list[float]) -> str:
    """Median and range [m] of the runs' shortest distances."""
    if not math.isfinite(max(values)):
        return "none"
    low, middle, high = min(values), statistics.median(values), max(values)
    return f"{middle:.2f} m ({low:.2f} to {high:.2f} m)"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("worlds", nargs="*", default=list(shipped_worlds()), metavar="WORLD")
    parser.add_argument("--seeds", type=seed_range, default=(100, 120), metavar="A:B")
    options = parser.parse_args()
    for name in options.worlds:
        study(name, *options.seeds)


if __name__ == "__main__":
    main()
