"""Environments of learners: the checkers of their libraries, and what they hold, see and reward."""

from __future__ import annotations

import sys
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import physim
from physim import PhysimError, Record, Simulation, load_world
from tests.helpers import facts, inside

pytest.importorskip("gymnasium", reason="needs physim[rl]")
pettingzoo = pytest.importorskip("pettingzoo", reason="needs physim[rl]")

Way = inside("physim.geometry", "Path")
WORLDS = ["crossing_cart", "cars", "mixed_team"]


def ahead(seen: Any) -> np.ndarray:
    """Actions that steer to the point 2 m ahead, from rows of observations."""
    rows = np.atleast_2d(seen)
    turn = 2.0 * np.arctan2(rows[:, 12], rows[:, 11]) / rows[:, 6]
    return np.column_stack((np.full(len(rows), 0.8), np.clip(turn, -1.0, 1.0))).astype(np.float32)


def driven(env: Any, cycles: int, seed: int | None = None) -> list[dict[str, Any]]:
    """Actions of an episode, which steer ahead."""
    seen, _ = env.reset(seed=seed)
    made = []
    for _ in range(cycles):
        made.append({name: ahead(seen[name])[0] for name in env.agents})
        seen, *_ = env.step(made[-1])
        if not env.agents:
            break
    return made


@pytest.mark.parametrize("world", WORLDS)
def test_the_checkers_of_both_libraries_pass(world: str) -> None:
    from gymnasium.utils.env_checker import check_env
    from pettingzoo.test import parallel_api_test, parallel_seed_test
    from pettingzoo.test.max_cycles_test import max_cycles_test
    from pettingzoo.utils.conversions import parallel_to_aec

    parallel_api_test(physim.env(world), num_cycles=20)
    parallel_seed_test(lambda: physim.env(world), num_cycles=5)
    module = types.SimpleNamespace(
        parallel_env=lambda **given: physim.env(world, **given),
        env=lambda **given: parallel_to_aec(physim.env(world, **given)),
    )
    max_cycles_test(module)
    check_env(physim.single_env(world, 1, render_mode="rgb_array"), skip_render_check=True)


def test_observations_are_the_arrays_of_the_simulation_padded_and_masked() -> None:
    env = physim.env("three_robots", others=4, walls=3, ahead=(0.5,), sensing={"range": 8.0})
    driven(env, 10)
    seen, *_ = env.step(dict.fromkeys(env.agents, np.zeros(2)))
    held = env.simulation.arrays(4, 3, (0.5,))
    at = env.task.columns
    for i, name in enumerate(env.agents):
        assert env.observation_space(name).contains(seen[name])
        for field, where in at.items():
            assert (seen[name][where] == getattr(held, field)[i].ravel()).all()
        others = seen[name][at["others"]].reshape(4, -1)
        mask = seen[name][at["others_mask"]]
        assert mask.tolist() == [1.0, 1.0, 0.0, 0.0]
        assert not others[mask == 0.0].any()


def test_terms_of_rewards_are_what_the_record_says(tmp_path: Path) -> None:
    weights = {"contact": -2.0, "boundary": -3.0, "smoothness": -0.5, "time": -0.1}
    env = physim.env("crossing", record=tmp_path, rewards=weights, max_cycles=400)
    seen, _ = env.reset(seed=4)
    robots = len(env.agents)
    terms, total, actions = [], np.zeros(robots), []
    while env.agents:
        action = {name: ahead(seen[name])[0] for name in env.agents}
        action["robot_3"] = np.array([0.5, -0.02])  # into a wall
        actions.append(list(action.values()))
        seen, rewards, _, cut, infos = env.step(action)
        terms.append([list(one["terms"].values()) for one in infos.values()])
        total += list(rewards.values())
    assert all(cut.values())
    summed = dict(zip(infos["robot_0"]["terms"], np.array(terms).sum(axis=0).T, strict=True))

    record, scene = Record.load(tmp_path / "episode_4.h5"), env.simulation.scene
    assert record.steps_made == 4000
    for i, robot in enumerate(record.world.robots):
        way = Way(np.array(robot.path))
        left = [
            abs(scene.stop_station[i] - way.project(*record.pose[k, i, :2])[0]) for k in (0, -1)
        ]
        assert summed["progress"][i] == pytest.approx(left[0] - left[1], abs=1e-6)
        contacts = record.contacts[record.contacts["step"] > 0]
        mine = contacts[(contacts["a"] == i) | (contacts["b"] == i)]
        with_walls = mine["b"] >= robots
        assert summed["contact"][i] * 10 == pytest.approx(len(np.unique(mine["step"][~with_walls])))
        assert summed["boundary"][i] * 10 == pytest.approx(len(np.unique(mine["step"][with_walls])))
    assert summed["contact"].any()
    assert summed["boundary"].any()
    changes = np.diff(np.array([np.zeros((robots, 2)), *actions]), axis=0)
    assert summed["smoothness"] == pytest.approx(np.square(changes).sum(axis=(0, 2)), rel=1e-5)
    assert summed["time"] == pytest.approx(np.full(robots, 40.0))
    asked = {"progress": 1.0, "arrival": 1.0, **weights}
    assert total == pytest.approx(sum(asked[name] * summed[name] for name in asked), rel=1e-9)


