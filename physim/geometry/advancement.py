"""Collision time of two convex parts that turn: certified conservative advancement.

At each time the parts are apart by a gap along some axis. How far either part can come along this
axis in a further time is bounded, the bound says how long the gap lasts, and time goes on by that
much. So no contact is ever stepped over: at every earlier instant the parts are apart.

Along an axis that stands still the height of a vertex of Q above a vertex of P changes at a rate
that is known exactly, and this rate at most by the accelerations: speed times turning of both
reference points, spin^2 radius of both bodies for their vertices. So ``h + h' t - bend t^2 / 2`` is
below the height at all times, and the gap lasts until the first of these parabolas has come down by
the gap (`axis_step`).

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
from physim.geometry.convex import (
    Faces,
    Frame,
    before,
    by_outline,
    edge_normal,
    frame_at,
    outline_witness,
    part_faces,
    support_gap,
)
from physim.geometry.motion import Course, along_course
from physim.geometry.shapes import Part
from physim.tolerances import CONTACT

MARGIN = 0.25
"""[-] Share of min(gap, CONTACT) that an advance leaves, far above rounding."""

MOST_STEPS = 2000
"""Advances after which the time reached is returned: a lower bound of the collision time."""

# How two parts lie to each other


class Relative(NamedTuple):
    """Body b seen from body a at one time."""

    f: Frame
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
    f = r.f
    return Relative(
        frame_at(f.c, -f.s, -(f.c * f.tx + f.s * f.ty), -(f.c * f.ty - f.s * f.tx)),
        -(f.c * r.vx + f.s * r.vy), -(f.c * r.vy - f.s * r.vx),
        r.other_spin, r.spin, r.pull, r.speed, radius,
    )  # fmt: skip


class Look(NamedTuple):
    """How two parts lie to each other at one time, and what is needed to go on from there."""

    distance: float
    """[m] signed"""
    gap: float
    """[m] along the axis; never more than the distance but by rounding"""
    nx: float
    """axis from P to Q, in P's frame"""
    ny: float
    face: int
    """1: the axis is the normal of an edge of P, 2: of Q, 0: of neither"""
    edge: int
    """that edge"""
    seen: Relative
    """Q seen from P"""


@compiled
def face_normal(P: Part, Q: Part, f: Frame, faces: Faces) -> tuple[float, float]:
    """Return the unit normal of the edge that `part_faces` found, from P to Q, in P's frame."""
    if faces.edge < 0:
        return 1.0, 0.0
    if faces.of_q:
        nx, ny, _ = edge_normal(Q, before(Q, faces.edge), faces.edge)
        nx, ny = -nx, -ny
        return f.c * nx - f.s * ny, f.s * nx + f.c * ny
    nx, ny, _ = edge_normal(P, before(P, faces.edge), faces.edge)
    return nx, ny


@compiled
def look_at(P: Part, a: Course, Q: Part, b: Course, t: float) -> Look:
    """Distance of part P on course a and part Q on course b at time t [s], and the best axis."""
    ax, ay, ac, az, avx, avy = along_course(a, t)
    bx, by, bc, bz, bvx, bvy = along_course(b, t)
    f = frame_at(
        ac * bc + az * bz,
        ac * bz - az * bc,
        ac * (bx - ax) + az * (by - ay),
        ac * (by - ay) - az * (bx - ax),
    )
    faces = part_faces(P, Q, f, np.inf)
    gap, edge = faces.gap, faces.edge
    nx, ny = face_normal(P, Q, f, faces)
    face = 2 if faces.of_q else 1
    if edge < 0:
        face = 0
    d, outline, ox, oy = gap, False, 0.0, 0.0
    if not faces.settled:
        distance, _, _, ox, oy = outline_witness(P, Q, f)
        d, outline = by_outline(gap, distance, f)
    if outline and d > 0.0:
        size = math.sqrt(ox * ox + oy * oy)
        ox /= size
        oy /= size
        wide = support_gap(P, Q, f, ox, oy)
        # Rounding can spoil the direction between two close points: then keep the normal.
        if wide > gap:
            nx, ny, gap = ox, oy, wide
            face = 0
    # Velocities in P's frame.
    avx, avy = ac * avx + az * avy, ac * avy - az * avx
    bvx, bvy = ac * bvx + az * bvy, ac * bvy - az * bvx
    pull = a.speed * abs(a.turn) + b.speed * abs(b.turn)
    seen = Relative(f, bvx - avx, bvy - avy, a.spin, b.spin, pull, a.speed + b.speed, b.radius)
    return Look(d, gap, nx, ny, face, edge, seen)


