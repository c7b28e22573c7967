"""Draw cases by number: the same seed and number give the same case, whatever the others."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from physim.crashtest import hazards, meetings
from physim.crashtest.case import Case, Layout
from physim.crashtest.footprints import Store
from physim.geometry.separation import body_distance
from physim.geometry.shapes import FloatArray, pack_shapes
from physim.randomness import stream

TIME_STEPS = (0.005, 0.01, 0.02, 0.05, 0.1)
"""[s]"""
CLEAR = 1e-8
"""[m] least distance at the start: a world with less is refused as touching"""
TRIES = 50
"""Layouts tried; the last resort is a robot pair far enough apart"""

Origin = tuple[float, float]
Draw = Callable[[Generator, Origin, float, Store], Layout]


def _convex(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
    a, b = (meetings.pick(rng, store.convex) for _ in range(2))
    return meetings.pair(rng, origin, dt, a, b)


def _nonconvex(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
    a, b = (meetings.pick(rng, store.nonconvex) for _ in range(2))
    return meetings.pair(rng, origin, dt, a, b)


def _mixed(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
    a, b = (hazards.any_robot(rng, store) for _ in range(2))
    return meetings.pair(rng, origin, dt, a, b)


def _graze(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
    a, b = (hazards.any_robot(rng, store) for _ in range(2))
    return meetings.graze(rng, origin, dt, a, b)


KINDS: dict[str, Draw] = {
    "convex": _convex,
    "nonconvex": _nonconvex,
    "mixed": _mixed,
    "side by side": meetings.side_by_side,
    "in a row": meetings.in_row,
    "graze": _graze,
    "wall": hazards.wall,
    "corner": hazards.corner,
    "wall end": hazards.wall_end,
    "wall graze": hazards.wall_graze,
    "obstacle": hazards.obstacle,
}
"""What is thrown, in turn."""


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
    layout = meetings.side_by_side(rng, origin, dt, store)
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
