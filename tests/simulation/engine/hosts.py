"""Small scenes for the tests of the physics."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from physim.geometry import Shapes
from physim.simulation.engine import Physics
from tests.helpers import inside

body_distance, pack_parts = inside("physim.geometry", "body_distance", "pack_parts")

FAR = [[(-900.0, -900.0), (-900.0, -901.0)]]
"""a wall that nothing reaches"""

ELL = [
    [(-0.5, -0.3), (0.5, -0.3), (0.5, 0.0), (-0.5, 0.0)],
    [(-0.5, 0.0), (-0.2, 0.0), (-0.2, 0.5), (-0.5, 0.5)],
]
"""an L: base along x, arm up at the left"""


def box(length=1.0, width=0.6, x=0.0, y=0.0):
    a, b = length / 2, width / 2
    return [(x - a, y - b), (x + a, y - b), (x + a, y + b), (x - a, y + b)]


def segments(points):
    return [list(pair) for pair in pairwise(points)]


def host(start, robots=None, walls=(FAR,), dt=0.05, mass=10.0, **more):
    start = np.atleast_2d(np.array(start, dtype=float))
    shapes = pack_parts(robots if robots is not None else [[box()]] * len(start))
    weights = np.broadcast_to(np.asarray(mass, dtype=float), len(start))
    return Physics(shapes, pack_parts(list(walls)), start, weights, dt, **more)


FALSE_CONTACTS = (35, 140, 171, 286, 421, 426, 603, 648, 708, 827, 906)
"""seeds of `side_by_side` at which the engine reports a false contact within 400 steps"""


def side_by_side(seed, guarded):
    """Two boxes with one heading, 0.2 m apart."""
    rng = np.random.default_rng(seed)
    heading = rng.uniform(-np.pi, np.pi)
    left = np.array([-np.sin(heading), np.cos(heading)])
    place = rng.uniform(-50, 50, 2)
    start = [[*place, heading], [*(place + 0.8 * left), heading]]
    return host(start, _guarded=guarded)


def drive(physics, command, steps):
    """Hold one command; poses (steps + 1, N, 3) and the contact rows of every sample."""
    command = np.atleast_2d(np.array(command, dtype=float))
    poses, rows = [physics.pose], [physics.contacts]
    for _ in range(steps):
        physics.step(command)
        poses.append(physics.pose)
        rows.append(physics.contacts)
    return np.array(poses), rows


def distances(robots: Shapes, walls: Shapes, pose):
    """Signed distance of every pair of bodies, by body ids."""
    n, still = len(pose), np.zeros(3)
    found = {}
    for a in range(n):
        for b in range(a + 1, n):
            found[a, b] = body_distance(robots, a, pose[a], robots, b, pose[b])
        for w in range(len(walls.body_start) - 1):
            found[a, n + w] = body_distance(robots, a, pose[a], walls, w, still)
    return found


def pairs_in(rows):
    """Pairs of bodies that touch according to the rows of one sample."""
    return {(int(r["a"]), int(r["b"])) for r in rows if r["phase"] != 2}


def deepest(rows):
    """Greatest depth [m] in the rows of some samples."""
    return max((float(r["depth"].max()) for r in rows if len(r)), default=0.0)
