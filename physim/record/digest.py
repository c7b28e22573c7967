"""One number that says whether two runs are the same."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

import h5py
import numpy as np

from physim.record.layout import ATTRIBUTES, DATASETS, FOOTPRINTS, STEPS, TABLES

if TYPE_CHECKING:
    from physim.record.reader import Record

BLOCK_BYTES = 1 << 22


def digest(record: Record, file: h5py.File) -> str:
    """SHA-256 (hexadecimal) over all datasets and the root attributes in `layout.ATTRIBUTES`.

    Each part goes in with its name, type and shape, so nothing can move from one to another. Left
    out: ``/wall_clock`` and the attribute ``versions``; chunks and places in the file do not
    matter. Two runs of the same world, seed and version on one machine have equal digests; so have
    a record in memory and its copy on disk.
    """
    total = hashlib.sha256()
    for name in ATTRIBUTES:
        total.update(f"{name}={file.attrs[name]!r}\n".encode())
    footprints = (
        f"{group}/{part}"
        for group in map(FOOTPRINTS.format, range(record.robots))
        for part in sorted(file[group], key=int)
    )
    for path in (*DATASETS, *footprints):
        _add(total, record, file[path], path)
    return total.hexdigest()


def _add(total: hashlib._Hash, record: Record, dataset: h5py.Dataset, path: str) -> None:
    """Add one dataset, block by block, so that memory stays flat."""
    shape = dataset.shape
    if path in STEPS:
        shape = (record.samples, *shape[1:])
    elif path in TABLES:
        shape = (len(record.read(path, check=False)),)
    total.update(f"{path} {dataset.dtype.descr} {shape}\n".encode())
    if not shape:
        total.update(record.read(path, check=False).tobytes())
        return
    row_bytes = dataset.dtype.itemsize * int(np.prod(shape[1:], dtype=int))
    block = max(1, BLOCK_BYTES // row_bytes)
    for first in range(0, shape[0], block):
        rows = record.read(path, first, min(first + block, shape[0]), check=False)
        if dataset.dtype.kind == "O":
            total.update(b"".join(len(text).to_bytes(8, "little") + text for text in rows))
        else:
            total.update(np.ascontiguousarray(rows).tobytes())
