"""What happens between two samples: earliest contact and least signed distance, in kernels.

From one sample to the next, position and angle go linearly, as the physics moves its bodies. The
angle turns by end - start as given: headings must be unwrapped. Poses are (3,) x, y [m],
heading [rad], world frame; ``dt`` > 0 is the time between the samples [s]. A wall is a body that
stands at the origin; it is the first of two, as what has many parts is.

- Earliest contact: the first time at which the signed distance is at most CONTACT (1e-9 m), so
  that a graze within CONTACT counts, as does touching at either sample. Never late: at every
  earlier instant of the step the shapes are more than CONTACT apart. Never without cause: at the
  time returned they are within CONTACT + SLACK. A miss (inf) is certain.
- Least signed distance: a value that the step attains, and a bound below all its values. They are
  CONTACT apart, or farther when the search reached its cap, MOST_LOOKS.

The exact arc of a robot lies within `tolerances.chord` of this motion.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.geometry.advancement import MOST_STEPS, fall_time, look_at
from physim.geometry.bodies import body_gap, describe_pair, relative_frame
from physim.geometry.collision import clear_of_part, never_meet
from physim.geometry.motion import Course, is_still, straight_course
from physim.geometry.shapes import FloatArray, IntArray, Part, Shapes
from physim.tolerances import CONTACT

SLACK = 0.25 * CONTACT
"""[m] An earliest contact may be by so much farther apart than CONTACT, so that the search ends."""

MOST_LOOKS = 20 * MOST_STEPS
"""Advances after which a least signed distance gets a lower bound instead of going on."""

FULL = -1
"""Count returned when the output has no room for another row."""

MARGIN = 4.0 * CONTACT
"""[m] Bounds must win by this."""


@compiled
def step_course(start: FloatArray, end: FloatArray, dt: float, radius: float) -> Course:
    """Course of a body from one sample to the next: straight, while turning evenly."""
    return straight_course(
        start,
        (end[0] - start[0]) / dt,
        (end[1] - start[1]) / dt,
        (end[2] - start[2]) / dt,
        radius,
    )


@compiled
def top_speed(a: Course, b: Course) -> float:
    """Bound [m/s] on how fast the distance of two bodies can change."""
    return a.speed + b.speed + abs(a.spin) * a.radius + abs(b.spin) * b.radius


@compiled
def touch_time(P: Part, a: Course, Q: Part, b: Course, horizon: float) -> float:
    """Earliest time [s] at which two parts are within CONTACT, without a cap on the advances.

    Bodies so fast that rounding of the time hides the rest of the gap (some 10^9 m/s) are taken to
    touch.
    """
    t = 0.0
    while True:
        t, d, steps = fall_time(P, a, Q, b, CONTACT, SLACK, t, horizon)
        if steps < MOST_STEPS or d <= 2.0 * CONTACT:
            return t
        further = t + (d - 2.0 * CONTACT) / top_speed(a, b)
        if further == t:
            return t
        t = further
        if not t <= horizon:
            return np.inf


@compiled
def swept_time(
    shapes_a: Shapes,
    i: int,
    start_i: FloatArray,
    end_i: FloatArray,
    shapes_b: Shapes,
    j: int,
    start_j: FloatArray,
    end_j: FloatArray,
    dt: float,
) -> float:
    """Earliest contact [s] of bodies i and j within [0, dt]; inf when there is none."""
    a = step_course(start_i, end_i, dt, shapes_a.radius[i])
    b = step_course(start_j, end_j, dt, shapes_b.radius[j])
    t = np.inf
    if never_meet(a, b, dt):
        return t
    V, start = shapes_a.vertices, shapes_a.part_start
    W, w_start = shapes_b.vertices, shapes_b.part_start
    for p in range(shapes_a.body_start[i], shapes_a.body_start[i + 1]):
        P = Part(V, start[p], start[p + 1])
        if is_still(a) and clear_of_part(b, P, dt):
            continue
        for q in range(shapes_b.body_start[j], shapes_b.body_start[j + 1]):
            Q = Part(W, w_start[q], w_start[q + 1])
            t = min(t, touch_time(P, a, Q, b, min(t, dt)))
    return t


class Least(NamedTuple):
    """The smallest signed distance of a step, as far as it is known."""

    distance: float
    """[m] attained"""
    bound: float
    """[m] no value is below this"""
    time: float
    """[s] when it is attained"""


@compiled
def least_of_parts(P: Part, a: Course, Q: Part, b: Course, dt: float, best: Least) -> Least:
    """Lower ``best`` to the least signed distance of two parts in [0, dt], where it is less.

    Of a level between the least value that was found and a bound below all it is asked whether and
    when the distance falls to it, and so on by halves.
    """
    high, bound, at = best
    middle = look_at(P, a, Q, b, 0.5 * dt).distance
    low = middle - 0.5 * dt * top_speed(a, b) - CONTACT
    if low > high:
        return best
    for t in (0.0, dt):
        d = look_at(P, a, Q, b, t).distance
        if d < high:
            high, at = d, t
    begun, t, looks = 0.0, 0.0, 0  # before `begun` nothing is below what was found there
    while high - low > CONTACT and looks < MOST_LOOKS:
        level = 0.5 * (low + high)
        t, d, steps = fall_time(P, a, Q, b, level, SLACK, t, dt)
        looks += steps + 1
        if t == np.inf:
            low, t = level, begun
        elif d <= level + SLACK:
            high, at, begun = d, t, t
    return Least(high, min(bound, low, high - CONTACT), at)


@compiled
def least_gap(
    shapes_a: Shapes,
    i: int,
    start_i: FloatArray,
    end_i: FloatArray,
    shapes_b: Shapes,
    j: int,
    start_j: FloatArray,
    end_j: FloatArray,
    dt: float,
) -> Least:
    """Smallest signed distance [m] of bodies i and j within [0, dt]."""
    a = step_course(start_i, end_i, dt, shapes_a.radius[i])
    b = step_course(start_j, end_j, dt, shapes_b.radius[j])
    best = Least(np.inf, np.inf, 0.0)
    V, start = shapes_a.vertices, shapes_a.part_start
    W, w_start = shapes_b.vertices, shapes_b.part_start
    for p in range(shapes_a.body_start[i], shapes_a.body_start[i + 1]):
        P = Part(V, start[p], start[p + 1])
        for q in range(shapes_b.body_start[j], shapes_b.body_start[j + 1]):
            best = least_of_parts(P, a, Part(W, w_start[q], w_start[q + 1]), b, dt, best)
    return best


# All bodies of a step


@compiled
def wear_off(
    old: FloatArray, now: FloatArray, radius: FloatArray, reach: FloatArray, room: FloatArray
) -> bool:
    """Take from ``room`` what a step may have taken; whether somebody may touch something in it.

    Poses (N, 3) at both samples, headings unwrapped; ``radius`` (N,) [m] about the reference
    points. ``room`` (2, N) [m] is a lower bound of each robot's distance from other robots, and
    from walls. ``reach`` (2, N) [m] takes how much these distances change at most: what is farther
    apart at either sample does not touch in between.
    """
    most = 0.0
    for i in range(len(old)):
        moved = math.hypot(now[i, 0] - old[i, 0], now[i, 1] - old[i, 1])
        reach[1, i] = moved + radius[i] * abs(now[i, 2] - old[i, 2]) + MARGIN
        most = max(most, reach[1, i])
    is_near = False
    for i in range(len(old)):
        reach[0, i] = reach[1, i] + most
        for k in range(2):
            is_near |= room[k, i] <= reach[k, i]
            room[k, i] -= reach[k, i]
    return is_near


@compiled
def find_swept_contacts(
    old: FloatArray,
    now: FloatArray,
    reach: FloatArray,
    near: NDArray[np.bool_],
    shapes: Shapes,
    dt: float,
    who: IntArray,
    values: FloatArray,
) -> int:
    """Write a row for each pair that is apart at both samples of a step and touches in between.

    Poses (B, 3) of all bodies, N robots first; ``reach`` (2, N) of `wear_off`; ``near`` (2, N), who
    may touch another robot, and a wall. ``who`` (C, 2) takes the bodies a < b, ``values`` (C, 5)
    what `describe_pair` gives when they are closest. Returns how many, or FULL.
    """
    count = 0
    robots = reach.shape[1]
    for a in range(robots):
        for b in range(a + 1 if near[0, a] else robots, len(now) if near[1, a] else robots):
            i, j, room = (b, a, reach[1, a]) if b >= robots else (a, b, reach[1, a] + reach[1, b])
            if b < robots:
                far = room + shapes.radius[a] + shapes.radius[b]
                dx, dy = now[b, 0] - now[a, 0], now[b, 1] - now[a, 1]
                if not near[0, b] or dx * dx + dy * dy > far * far:
                    continue
            f = relative_frame(now[i], now[j])
            after = body_gap(shapes, i, shapes, j, f, room + MARGIN)
            if after <= CONTACT or after > room:
                continue
            f = relative_frame(old[i], old[j])
            before = body_gap(shapes, i, shapes, j, f, room + MARGIN)
            if before <= CONTACT or before + after > room:
                continue
            if swept_time(shapes, i, old[i], now[i], shapes, j, old[j], now[j], dt) == np.inf:
                continue
            if count == len(who):
                return FULL
            share = least_gap(shapes, i, old[i], now[i], shapes, j, old[j], now[j], dt).time / dt
            who[count, 0], who[count, 1] = a, b
            describe_pair(
                shapes, a, old[a] + share * (now[a] - old[a]),
                shapes, b, old[b] + share * (now[b] - old[b]), values[count],
            )  # fmt: skip
            count += 1
    return count
