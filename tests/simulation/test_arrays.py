"""Arrays for learners: what observations hold, in fixed sizes; several steps in one call."""

from __future__ import annotations

import numpy as np
import pytest

from physim import Simulation, Step, load_world
from physim.errors import PhysimError
from physim.geometry import signed_distance

K, M, AHEAD = 6, 5, (0.5, 3.0)


def body(pose: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Points (n, 2) of the world in the frame of a robot."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return (points - pose[:2]) @ np.array([[c, -s], [s, c]])


def placed(pose: np.ndarray, parts: tuple[np.ndarray, ...]) -> list[np.ndarray]:
    """A footprint in the world frame."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return [part @ np.array([[c, s], [-s, c]]) + pose[:2] for part in parts]


@pytest.mark.parametrize("name", ["ten_robots", "warehouse"])
def test_arrays_hold_what_observations_do(name: str) -> None:
    simulation = Simulation(load_world(name).changed(sensing={"range": 6.0}))
    for _ in range(40):
        simulation.step()
    found = simulation.arrays(K, M, AHEAD, np.float64)
    assert found.others_mask.any()
    assert found.walls_mask.any()
    for i in range(simulation.scene.robots):
        o = simulation.observe(i)
        velocity = body(np.array([0.0, 0.0, o.pose[2]]), o.velocity[None, :2])[0]
        way, beside = o.path.project(o.pose[0], o.pose[1], near=o.station)
        ahead = body(o.pose, np.array([o.path.target(o.station, far) for far in AHEAD]))
        own = [*velocity, o.velocity[2], o.v, o.omega, *o.limits, o.stop_station - way, beside]
        assert found.own[i] == pytest.approx([*own, *ahead.ravel()], abs=1e-9)

        mine = placed(o.pose, o.footprint)
        others = sorted(o.others, key=lambda other: np.hypot(*(other.pose - o.pose)[:2]))[:K]
        assert found.others_mask[i].tolist() == [k < len(others) for k in range(K)]
        for row, other in zip(found.others[i], others, strict=False):
            turn = other.pose[2] - o.pose[2]
            (x, y), (vx, vy) = (
                body(o.pose, other.pose[None, :2])[0],
                body(np.array([0.0, 0.0, o.pose[2]]), (other.velocity - o.velocity)[None, :2])[0],
            )
            gap = signed_distance(mine, placed(other.pose, other.footprint))
            expected = [x, y, np.cos(turn), np.sin(turn), vx, vy, gap]
            assert row == pytest.approx(expected, abs=1e-9)

        gaps = sorted(signed_distance(mine, [wall.points]) for wall in o.walls)
        rows = found.walls[i][found.walls_mask[i]]
        assert len(rows) == min(M, len(gaps))
        if len(rows):
            assert rows[:, 2].min() == pytest.approx(gaps[0], abs=1e-9)
            assert (np.diff(np.hypot(*rows[:, :2].T)) >= -1e-9).all()
        assert not found.walls[i][~found.walls_mask[i]].any()


class Poses:
    """Keeps the poses of every step."""

    def start(self, simulation: Simulation) -> None:
        self.seen: list[np.ndarray] = []

    def after_step(self, step: Step) -> None:
        self.seen.append(step.pose)

    def close(self, ended: str) -> None:
        pass


def test_several_steps_in_one_call_are_that_many_calls() -> None:
    world, looks = load_world("ten_robots"), (Poses(), Poses())
    once, often = (Simulation(world, observers=[one]) for one in looks)
    commands = np.random.default_rng(0).uniform(-0.5, 0.5, (4, once.scene.robots, 2))
    for held in commands:
        once.step(held, steps=7)
        for _ in range(7):
            often.step(held)
    once.step(steps=5)
    for _ in range(5):
        often.step()
    assert np.array(looks[0].seen).tobytes() == np.array(looks[1].seen).tobytes()
    assert len(looks[0].seen) == 33
    assert once.arrays().own.tobytes() == often.arrays().own.tobytes()


def test_what_may_not_be_asked_for_is_refused() -> None:
    simulation = Simulation(load_world("straight"))
    for wrong in ({"others": -1}, {"walls": 1.5}, {"ahead": (-1.0,)}, {"dtype": "int8"}):
        with pytest.raises(PhysimError, match=f"^{next(iter(wrong))} = "):
            simulation.arrays(**wrong)  # type: ignore[arg-type]
    for steps in (0, True, 2.0):
        with pytest.raises(PhysimError, match=r"^steps = "):
            simulation.step(steps=steps)  # type: ignore[arg-type]
