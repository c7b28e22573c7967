"""How each shipped world fares over other seeds: contact-free runs, and where the others touch.

python benchmarks/seeds.py [WORLD ...] [--seeds 20]
"""

from __future__ import annotations

import argparse

import physim
from physim.metrics import contact_episodes, grazes
from physim.scene_builder import is_random
from physim.world_file.shipped import find_world, shipped_worlds


def study(name: str, count: int) -> None:
    world = physim.load_world(find_world(name))
    if not is_random(world):
        print(f"{name}: nothing in it is random")
        return
    seeds = [seed for seed in range(count + 1) if seed != world.seed][:count]
    free = finished = 0
    for seed in seeds:
        record = physim.simulate(world, seed=seed)
        episodes = contact_episodes(record)
        between = grazes(record)
        free += not episodes and not between
        finished += record.ended == "finished"
        for episode in episodes:
            names = [record.bodies[i].name for i in (episode.a, episode.b)]
            x, y, _ = record.pose[round(episode.time / record.dt), episode.a]
            print(
                f"  seed {seed}: {' and '.join(names)} at {episode.time:.2f} s near "
                f"({x:.0f}, {y:.0f}), {1e3 * episode.depth:.1f} mm deep"
            )
        for graze in between:
            names = [record.bodies[i].name for i in (graze.a, graze.b)]
            print(
                f"  seed {seed}: {' and '.join(names)} between samples before {graze.time:.2f} s, "
                f"{1e3 * graze.depth:.3g} mm deep"
            )
    total = len(seeds)
    print(f"{name}: {free} of {total} contact-free, {finished} of {total} finished", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("worlds", nargs="*", default=list(shipped_worlds()))
    parser.add_argument("--seeds", type=int, default=20)
    options = parser.parse_args()
    for name in options.worlds:
        study(name, options.seeds)


if __name__ == "__main__":
    main()
