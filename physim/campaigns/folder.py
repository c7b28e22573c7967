"""The folder of a campaign: what it is, its worlds, rows, results and kept records."""

from __future__ import annotations

import codecs
import csv
import fcntl
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from operator import attrgetter
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from physim._version import __version__
from physim.campaigns.rows import FOLDER as ROWS
from physim.campaigns.rows import Row, Rows, as_table, read_rows, told
from physim.campaigns.spec import Label, RunSpec, engine, identity_of, key_of, short_hash
from physim.errors import PhysimError
from physim.files import write_text, written
from physim.json_text import file_json, json_text
from physim.world.file.files import file_text

CAMPAIGN, RECORDS, WORLDS = "campaign.json", "records", "worlds"
RESULTS, PARQUET = "results.csv", "results.parquet"
UNTIL, LOCK, LEAGUE = "until.json", ".lock", "league.json"
STILLS, VIDEOS, PAGES = "stills", "videos", "pages"
"""Pictures of runs, by their keys, for reports"""
PARTS = (
    CAMPAIGN, RESULTS, PARQUET, UNTIL, LOCK, LEAGUE, ROWS, RECORDS, WORLDS, STILLS, VIDEOS, PAGES,
)  # fmt: skip
"""Files and folders of a campaign; the pages of reports stand beside them."""
FORMAT, VERSION = "physim-campaign", 1
SPAN = 1 << 40
"""Bytes of the file of locks, of which each part of the runs has its share"""
ORDER = ("world", "settings", "controller", "seed", "run")

Asked = Mapping[Label, tuple[range, ...]]
"""Seeds of each cell, in ranges that neither touch nor overlap, in ascending order"""
_Seed = Annotated[int, Field(ge=0, le=2**63)]


class Described(BaseModel):
    """A cell as the file of a campaign has it: its names, and the hashes of what they are."""

    model_config = ConfigDict(strict=True, frozen=True)
    world: str
    settings: str
    controller: str
    world_hash: Annotated[str, Field(pattern="^[0-9a-f]{1,64}$")]  # names a file
    source_hash: str
    physim: str
    engine: str
    draws: str = ""
    """what the seed draws there, in words"""
    seeds: Annotated[list[tuple[_Seed, _Seed]], Field(max_length=1000)] = []
    """it was asked for, first and end of each range"""

    @property
    def label(self) -> Label:
        """World, settings and controller."""
        return self.world, self.settings, self.controller

    @property
    def asked(self) -> tuple[range, ...]:
        """Seeds it was asked for."""
        return merged(range(*one) for one in self.seeds)


_CELLS = TypeAdapter(list[Described])


def merged(ranges: Iterable[range]) -> tuple[range, ...]:
    """Ranges of step 1 as few as they can be, in ascending order; empty ones are left out."""
    found: list[range] = []
    for one in sorted((one for one in ranges if one), key=lambda one: one.start):
        if found and one.start <= found[-1].stop:
            found[-1] = range(found[-1].start, max(found[-1].stop, one.stop))
        else:
            found.append(one)
    return tuple(found)


def is_part(path: Path, folder: Path) -> bool:
    """Whether a file is, or would be, a part of the campaign that ``folder`` holds."""
    try:
        inside = path.resolve().relative_to(folder.resolve())
    except (ValueError, OSError, RuntimeError):
        return False
    return inside.parts[:1] != () and inside.parts[0] in PARTS


