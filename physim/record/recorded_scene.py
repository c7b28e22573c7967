"""The scene of a record: who took part, and where everything that stands still is."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from physim.geometry.shapes import FloatArray, Polylines, Shapes, pack_polylines, pack_shapes
from physim.record import layout
from physim.record.rows import RecordFile, frozen
from physim.scene import Body


class RecordedScene(RecordFile):
    """What a `physim.record.Record` knows of its scene: lengths [m], world frame unless said."""

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """Robots by index, then boundaries, then obstacles: id, kind and name."""
        columns = [self.read(f"/bodies/{column}") for column in ("id", "kind", "name")]
        rows = zip(*columns, strict=True)
        return tuple(Body(int(id), kind.decode(), name.decode()) for id, kind, name in rows)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the N robots: labels only."""
        return tuple(body.name for body in self.bodies[: self.robots])

    @cached_property
    def footprints(self) -> tuple[tuple[FloatArray, ...], ...]:
        """Convex parts (n, 2) [m] of each robot, in its frame."""
        return tuple(self._parts(layout.FOOTPRINTS.format(robot)) for robot in range(self.robots))

    @cached_property
    def shapes(self) -> Shapes:
        """Footprints of the N robots, packed, in their frames."""
        return pack_shapes(self.footprints)

    @cached_property
    def walls(self) -> Shapes:
        """Boundaries and obstacles, world frame; body k of them has id N + k."""
        vertices = self._points("/walls/vertices")
        part_start = self._starts("/walls/part_start", len(vertices), empty=False)
        body_start = self._starts(
            "/walls/body_start", len(part_start) - 1, empty=False,
            runs=self._bounds.bodies - self.robots,
        )  # fmt: skip
        lengths = np.hypot(vertices[:, 0], vertices[:, 1])
        runs = zip(part_start[body_start[:-1]], part_start[body_start[1:]], strict=True)
        radius = [float(lengths[first:last].max()) for first, last in runs]
        return Shapes(vertices, part_start, body_start, frozen(np.array(radius, dtype=float)))

    @cached_property
    def paths(self) -> Polylines:
        """Own path of each robot."""
        return pack_polylines(self._runs("/paths", self.robots))

    @cached_property
    def reference(self) -> Polylines:
        """The one reference path s*."""
        return pack_polylines(self._runs("/reference", 1))

    @cached_property
    def stop_station(self) -> FloatArray:
        """(N,) [m] along the own path."""
        return self.read("/robots/stop_station")

    @cached_property
    def lead(self) -> FloatArray:
        """(N,) [m] wanted lead of each robot over the first along the reference path."""
        return self.read("/robots/lead")

    @cached_property
    def accessible(self) -> tuple[FloatArray, ...]:
        """Rings (n, 2) [m] of the accessible area."""
        return tuple(self._runs("/areas/accessible"))

    @cached_property
    def safe(self) -> tuple[FloatArray, ...]:
        """Rings (n, 2) [m] of the safe area."""
        return tuple(self._runs("/areas/safe"))
