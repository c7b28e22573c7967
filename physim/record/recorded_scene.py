"""The scene of a record: who took part, and where everything that stands still is."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray, Polylines, Shapes, pack_polylines, pack_shapes
from physim.record import layout
from physim.record.rows import Rows, frozen
from physim.record.values import check_points, check_start
from physim.scene import Body


class RecordedScene:
    """What a `physim.record.Record` knows of its scene: lengths [m], world frame unless said."""

    robots: int
    """N"""
    _rows: Rows
    _bodies: int
    _where: str

    def read(self, path: str) -> NDArray[Any]:
        """Rows of a dataset; see `physim.record.Record.read`."""
        raise NotImplementedError

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
        return tuple(
            self._rows.parts(layout.FOOTPRINTS.format(robot)) for robot in range(self.robots)
        )

    @cached_property
    def shapes(self) -> Shapes:
        """Footprints of the N robots, packed, in their frames."""
        return pack_shapes(self.footprints)

    @cached_property
    def walls(self) -> Shapes:
        """Boundaries and obstacles, world frame; body k of them has id N + k."""
        vertices, part_start, body_start = (
            self.read(f"/walls/{field}") for field in ("vertices", "part_start", "body_start")
        )
        check_points("/walls/vertices", vertices, self._where)
        check_start("/walls/part_start", part_start, len(vertices), self._where, empty=False)
        check_start(
            "/walls/body_start", body_start, len(part_start) - 1, self._where,
            empty=False, runs=self._bodies - self.robots,
        )  # fmt: skip
        lengths = np.hypot(vertices[:, 0], vertices[:, 1])
        runs = zip(part_start[body_start[:-1]], part_start[body_start[1:]], strict=True)
        radius = [float(lengths[first:last].max()) for first, last in runs]
        return Shapes(vertices, part_start, body_start, frozen(np.array(radius, dtype=float)))

    @cached_property
    def paths(self) -> Polylines:
        """Own path of each robot."""
        return pack_polylines(self._rows.runs("/paths", self.robots))

    @cached_property
    def reference(self) -> Polylines:
        """The one reference path s*."""
        return pack_polylines(self._rows.runs("/reference", 1))

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
        return tuple(self._rows.runs("/areas/accessible"))

    @cached_property
    def safe(self) -> tuple[FloatArray, ...]:
        """Rings (n, 2) [m] of the safe area."""
        return tuple(self._rows.runs("/areas/safe"))
