"""Write the record of a run as it goes: `RecordWriter`.

Rows on their way to a growing dataset are gathered in memory and written in bursts; shortest
and largest distances are kept over all physics steps, also those that are not recorded.
"""

from __future__ import annotations

import functools
import json
import os
import platform
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from itertools import accumulate
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any
from uuid import uuid4

import h5py
import numpy as np
from numpy.typing import ArrayLike, NDArray

from physim.errors import RecordError
from physim.geometry.shapes import IntArray
from physim.parts.declarations import Declared
from physim.parts.given import GivenSettings
from physim.record import layout
from physim.record.checks import open_record
from physim.record.crash_safe import PAGE, CrashSafeFile
from physim.record.reader import Record
from physim.record.table import Dataset
from physim.world.scene import Scene

if TYPE_CHECKING:
    from physim.geometry.clearance import Clearances

NOTHING = Declared()
LIBRARIES = ("physim", "numpy", "pymunk", "shapely", "h5py")
CHUNK_BYTES = 1 << 18
STATE_CHUNK = 1 << 13
"""Of kept states there are few."""
BUFFER_BYTES = 1 << 21


class Extremes:
    """Running extremes: ``rows`` (N,) of `layout.EXTREME`, ``farthest`` one `layout.FARTHEST`."""

    def __init__(self, robots: int) -> None:
        """Begin with nothing seen."""
        self.rows: NDArray[np.void] = np.full(
            robots, np.array((np.inf, -1, -1, np.inf, -1, -1), layout.EXTREME)
        )
        self.farthest: NDArray[np.void] = np.array((-np.inf, -1, -1, -1), layout.FARTHEST)

    def note(self, step: IntArray, found: Clearances) -> None:
        """Take the samples ``step`` (B,) into account; the earliest of equal values is kept."""
        if not len(step):
            return
        robots = np.arange(len(self.rows))
        columns = [field.name for field in layout.Layout.extremes.fields]
        for names, values, others in (
            (columns[:3], found.clearance, found.other),
            (columns[3:], found.boundary_clearance, found.boundary_other),
        ):
            at = np.argmin(values, axis=0)
            least = values[at, robots]
            closer = least < self.rows[names[0]]
            for name, now in zip(names, (least, step[at], others[at, robots]), strict=True):
                self.rows[name][closer] = now[closer]
        at = int(np.argmax(found.farthest))
        if found.farthest[at] > self.farthest["farthest"]:
            self.farthest[...] = (
                found.farthest[at], step[at], found.farthest_a[at], found.farthest_b[at],
            )  # fmt: skip


