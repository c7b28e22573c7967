"""The part of a record that is known before the first step: attributes, bodies, shapes, paths."""

from __future__ import annotations

import functools
import json
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from itertools import pairwise

import h5py
import numpy as np
from numpy.typing import ArrayLike, NDArray

from physim.declared import Declared
from physim.geometry.shapes import FloatArray, Shapes
from physim.record import layout
from physim.scene import Scene

LIBRARIES = ("physim", "numpy", "pymunk", "numba", "h5py")


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
    for key, value in attributes.items():
        file.attrs[key] = value


def write_scene(
    file: h5py.File, scene: Scene, accessible: Sequence[ArrayLike], safe: Sequence[ArrayLike]
) -> None:
    """Write bodies, footprints, walls, paths and areas (rings (n, 2) [m], world frame)."""
    text = h5py.string_dtype("utf-8")
    file["/bodies/id"] = np.array([body.id for body in scene.bodies], dtype=np.int32)
    for column in ("kind", "name"):
        values = [getattr(body, column) for body in scene.bodies]
        file.create_dataset(f"/bodies/{column}", data=values, dtype=text)
    for i, parts in enumerate(unpack(scene.shapes)[: len(scene.start)]):
        for p, part in enumerate(parts):
            file[f"{layout.FOOTPRINTS.format(i)}/{p:02d}"] = part
    file["/robots/stop_station"] = np.asarray(scene.stop_station, dtype=np.float64)
    file["/robots/lead"] = np.asarray(scene.formation.lead, dtype=np.float64)
    for field in ("vertices", "part_start", "body_start"):
        file[f"/walls/{field}"] = getattr(scene.walls, field)
    for group, lines in (("/paths", scene.paths), ("/reference", scene.reference)):
        file[f"{group}/points"] = lines.points
        file[f"{group}/start"] = lines.start
    for group, rings in (("/areas/accessible", accessible), ("/areas/safe", safe)):
        arrays = [np.asarray(ring, dtype=np.float64).reshape(-1, 2) for ring in rings]
        file[f"{group}/points"] = np.concatenate([np.zeros((0, 2)), *arrays])
        lengths = [0, *(len(ring) for ring in arrays)]
        file[f"{group}/start"] = np.cumsum(lengths).astype(np.int64)


def write_declared(file: h5py.File, declared: Declared) -> None:
    """Write modes, rules and columns of the controller, in the order of their numbers."""
    text = h5py.string_dtype("utf-8")
    for group, rows, fields in (
        ("/modes", declared.modes, ("name", "words", "colour")),
        ("/rules", declared.rules, ("name", "words")),
        ("/columns", declared.columns, ("name", "unit", "words")),
    ):
        for field in fields:
            values = np.array([getattr(row, field) for row in rows], dtype=object)
            file.create_dataset(f"{group}/{field}", data=values, dtype=text)
    file["/modes/danger"] = np.array([mode.danger for mode in declared.modes], dtype=np.int8)


def unpack(shapes: Shapes) -> tuple[tuple[FloatArray, ...], ...]:
    """Convex parts (n, 2) of every body of packed shapes."""
    vertices = np.split(shapes.vertices, shapes.part_start[1:-1])
    starts: NDArray[np.int64] = shapes.body_start
    return tuple(tuple(vertices[first:last]) for first, last in pairwise(starts))


@functools.cache
def _versions() -> dict[str, str]:
    """Versions of the libraries that made a record; looked up once, for it takes 2 ms."""
    found = {}
    for library in LIBRARIES:
        try:
            found[library] = version(library)
        except PackageNotFoundError:
            found[library] = "unknown"
    return found
