"""Drives against slow and obvious marches, and in runs: limits, states, records, refusals."""

from __future__ import annotations

import copy
import math
import re

import numpy as np
import pytest

import physim
from tests.helpers import inside

Car, Omni, Unicycle = inside("physim.drives", "Car", "Omni", "Unicycle")
CAR = {"type": "car", "wheelbase": 0.8, "steering": 0.6}
SLOW = {**CAR, "steering_rate": 1.0, "acceleration": 1.0}
ROAD = """
name: road
seed: 3
time: {step: 0.01, duration: 40.0}
corridor: {centreline: [[0, 0], [30, 0]], width: 9}
"""


def robot(name: str, y: float, drive: str = "", more: str = "") -> str:
    keys = f", drive: {drive}" if drive else ""
    return (
        f"  - {{name: {name}, footprint: {{length: 0.8, width: 0.6}}, pose: [3, {y}, 0.0], "
        f"path: {{offset: {y}}}{keys}{more}}}\n"
    )


def world(*robots: str, more: str = "") -> physim.World:
    return physim.parse_world(f"{ROAD}{more}robots:\n{''.join(robots)}")


def made(kind, **settings):
    return kind(kind.Settings(**settings))


def marched(pose, v, steering, wheelbase, time, n=200_000):
    """The bicycle model by Euler's method: the rear axle rolls, the front one where it points."""
    x, y, heading = pose
    for _ in range(n):
        x += v * math.cos(heading) * time / n
        y += v * math.sin(heading) * time / n
        heading += v * math.tan(steering) / wheelbase * time / n
    return x, y, heading


def test_a_car_follows_the_bicycle_model():
    simulation = physim.Simulation(world(robot("a", 0, str(CAR))), controller=Held(1.2, -0.9))
    start = simulation.pose[0].copy()
    simulation.step(steps=150)
    steering = math.atan(-0.9 / 1.2 * 0.8)
    assert simulation.now.drive[0] == pytest.approx([1.2, -0.9, 0.0, steering])
    expected = marched(start, 1.2, steering, 0.8, 1.5)
    assert simulation.pose[0] == pytest.approx(expected, abs=1e-5)


class Held:
    """The same command for everybody."""

    drives = ("any",)

    def __init__(self, v: float, omega: float, lateral: float = 0.0) -> None:
        self.told = v, omega, lateral

    def decide(self, observation, memory):
        v, omega, lateral = self.told
        return physim.Decision(v, omega, hold=math.inf, lateral=lateral)


def crept(now: float, wanted: float, most: float, n: int = 1000) -> float:
    """As near to what is wanted as n small changes lead, of ``most`` together."""
    for _ in range(n):
        now += max(-most / n, min(most / n, wanted - now))
    return now


@pytest.mark.parametrize("seed", range(20))
def test_speed_and_wheels_change_as_fast_as_they_can(seed):
    rng = np.random.default_rng(seed)
    most_steering, a, rate, dt, length = 0.6, 1.1, 0.9, 0.05, 0.8
    car = made(Car, wheelbase=length, steering=most_steering, steering_rate=rate, acceleration=a)
    v = steering = 0.0
    state = np.zeros((1, 4))
    for _ in range(30):
        wanted, bend = rng.uniform(-1.5, 1.5), rng.uniform(-0.85, 0.85)
        if rng.random() < 0.2:
            wanted = bend = 0.0
        state = car.follow(np.array([[wanted, wanted * bend, 0.0]]), state, dt)
        v = crept(v, wanted, a * dt)
        if wanted:
            steering = crept(steering, math.atan(length * bend), rate * dt)
        omega = v * math.tan(steering) / length
        assert state[0] == pytest.approx([v, omega, 0.0, steering], abs=1e-9)
        low, high = car.reach(state, dt)[0, 4:]
        turned = (
            max(-most_steering, min(most_steering, steering + k * rate * dt)) for k in (-1, 1)
        )
        assert (low, high) == pytest.approx([math.tan(one) / length for one in turned], abs=1e-9)


def test_an_omnidirectional_velocity_changes_straight_towards_the_wanted_one():
    omni, state = made(Omni, acceleration=2.0, turn_acceleration=4.0), np.zeros((1, 4))
    wanted = np.array([[0.6, -1.0, 0.8]])
    for k in range(1, 6):
        state = omni.follow(wanted, state, 0.1)
        assert state[0] == pytest.approx([0.12 * k, max(-0.4 * k, -1.0), 0.16 * k, 0.0])
    assert omni.follow(wanted, state, 0.1)[0, :3].tolist() == wanted[0].tolist()


