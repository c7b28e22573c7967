"""The learned policy: its features by a slow oracle, its file, and what it is worth."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from physim import PhysimError, Simulation, load_world
from physim.world import World
from tests.helpers import facts, inside

Learned, LearnedSettings, features = inside(
    "physim.controllers", "Learned", "LearnedSettings", "features"
)
SHIPPED = Path(__file__).parents[2] / "controllers" / "learned.json"
SCALES = (0.5, 0.4, 2.0, 0.3, 0.2, 1.0)


def met(scales: tuple[float, ...], x: float, y: float, vx: float, vy: float, gap: float) -> list:
    """Near and threat, each alone, ahead and left, and the side, of one row."""
    times = np.linspace(0.0, 4.0, 40_001)
    apart = np.hypot(x + vx * times, y + vy * times)
    best = int(apart.argmin())
    far = math.hypot(x, y)
    near = math.exp(-max(gap, 0.0) / scales[0])
    then = max(gap - far + apart[best], 0.0)
    threat = math.exp(-then / scales[1] - times[best] / scales[2]) if best else 0.0
    c, s = x / far, y / far
    side = (c * vy - s * vx) / math.hypot(vx, vy)
    return [near, near * c, near * s, threat, threat * c, threat * s, threat * side]


def test_features_are_sums_over_what_is_near_and_what_would_be_met() -> None:
    simulation = Simulation(load_world("ten_robots"), seed=5)
    for _ in range(300):
        simulation.step()
    seen = simulation.arrays(6, 6, (), np.float64)
    plain = np.stack((np.linspace(0.2, 1.0, 10), np.linspace(-0.5, 0.5, 10)), axis=1)
    limits = simulation.scene.limits
    robots = np.array([0, 3, 8])
    found = features(np.array(SCALES), plain[robots], limits[robots], robots, seen)
    assert seen.walls_mask.any()
    for i, row in zip(robots, found, strict=True):
        vx, vy = seen.own[i, 0] - plain[i, 0], seen.own[i, 1]
        others, walls = np.zeros(7), np.zeros(7)
        for x, y, _, _, wx, wy, gap in seen.others[i][seen.others_mask[i]]:
            others += met(SCALES[:3], x, y, wx + vx, wy + vy, gap)
        for x, y, gap in seen.walls[i][seen.walls_mask[i]]:
            walls += met(SCALES[3:], x, y, -plain[i, 0], 0.0, gap)
        expected = [1.0, plain[i, 1] / limits[i, 1], *others, *walls[:-1]]
        assert row == pytest.approx(expected, abs=1e-3)


def test_a_file_of_the_shipped_weights_gives_the_same_run(tmp_path: Path) -> None:
    copied = tmp_path / "mine.json"
    copied.write_text(SHIPPED.read_text(encoding="utf-8"), encoding="utf-8")
    poses = []
    for policy in ("shipped", str(copied)):
        world = load_world("three_robots").changed(controller={"type": "learned", "policy": policy})
        simulation = Simulation(world, seed=2)
        simulation.step(steps=300)
        poses.append(simulation.pose.tobytes())
    assert poses[0] == poses[1]


def broken(key: str, name: str, value: object) -> str:
    told = json.loads(SHIPPED.read_text(encoding="utf-8"))
    told[key][name] = value
    return json.dumps(told)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (None, "FileNotFoundError"),
        ("{", "JSONDecodeError"),
        ("{}", "KeyError: 'scales'"),
        (broken("v", "near", "far"), "ValueError"),
        (broken("scales", "near", -1.0), "scales above 0"),
        (broken("omega", "one", math.nan), "finite"),
    ],
)
def test_a_file_that_is_no_policy_is_refused(tmp_path: Path, text: str | None, why: str) -> None:
    file = tmp_path / "mine.json"
    if text is not None:
        file.write_text(text, encoding="utf-8")
    with pytest.raises(PhysimError, match=facts("mine.json", why)) as refused:
        Learned(LearnedSettings(policy=str(file)))
    assert "\n" not in str(refused.value)


def two_ways(world: World, controller: str, seed: int) -> bool:
    """Whether a run is without contact."""
    simulation = Simulation(world.changed(controller={"type": controller}), seed=seed)
    for _ in range(2500):
        simulation.step()
        if len(simulation.contacts):
            return False
    return True


def test_it_avoids_whom_path_following_meets() -> None:
    world = load_world("crossing").changed(formation=None)
    free = {
        name: sum(two_ways(world, name, seed) for seed in range(100, 104))
        for name in ("learned", "path_following")
    }
    assert free["learned"] > free["path_following"]
