"""The social force: its pushes against differences of the potentials, its weights, what it does."""

from __future__ import annotations

import math

import numpy as np
import pytest

from physim import Simulation, build_scene, load_world
from physim.testing import check_controller
from physim.world.file import parse_world
from tests.helpers import inside

Forces, Sources, SocialForce, SocialForceSettings = inside(
    "physim.controllers", "Forces", "Sources", "SocialForce", "SocialForceSettings"
)
push, push_of_robot, push_of_wall = inside(
    "physim.controllers", "push", "push_of_robot", "push_of_wall"
)

FORCES = Forces(2.1, 0.3, 10.0, 0.2, 0.5, 0.4, math.cos(math.radians(100.0)), 0.5, 1.3, 0.2)
STEP = 1e-6


def ellipse(z: np.ndarray, v: np.ndarray) -> float:
    """V_0 exp(-b / sigma), as the source writes it."""
    y = 0.4 * v
    wide = np.linalg.norm(z) + np.linalg.norm(z - y)
    return float(2.1 * math.exp(-0.5 * math.sqrt(wide**2 - y @ y) / 0.3))


def test_pushes_are_the_slopes_of_the_potentials() -> None:
    rng = np.random.default_rng(0)
    for _ in range(200):
        z, v = rng.uniform(-1.0, 1.0, 2), rng.uniform(-1.5, 1.5, 2)
        if np.linalg.norm(z) < 0.05 or np.linalg.norm(z - 0.4 * v) < 0.05:
            continue
        for found, potential in (
            (push_of_robot(FORCES, *z, *v), lambda at, v=v: ellipse(at, v)),
            (push_of_wall(FORCES, *z), lambda at: 10.0 * math.exp(-np.linalg.norm(at) / 0.2)),
        ):
            slope = [
                (potential(z - STEP * e) - potential(z + STEP * e)) / (2.0 * STEP)
                for e in np.eye(2)
            ]
            assert found == pytest.approx(slope, rel=1e-5, abs=1e-6)


def test_what_lies_behind_counts_half_and_walls_count_whole() -> None:
    def pushed(x: float, others: int) -> float:
        near = Sources(np.array([[x, 0.0]]), np.zeros((1, 2)), others, 1)
        return float(push(FORCES, near, 1.0, 0.0, 0.0, 0.0, 0.0)[0])

    ahead, behind = pushed(-0.5, 1), pushed(0.5, 1)  # the gap leads to the robot
    assert ahead < 0.0
    assert behind == pytest.approx(-0.5 * ahead)
    assert pushed(0.5, 0) == pytest.approx(-pushed(-0.5, 0))


def test_it_keeps_to_the_rules_and_off_a_wall_and_without_pushes_does_not() -> None:
    assert check_controller(SocialForce(), worlds=["three_robots"], seconds=0.5) == []
    text = """
name: beside a wall
time: {step: 0.02, duration: 17.0}
corridor: {centreline: [[0, 0], [20, 0]], width: 4}
robots:
  - {name: a, footprint: {length: 1, width: 0.6}, pose: [2, 0, 0], path: [[2, 0], [18, -1.8]]}
"""
    least = {}
    for strength in (0.0, 10.0):
        controller = SocialForce(SocialForceSettings(wall_strength=strength))
        simulation = Simulation(build_scene(parse_world(text)), controller=controller)
        least[strength] = math.inf
        for _ in range(160):
            simulation.step(steps=5)
            least[strength] = min(least[strength], float(simulation.boundary_clearance[0]))
    assert least[0.0] < 0.0 < 0.1 < least[10.0]


def test_robots_pass_each_other_where_all_step_aside() -> None:
    world = load_world("crossing")
    simulation = Simulation(build_scene(world), controller=SocialForce())
    least = math.inf
    while simulation.step_number < 2500:
        simulation.step(steps=10)
        least = min(least, float(simulation.clearance.min()))
    assert least > 0.3
