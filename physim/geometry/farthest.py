"""The two robots that are farthest apart, without a look at all pairs.

No two robots are farther apart than both are from a point between them, so only those at the rim
can be of the pair. The value is that of a look at all pairs, bit for bit.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.robot_frames import MARGIN, BoundingDiscs, pair_distance
from physim.geometry.shapes import FloatArray, IntArray, Shapes


@compiled
def farthest_pair(
    shapes: Shapes, discs: BoundingDiscs, frame: FloatArray, spread: FloatArray, rim: IntArray
) -> tuple[float, int, int]:
    """Largest distance between the shapes of two robots, and which; (-inf, -1, -1) if none.

    Of equal ones the first pair. ``spread`` (N,) and ``rim`` (N,) are room for work.
    """
    robots = len(frame)
    if robots < 2:
        return -np.inf, -1, -1
    V, part_start, body_start = shapes.vertices, shapes.part_start, shapes.body_start
    inner = discs.inner
    x, y = middle(frame)
    first = farthest_from(frame, x, y, spread)
    widest = spread[first]
    # The robot at the rim and the one farthest from it are a good start: few pairs can beat it.
    second = farthest_from(frame, frame[first, 4], frame[first, 5], spread)
    if second == first:
        second = 1 if first == 0 else 0
    if second < first:
        first, second = second, first
    best = pair_distance(V, part_start, body_start, first, second, frame)
    farthest_from(frame, x, y, spread)
    smallest = np.inf
    for i in range(robots):
        smallest = min(smallest, inner[i])
    count = 0
    for i in range(robots):
        if spread[i] + widest + 2.0 * MARGIN >= best + smallest + inner[i]:
            rim[count] = i
            count += 1
    for m in range(count):
        i = rim[m]
        for n in range(m + 1, count):
            j = rim[n]
            room = best + inner[i] + inner[j] - MARGIN
            if spread[i] + spread[j] + MARGIN < room:
                continue
            dx = frame[j, 4] - frame[i, 4]
            dy = frame[j, 5] - frame[i, 5]
            if room <= 0.0 or dx * dx + dy * dy >= room * room:
                d = pair_distance(V, part_start, body_start, i, j, frame)
                if d > best or (d == best and (i < first or (i == first and j < second))):
                    best, first, second = d, i, j
    return best, first, second


@compiled
def farthest_from(frame: FloatArray, x: float, y: float, apart: FloatArray) -> int:
    """Write the distance of each robot's middle from a point; which is the farthest."""
    most = 0
    for i in range(len(frame)):
        dx = frame[i, 4] - x
        dy = frame[i, 5] - y
        apart[i] = np.sqrt(dx * dx + dy * dy)
        if apart[i] > apart[most]:
            most = i
    return most


@compiled
def middle(frame: FloatArray) -> tuple[float, float]:
    """Middle of the box around the robots' middles."""
    low_x, high_x = frame[0, 4], frame[0, 4]
    low_y, high_y = frame[0, 5], frame[0, 5]
    for i in range(len(frame)):
        low_x, high_x = min(low_x, frame[i, 4]), max(high_x, frame[i, 4])
        low_y, high_y = min(low_y, frame[i, 5]), max(high_y, frame[i, 5])
    return 0.5 * (low_x + high_x), 0.5 * (low_y + high_y)
