"""Compile every kernel that the jobs need, in one process, before workers start."""

from __future__ import annotations

from physim.compiled import is_cached
from physim.geometry.batch import fill_times
from physim.metrics.pair_times import shortest_pair_collision_time
from physim.recording import simulate
from physim.registry import CONTROLLER, make_part
from physim.scene_builder import build_scene
from physim.warm_up import is_warm as runs_are_warm
from physim.warm_up import warm_up as warm_up_runs
from physim.world_file import load_world

WORLD = "three_robots"
SECONDS = 0.2
"""[s] simulated"""


def is_warm() -> bool:
    """Whether all kernels lie compiled on disk."""
    return runs_are_warm() and is_cached(fill_times)


def warm_up() -> None:
    """Take a run that is thrown away."""
    world = load_world(WORLD, overrides=[f"time.duration={SECONDS}"])
    choice = world.controller
    warm_up_runs(build_scene(world), make_part(CONTROLLER, choice.type, choice.settings))
    with simulate(world) as record:
        shortest_pair_collision_time(record)
