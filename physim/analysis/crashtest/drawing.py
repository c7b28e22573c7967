"""Draw cases by number, pack them for engine and kernels, and write one as a world.

The same seed and number give the same case, whatever the others. A batch holds many cases of
one time step in one space, far apart. The world of a case is a small one that ``physim run``
replays, to the bit at the same coordinates.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from physim.analysis.crashtest.case import STEPS, Case, Footprint, Layout, Store
from physim.analysis.crashtest.layouts import (
    Origin,
    any_robot,
    corner,
    graze,
    in_row,
    obstacle,
    pair,
    pick,
    side_by_side,
    wall,
    wall_end,
    wall_graze,
)
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

Draw = Callable[[Generator, Origin, float, Store], Layout]


def _two(
    plan: Callable[[Generator, Origin, float, Footprint, Footprint], Layout],
    choose: Callable[[Generator, Store], Footprint],
) -> Draw:
    """Draw two footprints, and plan how they meet."""

    def draw(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
        a, b = choose(rng, store), choose(rng, store)
        return plan(rng, origin, dt, a, b)

    return draw


KINDS: dict[str, Draw] = {
    "convex": _two(pair, lambda rng, store: pick(rng, store.convex)),
    "nonconvex": _two(pair, lambda rng, store: pick(rng, store.nonconvex)),
    "mixed": _two(pair, any_robot),
    "side by side": side_by_side,
    "in a row": in_row,
    "graze": _two(graze, any_robot),
    "wall": wall,
    "corner": corner,
    "wall end": wall_end,
    "wall graze": wall_graze,
    "obstacle": obstacle,
}
"""What is drawn, in turn."""


def draw_case(seed: int, number: int, origin: Origin, store: Store) -> Case:
    """Draw one case: kind and time step follow from its number, all else from its stream."""
    names = tuple(KINDS)
    kind = names[number % len(names)]
    dt = TIME_STEPS[number // len(names) % len(TIME_STEPS)]
    rng = stream(seed, "crash test", number)
    for _ in range(TRIES):
        layout = KINDS[kind](rng, origin, dt, store)
        walls = _walls(layout)
        if _is_clear(layout, walls):
            return Case(number, kind, dt, origin, layout, walls)
    layout = side_by_side(rng, origin, dt, store)
    return Case(number, kind, dt, origin, layout, ())


def _walls(layout: Layout) -> tuple[tuple[FloatArray, ...], ...]:
    lines = tuple(tuple(line[k : k + 2] for k in range(len(line) - 1)) for line in layout.lines)
    return (*lines, *(solid.parts for solid in layout.solids))


def _is_clear(layout: Layout, walls: tuple[tuple[FloatArray, ...], ...]) -> bool:
    """Whether nothing touches at the start, as a world must have it."""
    start, robot = layout.start, layout.robots[0].packed
    if len(start) == 2:
        other = layout.robots[1].packed
        return bool(body_distance(robot, 0, start[0], other, 0, start[1]) > CLEAR)
    solid, still = pack_parts(walls), np.zeros(3)
    return all(
        body_distance(robot, 0, start[0], solid, k, still) > CLEAR for k in range(len(walls))
    )


SPACING = 60.0
"""[m] between the places of two cases: twice what any of them can reach"""


class Batch(NamedTuple):
    """M cases of one time step with N robots in all."""

    dt: float
    """[s]"""
    cases: tuple[Case, ...]
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


def place_of(index: int) -> tuple[float, float]:
    """Middle of the place of a case [m]: a spiral of squares about the origin."""
    ring = int((np.sqrt(index) + 1.0) / 2.0)
    along = index - (2 * ring - 1) ** 2 if ring else 0
    side, offset = divmod(along, 2 * ring) if ring else (0, 0)
    far, near = ring, offset - ring
    x, y = ((far, near), (-near, far), (-far, -near), (near, -far))[side]
    return SPACING * x, SPACING * y


def pack(dt: float, cases: tuple[Case, ...]) -> Batch:
    """Pack cases of one time step."""
    robots = [robot for case in cases for robot in case.layout.robots]
    return Batch(
        dt,
        cases,
        pack_parts([robot.parts for robot in robots]),
        pack_parts([parts for case in cases for parts in case.walls]),
        np.concatenate([case.layout.start for case in cases]),
        np.concatenate([case.layout.command for case in cases]),
        np.array([DENSITY * robot.area for robot in robots]),
        _firsts([len(case.layout.robots) for case in cases]),
        _firsts([len(case.walls) for case in cases]),
    )


def _firsts(lengths: list[int]) -> IntArray:
    return np.concatenate(([0], np.cumsum(lengths))).astype(np.int64)


HALF_WIDTH = 29.0
"""[m] from the middle of the place to the boundary that closes it"""
LEAST = 1e-6
"""[m/s, rad/s] least limit of a robot that does not use it"""


def case_world(case: Case, seed: int, reason: str) -> World:
    """World of a case; ``reason`` goes into its description."""
    layout = case.layout
    (x, y), commands = case.origin, layout.command.tolist()
    corners = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    ring = [(x + i * HALF_WIDTH, y + j * HALF_WIDTH) for i, j in corners]
    robots = [
        {
            "name": f"robot {k + 1}",
            "footprint": layout.robots[k].outline.tolist(),
            "pose": layout.start[k].tolist(),
            "path": _ahead(layout.start[k]),
            "limits": {"v": max(abs(v), LEAST), "omega": max(abs(omega), LEAST)},
        }
        for k, (v, omega) in enumerate(commands)
    ]
    return World(
        name=f"crash-{seed}-{case.number}",
        description=f"Crash test, seed {seed}, case {case.number} ({case.kind}): {reason}",
        seed=seed,
        time={"step": case.dt, "duration": round(STEPS * case.dt, 12)},
        boundaries=[*(line.tolist() for line in layout.lines), [*ring, ring[0]]],
        reference_path=[(x - 5.0, y - HALF_WIDTH + 1.0), (x + 5.0, y - HALF_WIDTH + 1.0)],
        robots=robots,
        controller={"type": "constant", "commands": commands},
        obstacles=[solid.outline.tolist() for solid in layout.solids],
    )


def _ahead(pose: FloatArray) -> list[tuple[float, float]]:
    """A path of a metre straight ahead: every robot needs one, nobody follows it here."""
    x, y, heading = pose.tolist()
    return [(x, y), (x + cos(heading), y + sin(heading))]