@pytest.mark.parametrize("kind", [Unicycle, Omni, Car])
def test_what_is_followed_lies_within_what_is_reached(kind):
    rng = np.random.default_rng(7)
    some = {"wheelbase": 0.8, "steering_rate": 1.0} if kind is Car else {"turn_acceleration": 3.0}
    drive, state = made(kind, acceleration=1.5, **some), np.zeros((50, 4))
    for _ in range(40):
        v = rng.uniform(-1.5, 1.5, 50)
        lateral = rng.uniform(-1.0, 1.0, 50) * (kind is Omni)
        command = np.column_stack((v, v * rng.uniform(-0.8, 0.8, 50), lateral))
        after, reach = drive.follow(command, state, 0.1), drive.reach(state, 0.1)
        for k in (0, 1):
            assert (after[:, k] >= reach[:, 2 * k] - 1e-12).all()
            assert (after[:, k] <= reach[:, 2 * k + 1] + 1e-12).all()
        state = after


def test_a_drive_without_limits_of_its_own_changes_nothing():
    plain, named = world(robot("a", 0)), world(robot("a", 0, "{type: unicycle}"))
    (one, other) = (physim.simulate(each) for each in (plain, named))
    assert one.pose.tobytes() == other.pose.tobytes()
    assert other.updates.tobytes() == one.updates.tobytes()
    assert not one.holds("/steps/steering")


def test_mixed_teams_arrive_and_their_records_tell_steering_and_sideways_speed():
    mixed = world(
        robot("plain", 3), robot("slow", 1, "{type: unicycle, acceleration: 1.0}"),
        robot("car", -1, str(SLOW)),
        robot("omni", -3, "{type: omni, lateral: 0.3, acceleration: 0.5}",
              ", controller: {type: constant, commands: [[0, 0], [0, 0], [0, 0], "
              "[0.5, 0.1, -0.2]]}"),
    )  # fmt: skip
    simulation = physim.Simulation(mixed)
    assert simulation.command.shape == (4, 3)
    with physim.simulate(mixed) as run:
        assert (run.arrived[:3] >= 0).all()
        assert run.commands.dtype.names[2:5] == ("nominal_v", "nominal_omega", "nominal_lateral")
        held = run.commands_over("applied", 0, 300)
        assert held[:, 3, 2].min() == pytest.approx(-0.2)
        speed = np.hypot(held[:, 3, 0], held[:, 3, 2])
        assert np.diff(speed).max() <= 0.5 * 0.01 + 1e-12
        assert held[0, 1, 0] == pytest.approx(0.01)
        assert run.steering.shape == (run.samples, 4)
        assert (run.steering[:, [0, 1, 3]] == 0.0).all()
        assert np.abs(np.diff(run.steering[:, 2])).max() <= 1.0 * 0.01 + 1e-12
        assert ("drives", "unicycle (slow), car (car), omni (omni)") in run.setup.lines()
        report = physim.validate(run)
        assert report.code == 1, "the omnidirectional one runs into the wall, and all agrees"


def test_what_drives_do_is_part_of_the_state():
    simulation = physim.Simulation(world(robot("a", 0, str(SLOW))))
    simulation.step(steps=60)
    kept, twin = simulation.state, copy.deepcopy(simulation)
    assert 0.0 < simulation.now.drive[0, 0] < 1.0
    for one in (simulation, twin):
        one.step(steps=80)
    other = simulation.branch()
    simulation.restore(kept)
    simulation.step(steps=80)
    for one in (twin, other):
        assert one.pose.tobytes() == simulation.pose.tobytes()
        assert one.now.drive.tobytes() == simulation.now.drive.tobytes()


@pytest.mark.parametrize("told", [(1.0, 0.86), (0.0, 0.1), (-0.5, 0.43)])
def test_a_car_is_not_turned_more_than_its_wheels_can(told):
    simulation = physim.Simulation(world(robot("a", 0, str(CAR))), controller=Held(*told))
    with pytest.raises(physim.ControllerError, match=r"a at 0 s: command omega = .* 0\.855171"):
        simulation.step()


