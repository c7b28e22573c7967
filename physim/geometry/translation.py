"""Collision time of two convex parts that keep their headings: closed form.

As P sees it, part Q moves along a straight line. Along each separating axis the gap is linear in
time, so it says when the parts overlap on that axis; they touch while they overlap on all axes
(normals of both; for two segments or points, which those do not decide, their directions too).
"""

from __future__ import annotations

import math

import numpy as np

from physim.compiled import borrowing
from physim.geometry.convex import part_gap, support_gap
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT

PARALLEL = 1e-12
"""[-] Motion along an axis below this share of the speed is rounding: 1e-10 m over 100 m."""

Times = tuple[float, float, float, float]
"""[s] start and end of the overlap so far; the same for gaps of at most CONTACT"""


@borrowing
def clip(times: Times, gap: float, rate: float, least: float) -> Times:
    """Cut the times of overlap down to those with ``gap + rate * t <= 0`` (or <= CONTACT)."""
    first, last, near_first, near_last = times
    if abs(rate) <= least:
        if gap > 0.0:
            last = -np.inf
        if gap > CONTACT:
            near_last = -np.inf
    elif rate < 0.0:
        first = max(first, -gap / rate)
        near_first = max(near_first, (CONTACT - gap) / rate)
    else:
        last = min(last, -gap / rate)
        near_last = min(near_last, (CONTACT - gap) / rate)
    return first, last, near_first, near_last


@borrowing
def clip_normals(
    times: Times,
    P: FloatArray,
    p0: int,
    p1: int,
    Q: FloatArray,
    q0: int,
    q1: int,
    c: float,
    s: float,
    tx: float,
    ty: float,
    wx: float,
    wy: float,
    least: float,
) -> Times:
    """`clip` over the edge normals of P; (wx, wy) is the velocity of Q in the frame of P."""
    k = p1 - 1
    for m in range(p0, p1):
        ex = P[m, 0] - P[k, 0]
        ey = P[m, 1] - P[k, 1]
        length = math.sqrt(ex * ex + ey * ey)
        if length > 0.0:
            nx = ey / length
            ny = -ex / length
            ux = c * nx + s * ny
            uy = c * ny - s * nx
            low = np.inf
            for j in range(q0, q1):
                low = min(low, ux * Q[j, 0] + uy * Q[j, 1])
            gap = low + (nx * (tx - P[k, 0]) + ny * (ty - P[k, 1]))
            times = clip(times, gap, nx * wx + ny * wy, least)
            if times[3] < 0.0:
                return times
        k = m
    return times


@borrowing
def clip_directions(
    times: Times,
    P: FloatArray,
    p0: int,
    p1: int,
    Q: FloatArray,
    q0: int,
    q1: int,
    c: float,
    s: float,
    tx: float,
    ty: float,
    wx: float,
    wy: float,
    least: float,
) -> Times:
    """`clip` over the directions of two segments or points, of the motion, and across it."""
    px = P[p1 - 1, 0] - P[p0, 0]
    py = P[p1 - 1, 1] - P[p0, 1]
    qx = Q[q1 - 1, 0] - Q[q0, 0]
    qy = Q[q1 - 1, 1] - Q[q0, 1]
    axes = ((px, py), (c * qx - s * qy, s * qx + c * qy), (wx, wy), (-wy, wx))
    for ax, ay in axes:
        size = math.sqrt(ax * ax + ay * ay)
        if size > 0.0:
            for sign in (1.0, -1.0):
                nx = sign * ax / size
                ny = sign * ay / size
                gap = support_gap(P, p0, p1, Q, q0, q1, c, s, tx, ty, 0.0, 0.0, nx, ny)
                times = clip(times, gap, nx * wx + ny * wy, least)
    return times


@borrowing
def translation_times(
    P: FloatArray,
    p0: int,
    p1: int,
    Q: FloatArray,
    q0: int,
    q1: int,
    c: float,
    s: float,
    tx: float,
    ty: float,
    wx: float,
    wy: float,
    horizon: float,
) -> Times:
    """When P and Q overlap on all axes, Q at R(c, s) q + t + w time in the frame of P.

    Of times that do not come within [0, horizon] only that is sure: they do not.
    """
    least = PARALLEL * math.sqrt(wx * wx + wy * wy)
    times = (-np.inf, np.inf, -np.inf, np.inf)
    times = clip_normals(times, P, p0, p1, Q, q0, q1, c, s, tx, ty, wx, wy, least)
    if times[3] < 0.0 or times[2] > min(times[3], horizon):
        return times
    ux = -(c * wx + s * wy)
    uy = -(c * wy - s * wx)
    # The frame of P seen from Q: R' = (c, -s), t' = -R' t.
    ox = -(c * tx + s * ty)
    oy = -(c * ty - s * tx)
    times = clip_normals(times, Q, q0, q1, P, p0, p1, c, -s, ox, oy, ux, uy, least)
    if p1 - p0 <= 2 and q1 - q0 <= 2:
        times = clip_directions(times, P, p0, p1, Q, q0, q1, c, s, tx, ty, wx, wy, least)
    return times


@borrowing
def translation_time(
    P: FloatArray,
    p0: int,
    p1: int,
    Q: FloatArray,
    q0: int,
    q1: int,
    c: float,
    s: float,
    tx: float,
    ty: float,
    wx: float,
    wy: float,
    horizon: float,
) -> float:
    """Collision time [s] of P and Q, Q at R(c, s) q + t + w time in the frame of P; inf if none.

    0 when they are within CONTACT now. Where they graze within CONTACT it may say either.
    """
    first, last, near_first, near_last = translation_times(
        P, p0, p1, Q, q0, q1, c, s, tx, ty, wx, wy, horizon
    )  # fmt: skip
    if near_last < 0.0 or near_first > min(near_last, horizon):
        return np.inf
    if near_first <= 0.0 and (
        part_gap(P, p0, p1, Q, q0, q1, c, s, tx, ty, 0.0, 0.0, np.inf) <= CONTACT
    ):
        return 0.0
    xi = max(first, 0.0)
    if xi > horizon:
        return np.inf
    if xi <= last:
        return xi
    # A graze: the overlap is shorter than rounding, or a gap within CONTACT.
    x = tx + xi * wx
    y = ty + xi * wy
    if part_gap(P, p0, p1, Q, q0, q1, c, s, x, y, 0.0, 0.0, np.inf) <= CONTACT:
        return xi
    return np.inf
