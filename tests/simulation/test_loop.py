"""The loop as a whole: decisions in, motion and record out."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physim import Decision, Observation, Simulation, build_scene, simulate
from physim.errors import ControllerError, Notice
from physim.record import Record
from physim.world.file import load_world, parse_world
from tests.helpers import THREE, Says, facts, inside, road
from tests.helpers.stages import Changes

formation_energy = inside("physim.controllers", "formation_energy")
formation_energy_rate = inside("physim.controllers", "formation_energy_rate")
record_run = inside("physim.simulation", "record_run")
find_world = inside("physim.world.file", "find_world")

# Motion


def plain_update(pose: np.ndarray, command: np.ndarray, dt: float) -> np.ndarray:
    """Equation (1) over one step, written out: the chord of the arc."""
    after = pose.copy()
    for i, ((_, _, heading), (v, omega)) in enumerate(zip(pose, command, strict=True)):
        h = 0.5 * omega * dt
        speed = v * (math.sin(h) / h if h else 1.0)
        after[i, 0] += speed * math.cos(heading + h) * dt
        after[i, 1] += speed * math.sin(heading + h) * dt
        after[i, 2] += omega * dt
    return after


def test_commands_may_be_given_step_by_step() -> None:
    silent = Says(lambda o: pytest.fail("no controller may be asked"))
    simulation = Simulation(road(THREE), controller=silent)
    before, pose = simulation.pose, simulation.pose.copy()
    command = np.array([[1.0, 0.5], [-1.0, 0.0], [0.0, -0.5]])
    for k in range(5):
        simulation.step(commands=command * k / 4)
        pose = plain_update(pose, command * k / 4, 0.01)
        assert np.array_equal(simulation.pose, pose)
        assert simulation.last.decisions is None
    assert np.array_equal(simulation.command, command)
    assert np.array_equal(before, build_scene(road(THREE)).start)  # an old pose stays as it was
    command[:] = 0.0
    assert simulation.command[0, 0] == 1.0
    says = Says(lambda o: Decision(o.v / 2.0, 0.0, hold=1.0))
    driven = Simulation(road(THREE), controller=says)
    driven.step(np.full((3, 2), 0.5))
    driven.step()  # steered by hand so far, robots are asked
    assert says.asked == [(0, 1), (1, 1), (2, 1)]
    assert driven.command[:, 0].tolist() == [0.25] * 3


def test_velocities_are_what_bodies_do_whatever_they_are_commanded() -> None:
    """A filter holds the first robot, a disturbance drives the second otherwise, and the third
    runs into it: all see how each moves, beside what it was told."""
    near = [[20.0, -3.0, 0.0], [20.0, 0.0, 0.0], [20.0, 1.6, -np.pi / 2]]
    held, otherwise = np.array([[0.0], [1.0], [1.0]]), np.array([[1.0], [0.25], [1.0]])
    seen: list[tuple[int, Observation]] = []

    def decide(o: Observation) -> Decision:
        seen.append((o.index, o))
        return Decision(1.0, 0.1, hold=0.0)

    simulation = Simulation(
        road(near), controller=Says(decide), filters=[Changes(lambda given: held * given)],
        disturbances=[Changes(lambda given: otherwise * given)],
    )  # fmt: skip
    assert (simulation.velocity == 0.0).all()
    met = False
    for _ in range(80):
        before = simulation.pose
        simulation.step()
        assert simulation.velocity == pytest.approx((simulation.pose - before) / 0.01, abs=1e-12)
        met = met or len(simulation.contacts) > 0
    assert met
    v, omega = simulation.command.T
    assert (v == 1.0).all()
    assert (omega == 0.1).all()
    speed = np.hypot(*simulation.velocity[:, :2].T)
    assert speed[0] == 0.0
    assert speed[1:].max() < 0.9
    state = simulation.state
    simulation.step()
    for i, one in seen[-3:]:
        assert (one.v, one.omega) == (1.0, 0.1)
        assert np.array_equal(one.velocity, state.now.velocity[i])
        assert [np.array_equal(j.velocity, state.now.velocity[j.index]) for j in one.others] == [
            True, True,
        ]  # fmt: skip
    simulation.restore(state)
    assert np.array_equal(simulation.observe(1).velocity, state.now.velocity[1])


def test_clearances_are_those_of_the_record(monkeypatch: pytest.MonkeyPatch) -> None:
    """And a state takes no text of the world but the first."""
    world = road(THREE, duration=0.3)
    ahead = Says(lambda o: Decision(1.0, 0.3 * o.index, hold=0.1))
    record, simulation = simulate(world, controller=ahead), Simulation(world, controller=ahead)
    texts = []
    monkeypatch.setattr(type(world), "to_yaml", lambda self: texts.append(self) or "")
    for k in range(record.samples):
        assert np.array_equal(simulation.clearance, record.clearance[k])
        assert np.array_equal(simulation.boundary_clearance, record.boundary_clearance[k])
        assert simulation.state.seed == 0
        simulation.step()
    assert len(texts) == 1


# Commands and controllers that fail


@pytest.mark.parametrize(
    ("robot", "column", "value", "said"),
    [
        (1, 0, math.nan, ("r2", "v", "nan m/s")),
        (2, 1, math.inf, ("r3", "omega", "inf rad/s")),
        (0, 0, 1.5 * (1 + 1e-6), ("r1", "v", "1.5 m/s")),
        (0, 1, -1.7, ("r1", "omega", "-1.7 rad/s", "1.6 rad/s")),
        (0, 1, float(np.float32(-1.6)), ("r1", "-1.60000002 rad/s", "1.6 rad/s", "32 bits")),
        (0, slice(1, 1), 0.0, ("(3, 1)", "(3, 2)")),
    ],
)
def test_bad_commands_are_refused_with_robot_and_time(
    robot: int, column: Any, value: float, said: tuple[str, ...]
) -> None:
    """At the limit a command is fine; a refused one changes nothing."""
    simulation = Simulation(road(THREE))
    simulation.step(np.array([[0.5 * 3, 1.6], [-1.5, -1.6], [0.0, 0.0]]))
    simulation.step()
    pose = simulation.pose.copy()
    commands = np.zeros((3, 1 if isinstance(column, slice) else 2))
    commands[robot, column] = value
    with pytest.raises(ControllerError, match=facts("0.02 s", *said)):
        simulation.step(commands)
    assert simulation.step_number == 2
    assert np.array_equal(simulation.pose, pose)


def test_a_controller_that_fails_stops_the_run_and_the_record_is_kept(tmp_path: Path) -> None:
    def later(o: Observation) -> Decision:
        return Decision(1.0, 0.0, hold=[0.01][o.index == 1 and o.time > 0.045])

    with pytest.raises(ControllerError, match=facts("r2", "0.05 s", "IndexError")):
        simulate(road(THREE), controller=Says(later), path=tmp_path / "r.h5")
    with Record.load(tmp_path / "r.h5") as record:
        assert (record.ended, record.steps_run) == ("error", 5)
        assert record.steps.tolist() == list(range(6))
        assert record.updates["step"].max() == 4


# When decisions are due


@pytest.mark.parametrize(
    ("dt", "hold", "steps"),
    [
        (0.01, 0.1, 10),
        (0.03, 0.1, 3),
        (0.01, 0.29, 29),  # 0.29 / 0.01 is a hair below 29
        (0.01, 0.0299, 2),
        (0.01, 0.005, 1),
        (0.01, 0.0, 1),
        (0.01, math.inf, 10**9),
    ],
)
def test_a_hold_is_rounded_down_to_steps_one_at_least(dt: float, hold: float, steps: int) -> None:
    says = Says(lambda o: Decision(0.0, 0.0, hold))
    simulation = Simulation(road(THREE[:1], step=dt, duration=30 * dt), controller=says)
    for _ in range(30):
        simulation.step()
    assert [step for _, step in says.asked] == list(range(0, 30, steps))
    assert simulation.next_decision[0] == says.asked[-1][1] + steps


def test_every_robot_decides_when_its_own_time_has_come() -> None:
    holds = {0: [0.03, 0.0, 0.1], 1: [0.025], 2: [math.inf]}

    def decide(o: Observation) -> Decision:
        times = [step for robot, step in says.asked if robot == o.index]
        mine = holds[o.index]
        return Decision(0.1 * len(times), 0.0, hold=mine[(len(times) - 1) % len(mine)])

    says = Says(decide)
    record = simulate(road(THREE, duration=0.2), controller=says)
    steps = {0: [0, 3, 4, 14, 17, 18], 1: list(range(0, 20, 2)), 2: [0]}
    for robot, due in steps.items():
        assert [step for i, step in says.asked if i == robot] == due
        rows = record.updates[record.updates["robot"] == robot]
        assert rows["step"].tolist() == due
        assert rows["next_step"][:-1].tolist() == due[1:]
        assert rows["nominal_v"] == pytest.approx(0.1 * (1 + np.arange(len(due))))
    order = list(
        zip(record.updates["step"].tolist(), record.updates["robot"].tolist(), strict=True)
    )
    assert order == sorted(order)


def test_all_decide_from_the_commands_held_before() -> None:
    seen: list[tuple[int, int, float]] = []

    def decide(o: Observation) -> Decision:
        seen.extend((o.index, other.index, other.v) for other in o.others)
        assert o.v == (0.1 * o.index + 0.2 if o.time else 0.0)
        return Decision(0.1 * o.index + 0.2, 0.0, hold=0.01)

    near = [[20.0, -3.0, 0.0], [20.0, 0.0, 0.0], [20.0, 3.0, 0.0]]
    simulation = Simulation(road(near), controller=Says(decide))
    simulation.step()
    assert {v for _, _, v in seen} == {0.0}
    assert len(seen) == 6
    seen.clear()
    simulation.step()
    assert all(v == 0.1 * j + 0.2 for _, j, v in seen)


# Formation


@pytest.mark.parametrize("neighbours", ["all", "range", [["r1", "r2"], ["r2", "r3"]]])
def test_energy_falls_by_equation_10_in_a_real_run(neighbours: Any) -> None:
    """Straight road, headings along it, no saturation, every robot deciding at every step."""
    gain, dt = 0.04, 0.01
    world = road(
        [[20.0, -10.0, 0.0], [27.0, 0.0, 0.0], [23.0, 10.0, 0.0]],
        duration=4.0,
        reference_path=[[0.0, 0.0], [200.0, 0.0]],
        formation={
            "gain": gain, "speed": 1.0, "limits": [0.0, 1.49], "spacing": [0.0, 3.0, 5.0],
            "range": 50.0, "neighbours": neighbours,
        },
        controller={
            "type": "mode_switching", "update_period": dt, "dwell_times": [dt],
            "longest_interval": dt,
        },
    )  # fmt: skip
    record = simulate(world)
    scene = build_scene(world)
    near = scene.formation.adjacency if len(scene.formation.adjacency) else 1 - np.eye(3, dtype=int)
    station = record.updates["reference_station"].reshape(-1, 3)
    assert len(station) == 400
    speed = record.updates["applied_v"].reshape(-1, 3)
    assert (np.abs(speed - 1.0) < 0.49).all()
    assert (record.updates["mode"] == 0).all()
    energy = np.array([formation_energy(s, scene.formation.lead, near) for s in station])
    rate = np.array([formation_energy_rate(s, scene.formation.lead, near, gain) for s in station])
    spread = speed[:, None, :] - speed[:, :, None]
    remainder = 0.5 * (near * spread**2).sum(axis=(1, 2)) * dt * dt  # exact for a step of length dt
    assert energy[0] > 10.0
    assert (np.diff(energy) < 0.0).all()
    assert np.diff(energy) == pytest.approx((rate * dt + remainder)[:-1], abs=1e-11)


def test_robots_arrive_in_formation_and_stand_still() -> None:
    world = load_world(find_world("three_robots"))
    simulation = Simulation(world)
    while not simulation.finished:
        simulation.step()
        assert simulation.step_number < simulation.scene.steps
    scene = simulation.scene
    own, lead = simulation.now.station, scene.formation.lead
    settings = simulation.parts.controller.settings  # type: ignore[attr-defined]
    most = settings.update_period * scene.formation.v_max
    assert (own >= scene.stop_station - settings.arrival_tolerance).all()
    assert (own <= scene.stop_station + most).all()
    ends = scene.paths.station[scene.paths.start[1:] - 1]
    assert ends - scene.stop_station == pytest.approx(lead.max() - lead)
    assert np.ptp(simulation.now.reference_station - lead) < 0.5
    pose = simulation.pose.copy()
    for _ in range(30):
        simulation.step()
    assert np.array_equal(simulation.pose, pose)
    assert (simulation.command == 0.0).all()


# Set-up


@pytest.mark.parametrize("world", ["three_robots", Path("world.yaml")])
def test_a_name_in_place_of_a_world_is_told(world: Any) -> None:
    with pytest.raises(TypeError, match=r"World.*Scene.*(str|PosixPath).*load_world"):
        simulate(world)


def settings_in(world: Any, controller: str) -> dict[str, Any]:
    """Settings of its world, which its controller has, too."""
    made = Simulation(world, controller=controller)
    found = dict(made.scene.world.controller.settings)
    settings: Any = made.parts.controller.settings  # type: ignore[attr-defined]
    assert {key: getattr(settings, key) for key in found} == found
    return found


def test_a_controller_by_name_keeps_the_settings_of_its_own_type() -> None:
    """As on the command line; they were left out in silence, and another run was compared."""
    text = "name: x\ntime: {step: 0.05, duration: 1}\n"
    text += "corridor: {centreline: [[0, 0], [20, 0]], width: 8}\n"
    text += "robots: [{name: a, footprint: {length: 1.8, width: 1}, pose: [3, 0, 0], "
    text += "path: {offset: 0}}]\ncontroller: "
    named = parse_world(text + "{type: path_following, speed: 0.7}\n")
    assert settings_in(named, "path_following") == {"speed": 0.7}
    said = facts("speed", "path_following", "not used by", "mode_switching")
    with pytest.warns(Notice, match=said):
        assert settings_in(named, "mode_switching") == {}
    open_to_all = parse_world(text + "{speed: 0.7}\n")
    assert settings_in(open_to_all, "path_following") == {"speed": 0.7}
    changed = parse_world(text + "{}\n").changed(controller={"speed": 0.7})
    assert settings_in(changed, "path_following") == {"speed": 0.7}