def test_only_an_omnidirectional_robot_goes_sideways():
    with pytest.raises(physim.ControllerError, match="no robot of this world is omnidirectional"):
        physim.Simulation(world(robot("a", 0)), controller=Held(0.0, 0.0, 0.1)).step()
    both = world(robot("a", 2), robot("b", -2, "omni"), more="controller: {type: constant}\n")
    with pytest.raises(physim.ControllerError, match=r"a at 0 s: command lateral = 0\.1 m/s"):
        physim.Simulation(both, controller=Held(0.0, 0.0, 0.1)).step()


class ForUnicycles:
    """Says nothing of drives."""

    def decide(self, observation, memory):
        return physim.Decision(0.0, 0.0, hold=1.0)


@pytest.mark.parametrize(
    ("drive", "told"),
    [
        ("tank", r"robots\[0\].drive: .*registered: car, omni, unicycle"),
        ("omni", r'robots\[0\].drive: "omni" is no drive for .*drives omni \(constant'),
        ("car", r"robots\[0\].drive.wheelbase: missing"),
        ("{type: car, wheelbase: 1.0, steering: 2.0}", r"drive.steering: .*"),
        ("{type: unicycle, acceleration: 0.0}", r"drive.acceleration: .*"),
        ("{type: omni, wheelbase: 1.0}", r'drive.wheelbase: unknown key'),
        ("3", r"robots\[0\].drive"),
    ],
)  # fmt: skip
def test_a_drive_is_refused_at_its_place(drive, told):
    with pytest.raises(physim.WorldError) as refused:
        world(robot("a", 0, drive))
    (line,) = str(refused.value).splitlines()
    assert re.match(r"<text>:\d+:\d+: ", line)
    assert re.search(told, line), line


def test_a_controller_drives_what_it_says():
    cars = world(robot("a", 0, str(CAR)))
    with pytest.raises(physim.WorldError, match='add "car" to the drives of ForUnicycles'):
        physim.Simulation(cars, controller=ForUnicycles())
    with pytest.raises(physim.ControllerError, match="suits the robots of none of 1 world"):
        physim.check_controller(ForUnicycles, worlds=[cars])
    assert not physim.check_controller("mode_switching", worlds=[cars], seconds=1.0)


def test_a_controller_knows_its_wheels_and_what_it_can_come_to():
    seen = []

    class Watching(Held):
        def decide(self, observation, memory):
            seen.append(observation.vehicle)
            return physim.Decision(1.0, 0.5, hold=0.5)

    simulation = physim.Simulation(world(robot("a", 0, str(SLOW))), controller=Watching(0, 0))
    simulation.step(steps=51)
    first, later = seen
    assert (first.drive, first.v, first.steering, first.braking) == ("car", 0.0, 0.0, 1.0)
    assert first.reachable(0.5).v == (-0.5, 0.5)
    assert (later.v, later.steering) == pytest.approx((0.5, math.atan(0.4)))
    assert later.reachable(0.1).curvature[1] == pytest.approx(math.tan(math.atan(0.4) + 0.1) / 0.8)
    assert first.clipped(1.0, 1.0, 0.1) == pytest.approx((0.1, 0.1 * math.tan(0.1) / 0.8))


def test_a_car_that_faces_a_wall_backs_and_goes_on():
    """Standing meets nothing for ever, and a car that stands cannot turn."""
    blocked = physim.parse_world(
        "name: blocked\nseed: 1\ntime: {step: 0.02, duration: 12.0}\n"
        "corridor: {centreline: [[0, 0], [30, 0]], width: 5}\nrobots:\n"
        "  - {name: a, footprint: {length: 0.8, width: 0.6}, pose: [5, 1.2, 1.3], "
        f"path: {{offset: 0}}, drive: {SLOW}}}\n"
    )
    run = physim.simulate(blocked)
    assert len(run.contacts) == 0
    assert run.commands_over("applied", 0, run.steps_run)[:, 0, 0].min() < -0.1
    assert run.pose[-1, 0, 0] > 7.0


def test_path_following_leads_an_omnidirectional_robot_sideways():
    drive = "{type: omni, lateral: 0.3, acceleration: 1.0}"
    where = robot("a", 2, drive).replace("offset: 2", "offset: -2")
    record = physim.simulate(world(where, more="controller: {type: path_following}\n"))
    assert record.ended == "finished"
    assert np.ptp(record.pose[:, 0, 2]) < 1e-12  # it never turns
    assert np.abs(record.updates["nominal_lateral"]).max() == pytest.approx(0.3)
    assert record.pose[-1, 0, 1] == pytest.approx(-2.0, abs=0.05)