# An axis that stands still


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
def axis_step(P: Part, a: Course, Q: Part, b: Course, look: Look, room: float) -> float:
    """Return a time [s] for which the gap along the axis falls by no more than ``room`` [m]."""
    V, W, f, nx, ny = P.vertices, Q.vertices, look.seen.f, look.nx, look.ny
    ux, uy = f.c * nx + f.s * ny, f.c * ny - f.s * nx
    rate = nx * look.seen.vx + ny * look.seen.vy
    if a.spin == 0.0 and b.spin == 0.0:
        return lasting(room, rate, look.seen.pull)
    bend = look.seen.pull + a.spin * a.spin * a.radius + b.spin * b.spin * b.radius
    top, low = -np.inf, np.inf
    for k in range(P.first, P.end):
        top = max(top, nx * V[k, 0] + ny * V[k, 1])
    for j in range(Q.first, Q.end):
        low = min(low, ux * W[j, 0] + uy * W[j, 1])
    # All vertices of a part that does not turn move alike: the foremost of them stands for all.
    last_p = P.end if a.spin != 0.0 else P.first + 1
    last_q = Q.end if b.spin != 0.0 else Q.first + 1
    best = np.inf
    for k in range(P.first, last_p):
        below, rise = 0.0, rate
        if a.spin != 0.0:
            below = top - (nx * V[k, 0] + ny * V[k, 1])
            rise -= a.spin * (ny * V[k, 0] - nx * V[k, 1])
        for j in range(Q.first, last_q):
            above_low, its = 0.0, 0.0
            if b.spin != 0.0:
                above_low = ux * W[j, 0] + uy * W[j, 1] - low
                its = b.spin * (uy * W[j, 0] - ux * W[j, 1])
            best = min(best, lasting(room + below + above_low, rise + its, bend))
    # Turning never takes a vertex out of the body's disc.
    discs, speed = room, look.seen.speed
    if a.spin != 0.0:
        discs -= a.radius - top
    if b.spin != 0.0:
        discs -= b.radius + low
    if discs > 0.0:
        return max(best, discs / speed) if speed > 0.0 else np.inf
    return best


# An axis that turns with an edge


class Height(NamedTuple):
    """Of a vertex above an edge."""

    height: float
    """[m]"""
    rate: float
    """[m/s] how fast it grows"""
    reach: float
    """[m] of it from P's reference point; of its body's reference point, if that turns"""


@compiled
def above(P: Part, m: int, nx: float, ny: float, Q: Part, j: int, r: Relative) -> Height:
    """Height of vertex j of Q above vertex m of P along (nx, ny), all seen from P."""
    f, V, W = r.f, P.vertices, Q.vertices
    ox = f.c * W[j, 0] - f.s * W[j, 1]
    oy = f.s * W[j, 0] + f.c * W[j, 1]
    x = ox + f.tx
    y = oy + f.ty
    vx = r.vx - r.other_spin * oy + r.spin * y
    vy = r.vy + r.other_spin * ox - r.spin * x
    if r.other_spin == 0.0:
        reach = math.sqrt(x * x + y * y)
    else:
        reach = math.sqrt(f.tx * f.tx + f.ty * f.ty)
    h = nx * (ox + (f.tx - V[m, 0])) + ny * (oy + (f.ty - V[m, 1]))
    return Height(h, nx * vx + ny * vy, reach)


@compiled
def face_step(P: Part, m: int, Q: Part, r: Relative, spare: float) -> float:
    """Return a time [s] for which the gap along the normal of edge m of P, which turns, lasts.

    The gap stays above what it is now less ``spare`` [m]. Half a turn of P is the most it looks
    ahead.
    """
    nx, ny, _ = edge_normal(P, before(P, m), m)
    low = np.inf
    for j in range(Q.first, Q.end):
        low = min(low, above(P, m, nx, ny, Q, j, r).height)
    # First for the longest time, then for that of the time found.
    twist = r.other_spin - r.spin
    best = 0.0
    most = math.pi / abs(r.spin)
    for again in range(2):  # noqa: B007
        found = most
        for j in range(Q.first, Q.end):
            at = above(P, m, nx, ny, Q, j, r)
            reach = at.reach + r.speed * most
            bend = r.pull + (r.spin * r.spin * reach + 2.0 * abs(r.spin) * r.speed)
            if r.other_spin != 0.0:
                bend += twist * twist * r.radius
            found = min(found, lasting(at.height - low + spare, at.rate, bend))
        best = max(best, found)
        most = min(most, 3.0 * best)
    return best


# Advancement


@compiled
def advancement_time(
    P: Part, a: Course, Q: Part, b: Course, horizon: float
) -> tuple[float, float, int]:
    """Return (xi [s], distance then [m], advances) of part P on course a and part Q on course b.

    xi is inf when there is no contact up to ``horizon``. At every instant before xi the parts are
    apart; at xi they are within CONTACT, unless the advances are MOST_STEPS: then xi is a lower
    bound and the distance says how far they still are.
    """
    return fall_time(P, a, Q, b, 0.0, CONTACT, 0.0, horizon)


@compiled
def fall_time(
    P: Part,
    a: Course,
    Q: Part,
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
        look = look_at(P, a, Q, b, t)
        d = look.distance
        if d <= level + slack:
            return t, d, step
        room = look.gap - level
        room -= MARGIN * min(room, slack)
        if not room > 0.0:
            return t, d, MOST_STEPS
        rest = horizon - t
        stride = 0.0
        if look.face == 1 and a.spin != 0.0:
            stride = face_step(P, look.edge, Q, look.seen, room)
        elif look.face == 2 and b.spin != 0.0:
            stride = face_step(Q, look.edge, P, turned(look.seen, a.radius), room)
        if stride <= rest:
            stride = max(stride, axis_step(P, a, Q, b, look, room))
        t += stride
        if not t <= horizon:
            return np.inf, d, step + 1
    return t, d, MOST_STEPS
