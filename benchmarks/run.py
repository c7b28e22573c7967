"""Speed of whole runs, and how long it takes to get there: ``python benchmarks/run.py``.

- real-time factor: simulated time over wall time of the loop that ``physim run --no-video`` goes
  through, record included; kernels warm; the median of several runs of each world.
- cold: set-up of the first world with an empty cache of kernels, that is all of the compilation.
- start-up: whole processes, from the call to their end, with warm caches.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from physim.parts.registry import CONTROLLER, make_part
from physim.simulation.loop import Simulation
from physim.simulation.run import record_run, warm_up
from physim.world.file import read_world
from physim.world.file.files import find_world
from physim.world.layout.scene_builder import build_scene

WARM_UP = "import sys; from benchmarks.run import set_up; set_up(sys.argv[1])"
PHYSIM = [sys.executable, "-m", "physim"]


def set_up(name: str) -> Simulation:
    """Read a world and get all ready, kernels too."""
    world, _ = read_world(find_world(name))
    scene = build_scene(world, None)
    warm_up(scene, make_part(CONTROLLER, world.controller.type, world.controller.settings))
    return Simulation(scene)


def factor(name: str) -> tuple[float, float]:
    """Real-time factor of one run, by the wall clock and by processor time."""
    simulation = set_up(name)
    with tempfile.TemporaryDirectory() as folder:
        wall, cpu = time.perf_counter(), time.process_time()
        record_run(simulation, path=Path(folder) / "record.h5")
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    return simulation.time / wall, simulation.time / cpu


def process(command: list[str], **environment: str) -> tuple[float, float]:
    """Seconds that a process takes, by the wall clock and by processor time."""
    wall, before = time.perf_counter(), os.times()
    subprocess.run(
        command, check=True, capture_output=True, env={**os.environ, **environment},
        cwd=Path(__file__).resolve().parent.parent,
    )  # fmt: skip
    after = os.times()
    cpu = after.children_user + after.children_system
    return time.perf_counter() - wall, cpu - before.children_user - before.children_system


def cold(name: str) -> tuple[float, float]:
    with tempfile.TemporaryDirectory() as cache:
        return process([sys.executable, "-c", WARM_UP, name], NUMBA_CACHE_DIR=cache)


def report(what: str, unit: str, measure: Callable[[], tuple[float, float]], runs: int) -> None:
    wall, cpu = zip(*(measure() for _ in range(runs)), strict=True)
    median, spread = statistics.median(wall), f"{min(wall):.2f} to {max(wall):.2f}"
    print(f"{what:<34} {median:8.2f} {unit:<12} ({spread}; cpu {statistics.median(cpu):.2f})")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("world", nargs="*", default=["ten_robots"], help="shipped world or file")
    parser.add_argument("--runs", type=int, default=5, help="runs of each (default 5)")
    parser.add_argument("--no-cold", action="store_true", help="leave the compilation out")
    options = parser.parse_args()
    first = options.world[0]
    set_up(first)
    for name in options.world:
        report(f"run {name}", "x real time", lambda name=name: factor(name), options.runs)
    report("physim --help", "s", lambda: process([*PHYSIM, "--help"]), options.runs)
    report(
        "import physim", "s", lambda: process([sys.executable, "-c", "import physim"]), options.runs
    )
    report(
        f"set-up {first}, warm", "s",
        lambda: process([sys.executable, "-c", WARM_UP, first]), options.runs,
    )  # fmt: skip
    if not options.no_cold:
        report(f"set-up {first}, cold", "s", lambda: cold(first), min(options.runs, 3))


if __name__ == "__main__":
    main()
