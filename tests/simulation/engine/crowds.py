"""Random scenes in contact, and runs of them that are told bit for bit."""

from __future__ import annotations

import hashlib
from typing import NamedTuple

import numpy as np

from physim.contacts import Phase
from physim.simulation.engine import Physics, PhysicsState
from tests.simulation.engine.hosts import ELL, FALSE_CONTACTS, box, host, segments, side_by_side

ARROW = [[(1.0, 0.0), (-0.6, 0.5), (-0.3, 0.0)], [(1.0, 0.0), (-0.3, 0.0), (-0.6, -0.5)]]
"""nonconvex: two triangles that share an edge"""
STAR = [box(1.4, 0.3), box(0.3, 1.4)]
"""two parts that overlap"""


class Crowd(NamedTuple):
    """A scene and the commands that drive it; the same for the same kind and seed."""

    robots: list
    walls: list
    start: np.ndarray
    held: np.ndarray
    """(H, N, 2) random commands, each held for ten steps"""
    inwards: bool
    """all robots head for the middle instead, save in every fourth hold"""
    friction: float
    elasticity: float

    def physics(self, **more) -> Physics:
        return host(
            self.start,
            self.robots,
            self.walls,
            friction=self.friction,
            elasticity=self.elasticity,
            **more,
        )

    def command(self, k: int, pose: np.ndarray) -> np.ndarray:
        hold = k // 10 % len(self.held)
        if not self.inwards or hold % 4 == 3:
            return self.held[hold]
        turn = np.arctan2(-pose[:, 1], -pose[:, 0]) - pose[:, 2]
        turn = np.remainder(turn + np.pi, 2 * np.pi) - np.pi
        return np.column_stack((np.cos(turn), np.clip(2 * turn, -1, 1)))


def ring(size):
    angle = np.linspace(0, 2 * np.pi, 13)
    return segments(list(zip(size * np.cos(angle), size * np.sin(angle), strict=True)))


def lattice(rng, robots, spacing):
    side = int(np.ceil(np.sqrt(robots)))
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    places = (np.column_stack((x.ravel(), y.ravel()))[:robots] - (side - 1) / 2) * spacing
    return np.column_stack((places, rng.uniform(-np.pi, np.pi, robots)))


def boxes(rng):
    robots = [[box(*rng.uniform(0.4, 1.2, 2))] for _ in range(8)]
    return robots, [ring(3.2)], lattice(rng, 8, 1.4), False


def compound(rng):
    robots = [(ELL, ARROW, STAR)[k] for k in rng.integers(0, 3, 8)]
    return robots, [ring(3.4)], lattice(rng, 8, 1.6), False


def wall_ends(rng):
    """Short walls with free ends, corners and straight joints, and a solid obstacle."""
    walls = [ring(4.0), [[(-0.3, 1.4), (0.3, 1.4), (0.0, 2.0)]]]
    for _ in range(6):
        at, turn = rng.uniform(-3, 3, 2), rng.uniform(-np.pi, np.pi)
        along = np.array([np.cos(turn), np.sin(turn)])
        bend = at + 0.7 * along + 0.5 * np.array([-along[1], along[0]]) * rng.uniform(-1, 1)
        walls.append(segments([tuple(at - 0.6 * along), tuple(at), tuple(bend)]))
    robots = [[box(0.7, 0.4)] if k % 2 else ELL for k in range(6)]
    return robots, walls, lattice(rng, 6, 1.8), False


def abreast(rng):
    """Rows with one heading, one beside the other by 0 and by 1.5e-9 m.

    That is less than two skins of the engine's shapes and more than the contact tolerance, so it
    is a false contact at every step; a row behind the other by 0.2 m.
    """
    heading = rng.uniform(-np.pi, np.pi)
    along = np.array([np.cos(heading), np.sin(heading)])
    left = np.array([-along[1], along[0]])
    middle = rng.uniform(-30, 30, 2)
    beside = (-0.6 - 1.5e-9, 0.0, 0.6)
    places = [middle + 1.2 * i * along + y * left for i in range(3) for y in beside]
    start = np.column_stack((places, np.full(9, heading)))
    wall = [tuple(middle + 4 * along + 3 * left), tuple(middle + 4 * along - 3 * left)]
    return [[box()]] * 9, [[wall]], start, False


def apart(rng):
    """Two boxes with one heading, 0.2 m apart, at places where the engine errs by as much."""
    start = side_by_side(rng.choice(FALSE_CONTACTS), guarded=True).pose
    middle, heading = start[0, :2], start[0, 2]
    along = np.array([np.cos(heading), np.sin(heading)])
    left = np.array([-along[1], along[0]])
    wall = [tuple(middle + 20.5 * along + 3 * left), tuple(middle + 20.5 * along - 3 * left)]
    return [[box()]] * 2, [[wall]], start, False


def jam(rng):
    robots = [ELL if k % 3 == 0 else [box(0.6 + 0.02 * k, 0.4 + 0.01 * k)] for k in range(16)]
    return robots, [ring(4.5)], lattice(rng, 16, 1.5), True


KINDS = {one.__name__: one for one in (boxes, compound, wall_ends, abreast, apart, jam)}


def crowd(kind: str, seed: int) -> Crowd:
    rng = np.random.default_rng((sorted(KINDS).index(kind), seed))
    robots, walls, start, inwards = KINDS[kind](rng)
    held = rng.uniform((-1.0, -1.0), (1.0, 1.0), (40, len(start), 2))
    if kind == "abreast":  # straight on for a while, side by side, into the wall
        held[:6] = (0.9, 0.0)
    if kind == "apart":
        held[:] = (1.0, 0.0)
    friction, elasticity = ((0.0, 0.0), (0.4, 0.0), (0.3, 0.5))[seed % 3]
    return Crowd(robots, walls, start, held, inwards, friction, elasticity)


def told(physics: Physics) -> bytes:
    """Everything that a physics tells of its present sample."""
    return b"|".join(
        (
            str(physics.step_number).encode(),
            physics.pose.tobytes(),
            physics.contacts.tobytes(),
            physics.false_contacts.tobytes(),
            physics.touching.tobytes(),
        )
    )


def go_on(scene: Crowd, physics: Physics, until: int) -> list[bytes]:
    """Step to a sample; what is told from the present one on."""
    samples = [told(physics)]
    while physics.step_number < until:
        physics.step(scene.command(physics.step_number, physics.pose))
        samples.append(told(physics))
    return samples


def digest(samples: list[bytes]) -> str:
    return hashlib.sha256(b"||".join(samples)).hexdigest()


class Run(NamedTuple):
    """A run with its states."""

    samples: list[bytes]
    states: list[PhysicsState]


def run(kind: str, seed: int, steps: int, **more) -> Run:
    scene = crowd(kind, seed)
    physics = scene.physics(**more)
    samples, states = [told(physics)], [physics.state]
    for _ in range(steps):
        physics.step(scene.command(physics.step_number, physics.pose))
        samples.append(told(physics))
        states.append(physics.state)
    return Run(samples, states)


def worth_restoring(states: list[PhysicsState], rng, many: int) -> list[PhysicsState]:
    """The first, and some with contact just begun, under way, with a false one, and any."""
    groups = [
        [s for s in states if (s.contacts["phase"] == Phase.BEGAN).any()],
        [s for s in states if (s.contacts["phase"] == Phase.STAYS).any()],
        [s for s in states if len(s.false_contacts)],
        states,
    ]
    found = [states[0]]
    for k in range(many):
        group = groups[k % len(groups)]
        found += [group[rng.integers(len(group))]] if group else []
    return found
