"""Make and fill datasets of an HDF5 file, by the plain calls of the library.

A record has some forty of them: with the calls for every case, a short run would spend more time on
them than on its robots.
"""

from __future__ import annotations

from typing import Any

import h5py
import numpy as np
from h5py import h5d, h5p, h5s, h5t
from numpy.typing import ArrayLike, NDArray


def put(file: h5py.File, path: str, values: ArrayLike) -> h5d.DatasetID:
    """Make a dataset of its final size that holds ``values``, and the groups above it."""
    array = np.asarray(values)
    made = _create(file, path, array.dtype, h5s.create_simple(array.shape), _settings())
    if array.size:
        fill(made, array)
    return made


def put_texts(file: h5py.File, path: str, texts: list[str]) -> None:
    """Make a dataset of texts."""
    put(file, path, np.array(texts, dtype=h5py.string_dtype("utf-8")))


def growing(
    file: h5py.File, path: str, row: Any, shape: tuple[int, ...], chunk: int
) -> h5d.DatasetID:
    """Make an empty dataset of rows of a type and shape, stored ``chunk`` rows at a time."""
    settings = _settings()
    settings.set_chunk((chunk, *shape))
    space = h5s.create_simple((0, *shape), (h5s.UNLIMITED, *shape))
    return _create(file, path, np.dtype(row), space, settings)


def fill(dataset: h5d.DatasetID, values: NDArray[Any]) -> None:
    """Write all of a dataset."""
    dataset.write(h5s.ALL, h5s.ALL, np.ascontiguousarray(values))


def add_rows(dataset: h5d.DatasetID, written: int, rows: NDArray[Any]) -> None:
    """Let a dataset of ``written`` rows grow by more."""
    dataset.set_extent((written + len(rows), *rows.shape[1:]))
    place = dataset.get_space()
    place.select_hyperslab((written,) + (0,) * (rows.ndim - 1), rows.shape)
    dataset.write(h5s.create_simple(rows.shape), place, np.ascontiguousarray(rows))


def _create(
    file: h5py.File, path: str, row: np.dtype[Any], space: h5s.SpaceID, settings: h5p.PropDCID
) -> h5d.DatasetID:
    links = h5p.create(h5p.LINK_CREATE)
    links.set_create_intermediate_group(True)
    kind = h5t.py_create(row, logical=True)
    return h5d.create(file.id, path.encode(), kind, space, dcpl=settings, lcpl=links)


def _settings() -> h5p.PropDCID:
    """Without the time of making, which would tell equal records apart."""
    settings = h5p.create(h5p.DATASET_CREATE)
    settings.set_obj_track_times(False)
    return settings


__all__ = ["add_rows", "fill", "growing", "put", "put_texts"]
