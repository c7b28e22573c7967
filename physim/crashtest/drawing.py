"""Draw cases by number: the same seed and number give the same case, whatever the others."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from physim.crashtest.case import Case, Layout
from physim.crashtest.footprints import Footprint, Store
from physim.crashtest.hazards import any_robot, corner, obstacle, wall, wall_end, wall_graze
from physim.crashtest.meetings import Origin, graze, in_row, pair, pick, side_by_side
from physim.geometry.separation import body_distance
from physim.geometry.shapes import FloatArray, pack_shapes
from physim.randomness import stream

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
    solid, still = pack_shapes(walls), np.zeros(3)
    return all(
        body_distance(robot, 0, start[0], solid, k, still) > CLEAR for k in range(len(walls))
    )
