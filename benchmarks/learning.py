"""How fast learners step ten robots: ``python -m benchmarks.learning [WORKERS]``.

Each way is measured in turn, five times; told are medians. A robot-step is a robot held under an
action for a period of 0.1 s, which is ten physics steps. Seconds of processor count for what runs
in one process, so that other programs on the machine do not; of workers it is the wall clock.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import physim

WORLD, ACTIONS, ROUNDS, MANY = "ten_robots", 200, 5, 8


def steered(seen: NDArray[np.float32]) -> NDArray[np.float32]:
    """Actions of a policy that costs nearly nothing: to the point 1 m ahead."""
    turn = np.clip(2.0 * np.arctan2(seen[:, 10], seen[:, 9]) / seen[:, 6], -1.0, 1.0)
    return np.column_stack((np.full(len(seen), 0.6, np.float32), turn))


def simulation() -> int:
    """`Simulation.step` and `arrays` alone; robot-steps made."""
    one = physim.Simulation(physim.load_world(WORLD), seed=1)
    limits = one.scene.limits
    for _ in range(ACTIONS):
        one.step(steered(one.arrays().own).astype(float) * limits, steps=10)
    return ACTIONS * one.scene.robots


def parallel() -> int:
    """`physim.env`, with dictionaries."""
    env = physim.env(WORLD)
    seen, _ = env.reset(seed=1)
    for _ in range(ACTIONS):
        rows = steered(np.stack(list(seen.values())))
        seen, *_ = env.step(dict(zip(env.agents, rows, strict=True)))
    return ACTIONS * len(seen)


def vector(workers: int) -> Callable[[], int]:
    """`physim.vector_env` of eight copies."""

    def steps() -> int:
        seen, _ = env.reset(seed=1)
        for _ in range(ACTIONS):
            seen, *_ = env.step(steered(seen))
        return ACTIONS * len(seen)

    env = physim.vector_env(WORLD, MANY, workers=workers)
    return steps


def main() -> None:
    """Measure and print a table."""
    workers = int(sys.argv[1]) if len(sys.argv) > 1 else 2
    ways: list[tuple[str, Callable[[], int], Callable[[], float]]] = [
        ("Simulation.step, arrays", simulation, time.process_time),
        ("physim.env", parallel, time.process_time),
        (f"physim.vector_env, {MANY} copies", vector(0), time.process_time),
        (f"the same, {workers} workers", vector(workers), time.perf_counter),
    ]
    found: dict[str, list[float]] = {name: [] for name, *_ in ways}
    for _ in range(ROUNDS):
        for name, run, clock in ways:
            began = clock()
            made = run()
            found[name].append(made / (clock() - began))
    print(f"{WORLD}, robot-steps a second: of a period / of physics")
    for name, rates in found.items():
        rate = statistics.median(rates)
        print(f"{name:32s} {rate:10,.0f} / {10 * rate:10,.0f}")


if __name__ == "__main__":
    main()
