"""What a record knows before the first step, as it is written and as it is read.

That is attributes, bodies, shapes, walls, paths and areas, and the modes, rules and columns
of the controller, which are checked like those of a controller when they are read.
"""

from __future__ import annotations

import functools
import json
import platform
from collections.abc import Sequence
from functools import cached_property
from importlib.metadata import PackageNotFoundError, version
from itertools import pairwise
from types import SimpleNamespace

import h5py
import numpy as np
from numpy.typing import ArrayLike, NDArray

from physim.errors import ControllerError, RecordError
from physim.geometry.shapes import (
    FloatArray,
    Polylines,
    Shapes,
    pack_polylines,
)
from physim.parts.declarations import Column, Declared, Mode, Rule
from physim.parts.given import GivenSettings
from physim.record import layout
from physim.record.checks import damaged
from physim.record.datasets import put, put_texts
from physim.record.row_checks import Source
from physim.record.rows import RecordFile, frozen
from physim.world.kinds import MOST_CORNERS
from physim.world.scene import Body, Scene

FEWEST_CORNERS = 3
"""Of a convex part of a footprint or obstacle; those of a boundary are segments."""
LIBRARIES = ("physim", "numpy", "pymunk", "numba", "shapely", "h5py")


def write_attributes(
    file: h5py.File,
    scene: Scene,
    *,
    name: str,
    world_text: str,
    record_every: int,
    safe_distance: float,
    tables: Sequence[str],
    given: Sequence[tuple[str, str]],
    given_settings: Sequence[GivenSettings],
) -> None:
    """Set the root attributes of a run that begins."""
    attributes = {
        "format": layout.FORMAT,
        "version": layout.VERSION,
        "units": layout.UNITS,
        "name": name,
        "world": world_text,
        "seed": np.int64(scene.seed),
        "dt": float(scene.dt),
        "steps_planned": np.int64(scene.steps),
        "record_every": np.int64(record_every),
        "tables": json.dumps(list(tables)),
        "given": json.dumps([list(one) for one in given]),
        "safe_distance": float(safe_distance),
        "steps_run": np.int64(0),
        "rejected_contacts": np.int64(0),
        "versions": json.dumps(_versions()),
        "ended": np.array(b"running", dtype=f"S{layout.ENDED_BYTES}"),
    }
    if given_settings:
        attributes["given_settings"] = json.dumps([vars(one) for one in given_settings])
    for key, value in attributes.items():
        file.attrs[key] = value


def write_scene(
    file: h5py.File, scene: Scene, accessible: Sequence[ArrayLike], safe: Sequence[ArrayLike]
) -> None:
    """Write bodies, footprints, walls, paths and areas (rings (n, 2) [m], world frame)."""
    put(file, "/bodies/id", np.array([body.id for body in scene.bodies], dtype=np.int32))
    for column in ("kind", "name"):
        put_texts(file, f"/bodies/{column}", [getattr(body, column) for body in scene.bodies])
    put(file, "/robots/stop_station", np.asarray(scene.stop_station, dtype=np.float64))
    put(file, "/robots/lead", np.asarray(scene.formation.lead, dtype=np.float64))
    for group, shapes in (("/footprints", scene.shapes), ("/walls", scene.walls)):
        for field in ("vertices", "part_start", "body_start"):
            put(file, f"{group}/{field}", getattr(shapes, field))
    for group, lines in (("/paths", scene.paths), ("/reference", scene.reference)):
        put(file, f"{group}/points", lines.points)
        put(file, f"{group}/start", lines.start)
    for group, rings in (("/areas/accessible", accessible), ("/areas/safe", safe)):
        arrays = [np.asarray(ring, dtype=np.float64).reshape(-1, 2) for ring in rings]
        put(file, f"{group}/points", np.concatenate([np.zeros((0, 2)), *arrays]))
        lengths = [0, *(len(ring) for ring in arrays)]
        put(file, f"{group}/start", np.cumsum(lengths).astype(np.int64))


def write_declared(file: h5py.File, declared: Declared) -> None:
    """Write modes, rules and columns of the controller, in the order of their numbers."""
    for group, rows, fields in (
        ("/modes", declared.modes, ("name", "words", "colour")),
        ("/rules", declared.rules, ("name", "words")),
        ("/columns", declared.columns, ("name", "unit", "words")),
    ):
        for field in fields:
            put_texts(file, f"{group}/{field}", [getattr(row, field) for row in rows])
    put(file, "/modes/danger", np.array([mode.danger for mode in declared.modes], dtype=np.int8))


def unpack(shapes: Shapes) -> tuple[tuple[FloatArray, ...], ...]:
    """Convex parts (n, 2) of every body of packed shapes."""
    vertices = np.split(shapes.vertices, shapes.part_start[1:-1])
    starts: NDArray[np.int64] = shapes.body_start
    return tuple(tuple(vertices[first:last]) for first, last in pairwise(starts))


