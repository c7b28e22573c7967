"""Motion of a part seen from a face of a turning part: bounds on how long a gap or overlap lasts.

An axis that stands still in the world sees the ends of a turning edge come and go faster than the
edge itself does at the vertex before it. So where the best axis is the normal of an edge of a body
that turns, the axis turns along. In the frame of that body a vertex q of the other part lies at
``h`` above the edge, with ``h'`` known exactly, and ``|h''|`` is bounded by

    pull + 2 |spin| speed + spin^2 reach + (other spin - spin)^2 radius

(pull: accelerations of both reference points; speed: of these to each other; reach: how far apart
they may come; radius: of the other body), so that ``h + h' t -+ bend t^2 / 2`` are bounds. When
the other body does not turn, the last term goes and the reach is that of the vertex itself: walls
have vertices in the world frame and no radius.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray


class Relative(NamedTuple):
    """Body b seen from body a at one time: a point q of b is at R(c, s) q + (x, y)."""

    c: float
    s: float
    x: float
    y: float
    vx: float
    """[m/s] velocity of b's reference point less that of a's, in a's frame"""
    vy: float
    spin: float
    """[rad/s] of a"""
    other_spin: float
    pull: float
    """[m/s^2] bound on the accelerations of both reference points together"""
    speed: float
    """[m/s] both speeds together"""
    radius: float
    """[m] of b"""


@compiled
def turned(r: Relative, radius: float) -> Relative:
    """Body a, of that radius, seen from body b."""
    return Relative(
        r.c, -r.s,
        -(r.c * r.x + r.s * r.y), -(r.c * r.y - r.s * r.x),
        -(r.c * r.vx + r.s * r.vy), -(r.c * r.vy - r.s * r.vx),
        r.other_spin, r.spin, r.pull, r.speed, radius,
    )  # fmt: skip


@compiled
def above(
    P: FloatArray, m: int, nx: float, ny: float, Q: FloatArray, j: int, r: Relative
) -> tuple[float, float, float]:
    """Height [m] of vertex j of Q above vertex m of P along (nx, ny), its rate, and its reach.

    All is seen from P; the reach [m] goes into `bend`.
    """
    ox = r.c * Q[j, 0] - r.s * Q[j, 1]
    oy = r.s * Q[j, 0] + r.c * Q[j, 1]
    x = ox + r.x
    y = oy + r.y
    vx = r.vx - r.other_spin * oy + r.spin * y
    vy = r.vy + r.other_spin * ox - r.spin * x
    if r.other_spin == 0.0:
        reach = math.sqrt(x * x + y * y)
    else:
        reach = math.sqrt(r.x * r.x + r.y * r.y)
    h = nx * (ox + (r.x - P[m, 0])) + ny * (oy + (r.y - P[m, 1]))
    return h, nx * vx + ny * vy, reach


@compiled
def bend(r: Relative, reach: float, most: float) -> float:
    """Bound on |h''| [m/s^2] over a time ``most`` [s] of a vertex of that reach."""
    turning = r.spin * r.spin * (reach + r.speed * most) + 2.0 * abs(r.spin) * r.speed
    if r.other_spin == 0.0:
        return r.pull + turning
    twist = r.other_spin - r.spin
    return r.pull + turning + twist * twist * r.radius


@compiled
def lasting(room: float, rate: float, bend: float) -> float:
    """Time [s] up to which ``room + rate t - bend t^2 / 2`` is positive; room > 0, bend >= 0."""
    root = math.sqrt(rate * rate + 2.0 * bend * room)
    if rate < 0.0:
        return 2.0 * room / (root - rate)
    if bend == 0.0:
        return np.inf
    return (rate + root) / bend


@compiled
def face_step(
    P: FloatArray,
    p0: int,
    p1: int,
    m: int,
    Q: FloatArray,
    q0: int,
    q1: int,
    r: Relative,
    spare: float,
) -> float:
    """Return a time [s] for which the gap along the normal of an edge of P, which turns, lasts.

    The edge ends at vertex m. The gap stays above what it is now less ``spare`` [m]. Half a turn
    of P is the most it looks ahead.
    """
    k = m - 1 if m > p0 else p1 - 1
    ex = P[m, 0] - P[k, 0]
    ey = P[m, 1] - P[k, 1]
    size = math.sqrt(ex * ex + ey * ey)
    nx = ey / size
    ny = -ex / size
    low = np.inf
    for j in range(q0, q1):
        low = min(low, above(P, m, nx, ny, Q, j, r)[0])
    # First for the longest time, then for that of the time found.
    best = 0.0
    most = math.pi / abs(r.spin)
    for _ in range(2):
        found = most
        for j in range(q0, q1):
            h, rate, reach = above(P, m, nx, ny, Q, j, r)
            found = min(found, lasting(h - low + spare, rate, bend(r, reach, most)))
        best = max(best, found)
        most = min(most, 3.0 * best)
    return best
