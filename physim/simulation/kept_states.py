"""States of a run, kept in its record every so often, so that another run can start from one.

They are arrays, numbers and texts, and tuples and mappings of such: to read them runs no code.
"""

from __future__ import annotations

import io
import json
import zipfile
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.errors import PhysimError, RecordError
from physim.geometry.shapes import read_only
from physim.parts.controller import Sensed, Snapshot
from physim.parts.given import GivenSettings
from physim.record import Record
from physim.simulation.engine import PhysicsState
from physim.simulation.state import SimulationState

KINDS = {
    kind.__name__: kind for kind in (SimulationState, Snapshot, Sensed, PhysicsState, GivenSettings)
}
"""Objects that a state may hold, taken apart by their fields"""


def packed(state: SimulationState) -> bytes:
    """A state as NumPy's ``.npz``: its arrays, and as JSON where each belongs.

    Raises PhysimError where a part remembers something else than `KINDS` and plain values.
    """
    arrays: list[NDArray[Any]] = []
    tree = json.dumps(_tree(state, "state", arrays))
    file = io.BytesIO()
    named = {f"array{k}": array for k, array in enumerate(arrays)}
    np.savez_compressed(file, tree=np.frombuffer(tree.encode(), np.uint8), **named)  # type: ignore[arg-type]
    return file.getvalue()


def state_at(record: Record, time: float) -> SimulationState:
    """The state of a run at a time [s] at which it was kept; start from it by ``Simulation(world,
    state=...)``.

    Raises RecordError where none was kept then, with the nearest, and for one that is damaged.
    """
    rows = record.states
    if record.judged is not None:
        raise RecordError(f"{record.where}: holds the poses of a log; no run can go on from there")
    if not len(rows):
        raise RecordError(
            f"{record.where}: no states were kept; physim run --keep-states SECONDS, or "
            "simulate(world, save=SaveAt(states=SECONDS)), keeps some"
        )
    times = rows["step"] * record.dt
    k = int(np.argmin(np.abs(times - time)))
    if abs(times[k] - time) > record.dt / 2.0:
        raise RecordError(f"{record.where}: no state at {time:g} s; nearest: {times[k]:g} s")
    last = int(rows["size"][: k + 1].sum())
    data = record.read("/state_bytes", last - int(rows["size"][k]), last).tobytes()
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            arrays = [read_only(file[f"array{k}"]) for k in range(len(file.files) - 1)]
            found = _value(json.loads(file["tree"].tobytes()), arrays)
    except (
        ValueError, LookupError, TypeError, AttributeError, RecursionError, OSError,
        zipfile.BadZipFile,
    ) as error:  # fmt: skip
        raise RecordError(
            f"{record.where}: /state_bytes: damaged; make the record again"
        ) from error
    if not isinstance(found, SimulationState):
        raise RecordError(f"{record.where}: /state_bytes: no state; make the record again")
    return found


def _tree(value: Any, where: str, arrays: list[NDArray[Any]]) -> Any:
    """A value as JSON has it, its arrays put aside."""
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.ndarray) and value.dtype != object:
        at = next((k for k, one in enumerate(arrays) if one is value), len(arrays))
        if at == len(arrays):
            arrays.append(value)
        return {"array": at}
    if type(value).__name__ in KINDS and type(value) is KINDS[type(value).__name__]:
        names = value._fields if isinstance(value, tuple) else [one.name for one in fields(value)]
        inner = {name: _tree(getattr(value, name), f"{where}.{name}", arrays) for name in names}
        return {type(value).__name__: inner}
    if isinstance(value, dict) and all(isinstance(key, str) for key in value):
        return {"dict": {key: _tree(one, f"{where}.{key}", arrays) for key, one in value.items()}}
    if type(value) in (tuple, list) or (isinstance(value, np.ndarray) and value.ndim == 1):
        return {
            type(value).__name__: [
                _tree(one, f"{where}[{k}]", arrays) for k, one in enumerate(value)
            ]
        }
    raise PhysimError(
        f"{where} cannot be kept in a record: {type(value).__name__}; allowed: arrays, numbers, "
        "texts, tuples, lists and mappings of such"
    )


def _value(tree: Any, arrays: list[NDArray[Any]]) -> Any:
    if not isinstance(tree, dict):
        return tree
    ((kind, inner),) = tree.items()
    if kind == "array":
        return arrays[inner]
    if kind in ("tuple", "list", "ndarray"):
        found = [_value(one, arrays) for one in inner]
        if kind == "ndarray":
            objects = np.empty(len(found), dtype=object)
            for k, one in enumerate(found):
                objects[k] = one
            return objects
        return tuple(found) if kind == "tuple" else found
    named = {name: _value(one, arrays) for name, one in inner.items()}
    return named if kind == "dict" else KINDS[kind](**named)
