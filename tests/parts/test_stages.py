"""Stages and observers from outside, found by entry point: what they may do, and what they may not.

The parts are the examples of docs/how-to, installed for these tests alone.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from physim import (
    Sensed,
    Simulation,
    build_scene,
    for_each,
    observer_of_row,
    per_robot,
    simulate,
    with_poses,
)
from physim.errors import ControllerError
from physim.world import World
from physim.world.file import load_world
from tests.helpers import facts, inside
from tests.helpers.extending import entry_points, install
from tests.helpers.stages import Changes

CONTROLLER = inside("physim.parts", "CONTROLLER")
make_part = inside("physim.parts", "make_part")

HAZE = "sensing.stages=[{type: haze, sd: 0.2}]"
RAMP = "filters=[{type: ramp, acceleration: 1.0}]"
GAINS = "disturbances=[{type: gains, spread: 0.1}]"
SHORT = "time.duration=3.0"


@pytest.fixture(autouse=True, scope="module")
def _installed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    folder = install(tmp_path_factory.mktemp("stages") / "installed")
    targets = [target for names in entry_points().values() for target in names.values()]
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    yield
    sys.path.remove(str(folder))
    for target in targets:
        sys.modules.pop(target.split(":")[0], None)


def world(*overrides: str, name: str = "three_robots") -> World:
    return load_world(name, overrides=[SHORT, "expect=null", *overrides])


# Sense


def test_each_observer_sees_others_where_they_are_not_and_itself_where_it_is() -> None:
    simulation = Simulation(world(HAZE))
    for _ in range(30):
        simulation.step()
    truth, seen = simulation.now, {}
    for i in range(3):
        me = simulation.observe(i)
        assert (me.pose == truth.pose[i]).all()
        assert (me.station, me.reference_station) == (
            truth.station[i], truth.reference_station[i],
        )  # fmt: skip
        for other in me.others:
            seen[i, other.index] = other
            off = other.pose - truth.pose[other.index]
            assert 0.0 < np.abs(off[:2]).max() < 1.2
            assert off[2] == 0.0
    assert len(seen) == 6
    for j in range(3):
        one, two = (seen[i, j] for i in range(3) if i != j)
        assert (one.pose != two.pose)[:2].all()
        assert one.station != two.station
    stations = {i: {n.index: n.station for n in simulation.observe(i).neighbours} for i in range(3)}
    assert stations[0][2] == seen[0, 2].station != truth.reference_station[2]


def test_truth_is_what_it_is_whatever_is_sensed() -> None:
    """With commands from outside, robots do not look at what they sense, and move alike."""
    clear, hazy = Simulation(world()), Simulation(world(HAZE))
    for k in range(60):
        commands = np.full((3, 2), (0.8, 0.1 * np.sin(k)))
        clear.step(commands)
        hazy.step(commands)
        assert hazy.last is not None
        assert hazy.last.truth.pose is not hazy.last.sensed.pose
    assert np.array_equal(clear.pose, hazy.pose)
    assert np.array_equal(clear.now.reference_station, hazy.now.reference_station)


def test_robot_by_robot_the_same_is_decided_from_the_same_sensed_rows() -> None:
    hazy = world("sensing.stages=[{type: haze, sd: 0.5}, {type: haze, sd: 0.1}]")
    inner = make_part(CONTROLLER, "mode_switching", hazy.controller.settings)
    whole, plain = Simulation(hazy), Simulation(hazy, controller=per_robot(inner))
    decided = 0
    for _ in range(250):
        whole.step()
        plain.step()
        assert whole.last is not None
        assert plain.last is not None
        one, two = whole.last.decisions, plain.last.decisions
        assert (one is None) == (two is None)
        if one is not None and two is not None:
            for a, b in zip(one, two, strict=True):
                assert np.array_equal(a, b, equal_nan=True)
            decided += len(one.robot)
    assert decided > 40
    assert np.array_equal(whole.pose, plain.pose)
    clear = simulate(world())
    assert not np.array_equal(clear.pose[250], whole.pose)


def alone(sensed: Sensed) -> Sensed:
    """Nobody sees anybody: rows of the others are left out."""
    rows = for_each(sensed)
    own = observer_of_row(rows) == rows.robot
    kept = {
        name: getattr(rows, name)[own]
        for name in ("robot", "pose", "command", "velocity", "reference_station", "age")
    }
    number = np.arange(len(rows.first))
    return rows._replace(first=number, end=number + 1, **kept)


def test_rows_may_be_left_out() -> None:
    simulation = Simulation(world(), sensing=[Changes(alone)])
    assert [simulation.observe(i).others for i in range(3)] == [()] * 3
    assert [simulation.observe(i).neighbours for i in range(3)] == [()] * 3
    simulation.step()
    assert simulation.last is not None
    assert simulation.last.decisions is not None
    assert len(simulation.last.decisions.considered) == 0


def test_a_robot_that_errs_about_itself_errs_about_its_stations() -> None:
    """Every robot believes that it is 0.3 m further along the x axis than it is."""

    def drift(sensed: Sensed) -> Sensed:
        rows = for_each(sensed)
        own = observer_of_row(rows) == rows.robot
        return with_poses(scene, rows, rows.pose + np.outer(own, (0.3, 0.0, 0.0)))

    scene = build_scene(world(name="straight"))
    simulation = Simulation(scene, sensing=[Changes(drift)])
    for _ in range(100):
        simulation.step()
    truth, one = simulation.now, simulation.observe(0)
    assert one.pose[0] == pytest.approx(truth.pose[0, 0] + 0.3)
    assert one.station == pytest.approx(truth.station[0] + 0.3)
    assert one.reference_station == pytest.approx(truth.reference_station[0] + 0.3)
    assert one.others[0].station == truth.reference_station[1]
    assert (one.others[0].pose == truth.pose[1]).all()


@pytest.mark.parametrize("dtype", [">f8", "f4", "view"])
def test_what_is_sensed_may_be_of_any_type_of_number_and_layout(dtype: str) -> None:
    """Compiled code reads bytes as they lie; and a buffer may be filled again."""
    kept: dict[str, Any] = {}

    def other(name: str, values: Any) -> Any:
        if dtype == "view":
            buffer = kept.setdefault(name, np.zeros(values.shape, values.dtype))
            buffer[...] = values
            return buffer.view()
        kind = dtype if values.dtype.kind == "f" else ">i8" if dtype == ">f8" else "i4"
        return values.astype(kind)

    def changed(sensed: Sensed) -> Sensed:
        return Sensed(sensed.step, *(map(other, sensed._fields[1:], sensed[1:])))

    both = Simulation(world(), sensing=[Changes(changed)]), Simulation(world())
    for simulation in both:
        for _ in range(30):
            simulation.step()
    near = 1e-4 if dtype == "f4" else 0.0
    assert np.abs(both[0].pose - both[1].pose).max() <= near


# Filter and disturbance


@pytest.mark.parametrize("kind", ["filters", "disturbances"])
def test_filters_and_disturbances_stand_in_their_order(kind: str) -> None:
    half, more = Changes(lambda given: 0.5 * given), Changes(lambda given: given + 0.2)
    for first, second, reached in ((half, more, 0.7), (more, half, 0.6)):
        stages: dict[str, Any] = {kind: [first, second]}
        simulation = Simulation(world(), **stages)
        simulation.step(np.array([[1.0, 0.0]] * 3))
        assert simulation.last is not None
        assert simulation.last.applied[:, 0] == pytest.approx([reached] * 3)


def test_filters_see_what_is_sensed_and_remember() -> None:
    seen = []

    class Looks:
        def start(self, scene: Any) -> int:
            return 0

        def filter(self, scene: Any, sensed: Sensed, nominal: Any, state: int) -> Any:
            seen.append((state, sensed.step, sensed.pose))
            return nominal, state + 1

    simulation = Simulation(world(HAZE), filters=[Looks()])
    for _ in range(5):
        simulation.step()
        assert simulation.last is not None
        assert seen[-1][2] is simulation.last.sensed.pose
        assert simulation.last.filtered is simulation.last.nominal
    assert [(state, step) for state, step, _ in seen] == [(k, k) for k in range(5)]
    assert len(seen[0][2]) == 9


@pytest.mark.parametrize("dtype", [">f8", "f4", "i8", "object"])
@pytest.mark.parametrize("kind", ["filters", "disturbances"])
def test_commands_may_be_of_any_type_of_number(kind: str, dtype: str) -> None:
    """Also read-only ones, as from a file: compiled code would read the bytes as its own."""

    def other(given: Any) -> Any:
        found = np.asfortranarray(np.array(given, dtype))
        found.flags.writeable = False
        return found

    stages: dict[str, Any] = {kind: [Changes(other)]}
    changed, plain = Simulation(world(), **stages), Simulation(world())
    for simulation in (changed, plain):
        for _ in range(5):
            simulation.step(np.array([[1.0, 0.5]] * 3).round(0 if dtype == "i8" else 1))
    assert (changed.pose == plain.pose).all()


def test_limits_bind_filters_but_not_disturbances() -> None:
    twice: Any = Changes(lambda given: 2.0 * given)
    commands = np.array([[1.0, 0.2]] * 3)
    pushed = Simulation(world(), disturbances=[twice])
    before = pushed.pose
    pushed.step(commands)
    assert np.allclose(np.hypot(*(pushed.pose - before)[:, :2].T), 2.0 * pushed.scene.dt)
    with pytest.raises(ControllerError, match=facts("filter Changes", "r1", "0 s", "v", "2 m/s")):
        Simulation(world(), filters=[twice]).step(commands)


def test_stages_go_one_after_the_other_and_stand_in_the_record() -> None:
    given = world(RAMP, GAINS)
    record = simulate(given)
    plain = simulate(world())
    steps = len(record.pose) - 1
    stages = [record.commands_over(s, 0, steps) for s in ("nominal", "filtered", "applied")]
    nominal, filtered, applied = stages
    rise = np.diff(filtered[..., 0], axis=0, prepend=0.0)
    assert np.abs(rise).max() <= 1.0 * record.dt + 1e-12
    assert np.abs(np.diff(nominal[..., 0], axis=0, prepend=0.0)).max() > 0.5
    gains = applied[-1, :, 0] / filtered[-1, :, 0]
    assert np.allclose(applied[..., 0], filtered[..., 0] * gains, atol=1e-12)
    assert (np.abs(gains - 1.0) > 1e-3).all()
    turn = applied[..., 1] * record.dt
    assert np.allclose(np.diff(record.pose[..., 2], axis=0), turn, atol=1e-9)
    assert record.world == given
    assert record.given == ()
    assert len(plain.commands) == 0
    assert len(record.commands) == (np.abs(applied - nominal).max(axis=2) > 0.0).sum()
