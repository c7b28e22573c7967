"""How each shipped world fares over other seeds: contacts, arrivals, shortest distances.

python benchmarks/seeds.py [WORLD ...] [--seeds A:B] [--workers N]

Without names: every shipped world, seeds 100 to 119. Contacts are told one by one, and so are runs
that do not finish. A world is the name of a shipped one or a file.
"""

from __future__ import annotations

import argparse
import math
import statistics
from typing import NamedTuple

from physim.analysis.metrics import Figures
from physim.campaigns.cluster import executor
from physim.campaigns.grid import make_grid
from physim.campaigns.one_run import simulation_of
from physim.campaigns.pool import Job, Stop, Workers, outcomes, worker_count
from physim.campaigns.spec import RunSpec
from physim.cli.options import seed_range
from physim.record import Record
from physim.simulation.run import record_run
from physim.world.file.files import shipped_worlds


class Fared(NamedTuple):
    """What is told of a run."""

    contacts: list[str]
    ended: str
    seconds: float
    distance: float
    wall: float


def run(spec: RunSpec, stop: Stop) -> Fared:
    """Run a seed, in a worker."""
    with record_run(simulation_of(spec), stop=stop) as record:
        return Fared(
            told_contacts(record), record.ended, float(record.time[-1]),
            float(record.extremes["clearance"].min()),
            float(record.extremes["boundary_clearance"].min()),
        )  # fmt: skip


def study(name: str, seeds: range, workers: Workers) -> None:
    """Run a world with seeds and print what came of it."""
    grid = make_grid([name], seeds)
    jobs = ((spec.seed, Job(spec.note, run, (spec,))) for spec in grid)
    found: dict[int, Fared] = {}
    for outcome in outcomes(jobs, workers, lambda: False):
        if outcome.error is not None:
            raise outcome.error
        found[outcome.key] = outcome.result
    for seed, one in sorted(found.items()):
        late = [f"not finished after {one.seconds:.0f} s"] * (one.ended != "finished")
        for message in one.contacts + late:
            print(f"  seed {seed}: {message}", flush=True)
    cell = grid.cells[0]
    world = simulation_of(cell).scene.world
    of = f"of {len(found)}"
    print(
        f"{name}: {world.robot_count} robots, {world.time.duration:g} s, "
        f"{sum(not one.contacts for one in found.values())} {of} contact-free, "
        f"{sum(one.ended == 'finished' for one in found.values())} {of} finished, "
        f"shortest distance {spread([one.distance for one in found.values()])}, "
        f"to a wall {spread([one.wall for one in found.values()])}"
        f"{', nothing in it is random' if grid.fixed else ''}",
        flush=True,
    )


def told_contacts(record: Record) -> list[str]:
    """Who touched whom, when, where and how deep, a line each; touches between samples too."""
    lines = []
    for episode in Figures(record).episodes:
        a, b = (record.bodies[i].name for i in (episode.a, episode.b))
        x, y, _ = record.pose[round(episode.time / record.dt), episode.a]
        lines.append(
            f"{a} and {b} at {episode.time:.2f} s near ({x:.0f}, {y:.0f}), "
            f"{1e3 * episode.depth:.1f} mm deep"
        )
    for graze in Figures(record).grazes:
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
    parser.add_argument("--workers", type=int, default=worker_count(), metavar="N")
    options = parser.parse_args()
    with executor(options.workers) as workers:
        for name in options.worlds:
            study(name, range(*options.seeds), workers)


if __name__ == "__main__":
    main()
