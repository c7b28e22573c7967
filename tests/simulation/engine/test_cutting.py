"""No step ends with bodies deep in each other: they stop where they touch."""

from __future__ import annotations

import numpy as np
import pytest

from physim.contacts import Phase
from physim.tolerances import DEEP, SETTLED_DEPTH
from tests.simulation.engine.hosts import box, deepest, drive, host, segments

BOX = [box(1.8, 1.0)]
FAST = 24.9
"""[m/s] as fast as a box of 1 m may be at 0.01 s"""


def head_on(v, w, offset, mass=180.0, dt=0.01):
    """Two boxes on their way towards each other, with a last step of which a share is left."""
    gap = 2.0 + offset * (v + w) * dt
    return host([[0.0, 0.0, 0.0], [1.8 + gap, 0.0, np.pi]], [BOX] * 2, dt=dt, mass=mass)


@pytest.mark.parametrize(("v", "w"), [(FAST, FAST), (FAST, 0.0), (5.0, 12.0), (1.5, 1.0)])
def test_head_on_at_any_speed(v, w):
    for offset in np.linspace(0.05, 0.95, 4):
        _, rows = drive(head_on(v, w, offset), [[v, 0.0], [w, 0.0]], 150)
        assert 0.0 < deepest(rows) <= DEEP
        assert deepest(rows[-10:]) <= SETTLED_DEPTH


@pytest.mark.parametrize("offset", [0.05, 0.3, 0.7])
def test_the_impact_takes_all_momentum(offset):
    _, rows = drive(head_on(FAST, FAST, offset), [[FAST, 0.0], [FAST, 0.0]], 100)
    (hit,) = (r[0] for r in rows if len(r) and r[0]["phase"] == Phase.BEGAN)
    assert hit["impulse"] == pytest.approx(180.0 * FAST, rel=1e-9)
    assert hit["depth"] == pytest.approx(SETTLED_DEPTH, abs=1e-9)


def test_a_fast_robot_stops_at_a_wall_and_leaves_at_once():
    wall = [[(10.0, -5.0), (10.0, 5.0)]]
    physics = host([[0.0, 0.1, 0.0]], [BOX], walls=[wall], dt=0.01, mass=180.0)
    poses, rows = drive(physics, [FAST, 0.0], 60)
    assert 0.0 < deepest(rows) <= DEEP
    assert poses[:, 0, 0].max() <= 10.0 - 0.9 + DEEP
    back, rows = drive(physics, [-FAST, 0.0], 20)
    assert back[0, 0, 0] - back[-1, 0, 0] == pytest.approx(FAST * 0.2, abs=1e-3)
    assert len(rows[-1]) == 0


@pytest.mark.parametrize("degrees", [1.0, 2.0, 3.0, 5.0])
def test_forced_into_a_wedge(degrees):
    slope = np.tan(np.radians(degrees) / 2.0)
    far = 0.5 / slope + 10.0
    wedge = segments([(-far, far * slope), (0.0, 0.0), (-far, -far * slope)])
    start = [[-0.51 / slope - 0.9, 0.003, 0.01]]
    physics = host(start, [BOX], walls=[wedge], dt=0.01, mass=180.0)
    poses, rows = drive(physics, [3.0, 0.0], 400)
    assert deepest(rows[-100:]) <= DEEP
    if degrees < 5.0:  # where the solver alone does not hold it
        assert deepest(rows[-100:]) > DEEP / 2.0
    assert np.ptp(poses[-100:, 0, 0]) < 0.1
    drive(physics, [-3.0, 0.0], 10)
    assert poses[-1, 0, 0] - physics.pose[0, 0] >= 0.3 - 1e-9  # and what eased it out


def test_a_heavy_robot_that_squeezes_a_light_one_against_a_wall():
    room = segments([(-5.0, -3.0), (6.0, -3.0), (6.0, 3.0), (-5.0, 3.0), (-5.0, -3.0)])
    start = [[0.0, 0.0, 0.1], [3.007, 0.2, np.pi]]
    physics = host(start, [BOX] * 2, walls=[room], dt=0.01, mass=[1000.0, 100.0])
    _, rows = drive(physics, [[2.0, 0.0], [2.0, 0.0]], 1200)
    assert DEEP / 2.0 < deepest(rows) <= DEEP


