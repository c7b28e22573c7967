"""Compile or load every kernel that a run needs, so that no run has to wait in its middle."""

from __future__ import annotations

import time

from physim.compiled import is_cached
from physim.control import Controller
from physim.geometry.clearance import clearances, fill
from physim.grazes import warm_up_grazes
from physim.physics import Physics
from physim.scene import Scene
from physim.simulation import Simulation


def is_warm() -> bool:
    """Whether the kernels of a run lie compiled on disk.

    `warm_up` compiles the clearances last: when they are there, so is the rest.
    """
    return is_cached(fill)


def touch_a_wall(scene: Scene) -> None:
    """Put the first robot on a corner of a wall: compiles what only a contact needs."""
    start = scene.start.copy()
    start[0, :2] = scene.walls.vertices[0]
    Physics(scene.shapes, scene.walls, start, scene.mass, scene.dt)


def warm_up(scene: Scene, controller: Controller | None = None) -> float:
    """Take one step of a simulation that is thrown away; returns the seconds it took.

    ``controller`` should be one of its own, since it is asked once.
    """
    started = time.perf_counter()
    simulation = Simulation(scene, controller=controller)
    simulation.step()
    touch_a_wall(scene)
    warm_up_grazes(scene)
    clearances(simulation.pose[None], scene.shapes, scene.walls, scene.nearby)
    return time.perf_counter() - started
