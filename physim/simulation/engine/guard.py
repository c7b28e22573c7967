"""The guard that keeps the engine's false contacts out.

pymunk now and then reports a contact more than a metre deep between polygons that are apart and
have edges on one line. So each contact it reports is judged by the exact separation of the parts
(`physim.simulation.engine.verdict`): what is apart is not processed, not noted, only counted.

The guard here is plain Python. `physim.simulation.engine.native_guard` does the same in compiled
code, wherever this version of the engine lets it.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np
import pymunk

from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.simulation.engine.meeting import is_misled, meeting
from physim.simulation.engine.space import Hosted
from physim.simulation.engine.verdict import (
    ACTS,
    APART,
    LEFT,
    SIDE,
    classify,
    deepest,
    segment_links,
)


class Touches(NamedTuple):
    """True contacts of parts in one solve, in the order in which the engine met them."""

    part: IntArray
    """(M, 2) part numbers"""
    impulse: FloatArray
    """(M,) [N s] magnitude"""


NOTHING = Touches(np.zeros((0, 2), dtype=np.int64), np.zeros(0))


class Guard(Protocol):
    """Judges every contact in callbacks of the engine's step."""

    @property
    def rejected(self) -> int:
        """False contacts of parts met so far."""
        ...

    @rejected.setter
    def rejected(self, count: int) -> None: ...

    @property
    def reported(self) -> int:
        """Contacts of parts, true and false, that the engine reported between the last two calls
        of `take`: as many as it remembers, if that was one solve."""
        ...

    def take(self) -> Touches:
        """Return the true contacts since the last call; raise what went wrong in a callback."""
        ...

    def take_rejected(self) -> IntArray:
        """Return the parts (M, 2) of the false contacts since the last call."""
        ...


class PlainGuard:
    """The guard as plain Python: slow, and the reference."""

    def __init__(self, hosted: Hosted, shapes: Shapes, *, checks: bool = True) -> None:
        """Attach to the space; ``shapes`` has the parts of robots and walls in one numbering.

        Without ``checks`` every contact passes.
        """
        self.rejected = 0
        self.reported = 0
        self._reported = 0
        self._number = {shape: part for part, shape in enumerate(hosted.parts)}
        self._shapes = shapes
        self._links = segment_links(shapes)
        self._checks = checks
        self._found: list[tuple[int, int, float]] = []
        self._rejected: list[tuple[int, int]] = []
        self._failure: Exception | None = None
        hosted.space.on_collision(
            None, None, pre_solve=self._pre_solve, post_solve=self._post_solve
        )

    def take(self) -> Touches:
        """Return the true contacts since the last call; raise what went wrong in a callback."""
        self.reported, self._reported = self._reported, 0
        found, self._found = self._found, []
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure
        if not found:
            return NOTHING
        return Touches(
            np.array([(p, q) for p, q, _ in found], dtype=np.int64),
            np.array([impulse for _, _, impulse in found], dtype=np.float64),
        )

    def take_rejected(self) -> IntArray:
        """Return the parts (M, 2) of the false contacts since the last call."""
        if not self._rejected:
            return NOTHING.part
        parts, self._rejected = np.array(self._rejected, dtype=np.int64), []
        return parts

    def _pre_solve(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
        # An exception would be printed and swallowed by the engine: keep it for take().
        self._reported += 1
        try:
            verdict = self._classify(arbiter) if self._checks else ACTS
            arbiter.process_collision = verdict not in (APART, LEFT)
            if verdict == APART:
                first, second = arbiter.shapes
                self.rejected += 1
                self._rejected.append((self._number[first], self._number[second]))
        except Exception as failure:
            self._failure = self._failure or failure

    def _post_solve(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
        try:
            first, second = arbiter.shapes
            numbers = self._number[first], self._number[second]
            self._found.append((*numbers, arbiter.total_impulse.length))
        except Exception as failure:
            self._failure = self._failure or failure

    def _classify(self, arbiter: pymunk.Arbiter) -> int:
        # In the order of part numbers, as distances of bodies are worked out everywhere.
        shapes = arbiter.shapes
        first, second = sorted(shapes, key=self._number.__getitem__)
        p, q = self._number[first], self._number[second]
        verdict, nx, ny = classify(self._shapes, self._links, p, _pose(first), q, _pose(second))
        if verdict == SIDE:
            sign = 1.0 if shapes[0] is second else -1.0
            points = arbiter.contact_point_set
            points.normal = pymunk.Vec2d(sign * nx, sign * ny)
            # The engine's points are those of its own normal: turned to the segment's they would
            # show an overlap of millimetres where the part is half a metre beyond. pymunk 7.3.1
            # puts the first point of a set at the place of the second, too.
            beyond = deepest(self._shapes, self._links, p, _pose(first), q, nx, ny)
            for k, point in enumerate(points.points if beyond else ()):
                corner, foot = (pymunk.Vec2d(*one) for one in beyond[k % len(beyond)])
                point.point_a, point.point_b = (foot, corner) if sign > 0.0 else (corner, foot)
            arbiter.contact_point_set = points
        elif verdict == ACTS:
            self._set_right(arbiter, shapes[0] is second, p, _pose(first), q, _pose(second))
        return verdict

    def _set_right(
        self, arbiter: pymunk.Arbiter, swapped: bool, p: int, pose_p: FloatArray, q: int,
        pose_q: FloatArray,
    ) -> None:  # fmt: skip
        """Put a contact of which the engine is misled where the parts p and q meet."""
        points = arbiter.contact_point_set
        first = points.points[0]
        dx, dy = first.point_b - first.point_a
        if not is_misled(self._shapes, p, pose_p, q, pose_q, len(points.points), dx, dy):
            return
        nx, ny, *ends = meeting(self._shapes, p, pose_p, q, pose_q)
        sign = 1.0 if swapped else -1.0
        points.normal = pymunk.Vec2d(sign * nx, sign * ny)
        on_p, on_q = pymunk.Vec2d(*ends[:2]), pymunk.Vec2d(*ends[2:])
        for point in points.points:
            point.point_a, point.point_b = (on_q, on_p) if swapped else (on_p, on_q)
        arbiter.contact_point_set = points


def _pose(shape: pymunk.Shape) -> FloatArray:
    body = shape.body
    if body is None:
        raise RuntimeError("the engine reported a shape without a body")
    x, y = body.position
    return np.array((x, y, body.angle))
