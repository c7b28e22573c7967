"""Packed shapes: the arrays that the compiled kernels work on.

A *part* is a convex polygon, counter-clockwise, of at least three vertices; a wall segment is a
part of two vertices. A nonconvex shape is several parts. A *body* is a run of parts.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, chain
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
# In kernels the name of an array says how many numbers stand in a row: those above are (n,).
Rows2 = FloatArray
"""(n, 2)"""
Rows3 = FloatArray
Rows4 = FloatArray
Rows5 = FloatArray
Rows6 = FloatArray
Rows7 = FloatArray
Rows8 = FloatArray
Rows9 = FloatArray
IntRows2 = IntArray
"""(n, 2)"""
IntRows3 = IntArray
IntRows8 = IntArray
Flags = NDArray[np.bool_]
"""(n,)"""
ContactRows = NDArray[np.void]
"""(n,) rows of `physim.contacts.CONTACT_ROW`"""


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array itself, so marked that writing to it is an error."""
    array.setflags(write=False)
    return array


def locked(value: Any) -> Any:
    """A read-only view of an array, or of all arrays of a named tuple; anything else as it is."""
    if isinstance(value, tuple):
        return type(value)(*map(locked, value))
    return read_only(value.view()) if isinstance(value, np.ndarray) else value


class Shapes(NamedTuple):
    """Convex parts of several bodies, each in its own frame (robots) or the world's (walls).

    Part p has the vertices ``vertices[part_start[p]:part_start[p + 1]]`` and body i the parts
    ``body_start[i]`` to ``body_start[i + 1] - 1``.
    """

    vertices: Rows2
    """(V, 2) [m]"""
    part_start: IntArray
    """(P + 1,)"""
    body_start: IntArray
    """(B + 1,)"""
    radius: FloatArray
    """(B,) [m] largest distance of a vertex from the origin of the body's frame"""


class Part(NamedTuple):
    """One part: the vertices ``vertices[first:end]``."""

    vertices: Rows2
    first: int
    end: int


class Polylines(NamedTuple):
    """Several polylines, each a run of rows, one a point."""

    start: IntArray
    """(K + 1,) polyline k has the rows ``start[k]:start[k + 1]``"""
    row: Rows6
    """(V, 6) x, y [m], unit direction and station [m] of each point, and the length [m] of the
    segment that begins there; the last point of a polyline has no direction and no length"""

    @property
    def points(self) -> FloatArray:
        """(V, 2) [m]."""
        return self.row[:, :2]

    @property
    def station(self) -> FloatArray:
        """(V,) [m] arc length from the first point of its polyline."""
        return np.asarray(self.row[:, 4])


def pack_parts(bodies: Sequence[Sequence[ArrayLike]]) -> Shapes:
    """Pack bodies, each a sequence of convex parts (n, 2), counter-clockwise, into arrays.

    Nothing is looked at: `physim.geometry.pack_shapes` takes shapes of any kind.
    """
    packed = [[np.asarray(part, dtype=np.float64) for part in body] for body in bodies]
    parts = list(chain.from_iterable(packed))
    radius = [
        max((float(np.hypot(p[:, 0], p[:, 1]).max()) for p in body), default=0.0) for body in packed
    ]
    return Shapes(
        np.ascontiguousarray(np.concatenate(parts) if parts else np.zeros((0, 2))),
        _offsets([len(part) for part in parts]),
        _offsets([len(body) for body in packed]),
        np.array(radius, dtype=np.float64),
    )


def joined_shapes(shapes: Shapes, walls: Shapes) -> Shapes:
    """Return robots and walls in one numbering of bodies and parts: robots first."""
    return Shapes(
        np.concatenate((shapes.vertices, walls.vertices)),
        np.concatenate((shapes.part_start, walls.part_start[1:] + shapes.part_start[-1])),
        np.concatenate((shapes.body_start, walls.body_start[1:] + shapes.body_start[-1])),
        np.concatenate((shapes.radius, walls.radius)),
    )


def body_parts(shapes: Shapes, body: int) -> list[FloatArray]:
    """Return the convex parts (n, 2) of one body."""
    return [
        shapes.vertices[shapes.part_start[p] : shapes.part_start[p + 1]]
        for p in range(shapes.body_start[body], shapes.body_start[body + 1])
    ]


def part_bodies(shapes: Shapes) -> IntArray:
    """Return the body (P,) that each part belongs to."""
    bodies = np.arange(len(shapes.body_start) - 1, dtype=np.int64)
    return np.repeat(bodies, np.diff(shapes.body_start))


def pack_polylines(lines: Sequence[ArrayLike]) -> Polylines:
    """Pack polylines (n, 2), n >= 2, with their arc lengths."""
    rows = []
    for line in lines:
        points = np.asarray(line, dtype=np.float64)
        step, row = np.diff(points, axis=0), np.zeros((len(points), 6))
        row[:, :2] = points
        row[1:, 4] = np.cumsum(np.hypot(*step.T))
        row[:-1, 5] = np.diff(row[:, 4])
        row[:-1, 2:4] = step / row[:-1, 5, None]
        rows.append(row)
    return Polylines(_offsets([len(row) for row in rows]), np.concatenate(rows))


def _offsets(lengths: Sequence[int]) -> IntArray:
    return np.array([0, *accumulate(lengths)], dtype=np.int64)
