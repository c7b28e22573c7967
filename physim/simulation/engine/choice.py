"""Which guard serves: the compiled one where this version of the engine allows it."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from physim.compiled import compiles
from physim.geometry.shapes import Shapes, joined_shapes, pack_parts
from physim.simulation.engine.guard import Guard, PlainGuard
from physim.simulation.engine.space import Hosted, build_space
from physim.tolerances import CONTACT

if TYPE_CHECKING:
    from physim.simulation.engine.native_guard import NativeGuard


def guard_of(hosted: Hosted, shapes: Shapes, *, checks: bool = True) -> Guard:
    """Attach a guard to a space; without ``checks`` one that lets every contact pass."""
    if checks and judges_natively():
        return native(hosted, shapes)
    return PlainGuard(hosted, shapes, checks=checks)


def native(hosted: Hosted, shapes: Shapes) -> NativeGuard:
    """Attach the compiled guard, whose module cannot be had with every version of the engine."""
    from physim.simulation.engine.native_guard import NativeGuard

    return NativeGuard(hosted, shapes)


@functools.cache
def judges_natively() -> bool:
    """Whether the compiled guard keeps out, lets through and turns contacts as it must.

    Tried out once a process. False where the engine's private members are missing or others.
    """
    try:
        from physim.simulation.engine.native_memory import layout_is_known

        return compiles() and layout_is_known() and _trial()
    except Exception:  # whatever a missing or changed private member brings about
        return False


BOX = [(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)]
CORNER = [[(0.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (2.0, 0.3)]]
"""two segments; a box at `BEHIND` leaves the first by the shorter way into the second"""
BEHIND = (1.15, 0.05, 0.0)
PLACES = np.array(
    [(5.0, 0, 0), (5.6 + 1.5 * CONTACT, 0, 0), (9.0, 0, 0), (9.6 - 1e-3, 0, 0), BEHIND]
)
"""two boxes that the engine takes to touch but are apart, two that touch, one in the corner"""


def _trial() -> bool:
    robots, walls = pack_parts([[BOX]] * len(PLACES)), pack_parts([CORNER])
    hosted = build_space(robots, walls, PLACES, np.ones(len(PLACES)), 0.0, 0.0)
    guard = native(hosted, joined_shapes(robots, walls))
    hosted.bodies[2].force = (7.0, 0.0)
    hosted.space.step(1.0)
    found, kept_out = guard.take(), guard.take_rejected()
    touching = [tuple(sorted(pair)) for pair in found.part.tolist()]
    if np.sort(kept_out).tolist() != [[0, 1]] or guard.rejected != 1 or guard.reported != 4:
        return False
    if sorted(touching) != [(2, 3), (4, 5), (4, 6)]:
        return False
    number = {shape._shape: part for part, shape in enumerate(hosted.parts)}
    for arbiter in hosted.space._get_arbiters():
        pair = tuple(sorted((number[arbiter.a], number[arbiter.b])))
        points = [arbiter.contacts[k] for k in range(arbiter.count)]
        if pair == (2, 3):
            size = np.hypot(
                sum(p.jnAcc * arbiter.n.x - p.jtAcc * arbiter.n.y for p in points),
                sum(p.jnAcc * arbiter.n.y + p.jtAcc * arbiter.n.x for p in points),
            )
            impulse = found.impulse[touching.index(pair)]
            if not (size > 1.0 and abs(impulse - size) <= 1e-12 * size):
                return False
        elif pair == (4, 5):  # along the normal of the segment, from where the box is deepest
            heights = sorted((abs(points[0].r1.y), abs(points[0].r2.y)))
            if abs(arbiter.n.x) > 0.0 or not np.allclose(heights, (0.0, 0.3), rtol=0.0, atol=1e-12):
                return False
    return True
