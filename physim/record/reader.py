"""Read the record of a run: `Record`."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import h5py
import numpy as np

from physim.contacts import Kind, Phase
from physim.errors import Fault, PhysimError, RecordError, WorldError
from physim.files import draft
from physim.html import labelled
from physim.parts.declarations import Declared, Mode
from physim.parts.given import GivenSettings
from physim.record import layout
from physim.record.checks import check_layout, open_record, unreadable_world
from physim.record.history import RecordedHistory
from physim.record.layout import digest
from physim.record.lock import WriteLock
from physim.record.row_checks import Bounds
from physim.record.rows import NO_END
from physim.record.scene import read_declared
from physim.record.setup import Setup, setup_of
from physim.world.rules import MOST_STEPS

if TYPE_CHECKING:
    import pandas as pd

    from physim.world import World
    from physim.world.base import Model

    Section = TypeVar("Section", bound=Model)


def check_record(given: object) -> None:
    """Raise TypeError for what is no record, as a file, a world or a summary."""
    if not hasattr(given, "footprints"):
        raise TypeError(
            f"a Record is needed, not {type(given).__name__}; Record.load(file) or simulate(world) "
            "gives one"
        )


class Record(RecordedHistory):
    """One run of N robots with K recorded samples: lengths [m], angles [rad], world frame.

    Arrays are read when first asked for and are read-only; close the record, or use it in a
    ``with`` block, when done. In a file whose run was killed (``ended`` is "running") the tables
    end with the last recorded sample.
    """

    def __init__(self, file: h5py.File, path: Path | None = None) -> None:
        """Read an open file. Raises RecordError where it is no record with all its parts.

        ``path`` is where it lies, as messages name it; values are checked when they are read.
        Raises TypeError for what is no open file, such as its path.
        """
        if not isinstance(file, h5py.File):
            raise TypeError(f"Record is made of an open file; Record.load({file!r}) opens one")
        check_layout(file, _named(file, path))
        self._begin(file, path)

    def _begin(self, file: h5py.File, path: Path | None, declared: Declared | None = None) -> None:
        """Take what is needed at once from a file that has the layout of a record.

        ``declared`` is what the controller declared, where that need not be read.
        """
        self.path = path
        attributes, where = file.attrs, _named(file, path)
        self.name = str(attributes["name"])
        self.world_text = str(attributes["world"])
        """YAML text of the effective world"""
        self.seed = int(attributes["seed"])
        self.dt = float(attributes["dt"])
        """[s] physics step"""
        self.steps_planned = int(attributes["steps_planned"])
        self.steps_run = int(attributes["steps_run"])
        self.record_every = int(attributes["record_every"])
        """[steps] between two recorded samples"""
        self.safe_distance = float(attributes["safe_distance"])
        """[m] at which ``safe`` was drawn"""
        self.ended = attributes["ended"].decode()
        """"running" (it was killed), "finished", "duration", "interrupted" or "error\""""
        self.rejected_contacts = int(attributes["rejected_contacts"])
        self.tables: tuple[str, ...] = tuple(json.loads(attributes["tables"]))
        """the optional tables (`layout.OPTIONAL`) that the run recorded; others are empty"""
        self.given = tuple((str(kind), str(name)) for kind, name in json.loads(attributes["given"]))
        """parts that came from Python beside or in place of what the world names: kind and name"""
        self.declared = read_declared(file, where) if declared is None else declared
        """modes, rules and columns of the controller"""
        killed = self.ended == "running"
        bounds = Bounds(
            int(file["/robots/stop_station"].size), int(file["/bodies/id"].size),
            NO_END if killed else self.steps_run,
            len(self.declared.modes), len(self.declared.rules), self.record_every,
        )  # fmt: skip
        super().__init__(file, where, bounds, min(len(file[path]) for path in layout.STEPS))
        if killed:
            self.steps_run = max(0, self._cut_tables())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Record:
        """Open a record file. Raises RecordError with one line that says what is wrong with it."""
        file = open_record(Path(path))
        try:
            record = cls(file, Path(path))
            record.check_values()
            return record
        except BaseException:
            file.close()
            raise

    @classmethod
    def _just_made(cls, file: h5py.File, path: Path | None, declared: Declared) -> Record:
        """A file that `RecordWriter` made in this process: what it wrote is checked when it is
        first read, and the layout needs no check."""
        record = cls.__new__(cls)
        record._begin(file, path, declared)
        return record

    def check_values(self) -> None:
        """Read steps, tables and starts, which checks them. Poses are checked when they are read.

        Raises RecordError, one line: table, row, what was given, what is allowed.
        """
        last = max(self.steps_run, int(self.steps[-1]) if self.samples else 0)
        if last > self.samples * self.record_every:
            raise RecordError(
                f"{self.where}: truncated: {self.samples} samples, one every {self.record_every} "
                f"steps, for {last} steps; make the record again"
            )
        if self.ended != "running" and not (self.samples and self.steps[-1] == self.steps_run):
            raise RecordError(
                f"{self.where}: truncated: no sample of step {self.steps_run}, the last one; make "
                "the record again"
            )
        if last > MOST_STEPS:
            raise RecordError(
                f"{self.where}: {last} steps; a run has at most {MOST_STEPS}; make the record again"
            )
        for path in layout.TABLES:
            getattr(self, path[1:])
        for name in ("steps", "arrived", "stop_station", "lead", "extremes", "farthest", "bodies",
                     "footprints", "walls", "paths", "reference", "accessible",
                     "safe"):  # fmt: skip
            getattr(self, name)

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
                ("controller", self.setup.controller.name),
                ("robots", str(self.robots)),
                ("samples", f"{self.samples}, one every {self.record_every * self.dt:g} s"),
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

    @property
    def controller(self) -> str:
        """What decided, ``module:Class`` of an object given from Python; empty where it was the
        world's own controller."""
        return dict(self.given).get("controller", "")

    @cached_property
    def setup(self) -> Setup:
        """Controller, stages and versions of the run. RecordError where its world is no YAML."""
        return setup_of(self.world_settings, self.given, self.versions, self.given_settings)

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Modes that the controller declares; the column ``mode`` has their numbers."""
        return self.declared.modes

    @cached_property
    def world(self) -> World:
        """The effective world. Raises WorldError where its text is faulty.

        Its controller stands as it was named, ``module:Class`` too: nothing is looked up or
        imported, and the controller's settings are as they were recorded.
        """
        from physim.world.file import parse_world

        where = f"world of {self.where}"
        return parse_world(self.world_text, where, check_controller=False)

    @cached_property
    def world_settings(self) -> Mapping[str, Any]:
        """The effective world as plain values, as they stand in its text; empty where it has none.

        For figures of a few keys, of a world that need not be valid. Raises RecordError where its
        text is no YAML.
        """
        from physim.world.file import read_document

        try:
            world = read_document(self.world_text, f"world of {self.where}").values
        except WorldError as error:
            raise unreadable_world(self.where, error) from error
        return world if isinstance(world, Mapping) else {}

    def section(self, key: str, model: type[Section]) -> Section | None:
        """A part of the effective world by its model, ``arrival``, say; None where it has none.

        The rest of that world need not be valid. Raises RecordError where this part is not.
        """
        given = self.world_settings.get(key)
        if given is None:
            return None
        if not isinstance(given, Mapping):
            raise RecordError(f"world of {self.where}: {key} must be a mapping of keys to values")
        try:
            return model(**given)
        except WorldError as error:
            fault = error.faults[0]
            told = Fault((key, *fault.location), fault.message)
            raise RecordError(f"world of {self.where}: {told}") from None

    @cached_property
    def given_settings(self) -> tuple[GivenSettings, ...]:
        """Settings of the parts in ``given``, in their order; empty where the record has none."""
        found = json.loads(self._file.attrs.get("given_settings", "[]"))
        return tuple(GivenSettings(one["settings"], tuple(one["not_known"])) for one in found)

    @cached_property
    def versions(self) -> dict[str, str]:
        """Versions of physim and its libraries that made the record."""
        return dict(json.loads(self._file.attrs.get("versions", "{}")))

    @cached_property
    def wall_clock(self) -> dict[str, float]:
        """Figures of the wall clock; empty while running."""
        group = self._file.get(layout.WALL_CLOCK)
        return {} if group is None else {key: float(value) for key, value in group.attrs.items()}

    @property
    def noted_until(self) -> int:
        """Last step of which anything is told: of a run that was killed extremes and arrivals may
        be of steps after its last sample."""
        if self.ended != "running":
            return self.steps_run
        rows = self.extremes
        told = rows["clearance_step"], rows["boundary_step"], self.arrived, self.farthest["step"]
        return max(self.steps_run, *(int(steps.max(initial=0)) for steps in told))

    def digest(self) -> str:
        """SHA-256 of all but the wall clock and the versions, see `physim.record.layout`."""
        return digest(self, self._file)

    def to_pandas(self, table: str = "steps") -> pd.DataFrame:
        """Data frame of a table: "steps" (a row for each sample and robot), "updates" (decisions),
        "contacts"; columns and units as in the record, with times [s] and names.

        Raises PhysimError for another table, and where pandas is not installed.
        """
        from physim.record.frames import frame

        return frame(self, table)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a copy of the whole record to a file, in place of an earlier one.

        Raises RecordError when that fails, and where a run is writing the file.
        """
        target = Path(path)
        lock = None
        try:
            with draft(target) as part:
                lock = WriteLock(target)
                if self.path is not None:
                    shutil.copyfile(self.path, part)
                else:
                    self._file.flush()
                    part.write_bytes(self._file.id.get_file_image())
        except OSError as error:
            raise RecordError(f"{target}: cannot be written: {error.strerror}") from error
        except PhysimError as error:
            raise RecordError(str(error)) from None
        finally:
            if lock is not None:
                lock.release()


def _named(file: h5py.File, path: Path | None) -> str:
    """What messages call a file."""
    in_memory = file.driver in ("core", "fileobj")
    return "record in memory" if path is None and in_memory else str(path or file.filename)


__all__ = ["Record"]
