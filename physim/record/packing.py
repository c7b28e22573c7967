"""Whether what a dataset holds can be unpacked: no more comes out of a chunk than it says.

The HDF5 library unpacks a chunk whole and without a bound, whatever its size was said to be: some
megabytes of zeros become gigabytes. Records are written unpacked; h5repack may have packed them.
"""

from __future__ import annotations

import math
import zlib

from h5py import h5d, h5z

ALLOWED = (h5z.FILTER_SHUFFLE, h5z.FILTER_DEFLATE, h5z.FILTER_FLETCHER32)
"""Filters in the order in which they may be used, each once."""
SPARE = 64
"""[bytes] beyond those of a chunk that one may take that is stored as it is: a checksum"""


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
    deflated = filters.index(h5z.FILTER_DEFLATE) if h5z.FILTER_DEFLATE in filters else None
    chunks: list[h5d.StoreInfo] = []
    dataset.chunk_iter(chunks.append)
    for chunk in chunks:
        is_deflated = deflated is not None and not chunk.filter_mask >> deflated & 1
        if _unpacked(dataset, chunk, size) if is_deflated else chunk.size > size + SPARE:
            return "holds a chunk that is longer than it says; it is damaged"
    return None


def _unpacked(dataset: h5d.DatasetID, chunk: h5d.StoreInfo, size: int) -> bool:
    """Whether more than ``size`` bytes come out of a deflated chunk; no more are unpacked."""
    _, packed = dataset.read_direct_chunk(chunk.chunk_offset)
    try:
        return len(zlib.decompressobj().decompress(packed, size + SPARE + 1)) > size + SPARE
    except zlib.error:
        return False  # the library says so when it is read
