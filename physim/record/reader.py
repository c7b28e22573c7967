"""Read the record of a run: `Record`."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Mapping
from contextlib import closing
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import h5py
import numpy as np
from numpy.typing import NDArray

from physim.contacts import Kind, Phase
from physim.errors import PhysimError, RecordError, nearest
from physim.escaping import escaped
from physim.files import draft
from physim.geometry.shapes import FloatArray, IntArray, body_parts, read_only
from physim.html import labelled
from physim.parts.declarations import Mode
from physim.record import layout
from physim.record.checks import (
    AGAIN,
    attributes_of,
    check_datasets,
    check_rows,
    has_column,
    open_record,
    reading,
    reading_world,
)
from physim.record.course import followed
from physim.record.digest import digest_of, texts
from physim.record.lock import WriteLock
from physim.record.setup import Setup, setup_of
from physim.record.table import Dataset, Property
from physim.world.rules import MOST_STEPS

if TYPE_CHECKING:
    import pandas as pd

    from physim.world import World
    from physim.world.scene import Scene

POSE_BLOCK, POSE_BLOCKS = 1 << 14, 32
"""Poses read at once where single samples are asked for; how many such blocks are kept: 12 MB"""


class Record(layout.Layout):
    """One run of N robots with K recorded samples: lengths [m], angles [rad], world frame.

    All that is in the file are properties, too. Arrays are read when first asked for and are
    read-only; close the record, or use it in a ``with`` block, when done.
    In a file whose run was killed (``ended`` is "running") the tables end with the last recorded
    sample.
    """

    def __init__(
        self, file: h5py.File, path: Path | None = None, *, _just_made: bool = False
    ) -> None:
        """Read an open file. Raises RecordError where it is no record with all its parts.

        ``path`` is where it lies, as messages name it; values are checked when they are read.
        Raises TypeError for what is no open file, such as its path.
        """
        if not isinstance(file, h5py.File):
            raise TypeError(f"Record is made of an open file; Record.load({file!r}) opens one")
        in_memory = path is None and file.driver in ("core", "fileobj")
        self.path = path
        self.where = "record in memory" if in_memory else str(path or file.filename)
        """what messages call it"""
        self._handle = file
        vars(self).update(attributes_of(file, self.where))
        self.robots = sum(body.kind == "robot" for body in self.bodies)
        self.moving = layout.moving(self.bodies)
        """number of bodies that move, B: robots, movers, obstacles that can be pushed"""
        bodies, declared = len(self.bodies), self.declared
        if not _just_made:
            sizes = {"N": self.robots, "N+1": self.robots + 1, "B": self.moving}
            sizes |= {"B+1": self.moving + 1, "W+1": bodies - self.moving + 1}
            names = [column.name for column in declared.columns]
            sideways = has_column(file, layout.Layout.commands.path, f"applied_{layout.SIDEWAYS}")
            types = layout.row_types(self.robots, self.moving, names, sideways)
            sizes |= {"2": 2, "3": 3}
            check_datasets(file, self.where, self.tables, sizes, types)
        grown = [path for path in (*layout.STEPS, layout.Layout.steering.path) if path in file]
        self.samples = min(len(file[path]) for path in grown)
        """how many samples were recorded"""
        self._highest = {
            "robots": self.robots - 1,
            "moving": self.moving - 1,
            "bodies": bodies - 1,
            "modes": len(declared.modes) - 1,
            "rules": len(declared.rules) - 1,
            "steps": MOST_STEPS if self.ended == "running" else self.steps_run,
            **{of.path: len(file[of.path]) - bool(of.starts) for of in layout.PACKED},
        }
        self._rows = dict.fromkeys(grown, self.samples)
        """how many rows are read of a dataset; all, where nothing is said"""
        if self.ended == "running":
            self._cut_off()

    def _cut_off(self) -> None:
        """Leave out what was written after the last sample of a run that was killed."""
        last = int(self.steps[-1]) if self.samples else -1
        self.steps_run = max(self.begun_at, last)
        for path in filter(self.holds, layout.TABLES):
            with reading(self.where, path):
                step = self._file[path].fields("step")[()]
            self._rows[path] = int(np.count_nonzero(step <= last))
        counted = np.cumsum(self.read("/considered", check=False)["count"], dtype=np.int64)
        there = np.searchsorted(counted, self._file[layout.OTHERS].size, side="right")
        self._rows["/considered"] = int(there)  # the last ones may not have been written
        self._rows[layout.OTHERS] = int(counted[there - 1]) if there else 0

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Record:
        """Open a record file, or that of the folder of a run.

        Raises RecordError with one line that says what is wrong with it.
        """
        path = Path(path)
        if os.path.isdir(path):
            path /= "record.h5"
        file = open_record(path)
        try:
            record = cls(file, path)
            record._check_values()
            return record
        except BaseException:
            file.close()
            raise

    def _check_values(self) -> None:
        """Read all but what is large, samples and what was sensed, which is checked when read.

        Raises RecordError, one line: table, row, what was given, what is allowed.
        """
        for name, one in vars(layout.Layout).items():
            shape = one.shape[:2] if isinstance(one, Dataset) else ()
            if (
                name != layout.SENSED
                and shape not in (("K", "N"), ("K", "B"), ("S",))
                and isinstance(one, Property)
            ):
                getattr(self, name)
        _ = self.considered
        first, last = self.steps[[0, -1]].tolist() if self.samples else (self.begun_at, -1)
        whole = first == self.begun_at and (last == self.steps_run or self.ended == "running")
        if not whole or last - first > self.samples * self.record_every:
            raise RecordError(
                f"{self.where}: truncated: {self.samples} samples from step {first} to {last}, one "
                f"every {self.record_every} steps, for {self.steps_made} steps; {AGAIN}"
            )

    # The open file

    @property
    def _file(self) -> h5py.File:
        """The open file. Raises RecordError where the record was closed."""
        if not self._handle:
            raise RecordError(
                f"{self.where}: the record was closed, so that nothing more is read of it; read "
                "before the end of its with block, or load it again"
            )
        return self._handle

    def read(
        self, path: str, first: int = 0, last: int | None = None, *, check: bool = True
    ) -> NDArray[Any]:
        """Rows ``first`` to ``last - 1`` of a dataset, read-only, without keeping them.

        Of the attributes ``bodies`` and ``declared`` it reads their columns, as ``/bodies/name``.
        Raises RecordError when they cannot be read, and, with ``check``, for values that no run
        writes.
        """
        if path not in layout.TABLE:
            return texts(self.bodies, self.declared)[path][first:last]
        if path == layout.Layout.sensed.path and not self.holds(path):
            raise RecordError(
                f"{self.where}: what robots sensed was not kept; physim run --keep-sensed, or "
                "simulate(world, save=SaveAt(sensed=True)), keeps it"
            )
        if not self.holds(path):
            return read_only(np.zeros((self.samples, self.robots))[first:last])
        end = self._rows.get(path, last)
        last = end if last is None or end is None else min(last, end)
        with reading(self.where, path):
            dataset = self._file[path]
            rows = np.asarray(dataset[first:last] if dataset.ndim else dataset[()], dataset.dtype)
        if check:
            check_rows(self.where, layout.TABLE[path], rows, first, self._highest)
        return read_only(rows)

    def holds(self, path: str) -> bool:
        """Whether the file has a dataset; it may lack those that not every record needs."""
        return layout.TABLE[path].needed or path in self._file

    @property
    def columns(self) -> int:
        """Numbers of a command: v, omega and, in a world with an omnidirectional robot, lateral."""
        return 3 if f"nominal_{layout.SIDEWAYS}" in (self.commands.dtype.names or ()) else 2

    def close(self) -> None:
        """Close the file; what was read stays, nothing more can be read."""
        self._handle.close()

    def __enter__(self) -> Record:
        """Use in a ``with`` block, which closes the record."""
        return self

    def __exit__(self, *exception: object) -> None:
        """Close the record."""
        self.close()

    def __repr__(self) -> str:
        """Name, seed, size and end of the run."""
        size = f"{self.robots} robots, {self.samples} samples"
        return f'<Record "{self.name}" seed {self.seed}: {size}, ended "{self.ended}">'

    def _repr_html_(self) -> str:
        """What a notebook shows of it; `physim.page` shows the run itself."""
        began = self.contacts["phase"] == Phase.BEGAN
        found = np.count_nonzero(began & (self.contacts["kind"] == Kind.PHYSICAL))
        return labelled(
            [
                ("record", self.name),
                ("seed", str(self.seed)),
                ("controller", self.setup.controller_names),
                ("robots", str(self.robots)),
                ("samples", f"{self.samples}, one every {self.record_every * self.dt:g} s"),
                *([("begun", f"at {self.begun:g} s")] if self.begun_at else []),
                ("ended", f'"{self.ended}" after {self.steps_run * self.dt:g} s'),
                ("contacts", str(found) if "contacts" in self.tables else "not recorded"),
                ("to watch it", "physim.page(record)"),
            ]
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle or copy: the file is opened again. Raises TypeError for a record in memory."""
        if self.path is None:
            raise TypeError("a record in memory cannot be pickled or copied; save() it to a file")
        return Record.load, (self.path.absolute(),)

    # What the run was made with

    @property
    def controller(self) -> str:
        """What decided, ``module:Class`` of an object given from Python; empty where it was the
        world's own controller."""
        return dict(self.given).get("controller", "")

    @property
    def controller_name(self) -> str:
        """The world's own controller: ``module:Class`` of one given from Python, or as the world
        inside names it; empty where there is no text of a world."""
        if self.controller or not self.world_text.strip():
            return self.controller
        return self.world.controller.type

    @cached_property
    def setup(self) -> Setup:
        """Controller, stages and versions of the run. RecordError where its world is no YAML."""
        return setup_of(self)

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Modes that the controller declares; the column ``mode`` has their numbers."""
        return self.declared.modes

    @cached_property
    def world(self) -> World:
        """The effective world. Raises RecordError where its text is faulty.

        Its controller stands as it was named, ``module:Class`` too: nothing is looked up or
        imported, and the controller's settings are as they were recorded.
        """
        from physim.world.file import parse_world

        with reading_world(self.where):
            return parse_world(self.world_text, f"world of {self.where}", check_controller=False)

    @cached_property
    def scene(self) -> Scene:
        """The effective world made ready to run. Raises RecordError where it cannot be built."""
        from physim.world.layout.scene_builder import build_scene

        with reading_world(self.where):
            return build_scene(self.world)

    @cached_property
    def world_settings(self) -> Mapping[str, Any]:
        """The effective world as plain values, as they stand in its text; empty where it has none.

        For figures of a few keys, of a world that need not be valid. Raises RecordError where its
        text is no YAML.
        """
        from physim.world.file import read_document

        with reading_world(self.where):
            found = read_document(self.world_text, f"world of {self.where}").values
        return found if isinstance(found, Mapping) else {}

    @cached_property
    def wall_clock(self) -> dict[str, float]:
        """Figures of the wall clock; empty while running."""
        group = self._file.get(layout.WALL_CLOCK)
        return {} if group is None else {key: float(value) for key, value in group.attrs.items()}

    # The scene

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the N robots: labels only."""
        return tuple(body.name for body in self.bodies[: self.robots])

    @cached_property
    def footprints(self) -> tuple[tuple[FloatArray, ...], ...]:
        """Convex parts (n, 2) [m] of each robot, in its frame."""
        return tuple(tuple(body_parts(self.shapes, body)) for body in range(self.robots))

    # What happened

    @cached_property
    def time(self) -> FloatArray:
        """(K,) [s] since step 0."""
        return read_only(self.steps * self.dt)

    @property
    def begun(self) -> float:
        """[s] of the first sample: 0, or where the run went on from the state of another."""
        return self.begun_at * self.dt

    @property
    def steps_made(self) -> int:
        """Physics steps from the first sample to the last."""
        return self.steps_run - self.begun_at

    @cached_property
    def pose(self) -> FloatArray:
        """(K, N, 3) [m, m, rad] x, y, heading, unwrapped, of the robots."""
        if self.moving == self.robots:
            return self.moving_pose
        return read_only(np.ascontiguousarray(self.moving_pose[:, : self.robots]))

    def pose_at(self, step: int) -> FloatArray:
        """(B, 3) poses of all that moves at a recorded step, robots first. Raises RecordError for a
        step that is not recorded."""
        row = int(np.searchsorted(self.steps, step))
        if row == self.samples or self.steps[row] != step:
            closest = self.steps[np.argmin(np.abs(self.steps - step))] if self.samples else "none"
            raise RecordError(f"{self.where}: step {step} is not recorded; nearest: {closest}")
        block, place = divmod(row, max(1, POSE_BLOCK // self.moving))
        pose: FloatArray = self._pose_block(block)[place]
        return pose

    @cached_property
    def _pose_block(self) -> Callable[[int], FloatArray]:
        """Reads a block of the poses by its number; the last few are kept."""
        rows, path = max(1, POSE_BLOCK // self.moving), layout.Layout.moving_pose.path
        return lru_cache(POSE_BLOCKS)(lambda k: self.read(path, k * rows, (k + 1) * rows))

    @cached_property
    def course(self) -> FloatArray:
        """(K, N, 3) [m] at each sample: station on the own path, deviation from it (left positive),
        station on s*. Worked out from the poses, so that it does not depend on who decided when."""
        return read_only(followed(self))

    def column(self, name: str, *, absent: float | None = None) -> FloatArray:
        """(M,) values of a column of the decisions.

        ``absent`` stands in each place where the controller declares none such; where it is not
        given either, that raises RecordError.
        """
        names = self.updates.dtype.names or ()
        if name not in names:
            if absent is not None:
                return read_only(np.full(len(self.updates), absent))
            raise RecordError(
                f'{self.where}: no column "{escaped(name)}"; allowed: {", ".join(names)}'
                f"{nearest(name, [*names])}"
            )
        return np.asarray(self.updates[name], dtype=np.float64)

    def commands_over(
        self, stage: Literal["nominal", "filtered", "applied"], first: int, last: int
    ) -> FloatArray:
        """(last - first, N, columns) command of each robot over steps ``first`` to ``last - 1``.

        [m/s, rad/s, m/s]; a robot's command is 0 before its first decision, and that of its last
        one after the run, however far. Raises PhysimError for another stage.
        """
        stages = list(layout.COMMAND_STAGES)
        if stage not in stages:
            raise PhysimError(
                f"commands_over: stage is {stage!r}; allowed: {', '.join(stages)}"
                f"{nearest(str(stage), stages)}"
            )
        steps = max(0, last - first)
        parts = layout.PARTS[: self.columns]
        held = np.zeros((steps, self.robots, len(parts)))
        if not steps:
            return held
        updates = self.updates
        nominal = np.stack([updates[f"nominal_{part}"] for part in parts], axis=1)
        at = np.zeros((steps, self.robots), dtype=np.int64)  # row + 1 of the decision that holds
        begin = int(np.searchsorted(updates["step"], first, side="right"))
        end = int(np.searchsorted(updates["step"], last))
        robot, from_end = np.unique(updates["robot"][:begin][::-1], return_index=True)
        at[0, robot] = begin - from_end
        rows = np.arange(begin, end)
        at[updates["step"][rows] - first, updates["robot"][rows]] = rows + 1
        np.maximum.accumulate(at, axis=0, out=at)
        held[at > 0] = nominal[at[at > 0] - 1]
        table = self.commands
        mine = table[slice(*np.searchsorted(table["step"], (first, last)))]
        place = mine["step"] - first, mine["robot"]
        held[place] = np.stack([mine[f"{stage}_{part}"] for part in parts], axis=1)
        return held

    @cached_property
    def considered(self) -> NDArray[np.void]:
        """Robots considered in decisions, rows of `layout.CONSIDERED` in the order of steps."""
        count = self.considering["count"]
        if (counted := int(count.sum(dtype=np.int64))) != len(self.others):
            raise RecordError(
                f"{self.where}: {layout.OTHERS} has {len(self.others)} rows; /considered counts "
                f"{counted}; {AGAIN}"
            )
        rows = np.empty(len(self.others), dtype=layout.CONSIDERED)
        for name in ("step", "robot"):
            rows[name] = np.repeat(self.considering[name], count)
        rows["other"] = self.others
        return read_only(rows)

    def contacts_over(self, first: int, last: int) -> NDArray[np.void]:
        """Those rows of `contacts` of steps ``first`` to ``last - 1``."""
        return self.contacts[slice(*np.searchsorted(self._contact_steps, (first, last)))]

    @cached_property
    def _contact_steps(self) -> IntArray:
        return np.ascontiguousarray(self.contacts["step"])

    @property
    def noted_until(self) -> int:
        """Last step of which anything is told: of a run that was killed extremes and arrivals may
        be of steps after its last sample."""
        if self.ended != "running":
            return self.steps_run
        rows = self.extremes
        told = rows["clearance_step"], rows["boundary_step"], self.arrived, self.farthest["step"]
        return max(self.steps_run, *(int(steps.max(initial=0)) for steps in told))

    # As a whole

    def digest(self) -> str:
        """SHA-256 (hexadecimal) of all but the wall clock, the versions and kept states.

        Two runs of the same world, seed and version on one machine have equal digests; so have a
        record in memory and its copy on disk.
        """
        return digest_of(self, self._file.attrs)

    def to_pandas(self, table: str = "steps") -> pd.DataFrame:
        """Data frame of a table: "steps" (a row for each sample and robot), "updates" (decisions),
        "commands", "considered", "contacts", "false_contacts" or "sensed"; columns and units as in
        the record, with times [s] and names.

        Raises PhysimError for another table, and where pandas is not installed.
        """
        from physim.record.frames import frame

        return frame(self, table)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a copy of the whole record to a file, in place of an earlier one.

        Raises RecordError when that fails, and where a run is writing the file; PhysimError where
        there is something else than a file.
        """
        target = Path(path)
        try:
            with draft(target) as part, closing(WriteLock(target)):
                if self.path is not None:
                    shutil.copyfile(self.path, part)
                else:
                    self._file.flush()
                    part.write_bytes(self._file.id.get_file_image())
        except OSError as error:
            raise RecordError(f"{target}: cannot be written: {error.strerror}") from error


__all__ = ["Record"]