class RecordWriter:
    """Streams a run to an HDF5 file, or keeps it in memory.

    Rows are gathered and go to the file in bursts, at most every ``flush_every_s`` of wall time or
    when about 2 MB a dataset have come together, so memory stays flat. After every burst the file
    is complete: if the process is killed at any moment, ``h5py.File(path)`` and ``Record.load``
    read all up to the last burst. An existing file is replaced.
    """

    def __init__(
        self,
        path: str | os.PathLike[str] | None,
        scene: Scene,
        world_text: str,
        *,
        name: str | None = None,
        accessible: Sequence[ArrayLike] = (),
        safe: Sequence[ArrayLike] = (),
        safe_distance: float = 0.0,
        record_every: int | None = None,
        declared: Declared = NOTHING,
        tables: Sequence[str] = layout.OPTIONAL,
        given: Sequence[tuple[str, str]] = (),
        given_settings: Sequence[GivenSettings] = (),
        begun_at: int = 0,
        begun_along: ArrayLike | None = None,
        origin: layout.Origin = layout.NO_ORIGIN,
        judged: layout.Judged | None = None,
        flush_every_s: float = 0.5,
        overwrite: bool = True,
    ) -> None:
        """Begin the record of ``scene``; with ``path`` None it stays in memory.

        ``accessible`` and ``safe`` are rings (n, 2) [m] for pictures, ``safe`` at ``safe_distance``
        [m] from the boundaries. ``name`` and ``record_every`` [steps] are those of the scene's
        world where they are not given. ``declared`` are modes, rules and columns of the controller,
        ``tables`` the optional ones that the run fills, ``given`` the parts that came from Python,
        with their ``given_settings`` where these are known. ``begun_at`` is the step of the
        first sample, ``begun_along`` (N, 3) [m] where robots are then, as `Layout.begun_along` has
        it; ``origin`` is what a branch of a record went on from, ``judged`` the log that the poses
        are of. Raises RecordError where the file cannot be written, where another run is writing
        it, and, without ``overwrite``, where it exists; PhysimError for what is no regular file.
        """
        world = getattr(scene, "world", None)
        every = record_every or (int(world.time.record_every) if world else 1)
        self.path = None if path is None else Path(path)
        self.robots, self.moving = len(scene.start), len(scene.shapes.radius)
        self.extremes = Extremes(self.robots)
        self.arrived = np.full(self.robots, -1, dtype=np.int64)
        columns, steers = getattr(scene, "columns", 2), getattr(scene, "steers", False)
        names = [column.name for column in declared.columns]
        also = [f"/{name}" for name in tables] + [layout.Layout.steering.path] * steers
        self.types = layout.row_types(self.robots, self.moving, names, columns > 2, also)
        """type of the rows of each dataset that grows, by its path"""
        self._waiting: dict[str, list[NDArray[Any]]] = {path: [] for path in self.types}
        self._flush_every_s = flush_every_s
        self._disk: CrashSafeFile | None = None
        self._failure: RecordError | None = None
        attributes = {
            "format": layout.FORMAT,
            "version": layout.VERSION,
            "units": layout.UNITS,
            "name": name if name is not None else str(world.name) if world else "",
            "world": world_text,
            "seed": scene.seed,
            "dt": float(scene.dt),
            "steps_planned": scene.steps,
            "record_every": every,
            "tables": list(tables),
            "given": list(given),
            "safe_distance": float(safe_distance),
            "ended": np.array(b"running", dtype=f"S{layout.ENDED_BYTES}"),
            "begun_at": begun_at,
            "steps_run": begun_at,
            "rejected_contacts": 0,
            "bodies": list(scene.bodies),
            "declared": declared,
            "given_settings": list(given_settings),
            "versions": _versions(),
        }
        if origin.digest:
            attributes["origin"] = asdict(origin)
        if judged is not None:
            attributes["judged"] = judged
        packed = {
            "shapes": scene.shapes,
            "walls": scene.walls,
            "paths": scene.paths,
            "reference": scene.reference,
            "accessible": _rings(accessible),
            "safe": _rings(safe),
        }
        unknown = np.full((self.robots, 3), np.nan)
        self._values = {
            "/robots/stop_station": scene.stop_station,
            "/robots/lead": scene.formation.lead,
            **{one.path: getattr(packed[one.name], one.field) for one in layout.PACKED},
            layout.Layout.begun_along.path: unknown if begun_along is None else begun_along,
            layout.EXTREMES: self.extremes.rows,
            layout.EXTREMES_FARTHEST: self.extremes.farthest,
            layout.ARRIVED: self.arrived,
        }
        """what each other dataset holds; the last three change during the run"""
        try:
            with self._writing():
                self._file = self._open(overwrite)
                for key, value in attributes.items():
                    is_json = isinstance(value, list | dict | Declared | layout.Judged)
                    self._file.attrs[key] = json.dumps(value, default=asdict) if is_json else value
                self._file.create_group(layout.WALL_CLOCK)
                self._datasets = {
                    path: self._made(one, scene.steps // every + 2)
                    for path, one in layout.TABLE.items()
                    if one.needed or path in self.types
                }
                self.flush()
        except BaseException:
            self._abandon()
            raise

    def _made(self, one: Dataset[Any], samples: int) -> h5py.Dataset:
        """Make a dataset; one that grows, for a run of so many samples."""
        path = one.path
        if path not in self.types:
            return self._file.create_dataset(path, data=self._values[path], dtype=one.dtype)
        row = self.types[path]
        most = samples if path in layout.STEPS else samples * self.robots
        is_state = path in (layout.Layout.states.path, layout.Layout.state_bytes.path)
        rows = max(1, min((STATE_CHUNK if is_state else CHUNK_BYTES) // row.itemsize, most))
        return self._file.create_dataset(
            path, (0, *row.shape), row.base, maxshape=(None, *row.shape), chunks=(rows, *row.shape)
        )

    def append_steps(
        self,
        step: ArrayLike,
        pose: ArrayLike,
        clearance: ArrayLike,
        boundary_clearance: ArrayLike,
        steering: ArrayLike | None = None,
    ) -> None:
        """Append S samples: step (S,), pose (S, B, 3) of all that moves, clearances (S, N) [m].

        Also ``steering`` (B, N) [rad], where wheels steer.

        Goes to the file when the time has come; append the decisions and contacts of the samples
        before, then a killed run's tables end with its samples.
        """
        given = step, pose, clearance, boundary_clearance
        if steering is not None:  # before the samples, which say how many there are
            self._append(layout.Layout.steering.path, steering)
        for path, rows in zip(layout.STEPS, given, strict=True):
            self._append(path, rows)
        if time.monotonic() >= self._due:
            self.flush()

    def append(self, table: str, rows: NDArray[np.void]) -> None:
        """Append rows of a table (``updates``, ``contacts``, …), in the order of steps.

        Raises RecordError where they are not of its type, `types`.
        """
        path = f"/{table}"
        if rows.dtype != self.types[path]:
            raise RecordError(f"{path}: rows of type {rows.dtype}; {self.types[path]} expected")
        self._append(path, rows)

    def append_considered(self, decisions: NDArray[np.void], others: ArrayLike) -> None:
        """Append rows of `layout.CONSIDERING` and the robots that they count, in their order.

        Raises RecordError for rows of another type.
        """
        self.append("considered", decisions)
        self._append(layout.OTHERS, others)

    def keep_state(self, step: int, state: bytes) -> None:
        """Append a state of the run, from which another can start."""
        self._append(layout.Layout.state_bytes.path, np.frombuffer(state, np.uint8))
        row = np.array([(step, len(state))], self.types[layout.Layout.states.path])
        self._append(layout.Layout.states.path, row)

    def _append(self, path: str, rows: ArrayLike) -> None:
        """Gather rows; they go to the file when there are many. ValueError for another shape."""
        row, waiting = self.types[path], self._waiting[path]
        taken = np.array(rows, dtype=row.base)
        if taken.shape[1:] != row.shape:
            raise ValueError(f"{path}: rows {taken.shape[1:]}; {row.shape} expected")
        with self._writing():
            waiting.append(taken)
            if sum(one.nbytes for one in waiting) >= BUFFER_BYTES:
                self._write(path)

    def _write(self, path: str) -> None:
        """Hand what was gathered of a dataset to the library."""
        if self._waiting[path]:
            rows, dataset = np.concatenate(self._waiting[path]), self._datasets[path]
            self._waiting[path].clear()
            dataset.resize(len(dataset) + len(rows), axis=0)
            dataset[len(dataset) - len(rows) :] = rows

    def note_arrived(self, since: NDArray[np.int64]) -> None:
        """Set the physics steps (N,) from which on robots have arrived; -1 where they have not."""
        self.arrived[:] = since

    def note_extremes(self, step: ArrayLike, found: Clearances) -> None:
        """Take the clearances of B physics steps into account, see `Extremes.note`."""
        self.extremes.note(np.asarray(step, dtype=np.int64), found)

    def flush(self) -> None:
        """Make all that was appended so far readable. Raises RecordError when that fails."""
        with self._writing():
            for path in self.types:
                self._write(path)
            for path in (layout.EXTREMES, layout.EXTREMES_FARTHEST, layout.ARRIVED):
                self._datasets[path][...] = self._values[path]  # never older than the samples
            if self._disk is not None:
                self._disk.holding = True
            self._file.flush()
            if self._disk is not None:
                self._disk.commit()
        self._due = time.monotonic() + self._flush_every_s

    def close(
        self, ended: str, *, steps_run: int, rejected: int, wall_clock: Mapping[str, float]
    ) -> None:
        """Write what is left and close the record; ``ended`` is one of `layout.ENDED`.

        ``wall_clock`` are figures outside the digest, e.g. ``seconds`` and ``factor``.
        """
        if ended not in layout.ENDED:
            raise RecordError(f'ended "{ended}"; allowed: {", ".join(layout.ENDED)}')
        self.flush()
        attributes = self._file.attrs
        attributes.modify("steps_run", np.int64(steps_run))
        attributes.modify("rejected_contacts", np.int64(rejected))
        for key, value in wall_clock.items():
            self._file[layout.WALL_CLOCK].attrs[key] = float(value)
        attributes.modify("ended", np.array(ended.encode(), dtype=f"S{layout.ENDED_BYTES}"))
        self.flush()
        if self._disk is not None:
            with self._writing():
                self._disk.holding = True
                self._file.close()
                self._disk.commit()
                self._disk.close()

    def record(self) -> Record:
        """Return what was written, to be read; the writer must be closed."""
        file = self._file if self.path is None else open_record(self.path)
        return Record(file, self.path, _just_made=True)

    def _open(self, overwrite: bool) -> h5py.File:
        """Open the file, with an index that changes on disk at a flush only."""
        settings: dict[str, Any] = {"libver": "earliest", "rdcc_nbytes": 0}
        if self.path is None:
            settings |= {"driver": "core", "backing_store": False, "block_size": BUFFER_BYTES}
            return h5py.File(f"record {uuid4().hex}", "w", **settings)  # names must differ
        self._disk = CrashSafeFile(self.path)
        if not overwrite and os.path.lexists(self.path):
            raise RecordError(f"{self.path}: exists; give another path, or overwrite=True")
        self._disk.holding = True
        settings |= {"alignment_threshold": PAGE // 2, "alignment_interval": PAGE}
        file = h5py.File(self._disk, "w", **settings)
        cache = file.id.get_mdc_config()
        cache.evictions_enabled = False
        cache.incr_mode = cache.flash_incr_mode = cache.decr_mode = 0
        file.id.set_mdc_config(cache)
        return file

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Turn a failure of the disk into RecordError, the file left as the last flush made it."""
        if self._failure is not None:
            raise self._failure
        try:
            yield
        except OSError as error:
            told = f"{self.path}: cannot be written: {error.strerror or error}"
            self._failure = RecordError(told)
            self._abandon()
            raise self._failure from error

    def _abandon(self) -> None:
        """Close the file as the last flush left it; before the first flush nothing is left."""
        if self._disk is not None:
            self._disk.holding = True
        with suppress(OSError, RuntimeError, AttributeError):  # or it was never opened
            self._file.close()
        if self._disk is not None:
            self._disk.close()


def _rings(rings: Sequence[ArrayLike]) -> SimpleNamespace:
    """Rings (n, 2) as ``points`` and ``start`` of each."""
    arrays = [np.asarray(ring, dtype=np.float64).reshape(-1, 2) for ring in rings]
    return SimpleNamespace(
        points=np.concatenate([np.zeros((0, 2)), *arrays]),
        start=[*accumulate(map(len, arrays), initial=0)],
    )


@functools.cache
def _versions() -> dict[str, str]:
    """Versions of the libraries that made a record; looked up once, for it takes 2 ms.

    And the kind of processor: the same bits are due on that kind alone.
    """
    found = {"processor": platform.machine()}
    for library in LIBRARIES:
        try:
            found[library] = version(library)
        except PackageNotFoundError:
            found[library] = "unknown"
    return found
