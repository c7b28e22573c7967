"""The state of a simulation is a value: what goes on from it is what went on."""

from __future__ import annotations

import copy
import dataclasses
import os
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim import Decision, Observation, Simulation, simulate
from physim.errors import PhysimError
from physim.world.file import load_world, parse_world
from tests.helpers import examples, facts, inside, road

ModeSwitching = inside("physim.controllers", "ModeSwitching")
ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")
record_run = inside("physim.simulation", "record_run")
find_world, shipped_worlds = inside("physim.world.file", "find_world", "shipped_worlds")

AHEAD = 100
"""Steps that a restored run goes on beside the one that went through."""


DEEP = bool(os.environ.get("PHYSIM_DEEP"))
MOST = 6000 if DEEP else 2000
WORLDS = sorted(shipped_worlds()) if DEEP else ["doorway", "merging", "nonconvex", "three_robots"]
"""Of the thousand robots and of long runs a state is restored in the deep tier"""


def trace(simulation: Simulation, steps: int) -> list[bytes]:
    """What happens in the next steps, to the bit."""
    told = []
    for _ in range(steps):
        simulation.step()
        last = simulation.last
        assert last is not None
        parts = [last.pose, last.nominal, last.filtered, last.applied, last.contacts,
                 last.false_contacts, last.arrived, simulation.mode, simulation.next_decision,
                 *simulation.now[3:]]  # fmt: skip
        if last.decisions is not None:
            parts += list(last.decisions)
        told.append(b"".join(np.ascontiguousarray(part).tobytes() for part in parts))
    return told


def same(one: Any, other: Any) -> bool:
    """Whether two states are equal, array by array."""
    if dataclasses.is_dataclass(one) and not isinstance(one, type):
        return type(one) is type(other) and all(
            same(getattr(one, f.name), getattr(other, f.name)) for f in dataclasses.fields(one)
        )
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[k], other[k]) for k in one)
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and (
            one.tolist() == other.tolist()
            if one.dtype == object
            else one.tobytes() == other.tobytes()
        )
    return bool(one == other)


@examples(4, deep=20)
@given(
    name=st.sampled_from(WORLDS),
    deaf=st.booleans(),
    seed=st.integers(0, 10**6),
    share=st.floats(0.0, 0.6),
    way=st.sampled_from(["restore", "new", "deepcopy", "pickle"]),
)
def test_a_run_goes_on_bit_for_bit_from_any_step(
    name: str, deaf: bool, seed: int, share: float, way: str
) -> None:
    """All worlds; path following alone brings contacts under way."""
    world = load_world(find_world(name))
    controller = "path_following" if deaf else None
    simulation = Simulation(world, seed, controller)
    for _ in range(int(share * min(simulation.scene.steps, MOST))):
        simulation.step()
    state = simulation.state
    kept = pickle.dumps(state)
    wanted = trace(simulation, AHEAD)
    assert pickle.dumps(state) == kept  # a value handed out never changes
    other = restored(way, simulation, state, world, controller)
    assert trace(other, AHEAD) == wanted


def restored(
    way: str, simulation: Simulation, state: Any, world: Any, controller: str | None
) -> Simulation:
    if way == "restore":
        simulation.restore(state)
        return simulation
    if way == "new":
        return Simulation(world, controller=controller, state=state)
    simulation.restore(state)
    return (
        copy.deepcopy(simulation) if way == "deepcopy" else pickle.loads(pickle.dumps(simulation))
    )


def crowd(**more: Any) -> Any:
    """Robots that drive into one another and into a wall, one of them L-shaped."""
    poses = [[20.0, y, 0.0] for y in (-1.02, 0.0, 1.02)] + [[23.0, 0.1, 3.1], [24.9, 18.9, 0.7]]
    return road(poses, duration=5.0, **more)


class Stubborn:
    """Drives on, come what may; its memory counts its decisions."""

    def decide(self, observation: Observation, memory: Any) -> Decision:
        count = 0 if memory is None else memory["count"]
        omega = 0.3 * (-1.0) ** (count + observation.index)
        return Decision(1.0, omega, hold=0.07, memory={"count": count + 1})


class Slow:
    """A filter with memory: at most so much more each step [m/s]."""

    def __init__(self, rise: float = 0.02) -> None:
        self.rise = rise

    def start(self, scene: Any) -> Any:
        return np.zeros(scene.robots)

    def filter(self, scene: Any, sensed: Any, nominal: Any, state: Any) -> Any:
        v = np.minimum(nominal[:, 0], state + self.rise)
        return np.stack((v, nominal[:, 1]), axis=1), v