def test_a_recorded_episode_is_the_run_of_its_commands_bit_for_bit(tmp_path: Path) -> None:
    env = physim.env("three_robots", record=tmp_path, time={"duration": 5.0})
    made = driven(env, 50, seed=9)
    assert env.agents == []
    simulation = Simulation(load_world("three_robots"), seed=9)
    limits = simulation.scene.limits
    for actions in made:
        rows = np.array(list(actions.values()), np.float64)
        simulation.step(rows * limits, steps=10)
    record = Record.load(tmp_path / "episode_9.h5")
    assert record.ended == "duration"
    assert record.pose[-1].tobytes() == simulation.pose.tobytes()


def test_an_episode_ends_with_arrival_contact_or_the_next_reset(tmp_path: Path) -> None:
    env = physim.single_env("single_robot", record=tmp_path)
    seen, _ = env.reset(seed=2)
    over = cut = False
    while not (over or cut):
        action = ahead(seen)[0]
        action[0] = np.clip(seen[7], -0.8, 0.8)
        seen, _, over, cut, infos = env.step(action)
    assert (over, infos["terms"]["arrival"]) == (True, 1.0)
    assert Record.load(tmp_path / "episode_2.h5").ended == "finished"
    env.reset()
    env.step(np.zeros(2))
    env.close()
    assert Record.load(tmp_path / "episode_3.h5").ended == "interrupted"

    careful = physim.env("crossing", contact_ends=True)
    made = driven(careful, 600, seed=4)
    assert len(made) < 600
    assert careful.simulation.contacts.size


def test_others_of_a_single_environment_are_driven_by_the_controller() -> None:
    env = physim.single_env("crossing", "b1", controller="path_following")
    env.reset(seed=3)
    plain = Simulation(load_world("crossing"), seed=3, controller="path_following")
    for _ in range(30):
        env.step(np.zeros(2, np.float32))
        for _ in range(10):
            plain.step()
    others = [i for i in range(8) if i != 2]
    assert env.simulation.pose[others].tobytes() == plain.pose[others].tobytes()
    assert (env.simulation.pose[2] == env.simulation.scene.start[2]).all()


@pytest.mark.parametrize("workers", [0, 2])
def test_many_copies_are_as_one_alone(workers: int) -> None:
    many = physim.vector_env("three_robots", 3, workers=workers, max_cycles=4)
    alone = [physim.env("three_robots", max_cycles=4) for _ in range(3)]
    rows, _ = many.reset(seed=6)
    each = [env.reset(seed=6 + k)[0] for k, env in enumerate(alone)]
    assert many.observation_space.contains(rows)
    for cycle in range(7):
        assert rows.tobytes() == np.stack([row for one in each for row in one.values()]).tobytes()
        actions = ahead(rows)
        rows, rewards, over, cut, infos = many.step(actions)
        assert not over.any()
        assert cut.all() == (cycle == 3)
        found = []
        for k, env in enumerate(alone):
            if not env.agents:
                each[k] = env.reset(seed=6 + k + 3)[0]
                found += [0.0] * 3
                continue
            mine = dict(zip(env.agents, actions[3 * k :], strict=False))
            each[k], gained, *_ = env.step(mine)
            found += gained.values()
        assert rewards.tolist() == found
        assert infos["terms"]["progress"].shape == (9,)
    many.close()


def test_pictures_show_the_world_now() -> None:
    env = physim.env("three_robots", render_mode="rgb_array")
    env.reset(seed=1)
    first = env.render()
    for _ in range(20):
        env.step(dict.fromkeys(env.agents, np.array([0.9, 0.0])))
    assert first.shape == env.render().shape == (720, 1280, 3)
    assert (first != env.render()).any()


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: physim.env("crossing", period=0.015), ("period = 0.015", "0.01 s", "60 s")),
        (lambda: physim.env("crossing", rewards={"progres": 1}), ("progres", '"progress"')),
        (lambda: physim.env("crossing", rewards={"time": "much"}), ("time = 'much'", "finite")),
        (lambda: physim.env("crossing", max_cycles=601), ("max_cycles = 601", "1 to 600")),
        (lambda: physim.env("crossing", others=-1), ("others = -1",)),
        (lambda: physim.env("crossing", render_mode="human"), ("'human'", "rgb_array")),
        (lambda: physim.single_env("crossing", "a9"), ("'a9'", "0 to 7")),
        (lambda: physim.vector_env("crossing", 0), ("many = 0",)),
        (lambda: physim.env("crossing").step({}), ("reset",)),
    ],
)
def test_what_cannot_be_is_refused(make: Any, told: tuple[str, ...]) -> None:
    with pytest.raises(PhysimError, match=facts(*told)):
        make()


def test_without_the_extra_the_message_names_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("physim.learning.parallel", "pettingzoo"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setitem(sys.modules, "pettingzoo", None)
    with pytest.raises(PhysimError, match=r'physim\.env.*pip install "physim\[rl\]"'):
        physim.env("crossing")
