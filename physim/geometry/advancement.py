"""Collision time of two convex parts that turn: certified conservative advancement.

At each time the parts are apart by a gap along some axis. How far either part can come along this
axis in a further time is bounded, the bound says how long the gap lasts, and time goes on by that
much. So no contact is ever stepped over: at every earlier instant the parts are apart.

The bounds, along an axis that stands still and along the normal of an edge of a body that turns,
are in `face_bound`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.convex import by_outline, part_faces, support_gap
from physim.geometry.gap_bounds import (
    Closing,
    Relative,
    certified_step,
    face_step,
    travel,
    turned,
)
from physim.geometry.motion import Course, along_course
from physim.geometry.shapes import FloatArray
from physim.geometry.witness import outline_witness
from physim.tolerances import CONTACT

MARGIN = 0.25
"""[-] Share of min(gap, CONTACT) that an advance leaves, far above rounding."""

MOST_STEPS = 2000
"""Advances after which the time reached is returned: a lower bound of the collision time."""


class Look(NamedTuple):
    """How two parts lie to each other at one time, and what is needed to go on from there."""

    distance: float
    """[m] signed"""
    gap: float
    """[m] along the axis; never more than the distance but by rounding"""
    nx: float
    """axis from P to Q, in P's frame"""
    ny: float
    ux: float
    """the same in Q's frame"""
    uy: float
    closing: Closing
    face: int
    """1: the axis is the normal of an edge of P, 2: of Q, 0: of neither"""
    edge: int
    """that edge, by its last vertex"""
    seen: Relative
    """Q seen from P"""


@compiled
def face_normal(
    P: FloatArray,
    p0: int,
    p1: int,
    Q: FloatArray,
    q0: int,
    q1: int,
    c: float,
    s: float,
    of_q: bool,
    edge: int,
) -> tuple[float, float]:
    """Return the unit normal of the edge that `part_faces` found, from P to Q, in P's frame."""
    if edge < 0:
        return 1.0, 0.0
    if of_q:
        k = edge - 1 if edge > q0 else q1 - 1
        ex = Q[edge, 0] - Q[k, 0]
        ey = Q[edge, 1] - Q[k, 1]
        size = math.sqrt(ex * ex + ey * ey)
        nx = -ey / size
        ny = ex / size
        return c * nx - s * ny, s * nx + c * ny
    k = edge - 1 if edge > p0 else p1 - 1
    ex = P[edge, 0] - P[k, 0]
    ey = P[edge, 1] - P[k, 1]
    size = math.sqrt(ex * ex + ey * ey)
    return ey / size, -ex / size


@compiled
def look_at(
    P: FloatArray,
    p0: int,
    p1: int,
    a: Course,
    Q: FloatArray,
    q0: int,
    q1: int,
    b: Course,
    t: float,
) -> Look:
    """Distance of part P on course a and part Q on course b at time t [s], and the best axis."""
    ax, ay, ac, az, avx, avy = along_course(a, t)
    bx, by, bc, bz, bvx, bvy = along_course(b, t)
    c = ac * bc + az * bz
    s = ac * bz - az * bc
    tx = ac * (bx - ax) + az * (by - ay)
    ty = ac * (by - ay) - az * (bx - ax)
    gap, of_q, edge, settled = part_faces(P, p0, p1, Q, q0, q1, c, s, tx, ty, 0.0, 0.0, np.inf)
    nx, ny = face_normal(P, p0, p1, Q, q0, q1, c, s, of_q, edge)
    face = 2 if of_q else 1
    if edge < 0:
        face = 0
    d, outline, ox, oy = gap, False, 0.0, 0.0
    if not settled:
        distance, _, _, ox, oy = outline_witness(P, p0, p1, Q, q0, q1, c, s, tx, ty, 0.0, 0.0)
        d, outline = by_outline(gap, distance, abs(tx) + abs(ty))
    if outline and d > 0.0:
        size = math.sqrt(ox * ox + oy * oy)
        ox /= size
        oy /= size
        wide = support_gap(P, p0, p1, Q, q0, q1, c, s, tx, ty, 0.0, 0.0, ox, oy)
        # Rounding can spoil the direction between two close points: then keep the normal.
        if wide > gap:
            nx, ny, gap = ox, oy, wide
            face = 0
    # Velocities in P's frame.
    avx, avy = ac * avx + az * avy, ac * avy - az * avx
    bvx, bvy = ac * bvx + az * bvy, ac * bvy - az * bvx
    one = travel(nx, ny, avx, avy, a.turn)
    two = travel(-nx, -ny, bvx, bvy, b.turn)
    closing = Closing(one.first + two.first, one.second + two.second, one.third + two.third)
    pull = a.speed * abs(a.turn) + b.speed * abs(b.turn)
    seen = Relative(
        c, s, tx, ty, bvx - avx, bvy - avy, a.spin, b.spin, pull, a.speed + b.speed, b.radius
    )
    return Look(
        d, gap, nx, ny, c * nx + s * ny, c * ny - s * nx, closing, face, edge, seen
    )  # fmt: skip


@compiled
def advancement_time(
    P: FloatArray,
    p0: int,
    p1: int,
    a: Course,
    Q: FloatArray,
    q0: int,
    q1: int,
    b: Course,
    horizon: float,
) -> tuple[float, float, int]:
    """Return (xi [s], distance then [m], advances) of part P on course a and part Q on course b.

    xi is inf when there is no contact up to ``horizon``. At every instant before xi the parts are
    apart; at xi they are within CONTACT, unless the advances are MOST_STEPS: then xi is a lower
    bound and the distance says how far they still are.
    """
    return fall_time(P, p0, p1, a, Q, q0, q1, b, 0.0, CONTACT, 0.0, horizon)


@compiled
def fall_time(
    P: FloatArray,
    p0: int,
    p1: int,
    a: Course,
    Q: FloatArray,
    q0: int,
    q1: int,
    b: Course,
    level: float,
    slack: float,
    start: float,
    horizon: float,
) -> tuple[float, float, int]:
    """Return (t [s], signed distance then [m], advances): when the distance falls to ``level``.

    From ``start`` to t the signed distance is above ``level`` [m], which may be negative; at t it
    is at most level + slack, unless the advances are MOST_STEPS: then t is a lower bound. t is inf
    when this does not happen up to ``horizon``.

    The signed distance is the largest gap over all axes, also where the parts overlap, so that the
    gap along any one of them is a lower bound.
    """
    t = start
    d = np.inf
    for step in range(MOST_STEPS):
        look = look_at(P, p0, p1, a, Q, q0, q1, b, t)
        d = look.distance
        if d <= level + slack:
            return t, d, step
        room = look.gap - level
        room -= MARGIN * min(room, slack)
        if not room > 0.0:
            return t, d, MOST_STEPS
        rest = horizon - t
        stride = 0.0
        seen = look.seen
        V, v0, v1, W, w0, w1 = P, p0, p1, Q, q0, q1
        if look.face == 2:
            seen = turned(seen, a.radius)
            V, v0, v1, W, w0, w1 = Q, q0, q1, P, p0, p1
        if look.face != 0 and seen.spin != 0.0:
            stride = face_step(V, v0, v1, look.edge, W, w0, w1, seen, room)
        if stride <= rest:
            fixed = certified_step(
                P, p0, p1, a, Q, q0, q1, b, look.closing,
                look.nx, look.ny, look.ux, look.uy, room, rest,
            )  # fmt: skip
            stride = max(stride, fixed)
        t += stride
        if not t <= horizon:
            return np.inf, d, step + 1
    return t, d, MOST_STEPS