def jam(seed, lanes, rows, speed):
    """Robots of three shapes behind one another before the end of a dead end."""
    rng = np.random.default_rng(seed)
    shapes = (
        [box(0.8, 0.5)],
        [[(0.5, 0.0), (-0.35, 0.4), (-0.35, -0.4)]],
        [[(0.45, 0.0), (0.2, 0.35), (-0.4, 0.25), (-0.4, -0.25), (0.2, -0.35)]],
    )
    count, wide = lanes * rows, 1.05 * lanes + 0.05
    robots = [shapes[k] for k in rng.integers(0, 3, count)]
    start = [[-1.05 * (i // lanes) - 0.6, 1.05 * (i % lanes) + 0.55, 0.0] for i in range(count)]
    end = segments([(-20.0, 0.0), (0.0, 0.0), (0.0, wide), (-20.0, wide)])
    physics = host(start, robots, walls=[end], dt=0.01, mass=40.0)

    def command():
        turn = np.clip(rng.uniform(-0.5, 0.5, count) - 2.0 * physics.pose[:, 2], -1.5, 1.5)
        return np.stack([np.full(count, speed), turn], 1)

    return physics, command


@pytest.mark.parametrize(
    ("seed", "lanes", "rows", "speed", "steps"),
    [
        (3, 3, 4, 1.0, 500),
        *(
            pytest.param(*one, marks=pytest.mark.deep)
            for one in ((0, 4, 6, 0.5, 700), (2, 4, 6, 0.5, 700), (0, 6, 10, 1.0, 700))
        ),
    ],
)
def test_easing_in_a_jam_pushes_nobody_deep(seed, lanes, rows, speed, steps):
    """What eases two robots apart would push one of them into a third, a little at every step."""
    physics, command = jam(seed, lanes, rows, speed)
    found = [drive(physics, command(), 20)[1] for _ in range(steps // 20)]
    assert 0.99 * DEEP < max(map(deepest, found)) <= DEEP


def crowd(speed):
    """Eight boxes in a room, which drive about at speeds up to one given."""
    room = segments([(-6.0, -4.0), (6.0, -4.0), (6.0, 4.0), (-6.0, 4.0), (-6.0, -4.0)])
    rng = np.random.default_rng(3)
    start = [[2.8 * (i % 4) - 4.2, 2.8 * (i // 4) - 1.4, rng.uniform(-0.3, 3.0)] for i in range(8)]
    physics = host(start, [BOX] * 8, walls=[room], dt=0.01, mass=rng.choice([30.0, 300.0], 8))
    turns = rng.choice([-1.5, 0.0, 1.5], (12, 8))
    return physics, [np.stack([rng.choice([-1.0, 0.4, 1.0], 8) * speed, t], 1) for t in turns]


@pytest.mark.parametrize("speed", [3.0, 10.0])
def test_a_crowd_at_speed_stays_shallow_and_inside(speed):
    physics, commands = crowd(speed)
    for command in commands:
        poses, rows = drive(physics, command, 40)
        assert deepest(rows) <= DEEP
        assert (np.abs(poses[:, :, :2]) < (6.0, 4.0)).all()


def test_a_state_goes_on_through_steps_that_are_cut_short():
    physics, commands = crowd(10.0)
    other, _ = crowd(10.0)
    for command in commands:
        drive(physics, command, 20)
        other.restore(physics.state)
        one, two = (drive(each, command, 20) for each in (physics, other))
        assert one[0].tobytes() == two[0].tobytes()
        assert [r.tobytes() for r in one[1]] == [r.tobytes() for r in two[1]]


def test_a_robot_apart_from_an_impact_moves_as_commanded():
    start = [[0.0, 0.0, 0.0], [4.05, 0.0, np.pi], [0.0, 9.0, 0.7]]
    commands = [[FAST, 0.0], [FAST, 0.0], [1.3, 0.4]]
    physics = host(start, [BOX] * 3, dt=0.01, mass=180.0)
    alone = host([start[2]], [BOX], dt=0.01, mass=180.0)
    poses, rows = drive(physics, commands, 30)
    expected, _ = drive(alone, [commands[2]], 30)
    assert any(len(r) for r in rows)
    assert poses[:, 2] == pytest.approx(expected[:, 0], abs=1e-13)


SMALL_BESIDE_LARGE = [
    # half a side [m] of the room; length, width; poses; commands; kg/m^2 is 100
    (0.48, [(0.03, 0.03), (0.3, 0.3)],
     [(0.453, 0.454652909039448, 1.0224577044117868), (0.12, 0.12, 0.724048693330518)],
     [(0.225, 0.0), (0.45, 0.045642319746476215)], 410),
    (1.2, [(0.5, 0.4)] * 2 + [(0.4, 0.02)] * 4,
     [(-0.12840, 0.12472, -1.31919), (0.08543, -0.66392, 0.69670), (-0.73064, 0.24974, 2.35531),
      (0.42631, 0.47621, -0.29293), (0.39477, 0.02329, -0.98141), (-0.62489, -0.70339, -2.92708)],
     [(0.26731, -0.28786), (0.26901, 0.38264), (0.19044, -0.08526), (0.23953, 0.16892),
      (0.21665, 0.42246), (0.26344, 0.48862)], 900),
]  # fmt: skip


@pytest.mark.parametrize(("half", "sides", "start", "command", "steps"), SMALL_BESIDE_LARGE)
def test_a_small_robot_is_not_squeezed_through_a_wall(half, sides, start, command, steps):
    # What is beyond a wall by more than half of its width is pushed out on the far side.
    ring = [(-half, -half), (half, -half), (half, half), (-half, half), (-half, -half)]
    physics = host(
        start, [[box(*one)] for one in sides], [segments(ring)], dt=0.01,
        mass=[100.0 * a * b for a, b in sides],
    )  # fmt: skip
    poses, rows = drive(physics, command, steps)
    assert sum(len(r) for r in rows) > 100
    assert np.abs(poses[..., :2]).max() < half
