"""Draw cases by number, pack them for engine and kernels, and write one as a world.

The same seed and number give the same case, whatever the others. A batch holds many cases of
one time step in one space, far apart. The world of a case is a small one that ``physim run``
replays, to the bit at the same coordinates.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin
from typing import NamedTuple

import numpy as np

from physim.analysis.crashtest.drafts import KINDS, STEPS, Draft, Layout, Store
from physim.geometry.separation import body_distance
from physim.geometry.shapes import FloatArray, IntArray, Shapes, pack_parts
from physim.randomness import stream
from physim.world import World
from physim.world.scene import DENSITY

TIME_STEPS = (0.005, 0.01, 0.02, 0.05, 0.1)
"""[s]"""
CLEAR = 1e-8
"""[m] least distance at the start: a world with less is refused as touching"""
TRIES = 50
"""Layouts tried; the last resort is a robot pair far enough apart"""
SPACING = 60.0
"""[m] between the places of two cases: twice what any of them can reach"""
HALF_WIDTH = 29.0
"""[m] from the middle of the place to the boundary that closes it"""
LEAST = 1e-6
"""[m/s, rad/s] least limit of a robot that does not use it"""

Place = tuple[float, float]
Walls = tuple[Sequence[FloatArray], ...]
"""Convex parts or segments of each line and each solid"""


class Case(NamedTuple):
    """A layout with its number, by which it can be drawn again."""

    number: int
    kind: str
    dt: float
    """[s]"""
    origin: Place
    """[m] middle of the place where it happens"""
    layout: Layout
    walls: Walls


def draw_case(seed: int, number: int, origin: Place, store: Store) -> Case:
    """Draw one case: kind and time step follow from its number, all else from its stream."""
    kind = tuple(KINDS)[number % len(KINDS)]
    dt = TIME_STEPS[number // len(KINDS) % len(TIME_STEPS)]
    draft = Draft(stream(seed, "crash test", number), origin, dt, store)
    for _ in range(TRIES):
        layout = KINDS[kind](draft)
        lines = (tuple(line[k : k + 2] for k in range(len(line) - 1)) for line in layout.lines)
        walls = (*lines, *(parts for _, *parts in layout.solids))
        if _is_clear(layout, walls):
            return Case(number, kind, dt, origin, layout, walls)
    return Case(number, kind, dt, origin, draft.aligned(across=True), ())


def _is_clear(layout: Layout, walls: Walls) -> bool:
    """Whether nothing touches at the start, as a world must have it."""
    start, robot = layout.start, layout.robots[0].packed
    if len(start) == 2:
        other = layout.robots[1].packed
        return bool(body_distance(robot, 0, start[0], other, 0, start[1]) > CLEAR)
    solid, still = pack_parts(walls), np.zeros(3)
    return all(
        body_distance(robot, 0, start[0], solid, k, still) > CLEAR for k in range(len(walls))
    )


class Packed(NamedTuple):
    """M cases of one time step with N robots in all, for the kernels."""

    shapes: Shapes
    """of the N robots"""
    walls: Shapes
    """of all cases, world frame"""
    start: FloatArray
    """(N, 3)"""
    command: FloatArray
    """(N, 2)"""
    mass: FloatArray
    """(N,) [kg]"""
    first_robot: IntArray
    """(M + 1,) case k has the robots from first_robot[k] to first_robot[k + 1] - 1"""
    first_wall: IntArray
    """(M + 1,) likewise of the bodies of ``walls``"""
    dt: float
    """[s]"""


def pack(dt: float, cases: tuple[Case, ...]) -> Packed:
    """Pack cases of one time step."""
    layouts = [case.layout for case in cases]
    robots = [robot for one in layouts for robot in one.robots]
    first_robot, first_wall = (
        np.concatenate(([0], np.cumsum([len(one) for one in some]))).astype(np.int64)
        for some in ([one.robots for one in layouts], [case.walls for case in cases])
    )
    return Packed(
        pack_parts([robot.parts for robot in robots]),
        pack_parts([parts for case in cases for parts in case.walls]),
        np.concatenate([one.start for one in layouts]),
        np.concatenate([one.command for one in layouts]),
        np.array([DENSITY * robot.area for robot in robots]), first_robot, first_wall, dt,
    )  # fmt: skip


def place_of(index: int) -> Place:
    """Middle of the place of a case [m]: a spiral of squares about the origin."""
    ring = int((np.sqrt(index) + 1.0) / 2.0)
    along = index - (2 * ring - 1) ** 2 if ring else 0
    side, offset = divmod(along, 2 * ring) if ring else (0, 0)
    far, near = ring, offset - ring
    x, y = ((far, near), (-near, far), (-far, -near), (near, -far))[side]
    return SPACING * x, SPACING * y


def case_world(case: Case, seed: int, reason: str) -> World:
    """World of a case; ``reason`` goes into its description."""
    layout = case.layout
    (x, y), commands = case.origin, layout.command.tolist()
    corners = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    ring = [(x + i * HALF_WIDTH, y + j * HALF_WIDTH) for i, j in corners]
    robots = []
    for k, (v, omega) in enumerate(commands):
        px, py, heading = layout.start[k].tolist()
        robots.append({
            "name": f"robot {k + 1}",
            "footprint": layout.robots[k].outline.tolist(),
            "pose": [px, py, heading],
            # a metre straight ahead: every robot needs a path, nobody follows it here
            "path": [(px, py), (px + cos(heading), py + sin(heading))],
            "limits": {"v": max(abs(v), LEAST), "omega": max(abs(omega), LEAST)},
        })  # fmt: skip
    return World(
        name=f"crash-{seed}-{case.number}",
        description=f"Crash test, seed {seed}, case {case.number} ({case.kind}): {reason}",
        seed=seed,
        time={"step": case.dt, "duration": round(STEPS * case.dt, 12)},
        boundaries=[*(line.tolist() for line in layout.lines), [*ring, ring[0]]],
        reference_path=[(x - 5.0, y - HALF_WIDTH + 1.0), (x + 5.0, y - HALF_WIDTH + 1.0)],
        robots=robots,
        controller={"type": "constant", "commands": commands},
        obstacles=[outline.tolist() for outline, *_ in layout.solids],
    )