@pytest.mark.parametrize(
    "step", [3, 260, *(pytest.param(k, marks=pytest.mark.deep) for k in (0, 60, 133, 401))]
)
def test_contacts_under_way_memories_and_filters_come_along(step: int) -> None:
    simulation = Simulation(crowd(), controller=Stubborn(), filters=[Slow()])
    touched = 0
    for _ in range(step):
        simulation.step()
        touched += len(simulation.contacts) > 0
    assert touched > 0 or step < 100
    state = pickle.loads(pickle.dumps(simulation.state))
    wanted = trace(simulation, AHEAD)
    other = Simulation(crowd(), controller=Stubborn(), filters=[Slow()], state=state)
    assert same(other.state, state)
    for array in (*other.now[1:], other.mode, other.next_decision, other.arrived):
        assert not array.flags.writeable
    assert trace(other, AHEAD) == wanted
    lost = dataclasses.replace(state, stages=((), (np.zeros(5),), ()))  # without its memory
    if 0 < step < 60:
        other.restore(lost)
        assert trace(other, AHEAD) != wanted


LONG_OR_SHORT = """
name: long or short
time: {step: 0.02, duration: 20.0}
corridor: {centreline: [[0, 0], [20, 0]], width: 8.0}
robots:
  - {count: 1, footprints: [{length: 2.0, width: 0.4}, {length: 0.4, width: 0.4}],
     start: {region: [[1, -1.2], [4, -1.2], [4, 1.2], [1, 1.2]], abreast: 1}, path: {offset: 0.0}}
  - {name: block, footprint: {length: 1.0, width: 4.0}, pose: [6.0, 0.0, 0.0], path: {offset: 0.0}}
"""


@pytest.mark.parametrize(
    "name",
    [
        "three_robots",
        "long or short",
        *(
            pytest.param(name, marks=pytest.mark.deep)
            for name in sorted(set(shipped_worlds()) - {"three_robots", "thousand_robots"})
        ),
    ],
)
def test_reset_is_a_new_simulation(name: str) -> None:
    """Until robots have met the walls, which the seed may draw as it may draw the robots."""
    world = parse_world(LONG_OR_SHORT) if name == "long or short" else load_world(name)
    simulation = Simulation(world)
    scene = simulation.scene
    ahead = scene.limits * [1.0, 0.05, 0.0][: scene.columns]
    simulation.step(ahead)
    for seed in (1, 4, None):
        simulation.reset(seed)
        fresh, copied = Simulation(world, simulation.scene.seed), copy.deepcopy(simulation)
        assert same(simulation.state, fresh.state)
        assert trace(simulation, 20) == trace(fresh, 20) == trace(copied, 20)
        for _ in range(1000 if name in ("random_road", "long or short") else 60):
            for one in (simulation, fresh, copied):
                one.step(ahead)
        assert same(simulation.state, fresh.state)
        assert same(copied.state, fresh.state)


def test_a_state_of_another_run_is_refused_by_what_differs() -> None:
    world, settings = load_world("straight"), ModeSwitchingSettings
    for key, one, other in [
        ("safe_distance", {"controller": ModeSwitching(settings(safe_distance=0.7))},
         {"controller": ModeSwitching(settings(safe_distance=0.8))}),
        ("rise", {"filters": [Slow(0.01)]}, {"filters": [Slow()]}),
    ]:  # fmt: skip
        state = pickle.loads(pickle.dumps(Simulation(world, **one).state))
        assert same(Simulation(world, **one, state=state).state, state)
        with pytest.raises(PhysimError, match=key):
            Simulation(world, **other, state=state)
    state = Simulation(world).state
    with pytest.raises(PhysimError, match="safe_distance"):
        Simulation(world.changed(controller={"safe_distance": 0.7}), state=state)
    with pytest.raises(PhysimError, match="another world or seed"):
        Simulation(load_world("doorway"), state=state)
    with pytest.raises(PhysimError, match="a run with mode_switching; this one has path_following"):
        Simulation(world, controller="path_following", state=state)


def test_values_handed_out_never_change() -> None:
    simulation = Simulation(load_world("straight"))
    simulation.step()
    now, last = simulation.now, simulation.last
    kept = pickle.dumps((now, last, simulation.mode, simulation.arrived))
    held = (now, last, simulation.mode, simulation.arrived)
    for _ in range(200):
        simulation.step()
    assert pickle.dumps(held) == kept
    with pytest.raises(ValueError, match="read-only"):
        now.pose[0, 0] = 1.0


def test_a_run_that_was_reset_is_recorded_as_a_new_one() -> None:
    world = load_world("straight")
    simulation = Simulation(world)
    for _ in range(30):
        simulation.step()
    simulation.reset(3)
    with record_run(simulation) as again, simulate(world, seed=3) as fresh:
        assert again.digest() == fresh.digest()
    for seed, said in ((-1, ("-1", "whole number")), (10**15 + 1, ("1000000000000001", "10^15"))):
        with pytest.raises(PhysimError, match=facts(*said)):
            simulation.reset(seed)