class Folder:
    """A folder that holds a campaign, or is to hold one."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        self.rows = Rows(self.path)
        self._lock: int | None = None

    @property
    def records(self) -> Path:
        """Folder of the records that are kept."""
        return self.path / RECORDS

    def world_file(self, world_hash: str) -> Path:
        """File of an effective world, with the seed 0."""
        return self.path / WORLDS / f"{world_hash}.yaml"

    def open(
        self,
        cells: Iterable[RunSpec],
        asked: Mapping[Label, range] | None = None,
        part: tuple[int, int] | None = None,
        beside: bool = False,
    ) -> None:
        """Make the folder ready for runs of some cells, a spec of each; the seed does not matter.

        ``asked`` are the seeds of each cell that the folder is to have in the end; they are added
        to those of before. With ``beside`` cells may stand beside others that are there. Nobody
        else does the runs of ``part`` (one of so many) until `close`, or until this process is
        gone.

        Raises PhysimError where it holds another campaign or something else, cannot be written, or
        another sweep is at work.
        """
        cells = list(cells)
        wanted = {spec.label: _described(spec) for spec in cells}
        texts = {spec.world_hash: spec.text for spec in cells}
        known = {one.label: one for one in self.cells()} if self._is_there() else {}
        self._check(known, wanted, beside)
        try:
            for folder in (self.path / ROWS, self.records, self.path / WORLDS):
                folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise PhysimError(f"{self.path}: cannot be written: {error.strerror}") from None
        if part is not None:
            self._claim(*part)
        for world_hash, text in texts.items():
            if not (file := self.world_file(world_hash)).exists():
                write_text(file, text)
        found = wanted | known
        for label, one in (asked or {}).items():
            seeds = [(one.start, one.stop) for one in merged((*found[label].asked, one))]
            found[label] = found[label].model_copy(update={"seeds": seeds})
        if found != known:
            cells_ = [found[label].model_dump() for label in {**known, **wanted}]
            tree = {"format": FORMAT, "version": VERSION, "physim": __version__,
                    "engine": engine(), "cells": cells_}  # fmt: skip
            write_text(self.path / CAMPAIGN, json_text(tree))

    def _claim(self, number: int, of: int) -> None:
        """Take the locks of a part of the runs; where the file system knows none, all may be had.

        They are gone with this process.
        """
        first, end = SPAN * (number - 1) // of, SPAN * number // of
        try:
            flags = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC
            self._lock = os.open(self.path / LOCK, flags, 0o666)
        except OSError as error:
            raise PhysimError(f"{self.path}: cannot be written: {error.strerror}") from None
        try:
            fcntl.lockf(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB, end - first, first)
        except (BlockingIOError, PermissionError):
            self.close()
            raise PhysimError(
                f"{self.path}: another sweep is at work in this folder; wait until it ends, or "
                "give each a part of the runs by --shard I/N"
            ) from None
        except OSError:
            pass

    def close(self) -> None:
        """Let others do its runs."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def asked(self) -> Asked:
        """Seeds that each cell was asked for, where that is known: with ``--until`` it is not.

        Raises PhysimError as `cells`.
        """
        return {one.label: one.asked for one in self.cells() if one.asked}

    def cells(self) -> list[Described]:
        """What there are runs of. Raises PhysimError where this is no folder of a campaign."""
        try:
            tree = read_tree(self.path / CAMPAIGN, FORMAT, VERSION)
        except NotADirectoryError:
            raise PhysimError(f"{self.path}: is a file; a campaign is a folder") from None
        if tree is None:
            raise PhysimError(
                f"{self.path}: holds no campaign (physim sweep WORLD -o {self.path} makes one)"
            )
        try:
            found = _CELLS.validate_json(json.dumps(tree.get("cells")))
        except ValidationError as error:
            raise PhysimError(f"{self.path / CAMPAIGN}: cells: {told(error)}") from None
        if len({one.label for one in found}) < len(found):
            raise PhysimError(f"{self.path / CAMPAIGN}: cells: one is there twice")
        return found

    def _is_there(self) -> bool:
        """Whether it holds a campaign; PhysimError where it holds something else."""
        try:
            there = {one for one in os.listdir(self.path) if not one.startswith(".")}
        except FileNotFoundError:
            return False
        except NotADirectoryError:
            raise PhysimError(f"{self.path}: is a file; rows take a folder") from None
        except OSError as error:
            raise PhysimError(f"{self.path}: cannot be read: {error.strerror}") from None
        is_one = CAMPAIGN in there
        begun = {ROWS, RECORDS, WORLDS, LEAGUE}  # another sweep may just be making it
        if not is_one and there - begun:
            raise PhysimError(
                f"{self.path}: is not empty and holds no campaign; give another folder"
            )
        return is_one

    def _check(
        self, known: dict[Label, Described], wanted: dict[Label, Described], beside: bool
    ) -> None:
        """Raise PhysimError where its campaign is another than the one that is wanted.

        It may have more cells than are wanted or fewer, but those in both must be the same; with
        ``beside`` it may have more and lack some.
        """
        for label in known.keys() & wanted.keys():
            one, other = known[label], wanted[label]
            words = []
            if one.world_hash != other.world_hash:
                words.append("the world was changed")
            if one.source_hash != other.source_hash:
                words.append(
                    "the source of its controller or of a stage, or a file they name, was changed"
                )
            for key in ("physim", "engine"):
                there, here = getattr(one, key), getattr(other, key)
                if there != here:
                    words.append(f"{key} {there} there, {here} here")
            if words:
                raise PhysimError(
                    f"{self.path}: holds a campaign of another {label[0]}: {', '.join(words)}; "
                    "give another folder"
                )
        one_in_other = known.keys() >= wanted.keys() or known.keys() <= wanted.keys()
        if known and not (one_in_other or beside):
            named = ", ".join(filter(None, next(label for label in known if label not in wanted)))
            raise PhysimError(
                f"{self.path}: holds another campaign (of {named}, which is not wanted here); give "
                "another folder, or one that it is part of"
            )


