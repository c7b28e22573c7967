"""The folder of a campaign: what it is, its worlds, rows, results and kept records."""

from __future__ import annotations

import fcntl
import json
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from physim._version import __version__
from physim.campaigns.asked import Asked, as_stored, merged, ranges_of
from physim.campaigns.rows import FOLDER as ROWS
from physim.campaigns.rows import Shards, write_whole
from physim.campaigns.spec import Label, RunSpec, engine
from physim.errors import PhysimError
from physim.json_text import file_json
from physim.world.file.reading import MOST_BYTES

CAMPAIGN, RECORDS, WORLDS = "campaign.json", "records", "worlds"
RESULTS, UNTIL, CLAIMS = "results.parquet", "until.json", ".claims"
STILLS, VIDEOS, PAGES = "stills", "videos", "pages"
"""Pictures of runs, by their keys, for reports"""
PARTS = (CAMPAIGN, RESULTS, UNTIL, CLAIMS, ROWS, RECORDS, WORLDS, STILLS, VIDEOS, PAGES)
"""Files and folders of a campaign; the pages of reports stand beside them."""
FORMAT, VERSION = "physim-campaign", 1


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
        self.shards = Shards(self.path)

    @property
    def records(self) -> Path:
        """Folder of the records that are kept."""
        return self.path / RECORDS

    def open(self, cells: Iterable[RunSpec], asked: Mapping[Label, range] | None = None) -> None:
        """Make the folder ready for runs of some cells, a spec of each; the seed does not matter.

        ``asked`` are the seeds of each cell that the folder is to have in the end; they are added
        to those of before.

        Raises PhysimError where it holds another campaign or something else, or cannot be written.
        """
        wanted = {spec.label: spec for spec in cells}
        for spec in wanted.values():
            if len(spec.text.encode()) > MOST_BYTES:  # it could not be read again
                raise PhysimError(
                    f"{spec.world}: is too large for a campaign: written out it has more than "
                    f"{MOST_BYTES} bytes"
                )
        described = self._read() if self._is_there() else []
        known = [cell for cell, _ in described]
        before = {label_of(cell): seeds for cell, seeds in described if seeds}
        _check(self.path, known, wanted)
        try:
            for folder in (self.path / ROWS, self.records, self.path / WORLDS):
                folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise PhysimError(f"{self.path}: cannot be written: {error.strerror}") from None
        for spec in wanted.values():
            file = self.world_file(spec.world_hash)
            if not file.exists():
                write_whole(file, spec.text.encode())
        there = {label_of(one) for one in known}
        new = [_described(spec) for label, spec in wanted.items() if label not in there]
        seeds = dict(before)
        for label, one in (asked or {}).items():
            seeds[label] = merged((*before.get(label, ()), one))
        if new or not known or seeds != before:
            self._describe([*known, *new], seeds)

    def cells(self) -> list[dict[str, str]]:
        """What there are runs of: world, settings and controller, the hashes of what they are, and
        in words what the seed ``draws`` there.

        Raises PhysimError where this is no folder of a campaign.
        """
        return [cell for cell, _ in self._read()]

    def asked(self) -> Asked:
        """Seeds that each cell was asked for, where that is known: with ``--until`` it is not.

        Raises PhysimError as `cells`.
        """
        return {label_of(cell): seeds for cell, seeds in self._read() if seeds}

    def _read(self) -> list[tuple[dict[str, str], tuple[range, ...]]]:
        """Cells, and the seeds that each was asked for."""
        try:
            found = file_json(self.path / CAMPAIGN)
            if not isinstance(found, dict) or found.get("format") != FORMAT:
                raise ValueError("another format")
            check_version(self.path / CAMPAIGN, found.get("version"), VERSION)
            return _cells(found.get("cells"))
        except FileNotFoundError:
            raise PhysimError(
                f"{self.path}: holds no campaign (physim sweep WORLD -o {self.path} makes one)"
            ) from None
        except NotADirectoryError:
            raise PhysimError(f"{self.path}: is a file; a campaign is a folder") from None
        except OSError as error:
            raise PhysimError(f"{self.path / CAMPAIGN}: cannot be read: {error.strerror}") from None
        except ValueError as error:
            raise PhysimError(f"{self.path / CAMPAIGN}: cannot be read ({error})") from None

    def world_file(self, world_hash: str) -> Path:
        """File of an effective world, with the seed 0."""
        return self.path / WORLDS / f"{world_hash}.yaml"

    def _is_there(self) -> bool:
        """Whether it holds a campaign; PhysimError where it holds something else."""
        if (self.path / CAMPAIGN).exists():
            return True
        if self.path.exists() and not self.path.is_dir():
            raise PhysimError(f"{self.path}: is a file; rows take a folder")
        try:
            there = {one for one in os.listdir(self.path) if not one.startswith(".")}
        except FileNotFoundError:
            return False
        except OSError as error:
            raise PhysimError(f"{self.path}: cannot be read: {error.strerror}") from None
        if there - {ROWS, RECORDS, WORLDS}:  # another sweep may just be making it
            raise PhysimError(
                f"{self.path}: is not empty and holds no campaign; give another folder"
            )
        return False

    def _describe(self, cells: list[dict[str, str]], asked: Asked) -> None:
        tree: dict[str, Any] = {
            "format": FORMAT, "version": VERSION, "physim": __version__, "engine": engine(),
            "cells": [{**one, "seeds": as_stored(asked.get(label_of(one), ()))} for one in cells],
        }  # fmt: skip
        text = json.dumps(tree, indent=1, ensure_ascii=False)
        write_whole(self.path / CAMPAIGN, text.encode())


