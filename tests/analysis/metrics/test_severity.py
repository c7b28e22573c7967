"""Severity of an impact in closed form: impulse m (1 + e) c, energy m (1 - e²) c² / 2."""

from __future__ import annotations

from math import cos, hypot, pi, sin

import h5py
import pytest
from numpy import array, sinc

import physim
from physim import Decision
from physim.analysis.metrics import Figures, masses, severity

ROOM = """\
name: room
seed: 1
time: {step: 0.01, duration: 3.0}
physics: {elasticity: ELASTICITY}
boundaries: [[[-20, -20], [20, -20], [20, 20], [-20, 20], [-20, -20]]]
reference_path: [[-19, 0], [19, 0]]
robots:
"""
ROBOT = (
    "  - {name: r%d, footprint: {length: 1.8, width: 1.0}, %spose: %s, "
    "path: [[-19, 0], [19, 0]], limits: {v: 3.0, omega: 3.0}}\n"
)


class Driven:
    """Each robot holds one command."""

    def __init__(self, *commands) -> None:
        self.commands = commands

    def decide(self, observation, memory):
        v, omega = self.commands[observation.index]
        return Decision(v=v, omega=omega, hold=0.1)


def impacts(*robots, elasticity=0.0):
    """Severities of the first and of the severest contact of robots (mass [kg], pose, command)."""
    text = ROOM.replace("ELASTICITY", str(elasticity))
    for k, (mass, pose, _) in enumerate(robots):
        text += ROBOT % (k, "" if mass is None else f"mass: {mass}, ", list(pose))
    driver = Driven(*(command for _, _, command in robots))
    with physim.simulate(physim.parse_world(text), controller=driver) as record:
        run = Figures(record)
        return severity(record, run.episodes[0], masses(record)), run.severest[1]


def first_impact(*robots, elasticity=0.0):
    return impacts(*robots, elasticity=elasticity)[0]


@pytest.mark.parametrize(("mass", "kilograms"), [(70.0, 70.0), (None, 180.0)])
def test_a_box_head_on_against_a_wall(mass, kilograms):
    hit = first_impact((mass, (18.0, 0.0, 0.0), (1.3, 0.0)))
    assert hit.closing == pytest.approx(1.3, rel=1e-9)
    assert hit.changes == pytest.approx((1.3,), rel=1e-6)  # it stands afterwards
    assert hit.energy == pytest.approx(0.5 * kilograms * 1.3**2, rel=1e-6)
    assert hit.sliding == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("elasticity", [0.0, 0.5, 1.0])
@pytest.mark.parametrize(
    ("poses", "speeds", "closing"),
    [
        (((-2.0, 0.0, 0.0), (2.0, 0.0, pi)), (1.0, 0.7), 1.7),
        (((-2.0, 0.0, 0.0), (2.0, 0.0, 0.0)), (1.2, 0.1), 1.1),
    ],
)
def test_two_boxes_in_a_line(poses, speeds, closing, elasticity):
    m, n = 100.0, 50.0
    hit = first_impact(
        (m, poses[0], (speeds[0], 0.0)), (n, poses[1], (speeds[1], 0.0)), elasticity=elasticity
    )
    together = m * n / (m + n)
    impulse = (1 + elasticity) * together * closing
    assert hit.closing == pytest.approx(closing, rel=1e-9)
    assert hit.changes == pytest.approx((impulse / m, impulse / n), rel=1e-6)
    energy = 0.5 * together * (1 - elasticity**2) * closing**2
    assert hit.energy == pytest.approx(energy, rel=1e-6, abs=1e-9)


def test_a_corner_against_a_wall_turns_the_box():
    heading, m, v = 0.3, 180.0, 1.3
    hit = first_impact((m, (18.0, 0.0, heading), (v, 0.0)))
    closing = v * cos(heading)
    # the corner that leads touches at (x, y) from the middle: it gives way by turning
    y = -0.5 * cos(heading) + 0.9 * sin(heading)
    effective = 1.0 / (1.0 / m + y**2 / (m * (1.8**2 + 1.0**2) / 12.0))
    assert hit.closing == pytest.approx(closing, rel=1e-9)
    assert hit.sliding == pytest.approx(v * sin(heading), rel=1e-9)
    assert hit.changes == pytest.approx((effective * closing / m,), rel=1e-6)
    assert hit.energy == pytest.approx(0.5 * effective * closing**2, rel=1e-6)


def test_the_severest_contact_is_that_of_the_greatest_closing_speed():
    slow, fast = (18.9, -5.0, 0.0), (17.0, 5.0, 0.0)
    first, severest = impacts((None, slow, (0.4, 0.0)), (None, fast, (1.3, 0.0)))
    assert first.closing == pytest.approx(0.4, rel=1e-9)
    assert severest.closing == pytest.approx(1.3, rel=1e-9)


def test_a_box_that_turns_in_place_closes_as_fast_as_its_corner():
    hit = first_impact((None, (19.2, 0.0, pi / 2), (0.0, 1.0)))
    lever = (0.9**2 + 0.5**2 - 0.8**2) ** 0.5  # of the corner, along the wall 0.8 m away
    assert hit.closing == pytest.approx(lever, rel=0.02)  # a step turns it by 0.01 rad


def test_each_robot_of_a_group_has_its_mass() -> None:
    group = ROBOT.replace("{name: r%d", "{count: 3").replace("pose: %s", "start: %s")
    region = "{region: [[-9, -9], [9, -9], [9, 9], [-9, 9]]}"
    text = ROOM.replace("ELASTICITY", "0") + group % ("mass: 70, ", region)
    text += ROBOT % (9, "", [15, 0, 0])
    world = physim.parse_world(text, overrides=["time.duration=0.01"])
    with physim.simulate(world, controller=Driven(*[(0.0, 0.0)] * 4)) as record:
        assert masses(record) == pytest.approx([70.0, 70.0, 70.0, 180.0])


def test_impulses_are_all_that_the_record_holds(tmp_path):
    """Also the push of the step in which two part: what the robot lacks of its momentum there."""
    over = ["time.duration=1", "controller.avoidance=none"]
    path = tmp_path / "record.h5"
    world = physim.load_world("u_turn", overrides=over)
    with physim.simulate(world, seed=12, path=path) as record:
        mass, found = masses(record)[0], Figures(record).episodes
        (v, omega) = record.commands_over("applied", 88, 89)[0, 0]
    with h5py.File(path) as file:
        rows, pose = file["contacts"][()], file["steps/pose"][()]
    (last,) = rows[rows["phase"] == 2]
    assert (last["step"], last["a"]) == (89, 0)
    before, after = pose[88:90, 0]
    heading = before[2] + omega * 0.01 / 2.0
    wanted = v * sinc(omega * 0.01 / (2.0 * pi)) * array([cos(heading), sin(heading)])
    lacks = mass * hypot(*(wanted - (after - before)[:2] / 0.01))
    assert last["impulse"] == pytest.approx(lacks, rel=1e-9)
    assert lacks > 100.0
    for one in found:
        same = rows[(rows["a"] == one.a) & (rows["b"] == one.b)]
        same = same[(same["step"] >= one.step) & (same["step"] <= one.step + one.samples)]
        assert one.impulse == pytest.approx(sum(same["impulse"]), rel=1e-12)
    assert sum(one.impulse for one in found) == pytest.approx(sum(rows["impulse"]), rel=1e-12)
