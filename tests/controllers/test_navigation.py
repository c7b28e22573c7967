"""What methods that choose a velocity share: preferred velocity, stop, who avoids whom."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from physim import Simulation, build_scene
from physim.testing import check_controller
from physim.world.file import parse_world
from tests.helpers import inside

Navigating, NavigationSettings = inside("physim.controllers", "Navigating", "NavigationSettings")
project_and_turn, share_of = inside("physim.controllers", "project_and_turn", "share_of")


class Straight(Navigating):  # type: ignore[misc, valid-type]
    """Takes its preferred velocity, whoever is in the way."""

    kept: Any = None

    def avoid(self, view: Any, team: Any, bodies: Any, asked: Any, memory: Any) -> Any:
        pairs = [
            project_and_turn(*u, bodies.pose[row, 2], *team.limits[i], 0.2)
            for i, row, u in zip(asked.robot, asked.row, asked.preferred, strict=True)
        ]
        return np.reshape(pairs, (-1, 2)), np.zeros(asked.size, np.int64), np.zeros((asked.size, 0))


class Listening(Straight):
    """Keeps what it was asked last."""

    def avoid(self, view: Any, team: Any, bodies: Any, asked: Any, memory: Any) -> Any:
        shares = [[share_of(team, bodies, me, j) for j in range(bodies.size)] for me in asked.row]
        self.kept = asked, shares
        return super().avoid(view, team, bodies, asked, memory)


WORLD = """
name: two and a cart
time: {{step: 0.05, duration: 30.0}}
corridor: {{centreline: [[0, 0], [30, 0]], width: 12}}
robots:
  - {{name: a, footprint: {{length: 1, width: 1}}, pose: [3, 3, 0], path: {{offset: 3}}}}
  - {{name: b, footprint: {{length: 1, width: 1}}, pose: [6, 0, 1], path: {{offset: 0}}}}
movers:
  - {{name: cart, footprint: {{length: 1, width: 1}}, waypoints: [[9, -4], [9, -4.5]], speed: 0.1}}
{}
"""


def asked_first(more: str = "", **settings: Any) -> tuple[Any, Any]:
    """What the robots are asked at the first step."""
    controller = Listening(NavigationSettings(**settings))
    Simulation(build_scene(parse_world(WORLD.format(more))), controller=controller).step()
    return controller.kept


def test_what_is_built_upon_it_keeps_to_the_rules() -> None:
    assert check_controller(Straight, worlds=["three_robots"], seconds=0.5) == []
    nudged = Straight(NavigationSettings(nudge=0.1, priority="ahead"))
    assert check_controller(nudged, worlds=["three_robots"], seconds=0.5) == []


def test_the_preferred_velocity_points_at_the_target_and_has_the_speed() -> None:
    asked, _ = asked_first(speed=0.7)
    assert asked.target == pytest.approx(np.array([[5, 3], [8, 0]]), abs=0.01)
    assert asked.preferred == pytest.approx(np.array([[0.7, 0], [0.7, 0]]), abs=1e-9)
    # (7): a shall be 2 m ahead of b and is 3 m behind, and the other way round
    formation = "formation: {gain: 0.1, speed: 0.8, limits: [0.1, 1.2], spacing: [0, -2]}"
    asked, _ = asked_first(formation)
    assert np.hypot(*asked.preferred.T) == pytest.approx([1.2, 0.3])


def test_pairs_share_or_the_one_ahead_goes_first() -> None:
    asked, shares = asked_first()
    assert shares == [[0.5, 0.5, 1.0]] * 2
    assert asked.near.tolist()[: asked.start[-1]] == [1, 2, 0, 2]
    asked, shares = asked_first(priority="ahead")
    assert (shares[0][1], shares[1][0], shares[1][2]) == (1.0, 0.0, 1.0)
    assert asked.near.tolist()[: asked.start[-1]] == [1, 2, 2]


def test_it_stands_at_its_stop_station() -> None:
    world = parse_world(WORLD.format("formation: {speed: 1.0}"))
    simulation = Simulation(build_scene(world), controller=Straight())
    for _ in range(600):
        simulation.step()
    missing = simulation.scene.stop_station - simulation.now.station
    assert np.all((missing >= -1e-9) & (missing <= 0.06))
    assert not simulation.command.any()


def test_a_nudge_is_drawn_from_the_seed() -> None:
    plain, _ = asked_first()
    one, _ = asked_first(nudge=0.01)
    same, _ = asked_first(nudge=0.01)
    other, _ = asked_first("seed: 7", nudge=0.01)
    off = np.hypot(*(one.preferred - plain.preferred).T)
    assert np.all((off > 0) & (off < 0.01))
    assert off[0] != off[1]
    assert np.array_equal(one.preferred, same.preferred)
    assert not np.array_equal(one.preferred, other.preferred)


def test_a_velocity_becomes_a_command() -> None:
    assert project_and_turn(0.5, 0.0, 0.0, 1.0, 1.5, 0.2) == (0.5, 0.0)
    assert project_and_turn(2.0, 0.0, 0.0, 1.0, 1.5, 0.2) == (1.0, 0.0)
    assert project_and_turn(0.0, 0.5, 0.0, 1.0, 1.5, 0.2) == (pytest.approx(0.0), 1.5)
    assert project_and_turn(-1.0, -0.1, 0.0, 1.0, 1.5, 0.2) == (0.0, -1.5)
    v, omega = project_and_turn(math.cos(6.1), math.sin(6.1), 6.2, 1.0, 1.5, 0.2)
    assert (v, omega) == pytest.approx((math.cos(0.1), -0.5))
    assert project_and_turn(0.0, 0.0005, 0.0, 1.0, 1.5, 0.2) == (0.0, 0.0)


def test_who_comes_beside_its_stop_goes_to_it() -> None:
    beside = WORLD.replace("pose: [6, 0, 1]", "pose: [29.9, -2, 0]").replace("[[9, -4]", "[[9, -5]")
    simulation = Simulation(build_scene(parse_world(beside.format(""))), controller=Straight())
    assert simulation.scene.stop_station[1] - simulation.now.station[1] <= 0.11
    simulation.step(steps=200)
    stop = simulation.scene.stop_station[1]
    assert simulation.pose[1, :2] == pytest.approx([stop, 0.0], abs=0.26)  # a quarter of 1 m
    assert not simulation.command[1].any()
