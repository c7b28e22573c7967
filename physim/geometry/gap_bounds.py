"""How long a gap of two moving parts lasts, or an overlap: bounds that hold all that time.

Along an axis that stands still a body's reference point moves by
``a sin(k t)/k + b (1 - cos(k t))/k^2`` (a speed along the axis now, k turning rate, b acceleration
along the axis now), a vertex about it by ``x cos(w t) + r sin(w t)/w`` less x. With sin y <= y,
sin y >= y - y^3/6, 1 - y^2/2 <= cos y <= 1 these are below polynomials with coefficients >= 0 from
the second power on, so their sum and the maximum over the vertices, closing(t), are convex.
closing(0) <= 0, hence closing(T) <= gap bounds all times up to T, not only the start. The first
power is exact, so that steps shrink no faster than the gap closes (Newton-like near contact).

Such an axis sees the ends of a turning edge come and go faster than the edge itself does at the
vertex before it. So where the best axis is the normal of an edge of a body that turns, the axis
turns along. In the frame of that body a vertex q of the other part lies at ``h`` above the edge,
with ``h'`` known exactly, and ``|h''|`` is bounded by

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
from physim.geometry.motion import Course
from physim.geometry.shapes import FloatArray

LOOKS = 3
"""How often the advance is lengthened towards the root of closing(t) = gap."""


class Closing(NamedTuple):
    """Coefficients of the bound on how far two bodies close along an axis, but for the turning."""

    first: float
    second: float
    third: float


@compiled
def turning_reach(
    V: FloatArray, v0: int, v1: int, ux: float, uy: float, spin: float, top: float, t: float
) -> float:
    """Bound on how far a part, turning for time t, reaches along (ux, uy) beyond ``top``."""
    best = -np.inf
    square = 0.5 * (spin * t) * (spin * t)
    for k in range(v0, v1):
        x = ux * V[k, 0] + uy * V[k, 1]
        rate = spin * (uy * V[k, 0] - ux * V[k, 1])
        reach = x + t * rate
        if x < 0.0:
            reach -= square * x
        if rate < 0.0:
            reach -= square * t * rate / 3.0
        best = max(best, reach)
    return best - top


@compiled
def top_along(V: FloatArray, v0: int, v1: int, ux: float, uy: float) -> float:
    """Return how far a part reaches along (ux, uy) from the origin of its frame."""
    top = -np.inf
    for k in range(v0, v1):
        top = max(top, ux * V[k, 0] + uy * V[k, 1])
    return top


@compiled
def travel(ax: float, ay: float, vx: float, vy: float, turn: float) -> Closing:
    """Bound on the travel along the axis (ax, ay) of a point of velocity v that turns."""
    along = ax * vx + ay * vy
    bend = turn * (ay * vx - ax * vy)
    return Closing(along, 0.5 * max(0.0, bend), max(0.0, -along) * turn * turn / 6.0)


@compiled
def certified_step(
    P: FloatArray,
    p0: int,
    p1: int,
    a: Course,
    Q: FloatArray,
    q0: int,
    q1: int,
    b: Course,
    closing: Closing,
    nx: float,
    ny: float,
    ux: float,
    uy: float,
    gap: float,
    rest: float,
) -> float:
    """Return a time [s] for which the gap along n surely lasts (more than ``rest`` is enough).

    n is in P's frame, u the same direction in Q's.
    """
    top_a = top_along(P, p0, p1, nx, ny) if a.spin != 0.0 else 0.0
    top_b = top_along(Q, q0, q1, -ux, -uy) if b.spin != 0.0 else 0.0
    speed = a.speed + b.speed
    low = gap / (speed + abs(a.spin) * a.radius + abs(b.spin) * b.radius)
    # Turning never takes a vertex out of the body's disc.
    discs = gap
    if a.spin != 0.0:
        discs -= a.radius - top_a
    if b.spin != 0.0:
        discs -= b.radius - top_b
    if discs > 0.0:
        low = max(low, discs / speed)
    at_low = 0.0
    high = low
    for look in range(64):
        value = (closing.first + (closing.second + closing.third * high) * high) * high
        if a.spin != 0.0:
            value += turning_reach(P, p0, p1, nx, ny, a.spin, top_a, high)
        if b.spin != 0.0:
            value += turning_reach(Q, q0, q1, -ux, -uy, b.spin, top_b, high)
        if value > gap:
            if look == 0:
                return low
            return lengthen(
                P,
                p0,
                p1,
                a,
                Q,
                q0,
                q1,
                b,
                closing,
                nx,
                ny,
                ux,
                uy,
                gap,
                low,
                at_low,
                high,
                value,
                top_a,
                top_b,
            )
        low = high
        at_low = value
        if low > rest:
            return low
        high = 2.0 * low
    return low


@compiled
def lengthen(
    P: FloatArray,
    p0: int,
    p1: int,
    a: Course,
    Q: FloatArray,
    q0: int,
    q1: int,
    b: Course,
    closing: Closing,
    nx: float,
    ny: float,
    ux: float,
    uy: float,
    gap: float,
    low: float,
    at_low: float,
    high: float,
    at_high: float,
    top_a: float,
    top_b: float,
) -> float:
    """Move ``low`` along chords, which lie above the convex curve, towards closing = gap."""
    for _ in range(LOOKS):
        t = low + (high - low) * (gap - at_low) / (at_high - at_low)
        value = (closing.first + (closing.second + closing.third * t) * t) * t
        if a.spin != 0.0:
            value += turning_reach(P, p0, p1, nx, ny, a.spin, top_a, t)
        if b.spin != 0.0:
            value += turning_reach(Q, q0, q1, -ux, -uy, b.spin, top_b, t)
        if not value <= gap:
            return low
        low = t
        at_low = value
        if gap - value < 0.05 * gap:
            return low
    return low


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
