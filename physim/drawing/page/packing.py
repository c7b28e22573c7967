"""Numbers of a run as a few bytes: whole numbers of a quantum, differences, byte planes, gzip.

What is packed here is read by ``assets/decode.js``. A pack is one gzip stream: the length of a JSON
header (4 bytes, little-endian), the header, and the planes of all arrays one behind the other.
"""

from __future__ import annotations

import base64
import gzip
import json
import zlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

MOST_ORDERS = 3
"""Values, differences, differences of differences: whichever is smallest is kept."""
PROBE = 1 << 16
"""Values by which that is tried"""
FINITE, NAN, INF, MINUS_INF = range(4)
LARGEST = 1 << 29
"""of the whole numbers that are packed: sums of differences stay within 32 bits"""
EXACT = 2.0**53
"""up to which whole numbers are exact"""


class Pack:
    """Arrays by name, packed one behind the other."""

    def __init__(self) -> None:
        self.index: dict[str, dict[str, Any]] = {}
        """of each array: where its bytes begin, how many values, planes, order of differences, the
        quantum of one, and what is to be added to the numbers where they are large; a quantum of 0
        means floats of 8 bytes"""
        self._blobs: list[bytes] = []
        self._size = 0

    def whole(self, name: str, values: ArrayLike, quantum: float = 1.0, far: bool = False) -> None:
        """Add whole numbers (n,), each so many times ``quantum``; their size is below 2^29.

        Those of which the page takes multiples may be ``far`` from 0, and differ by so much.
        """
        numbers = np.asarray(values, dtype=np.int64).ravel()
        base = 0
        if far and len(numbers) and int(np.abs(numbers).max()) >= LARGEST:
            base = (int(numbers.min()) + int(numbers.max())) // 2
            numbers = numbers - base
        if len(numbers) and int(np.abs(numbers).max()) >= LARGEST:
            raise ValueError(f"{name}: a number does not fit")
        order, planes = _smallest(numbers)
        self._add(name, planes, order=order, quantum=quantum, **({"base": base} if base else {}))

    def _add(self, name: str, planes: NDArray[np.uint8], **about: float) -> None:
        """Add byte planes (b, n), and what the index says of them."""
        count, values = planes.shape
        self.index[name] = {"at": self._size, "n": values, "planes": count, **about}
        blob = planes.tobytes()
        self._blobs.append(blob)
        self._size += len(blob)

    def real(self, name: str, values: ArrayLike, quantum: float) -> None:
        """Add real numbers (n,), rounded to ``quantum``; as they are where they lie too far apart.

        Infinite ones and NaN stay what they are.
        """
        given = np.asarray(values, dtype=np.float64).ravel()
        finite = np.isfinite(given)
        known = given[finite] if finite.any() else np.zeros(1)
        least, most = float(known.min()), float(known.max())
        if most / quantum - least / quantum >= LARGEST or max(-least, most) / quantum >= EXACT:
            self._add(name, given.astype("<f8").view(np.uint8).reshape(-1, 8).T, quantum=0.0)
            return
        if not finite.all():
            kinds = np.select([finite, np.isnan(given), given > 0.0], [FINITE, NAN, INF], MINUS_INF)
            self.whole(f"{name}?", kinds)
            given = _filled(given, finite)
        self.whole(name, np.rint(given / quantum), quantum, far=True)

    def to_base64(self, header: dict[str, Any]) -> str:
        """All of it as text; ``header`` gets the key ``arrays``."""
        head = json.dumps(
            {**header, "arrays": self.index}, ensure_ascii=True, separators=(",", ":"),
            allow_nan=False,
        ).encode("ascii")  # fmt: skip
        whole = len(head).to_bytes(4, "little") + head + b"".join(self._blobs)
        return base64.b64encode(gzip.compress(whole, 9, mtime=0)).decode("ascii")


def _filled(values: NDArray[np.float64], finite: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Values with each that is not finite replaced by the last before it that is, or else by the
    first; 0 without any."""
    first = int(np.argmax(finite))
    last = np.maximum.accumulate(np.where(finite, np.arange(len(values)), first))
    return np.where(finite, values, 0.0)[last]


def _smallest(numbers: NDArray[np.int64]) -> tuple[int, NDArray[np.uint8]]:
    """Order of differences that packs best, and the byte planes (b, n) of these."""
    best, size, found = 0, -1, np.zeros((0, len(numbers)), np.uint8)
    differences = numbers
    for order in range(MOST_ORDERS):
        if order:
            differences = np.diff(differences, prepend=0)
        planes = _planes(differences)
        cost = len(zlib.compress(planes[:, :PROBE].tobytes(), 6))
        if size < 0 or cost < size:
            best, size, found = order, cost, planes
    return best, found


def _planes(numbers: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Byte planes (b, n), lowest first, of zigzag numbers; as many as are not all 0."""
    zigzag = ((numbers << 1) ^ (numbers >> 63)).astype("<u4")
    planes = zigzag.view(np.uint8).reshape(-1, 4).T
    used = np.flatnonzero(planes.any(axis=1))
    return np.ascontiguousarray(planes[: int(used[-1]) + 1 if len(used) else 0])
