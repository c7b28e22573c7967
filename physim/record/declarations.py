"""Modes, rules and columns of a record, checked like those of a controller."""

from __future__ import annotations

from types import SimpleNamespace

import h5py

from physim.declared import Column, Declared, Mode, Rule
from physim.errors import ControllerError, RecordError
from physim.record.checks import damaged


def read_declared(file: h5py.File, where: str) -> Declared:
    """Read what the controller declared. Raises RecordError for what none can declare."""
    try:
        danger = [bool(value) for value in file["/modes/danger"][:]]
        modes = [
            Mode(name, colour, words, is_danger)
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
    try:
        return Declared.of(SimpleNamespace(modes=modes, rules=rules, columns=columns))
    except ControllerError as error:
        fault = str(error).replace("SimpleNamespace.", "/")
        raise RecordError(f"{where}: {fault}; make the record again") from error


def _texts(file: h5py.File, group: str, *fields: str) -> list[list[str]]:
    return [[value.decode() for value in file[f"{group}/{field}"][:]] for field in fields]
