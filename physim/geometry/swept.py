"""What happens between two samples: earliest contact and least signed distance, in kernels.

From one sample to the next, position and angle go linearly, as the physics moves its bodies. The
angle turns by end - start as given: headings must be unwrapped. Poses are (3,) x, y [m],
heading [rad], world frame; ``dt`` > 0 is the time between the samples [s].

- Earliest contact: the first time at which the signed distance is at most CONTACT (1e-9 m), so
  that a graze within CONTACT counts, as does touching at either sample. Never late: at every
  earlier instant of the step the shapes are more than CONTACT apart. Never without cause: at the
  time returned they are within CONTACT + SLACK. A miss (inf) is certain.
- Least signed distance: a value that the step attains, and a bound below all its values. They are
  CONTACT apart, or farther when the search reached its cap, MOST_LOOKS.

The exact arc of a robot lies within `tolerances.chord` of this motion.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.advancement import MOST_STEPS, fall_time, look_at
from physim.geometry.bodies import point_gap
from physim.geometry.collision import clear_of_part, never_meet
from physim.geometry.motion import Course, still_course, straight_course
from physim.geometry.shapes import FloatArray, IntArray, Part, Shapes
from physim.tolerances import CONTACT

SLACK = 0.25 * CONTACT
"""[m] An earliest contact may be by so much farther apart than CONTACT, so that the search ends."""

GOLDEN = 0.6180339887498949
CUTS = 40
"""Of the search for a least value: 0.618^40 = 4e-9 of the last stride remains."""

FIRST_STRIDE = 1e-4
"""[-] First stride of the same search, as a share of the time left."""

MOST_LOOKS = 20 * MOST_STEPS
"""Advances after which a least signed distance gets a lower bound instead of going on."""

Least = tuple[float, float, float]
"""least signed distance found [m], bound below all values [m], time of the former [s]"""


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
def touch_time(
    P: Part,
    a: Course,
    Q: Part,
    b: Course,
    horizon: float,
) -> float:
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
def swept_pair(
    shapes: Shapes,
    i: int,
    start_i: FloatArray,
    end_i: FloatArray,
    j: int,
    start_j: FloatArray,
    end_j: FloatArray,
    dt: float,
) -> float:
    """Earliest contact [s] of robots i and j within [0, dt]; inf when there is none."""
    a = step_course(start_i, end_i, dt, shapes.radius[i])
    b = step_course(start_j, end_j, dt, shapes.radius[j])
    t = np.inf
    if never_meet(a, b, dt):
        return t
    V, start = shapes.vertices, shapes.part_start
    for p in range(shapes.body_start[i], shapes.body_start[i + 1]):
        P = Part(V, start[p], start[p + 1])
        for q in range(shapes.body_start[j], shapes.body_start[j + 1]):
            Q = Part(V, start[q], start[q + 1])
            t = min(t, touch_time(P, a, Q, b, min(t, dt)))
    return t


@compiled
def swept_walls(
    shapes: Shapes,
    i: int,
    start: FloatArray,
    end: FloatArray,
    walls: Shapes,
    part_ids: IntArray,
    dt: float,
) -> tuple[float, int]:
    """Earliest contact [s] of robot i with the given parts of ``walls`` in [0, dt], and that part.

    (inf, -1) when there is none. Of parts touched at the same time the first given wins.
    """
    a = step_course(start, end, dt, shapes.radius[i])
    still = still_course()
    t = np.inf
    touched = -1
    W, w_start = walls.vertices, walls.part_start
    V, v_start = shapes.vertices, shapes.part_start
    for part in part_ids:
        wall = Part(W, w_start[part], w_start[part + 1])
        if clear_of_part(a, wall, dt):
            continue
        for q in range(shapes.body_start[i], shapes.body_start[i + 1]):
            Q = Part(V, v_start[q], v_start[q + 1])
            found = touch_time(wall, still, Q, a, min(t, dt))
            if found < t:
                t = found
                touched = part
    return t, touched


@compiled
def valley(
    P: Part,
    a: Course,
    Q: Part,
    b: Course,
    start: float,
    end: float,
) -> tuple[float, float]:
    """Return (signed distance, time) of a local minimum of two parts after ``start``.

    Strides double as long as the distance falls; then the golden section narrows it down.
    """
    low = start
    t = start
    at_t = look_at(P, a, Q, b, start).distance
    stride = FIRST_STRIDE * (end - start)
    high = end
    while t < end:
        u = min(t + stride, end)
        at_u = look_at(P, a, Q, b, u).distance
        if at_u >= at_t:
            high = u
            break
        low = t
        t = u
        at_t = at_u
        stride *= 2.0
    best = at_t
    best_at = t
    t = high - GOLDEN * (high - low)
    u = low + GOLDEN * (high - low)
    at_t = look_at(P, a, Q, b, t).distance
    at_u = look_at(P, a, Q, b, u).distance
    for _ in range(CUTS):
        if at_t <= at_u:
            high, u, at_u = u, t, at_t
            t = high - GOLDEN * (high - low)
            at_t = look_at(P, a, Q, b, t).distance
        else:
            low, t, at_t = t, u, at_u
            u = low + GOLDEN * (high - low)
            at_u = look_at(P, a, Q, b, u).distance
    if at_u < at_t:
        t, at_t = u, at_u
    if at_t < best:
        return at_t, t
    return best, best_at


@compiled
def least_part(
    P: Part,
    a: Course,
    Q: Part,
    b: Course,
    dt: float,
    best: Least,
) -> Least:
    """Lower ``best`` to the least signed distance of two parts in [0, dt], where it is less."""
    least, bound, at = best
    for end in (0.0, dt):
        d = look_at(P, a, Q, b, end).distance
        if d < least:
            least = d
            at = end
    t = 0.0
    steps = 0
    while True:
        # Either nothing comes below the level any more, or a lower value is found.
        level = least - CONTACT
        t, d, used = fall_time(P, a, Q, b, level, SLACK, t, dt)
        if t == np.inf:
            return least, min(bound, level), at
        steps += used
        if steps >= MOST_LOOKS:
            return least, min(bound, level, d - top_speed(a, b) * (dt - t)), at
        if d < least:
            least = d
            at = t
        d, u = valley(P, a, Q, b, t, dt)
        if d < least:
            least = d
            at = u


@compiled
def least_gap_pair(
    shapes: Shapes,
    i: int,
    start_i: FloatArray,
    end_i: FloatArray,
    j: int,
    start_j: FloatArray,
    end_j: FloatArray,
    dt: float,
) -> Least:
    """Return (least, bound, t): the smallest signed distance [m] of robots i and j in [0, dt].

    ``least`` is attained at t [s]; no value of the step is below ``bound``, which is least - 1e-9,
    or lower should the search reach its cap.
    """
    a = step_course(start_i, end_i, dt, shapes.radius[i])
    b = step_course(start_j, end_j, dt, shapes.radius[j])
    best = (np.inf, np.inf, 0.0)
    V, start = shapes.vertices, shapes.part_start
    for p in range(shapes.body_start[i], shapes.body_start[i + 1]):
        P = Part(V, start[p], start[p + 1])
        for q in range(shapes.body_start[j], shapes.body_start[j + 1]):
            best = least_part(P, a, Part(V, start[q], start[q + 1]), b, dt, best)
    return best[0], min(best[1], best[0] - CONTACT), best[2]


@compiled
def least_gap_walls(
    shapes: Shapes,
    i: int,
    start: FloatArray,
    end: FloatArray,
    walls: Shapes,
    part_ids: IntArray,
    dt: float,
) -> tuple[float, float, float, int]:
    """Return (least, bound, t, part): `least_gap_pair` of robot i and the given parts of ``walls``.

    (inf, inf, 0, -1) when no part is given.
    """
    a = step_course(start, end, dt, shapes.radius[i])
    still = still_course()
    best = (np.inf, np.inf, 0.0)
    nearest = -1
    middle_x = a.x + 0.5 * dt * a.vx
    middle_y = a.y + 0.5 * dt * a.vy
    reach = a.radius + 0.5 * dt * a.speed + CONTACT
    W, w_start = walls.vertices, walls.part_start
    V, v_start = shapes.vertices, shapes.part_start
    for part in part_ids:
        wall = Part(W, w_start[part], w_start[part + 1])
        if point_gap(wall, middle_x, middle_y) - reach > best[0]:
            continue
        for q in range(shapes.body_start[i], shapes.body_start[i + 1]):
            before = best[0]
            best = least_part(wall, still, Part(V, v_start[q], v_start[q + 1]), a, dt, best)
            if best[0] < before:
                nearest = part
    return best[0], min(best[1], best[0] - CONTACT), best[2], nearest
