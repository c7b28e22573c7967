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
solver (`host.ALL_ROUNDS`) help there, with 20 of them it was 56 mm, but crowds cannot have them:
jams of 60 robots at 1 m/s are 54 mm deep without what is done here.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.bodies import body_distance
from physim.geometry.shapes import Flags, FloatArray, IntArray, Rows3, Shapes
from physim.tolerances import SETTLED_DEPTH

NARROWINGS = 60
"""of a step, at most, to find when two bodies touch"""
EXACT = 1e-10
"""[m] to which the depth is found at which they stop"""
MOST_STOPS = 3
"""of a robot within a step, after which it stays where it began"""


class Moves(NamedTuple):
    """How bodies move in a step."""

    shapes: Shapes
    """of robots and walls"""
    end: Rows3
    """(B, 3) poses of all bodies at the end of the whole step, robots first"""
    way: Rows3
    """(N, 3) how the robots come there from the sample before, easing included"""
    share: FloatArray
    """(N,) of which each goes so much: 1, or up to where it stops"""
    goes_on: Flags
    """(N,) which of them go their whole way whatever they meet: movers"""
    robots: int
    bodies: int


@compiled
def cut_short(key: IntArray, pairs: int, moves: Moves, deepest: float) -> None:
    """Stop robots of so many ``pairs``, known by ``key``, that come deeper than ``deepest`` [m].

    Writes their ``share``: up to where they touch others at the depth at which contacts settle, or
    no deeper than before. A pair that does not come deeper is let go. Robots stop one pair after
    the other, the earliest first, so that each of them is met by what moves on where it then
    stands; two that others stop while they pass each other, too deep, stop where they meet.
    """
    share, bodies, robots = moves.share, moves.bodies, moves.robots
    stops = np.full(bodies, 1, np.int64)
    for i in range(robots):
        stops[i], share[i] = 1 if moves.goes_on[i] else 0, 1.0
    due = np.empty(pairs)  # when each pair stops; above 1: never
    for k in range(pairs):
        due[k] = stop_time(key[k], 0.0, moves, deepest, stops)
    now = 0.0
    while pairs > 0:
        first = 0
        for k in range(pairs):
            if due[k] < due[first]:
                first = k
        if due[first] > 1.0:
            return
        now = max(now, due[first])
        a, b = key[first] // bodies, key[first] % bodies
        for end in range(2):
            i = b if end else a
            if i < robots and not moves.goes_on[i]:
                share[i] = 0.0 if stops[i] >= MOST_STOPS else min(share[i], due[first])
                stops[i] += 1
        for k in range(pairs):
            c, d = key[k] // bodies, key[k] % bodies
            if c == a or d == a or (b < robots and (c == b or d == b)):
                due[k] = stop_time(key[k], now, moves, deepest, stops)


@compiled
def stop_time(key: int, now: float, moves: Moves, deepest: float, stops: IntArray) -> float:
    """Share of the step, from ``now`` on, at which a pair stops; 2 where it goes on to the end."""
    a, b = key // moves.bodies, key % moves.bodies
    has_mover = moves.goes_on[a] or (b < moves.robots and moves.goes_on[b])
    if has_mover and stops[a] and stops[b]:  # what can stop has stopped
        return 2.0
    after = depth(a, b, 1.0, moves)
    if after <= deepest:
        return 2.0
    before = depth(a, b, 0.0, moves)
    if after <= before:
        return 2.0
    least = max(before, SETTLED_DEPTH)
    low, high = 0.0 if has_mover or (stops[a] and stops[b]) else now, 1.0
    lower = depth(a, b, low, moves) - least
    if lower > 0.0:
        return low
    # Regula falsi in the form called Illinois: along a way the depth is nearly linear.
    upper, weight = after - least, 0
    for _ in range(NARROWINGS):
        middle = (low * upper - high * lower) / (upper - lower)
        beyond = depth(a, b, middle, moves) - least
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
def depth(a: int, b: int, time: float, moves: Moves) -> float:
    """Depth [m] of a pair after a share ``time`` of the step, each no farther than it goes.

    A mover is where it will be at the end: what meets it is to touch it there.
    """
    at = np.empty((2, 3))
    for row in range(2):
        i = b if row else a
        stands = i >= moves.robots or moves.goes_on[i]
        left = 0.0 if stands else 1.0 - min(time, moves.share[i])
        for k in range(3):
            at[row, k] = moves.end[i, k]
            if left > 0.0:
                at[row, k] -= left * moves.way[i, k]
    return -body_distance(moves.shapes, a, at[0], moves.shapes, b, at[1])
