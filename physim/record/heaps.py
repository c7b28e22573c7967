"""Texts of a file as they lie in it, looked at before the HDF5 library reads one.

A text of its own length is a reference of 16 bytes (length, address, number) to an object of a heap
in the file. The library believes all three: it takes memory for the length, and reads or goes on
without an end where heap and reference do not fit together.
"""

from __future__ import annotations

import mmap
import struct
from pathlib import Path

import numpy as np
from h5py import h5d
from numpy.typing import NDArray

SIGN = b"GCOL\x01\x00\x00\x00"
"""how a heap begins, at a multiple of 8 bytes; its size follows, and then its objects"""
HEAD, OBJECT = 16, 16
"""[bytes] before the first object of a heap, and before what an object holds"""
REFERENCE = np.dtype([("length", "<u4"), ("heap", "<u8"), ("number", "<u4")])


def text_fault(path: Path, dataset: h5d.DatasetID, most: int) -> tuple[str | None, int | None]:
    """Say what is wrong with the references of a dataset of texts that lies in one piece: longer
    than ``most`` [bytes] together, or to what is not there; and how long they are.

    None is known of one that is packed or in pieces. Raises OSError.
    """
    first = dataset.get_offset()
    if dataset.get_create_plist().get_layout() != h5d.CONTIGUOUS or first is None:
        return None, None
    end = first + dataset.get_space().get_simple_extent_npoints() * REFERENCE.itemsize
    with path.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
        if end > len(data):
            return "lies beyond the end of the file; it is damaged", 0
        found: NDArray[np.void] = np.frombuffer(data[first:end], REFERENCE)
        length = int(found["length"].sum(dtype=np.uint64))
        if length > most:
            return f"claims more than {most} letters; it is damaged", length
        sizes: dict[int, dict[int, int]] = {}
        for text, heap, number in found.tolist():
            if heap and heap not in sizes:
                sizes[heap] = _sizes(data, heap)
            if (text or heap) and sizes.get(heap, {}).get(number) != text:
                return "has a text that is not in the file as it says; it is damaged", length
    return None, length


def _sizes(data: mmap.mmap, at: int) -> dict[int, int]:
    """Sizes of the objects of a heap, by number; none where it is no heap, or not a whole one."""
    if at % 8 or at + HEAD > len(data) or data[at : at + len(SIGN)] != SIGN:
        return {}
    end = at + int(struct.unpack_from("<Q", data, at + 8)[0])
    if end > len(data):
        return {}
    place, sizes = at + HEAD, dict[int, int]()
    while place + OBJECT <= end:
        number, _, _, size = struct.unpack_from("<HHIQ", data, place)
        if number == 0:  # what is left free
            break
        place += OBJECT + (size + 7) // 8 * 8
        if place > end or number in sizes:
            return {}
        sizes[number] = size
    return sizes


__all__ = ["text_fault"]
