"""Speed of the physics, free and in a jam, and of its state: ``python benchmarks/physics.py``."""

from __future__ import annotations

import argparse
import time
from itertools import pairwise

import numpy as np

from physim.geometry.shapes import FloatArray, pack_parts
from physim.simulation.engine import Physics


def box(length: float, width: float) -> FloatArray:
    a, b = length / 2, width / 2
    return np.array([[-a, -b], [a, -b], [a, b], [-a, b]])


def scene(robots: int, spacing: float) -> Physics:
    """Robots on a square lattice in a ring of 200 wall segments well outside."""
    side = int(np.ceil(np.sqrt(robots)))
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    places = (np.column_stack((x.ravel(), y.ravel()))[:robots] - (side - 1) / 2) * spacing
    start = np.column_stack((places, np.linspace(-3, 3, robots)))
    angle = np.linspace(0, 2 * np.pi, 201)
    ring = (10 + side * spacing) * np.column_stack((np.cos(angle), np.sin(angle)))
    walls = pack_parts([list(pairwise(ring))])
    return Physics(pack_parts([[box(1.0, 0.6)]] * robots), walls, start, np.full(robots, 10), 0.05)


def free(physics: Physics) -> FloatArray:
    """Circles of radius 0.5 m."""
    return np.tile([0.4, 0.8], (len(physics.pose), 1))


def inwards(physics: Physics) -> FloatArray:
    """All robots to the middle."""
    pose = physics.pose
    turn = np.arctan2(-pose[:, 1], -pose[:, 0]) - pose[:, 2]
    turn = np.remainder(turn + np.pi, 2 * np.pi) - np.pi
    return np.column_stack((np.cos(turn), np.clip(2 * turn, -1, 1)))


def measure(robots: int, jam: bool, steps: int) -> str:
    physics = scene(robots, 2.0 if jam else 4.0)
    command, contacts, seconds = free(physics), 0, 0.0
    for k in range(-steps // 2, steps):
        if jam:
            command = inwards(physics)
        begin = time.perf_counter()
        physics.step(command)
        if k >= 0:
            seconds += time.perf_counter() - begin
            contacts += len(physics.contacts)
    name = "jam" if jam else "free"
    return (
        f"{name:5}{robots:5}{seconds / steps * 1e6:11.1f} us/step"
        f"{robots * steps / seconds:12.0f} robot-steps/s{contacts / steps:8.1f} contacts"
    )


def measure_state(robots: int, jam: bool, rounds: int) -> str:
    """Processor time of taking a state, restoring it, and resetting, as median."""
    physics = scene(robots, 2.0 if jam else 4.0)
    start, seconds = physics.pose, np.zeros((rounds, 3))
    for _ in range(150):
        physics.step(inwards(physics) if jam else free(physics))
    for row in seconds:
        times = [time.process_time()]
        state = physics.state
        times.append(time.process_time())
        physics.restore(state)
        times.append(time.process_time())
        physics.reset(start)
        times.append(time.process_time())
        row[:] = np.diff(times)
        physics.restore(state)
    told = "".join(f"{us:11.1f}" for us in np.median(seconds, axis=0) * 1e6)
    name = "jam" if jam else "free"
    return f"{name:5}{robots:5}{told} us to take, restore, reset{len(state.part):5} points"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=1000)
    steps = parser.parse_args().steps
    for robots in (10, 100):
        for jam in (False, True):
            print(measure(robots, jam, steps))
            print(measure_state(robots, jam, max(10, steps // 10)))


if __name__ == "__main__":
    main()