def check_version(file: Path, version: object, known: int) -> None:
    """Raise PhysimError for a file of a later version, ValueError for what is no version."""
    if not isinstance(version, int) or isinstance(version, bool) or version < 1:
        raise ValueError(f"version: must be a whole number from 1; given: {str(version)[:40]}")
    if version > known:
        raise PhysimError(
            f"{file}: has version {version}; this physim ({__version__}) reads {known}: it was "
            "written by a later one"
        )


class Claims:
    """Which runs are under way, for all sweeps of a folder: a lock each, gone with its process.

    Where the file system knows no locks every run may be had.
    """

    def __init__(self, folder: Path) -> None:
        self._fd = os.open(folder / CLAIMS, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)

    def take(self, key: str) -> bool:
        """Whether nobody else has this run under way; it is ours then."""
        try:
            fcntl.lockf(self._fd, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, _offset(key))
        except (BlockingIOError, PermissionError):
            return False
        except OSError:
            return True
        return True

    def give_back(self, key: str) -> None:
        """Let others have a run."""
        try:
            fcntl.lockf(self._fd, fcntl.LOCK_UN, 1, _offset(key))
        except OSError:
            return

    def close(self) -> None:
        """Give back all."""
        os.close(self._fd)


_KEYS = ("world", "settings", "controller", "world_hash", "source_hash", "physim", "engine")


def label_of(cell: dict[str, str]) -> Label:
    """World, settings and controller of a cell as it stands in the file."""
    return cell["world"], cell["settings"], cell["controller"]


def _cells(values: object) -> list[tuple[dict[str, str], tuple[range, ...]]]:
    """Cells as they stand in the file, with the seeds of each. Raises ValueError."""
    if not isinstance(values, list):
        raise ValueError("cells: must be a list")
    for value in values:
        if not isinstance(value, dict):
            raise ValueError("cells: each must be an object")
        value.setdefault("draws", "")
        for key in (*_KEYS, "draws"):
            text = value.get(key)
            if not isinstance(text, str) or text != text.encode("utf-8", "replace").decode():
                raise ValueError(f"cells: each must have a text {key}")
        if not re.fullmatch("[0-9a-f]{1,64}", value["world_hash"]):  # names a file
            raise ValueError("cells: world_hash: must be hex digits")
    found = [{key: value[key] for key in (*_KEYS, "draws")} for value in values]
    if len({label_of(one) for one in found}) < len(found):
        raise ValueError("cells: one is there twice")
    try:
        seeds = [ranges_of(value.get("seeds", [])) for value in values]
    except ValueError as error:
        raise ValueError(f"cells: {error}") from None
    return list(zip(found, seeds, strict=True))


def _described(spec: RunSpec) -> dict[str, str]:
    values = (spec.world, spec.settings, spec.controller, spec.world_hash, spec.source_hash)
    return {
        **dict(zip(_KEYS, (*values, __version__, engine()), strict=True)),
        "draws": spec.draws,
    }


def _check(path: Path, known: list[dict[str, str]], wanted: dict[Label, RunSpec]) -> None:
    """Raise PhysimError where a folder's campaign is another than the one that is wanted.

    It may have more cells than are wanted or fewer, but those in both must be the same.
    """
    there = {label_of(one): one for one in known}
    for label in there.keys() & wanted.keys():
        one, other = there[label], _described(wanted[label])
        differing = [key for key in _KEYS if one[key] != other[key]]
        if differing:
            words = ", ".join(_difference(key, one[key], other[key]) for key in differing)
            raise PhysimError(
                f"{path}: holds a campaign of another {label[0]}: {words}; give another folder"
            )
    if there and not (there.keys() >= wanted.keys() or there.keys() <= wanted.keys()):
        other_label = next(label for label in there if label not in wanted)
        named = ", ".join(part for part in other_label if part)
        raise PhysimError(
            f"{path}: holds another campaign (of {named}, which is not wanted here); give another "
            "folder, or one that it is part of"
        )


def _difference(key: str, one: str, other: str) -> str:
    if key == "world_hash":
        return "the world was changed"
    if key == "source_hash":
        return "the source of its controller or of a stage, or a file they name, was changed"
    return f"{key} {one} there, {other} here"


def _offset(key: str) -> int:
    """Place in the file of claims that stands for a run."""
    return int(key[:15], 16)


__all__ = ["CAMPAIGN", "RECORDS", "WORLDS", "Claims", "Folder"]
