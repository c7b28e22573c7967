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

from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.advancement import MOST_STEPS, fall_time, look_at
from physim.geometry.collision import clear_of_part, never_meet
from physim.geometry.motion import Course, is_still, straight_course
from physim.geometry.shapes import FloatArray, Part, Shapes
from physim.tolerances import CONTACT

SLACK = 0.25 * CONTACT
"""[m] An earliest contact may be by so much farther apart than CONTACT, so that the search ends."""

MOST_LOOKS = 20 * MOST_STEPS
"""Advances after which a least signed distance gets a lower bound instead of going on."""


@compiled
def step_course(start: FloatArray, end: FloatArray, dt: float, radius: float) -> Course:
    """Course of a body from one sample to the next: straight, while turning evenly."""
    return straight_course(
        start[0], start[1], start[2],
        (end[0] - start[0]) / dt, (end[1] - start[1]) / dt, (end[2] - start[2]) / dt, radius,
    )  # fmt: skip


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
    high, bound, at = best.distance, best.bound, best.time
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