def _area(part: FloatArray) -> float:
    """[m²] of a convex part (n, 2)."""
    x, y = (part - part[0]).T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0


@functools.cache
def _versions() -> dict[str, str]:
    """Versions of the libraries that made a record; looked up once, for it takes 2 ms.

    And the processor: kernels are compiled for it, so the same bits are due on its kind alone.
    """
    from llvmlite.binding import get_host_cpu_name

    found = {"processor": f"{platform.machine()}-{get_host_cpu_name()}"}
    for library in LIBRARIES:
        try:
            found[library] = version(library)
        except PackageNotFoundError:
            found[library] = "unknown"
    return found


def read_declared(file: h5py.File, where: str) -> Declared:
    """Read what the controller declared. Raises RecordError for what none can declare."""
    try:
        danger = file["/modes/danger"][:].tolist()
        modes = [
            Mode(name, colour, words, bool(is_danger))
            for name, colour, words, is_danger in zip(
                *_texts(file, "/modes", "name", "colour", "words"), danger, strict=True
            )
        ]
        rules = [Rule(*row) for row in zip(*_texts(file, "/rules", "name", "words"), strict=True)]
        columns = [
            Column(*row)
            for row in zip(*_texts(file, "/columns", "name", "unit", "words"), strict=True)
        ]
    except (OSError, RuntimeError, KeyError, ValueError, UnicodeDecodeError) as error:
        raise damaged(where, "/modes, /rules or /columns", error) from error
    for row, value in enumerate(danger):
        if value not in (0, 1):
            raise RecordError(f"{where}: /modes/danger: row {row}: {value}; it must be 0 or 1")
    try:
        return Declared.of(SimpleNamespace(modes=modes, rules=rules, columns=columns))
    except ControllerError as error:
        fault = str(error).replace("SimpleNamespace.", "/")
        raise RecordError(f"{where}: {fault}; make the record again") from error


def _texts(file: h5py.File, group: str, *fields: str) -> list[list[str]]:
    return [[value.decode() for value in file[f"{group}/{field}"][:]] for field in fields]


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
        return unpack(self.shapes)

    @cached_property
    def shapes(self) -> Shapes:
        """Footprints of the N robots, packed, in their frames."""
        corners = np.full(self.robots, FEWEST_CORNERS)
        shapes = self._shapes("/footprints", corners)
        counts = np.diff(shapes.body_start)
        Source(self.where, "/footprints/body_start").refuse(
            counts > MOST_CORNERS,
            lambda k: f"a footprint of {counts[k]} parts; of a polygon at most {MOST_CORNERS}",
        )
        areas = [sum(map(_area, parts)) for parts in unpack(shapes)]
        Source(self.where, "/footprints/body_start").refuse(
            np.array(areas) <= 0.0, lambda _: "a footprint without area"
        )
        return shapes

    @cached_property
    def walls(self) -> Shapes:
        """Boundaries and obstacles, world frame; body k of them has id N + k."""
        kinds = [body.kind for body in self.bodies[self.robots :]]
        corners = [2 if kind == "boundary" else FEWEST_CORNERS for kind in kinds]
        return self._shapes("/walls", np.array(corners, dtype=np.int64))

    def _shapes(self, group: str, corners: NDArray[np.int64]) -> Shapes:
        """Convex parts of bodies, packed; parts of a body have so many corners, or more."""
        bodies = len(corners)
        vertices = self._points(f"{group}/vertices")
        part_start = self._starts(f"{group}/part_start", len(vertices), empty=False)
        body_start = self._starts(
            f"{group}/body_start", len(part_start) - 1, empty=False, runs=bodies
        )
        fewest, found = np.repeat(corners, np.diff(body_start)), np.diff(part_start)
        Source(self.where, f"{group}/part_start").refuse(
            found < fewest, lambda k: f"a part of {found[k]} corners; {fewest[k]} are needed"
        )
        lengths = np.hypot(vertices[:, 0], vertices[:, 1])
        radius = np.maximum.reduceat(lengths, part_start[body_start[:-1]]) if bodies else lengths
        return Shapes(vertices, part_start, body_start, frozen(radius))

    def _lines(self, group: str, runs: int) -> Polylines:
        """So many polylines, each of some length."""
        lines = self._runs(group, 2, runs)
        still = np.array([not np.ptp(line, axis=0).any() for line in lines], dtype=np.bool_)
        Source(self.where, f"{group}/start").refuse(still, lambda _: "a path of length 0")
        return pack_polylines(lines)

    @cached_property
    def paths(self) -> Polylines:
        """Own path of each robot."""
        return self._lines("/paths", self.robots)

    @cached_property
    def reference(self) -> Polylines:
        """The one reference path s*."""
        return self._lines("/reference", 1)

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
        return tuple(self._runs("/areas/accessible", 3))

    @cached_property
    def safe(self) -> tuple[FloatArray, ...]:
        """Rings (n, 2) [m] of the safe area."""
        return tuple(self._runs("/areas/safe", 3))
