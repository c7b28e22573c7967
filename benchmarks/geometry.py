"""Pairs per second of the batch forms on one core: ``python benchmarks/geometry.py``.

Boxes of 1.8 x 1.0 m at random poses in 12 x 12 m; the smallest processor time of several rounds.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from physim.geometry import collision_times, shortest_distances
from physim.geometry.clearance import clearances
from physim.geometry.shapes import Shapes, pack_parts
from physim.geometry.walls import build_wall_tree

ROBOTS = 300
ROUNDS = 5
BOX = np.array([[-0.9, -0.5], [0.9, -0.5], [0.9, 0.5], [-0.9, 0.5]])


def best_time(work: Callable[..., Any], *args: Any) -> float:
    times = []
    for _ in range(ROUNDS):
        start = time.process_time()
        work(*args)
        times.append(time.process_time() - start)
    return min(times)


def corridor() -> Shapes:
    x = np.arange(0.0, 260.0, 1.3)

    def wall(offset: float) -> list[Any]:
        line = np.c_[x, 3.0 * np.sin(x / 15.0) + offset]
        return [line[k : k + 2] for k in range(len(line) - 1)]

    return pack_parts([wall(4.0), wall(-4.0)])


def main() -> None:
    rng = np.random.default_rng(1)
    shapes = pack_parts([[BOX]] * ROBOTS)
    pose = np.c_[rng.uniform(-6.0, 6.0, (ROBOTS, 2)), rng.uniform(-7.0, 7.0, ROBOTS)]
    a, b = np.tril_indices(ROBOTS, -1)
    straight = np.c_[np.ones(ROBOTS), np.zeros(ROBOTS)]
    arcs = np.c_[np.ones(ROBOTS), rng.choice([-1.57, -0.785, 0.785, 1.57], ROBOTS)]

    def rate(work: Callable[..., Any], *rows: Any) -> float:
        one, other = ([row[index] for row in rows] for index in (a, b))
        return len(a) / best_time(work, shapes, a, *one, shapes, b, *other) / 1e6

    distance = rate(shortest_distances, pose)
    translation = rate(collision_times, pose, straight)
    turning = rate(collision_times, pose, arcs)
    print(f"distance          {distance:6.2f} M pairs/s")
    print(f"translation time  {translation:6.2f} M pairs/s")
    print(f"arc time          {turning:6.2f} M pairs/s")

    samples, robots, walls = 4000, 10, corridor()
    t = 0.01 * np.arange(samples)[:, None]
    i = np.arange(robots)
    x = 5.0 + 2.3 * (i // 2) + t * (1.0 + 0.02 * i)
    y = 3.0 * np.sin(x / 15.0) + np.where(i % 2, 1.4, -1.4)
    heading = 0.2 * np.cos(x / 15.0) + 0.1 * np.sin(t * i)
    group = pack_parts([[BOX]] * robots)
    poses = np.stack([x, y, heading], axis=2)
    sample = best_time(clearances, poses, group, build_wall_tree(walls)) / samples * 1e6
    print(f"clearances        {sample:6.2f} us a sample of {robots} robots")


if __name__ == "__main__":
    main()
