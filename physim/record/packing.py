"""Whether what a dataset holds can be unpacked: out of a chunk comes what it says, to the byte.

The HDF5 library unpacks a chunk whole and without a bound, whatever its size was said to be: some
megabytes of zeros become gigabytes. Of a chunk that is shorter than it says it reads on into the
memory of the process. Records are written unpacked; h5repack may have packed them.
"""

from __future__ import annotations

import math
import zlib

from h5py import h5d, h5z

ALLOWED = (h5z.FILTER_SHUFFLE, h5z.FILTER_DEFLATE, h5z.FILTER_FLETCHER32)
"""Filters in the order in which they may be used, each once."""
CHECKSUM = 4
"""[bytes] that fletcher32 puts behind a chunk"""


def packing_fault(dataset: h5d.DatasetID, most: int) -> str | None:
    """Say what is wrong with the chunks of a dataset; None of one that can be read.

    ``most`` [bytes] is what one chunk may be, unpacked: to read a value, its chunk is read whole.
    """
    plan = dataset.get_create_plist()
    if plan.get_layout() != h5d.CHUNKED:
        return None
    size = math.prod(plan.get_chunk()) * dataset.get_type().get_size()
    if size > most:
        return "is stored in chunks that are far larger than it; it is damaged"
    filters = [plan.get_filter(k)[0] for k in range(plan.get_nfilters())]
    if filters != [one for one in ALLOWED if one in filters]:
        return "is packed by other filters than shuffle, gzip and fletcher32, in this order"
    if not filters:
        return None
    chunks: list[h5d.StoreInfo] = []
    dataset.chunk_iter(chunks.append)
    for chunk in chunks:
        used = [one for k, one in enumerate(filters) if not chunk.filter_mask >> k & 1]
        if h5z.FILTER_DEFLATE in used:
            there = _unpacked(dataset, chunk, size)
        else:
            there = chunk.size - CHECKSUM * (h5z.FILTER_FLETCHER32 in used)
        if there != size:
            than = "longer" if there > size else "shorter"
            return f"holds a chunk that is {than} than it says; it is damaged"
    return None


def _unpacked(dataset: h5d.DatasetID, chunk: h5d.StoreInfo, size: int) -> int:
    """How many bytes come out of a deflated chunk; of more than ``size`` one more is unpacked."""
    _, packed = dataset.read_direct_chunk(chunk.chunk_offset)
    try:
        return len(zlib.decompressobj().decompress(packed, size + 1))
    except zlib.error:
        return size  # the library says so when it is read
