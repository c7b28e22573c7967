"""Small edits of an open record file, from which forgeries are made."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import h5py
import numpy as np

from tests.helpers import inside

CONSIDERED, CONSIDERING = inside("physim.record", "CONSIDERED", "CONSIDERING")

Change = Callable[[h5py.File], None]


def together(*changes: Change) -> Change:
    """One edit after the other."""

    def change(file: h5py.File) -> None:
        for one in changes:
            one(file)

    return change


def attribute(name: str, value: Any) -> Change:
    """Another value of an attribute."""

    def change(file: h5py.File) -> None:
        if isinstance(value, str) and name == "ended":
            file.attrs.modify(name, np.array(value.encode(), dtype="S16"))
        else:
            file.attrs[name] = value

    return change


def world(old: str, new: str) -> Change:
    """Another text of the world inside."""

    def change(file: h5py.File) -> None:
        text = file.attrs["world"]
        assert old in text, f"{old!r} is not in the world:\n{text}"
        file.attrs["world"] = text.replace(old, new)

    return change


def rows_of(file: h5py.File, path: str) -> np.ndarray:
    """Rows of a table or of the samples; of considered robots a row each, with its decision."""
    rows = file[path][()]
    if path.strip("/") != "considered":
        return rows
    other = file["/considered_others"][()]
    found = np.zeros(len(other), dtype=CONSIDERED)
    for name in ("step", "robot"):
        found[name] = np.repeat(rows[name], rows["count"])
    found["other"] = other
    return found


def replace_rows(file: h5py.File, path: str, rows: np.ndarray) -> None:
    """Put other rows into a table or among the samples."""
    if path.strip("/") == "considered":
        first = np.ones(len(rows), dtype=np.bool_)
        first[1:] = rows[["step", "robot"]][1:] != rows[["step", "robot"]][:-1]
        decisions = np.zeros(int(first.sum()), dtype=CONSIDERING)
        for name in ("step", "robot"):
            decisions[name] = rows[name][first]
        decisions["count"] = np.diff(np.flatnonzero(first), append=len(rows))
        replace_rows(file, "/considered_others", rows["other"])
        old, made = file[path][()], file["/updates"][()][["step", "robot"]]
        alone = old[(old["count"] == 0) & np.isin(old[["step", "robot"]], made)]
        rows = np.concatenate((decisions, alone))
        rows = rows[np.lexsort((rows["robot"], rows["step"]))]
    if len(file[path]) != len(rows):
        file[path].resize(len(rows), axis=0)
    file[path][...] = rows


def where(rows: np.ndarray, pick: Any) -> np.ndarray:
    """Numbers of rows: all of them, those that a function picks, or a number as it is."""
    if pick is None:
        return np.arange(len(rows))
    if callable(pick):
        found = np.flatnonzero(pick(rows))
        assert len(found), "the edit picks no row"
        return found
    return np.atleast_1d(pick)


def column(path: str, name: str, value: Any, pick: Any = None) -> Change:
    """Another value, or a function of the old ones, in a column of a table."""

    def change(file: h5py.File) -> None:
        rows = rows_of(file, path)
        at = where(rows, pick)
        old = rows[name][at]
        new = value(old) if callable(value) else np.full(len(at), value, dtype=old.dtype)
        assert not np.array_equal(old, new, equal_nan=True), f"{path} {name}: nothing is changed"
        rows[name][at] = new
        replace_rows(file, path, rows)

    return change


def dropped(path: str, pick: Any) -> Change:
    """Rows taken out of a table."""

    def change(file: h5py.File) -> None:
        rows = rows_of(file, path)
        kept = np.ones(len(rows), dtype=np.bool_)
        kept[where(rows, pick)] = False
        replace_rows(file, path, rows[kept])

    return change


def cells(path: str, at: Any, value: Any) -> Change:
    """Another value, or a function of the old, in a dataset of plain numbers or texts."""

    def change(file: h5py.File) -> None:
        values = file[path][()]
        values[at] = value(values[at]) if callable(value) else value
        file[path][...] = values

    return change


def cut(step: int, ended: str) -> Change:
    """A run cut off at a step and relabelled."""

    def change(file: h5py.File) -> None:
        for name in ("step", "pose", "clearance", "boundary_clearance"):
            file[f"steps/{name}"].resize(step + 1, axis=0)
        for name in ("updates", "commands", "considered", "contacts", "false_contacts"):
            rows = rows_of(file, name)
            last = step if name.endswith("contacts") else step - 1
            replace_rows(file, name, rows[rows["step"] <= last])
        extremes, farthest = file["/extremes"][()], file["/extremes_farthest"][()]
        for value, when in (
            ("clearance", "clearance_step"),
            ("boundary_clearance", "boundary_step"),
        ):
            kept = file[f"steps/{value}"][()]
            extremes[value], extremes[when] = kept.min(axis=0), kept.argmin(axis=0)
        farthest["step"] = min(farthest["step"], step)
        file["/extremes"][...], file["/extremes_farthest"][()] = extremes, farthest
        arrived = file["/robots/arrived"][()]
        file["/robots/arrived"][...] = np.where(arrived > step, -1, arrived)
        file.attrs["steps_run"] = np.int64(step)
        attribute("ended", ended)(file)

    return change


def decided(robot: int, number: int) -> Callable[[np.ndarray], np.ndarray]:
    """Pick one decision of a robot, by its number from 0."""

    def pick(rows: np.ndarray) -> np.ndarray:
        step = rows["step"][rows["robot"] == robot][number]
        return (rows["step"] == step) & (rows["robot"] == robot)

    return pick
