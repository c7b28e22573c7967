"""Which robots stop within a step, so that no two bodies sink into each other?

The engine finds a contact where a step ends: by then two bodies are as deep in each other as they
closed in it, 45 cm of two robots head-on at 25 m/s each. And where pushes nearly cancel, in a wedge
of a few degrees, in a jam, between a heavy robot and a wall, its solver lets robots sink in a
little at every step. A step that would end deeper than `physim.contacts.allowed_depth` is done
again, and the bodies that are too deep go no farther than to where they touch, the earliest first.
They do so at their full velocities, for which the engine solves: the impulse is that of the impact.
What the engine adds to a step to ease overlaps is cut with it: in a jam that pushes robots into
others, for seconds on end up to 48 mm deep where only velocities were cut.

Steps that end less deep are left as they are, to the last bit. Shorter steps of the engine would
mend impacts, but nothing else (in a wedge of 2 degrees at 1 m/s robots sink in by 7.4 mm at 0.01 s
and by 7.2 mm at 0.0005 s), and contacts could begin and end between two samples. More rounds of the
solver (`space.rounds`) help there, with 20 of them it was 56 mm, but crowds cannot have them: jams
of 60 robots at 1 m/s are 54 mm deep without what is done here.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.bodies import body_distance
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.tolerances import SETTLED_DEPTH

NARROWINGS = 60
"""of a step, at most, to find when two bodies touch"""
EXACT = 1e-10
"""[m] to which the depth is found at which they stop"""
MOST_STOPS = 3
"""of a robot within a step, after which it stays where it began"""


@compiled
def cut_short(
    key: IntArray,
    shapes: Shapes,
    end: FloatArray,
    way: FloatArray,
    deepest: float,
    share: FloatArray,
) -> None:
    """Stop robots of the pairs ``key`` (K,) that come deeper than ``deepest`` [m].

    ``end`` (B, 3) are the poses of all bodies at the end of the whole step, robots first, and
    ``way`` (N, 3) how the robots come there from the sample before, easing included. Of that each
    goes ``share`` (N,), written here: 1, or up to where it touches another at the depth at which
    contacts settle, or no deeper than before. A pair that does not come deeper is let go. Robots
    stop one pair after the other, the earliest first, so that each of them is met by what moves on
    where it then stands; two that others stop while they pass each other, too deep, stop where they
    meet.
    """
    bodies, robots = len(end), len(way)
    stops = np.zeros(bodies, np.int64)
    stops[robots:] = 1
    share[:] = 1.0
    due = np.empty(len(key))  # when each pair stops; above 1: never
    for k in range(len(key)):
        due[k] = _time(key[k], 0.0, shapes, end, way, deepest, share, stops)
    now = 0.0
    while len(key):
        first = np.argmin(due)
        if due[first] > 1.0:
            return
        now = max(now, due[first])
        a, b = key[first] // bodies, key[first] % bodies
        for i in (a, b):
            if i < robots:
                share[i] = 0.0 if stops[i] >= MOST_STOPS else min(share[i], due[first])
                stops[i] += 1
        for k in range(len(key)):
            c, d = key[k] // bodies, key[k] % bodies
            if c == a or d == a or (b < robots and (c == b or d == b)):
                due[k] = _time(key[k], now, shapes, end, way, deepest, share, stops)


@compiled
def _time(
    key: int,
    now: float,
    shapes: Shapes,
    end: FloatArray,
    way: FloatArray,
    deepest: float,
    share: FloatArray,
    stops: IntArray,
) -> float:
    """Share of the step, from ``now`` on, at which a pair stops; 2 where it goes on to the end."""
    a, b = key // len(end), key % len(end)
    after = _depth(a, b, 1.0, shapes, end, way, share)
    if after <= deepest:
        return 2.0
    before = _depth(a, b, 0.0, shapes, end, way, share)
    if after <= before:
        return 2.0
    least = max(before, SETTLED_DEPTH)
    low, high = 0.0 if stops[a] and stops[b] else now, 1.0
    lower = _depth(a, b, low, shapes, end, way, share) - least
    if lower > 0.0:
        return low
    # Regula falsi in the form called Illinois: along a way the depth is nearly linear.
    upper, weight = after - least, 0
    for _ in range(NARROWINGS):
        middle = (low * upper - high * lower) / (upper - lower)
        beyond = _depth(a, b, middle, shapes, end, way, share) - least
        if abs(beyond) <= EXACT:
            return middle
        if beyond > 0.0:
            high, upper = middle, beyond
            lower *= 0.5 if weight > 0 else 1.0
            weight = 1
        else:
            low, lower = middle, beyond
            upper *= 0.5 if weight < 0 else 1.0
            weight = -1
    return high


@compiled
def _depth(
    a: int, b: int, time: float, shapes: Shapes, end: FloatArray, way: FloatArray, share: FloatArray
) -> float:
    """Depth [m] of a pair after a share ``time`` of the step, each no farther than it goes."""
    at = np.empty((2, 3))
    for row, i in enumerate((a, b)):
        gone = min(time, share[i]) if i < len(way) else 1.0
        for k in range(3):
            at[row, k] = end[i, k]
            if i < len(way):
                at[row, k] -= (1.0 - gone) * way[i, k]
    return -body_distance(shapes, a, at[0], shapes, b, at[1])