def _described(spec: RunSpec) -> Described:
    return Described(
        world=spec.world, settings=spec.settings, controller=spec.controller,
        world_hash=spec.world_hash, source_hash=spec.source_hash, physim=__version__,
        engine=engine(), draws=spec.draws,
    )  # fmt: skip


def read_tree(path: Path, format: str, version: int) -> dict[str, Any] | None:
    """A file of a campaign; None where there is none.

    Raises PhysimError for one that cannot be read, of another format or of a later version, and
    NotADirectoryError.
    """
    try:
        found = file_json(path)
        if not isinstance(found, dict) or found.get("format") != format:
            raise ValueError("another format")
        there = found.get("version")
        if not isinstance(there, int) or isinstance(there, bool) or there < 1:
            raise ValueError(f"version: must be a whole number from 1; given: {str(there)[:40]}")
    except FileNotFoundError:
        return None
    except NotADirectoryError:
        raise
    except OSError as error:
        raise PhysimError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise PhysimError(f"{path}: cannot be read ({error})") from None
    if there > version:
        raise PhysimError(
            f"{path}: has version {there}; this physim ({__version__}) reads {version}: it was "
            "written by a later one"
        )
    return found


def read(folder: str | os.PathLike[str]) -> list[Row]:
    """All rows, each run once, in the order of world, settings, controller and seed.

    Of a run that was done again the last row that did not fail, else the last. Raises PhysimError
    where there is no campaign, a file of rows cannot be read, or a row is of no run of the campaign
    (its cell is not in ``campaign.json``, or its key is not that of its cell and seed).
    """
    place = Folder(folder)
    known = _keys_of(place)

    def rows() -> Iterator[Row]:
        for file in place.rows.files():
            for number, row in enumerate(read_rows(file), 1):
                if why := _of_no_run(row, known):
                    where = f"{file}:{number}"
                    raise PhysimError(f"{where}: {why}; is this a row of another campaign?")
                yield row

    return each_once(rows())


def _keys_of(place: Folder) -> dict[Label, tuple[str, ...]]:
    """Of each cell the identity of its runs, world, versions. PhysimError for a changed world."""
    found: dict[Label, tuple[str, ...]] = {}
    for one in place.cells():
        text = file_text(file := place.world_file(one.world_hash))
        if short_hash(text) != one.world_hash:
            raise PhysimError(f"{file}: was changed since its runs were made")
        identity = identity_of(text, one.controller, one.source_hash, one.physim, one.engine)
        found[one.label] = identity, one.world_hash, one.physim, one.engine
    return found


def _of_no_run(row: Row, known: Mapping[Label, tuple[str, ...]]) -> str:
    """Why a row is of no run of these cells; empty where it is of one."""
    label = row.world, row.settings, row.controller
    if label not in known:
        return f"{CAMPAIGN} has no runs of {', '.join(filter(None, label))}"
    identity, *made_by = known[label]
    if [key_of(identity, row.seed), *made_by] != [row.run, row.world_hash, row.physim, row.engine]:
        what = f"{CAMPAIGN} makes of its world, controller and seed {row.seed}"
        return f"run {row.run} is not what {what}"
    return ""


def each_once(rows: Iterable[Row]) -> list[Row]:
    """Of each run the last row that did not fail, or its last row, in the order of cells."""
    found: dict[str, Row] = {}
    for row in rows:
        before = found.get(row.run)
        if before is None or before.failed or not row.failed:
            found[row.run] = row
    return sorted(found.values(), key=attrgetter(*ORDER))


def write_results(folder: Path) -> None:
    """Write all rows to ``results.csv``, whole or not at all. Raises PhysimError as `read`.

    A ``results.parquet`` of before goes: it would lack rows.
    """
    rows = read(folder)
    with written(folder / RESULTS) as stream:
        lines = csv.writer(codecs.getwriter("utf-8")(stream), lineterminator="\n")
        lines.writerows(as_table(rows))
        (folder / PARQUET).unlink(missing_ok=True)
