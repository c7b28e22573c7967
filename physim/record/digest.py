"""The digest of a record: over its values, whatever the layout of the file.

Every part goes in with its name, type and shape, so that nothing can move from one to another.
Chunks and places in the file do not matter, nor how names and declarations are written there: they
go in as columns. So runs have the digests that they had in files of format 4.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from physim.parts.declarations import Declared
from physim.record import layout
from physim.world.scene import Body

if TYPE_CHECKING:
    from physim.record.reader import Record

HEAD = {"format": layout.FORMAT, "version": "4.0", "units": layout.UNITS}
"""What the digest begins with; the version is that of its own definition."""
DIGESTED = (
    "name", "world", "seed", "dt", "steps_planned", "record_every", "tables", "given",
    "safe_distance", "ended", "steps_run", "rejected_contacts",
)  # fmt: skip
KNOWN = (
    "/bodies/id", "/bodies/kind", "/bodies/name", "/robots/stop_station", "/robots/lead",
    "/modes/name", "/modes/words", "/modes/colour", "/modes/danger", "/rules/name", "/rules/words",
    "/columns/name", "/columns/unit", "/columns/words",
    *(one.path for one in layout.PACKED),
)  # fmt: skip
"""What is known before the first step: datasets, and columns of ``bodies`` and ``declared``."""
LEFT_OUT = (
    *KNOWN, layout.Layout.begun_along.path, layout.Layout.states.path,
    layout.Layout.state_bytes.path,
)  # fmt: skip
"""What follows from the samples, and states: no two runs differ in these alone."""
PARTS = (*KNOWN, *(path for path in layout.TABLE if path not in LEFT_OUT))
BLOCK_BYTES = 1 << 22


def texts(bodies: tuple[Body, ...], declared: Declared) -> dict[str, NDArray[Any]]:
    """What the attributes ``bodies`` and ``declared`` say, column by column."""
    found = {"/bodies/id": np.arange(len(bodies), dtype="<i4")}
    for group, rows, keys in (
        ("bodies", bodies, ("kind", "name")),
        ("modes", declared.modes, ("name", "words", "colour")),
        ("rules", declared.rules, ("name", "words")),
        ("columns", declared.columns, ("name", "unit", "words")),
    ):
        for key in keys:
            found[f"/{group}/{key}"] = np.array([getattr(row, key) for row in rows], dtype=object)
    found["/modes/danger"] = np.array([mode.danger for mode in declared.modes], dtype="i1")
    return found


def digest_of(record: Record, attributes: Mapping[str, Any]) -> str:
    """SHA-256 (hexadecimal), block by block, so that memory stays flat."""
    total = hashlib.sha256()
    named = (*DIGESTED, *(["judged"] if record.judged else []))
    for name, value in (*HEAD.items(), *((name, attributes[name]) for name in named)):
        total.update(f"{name}={value!r}\n".encode())
    told = texts(record.bodies, record.declared)
    for path in (path for path in PARTS if path in told or record.holds(path)):
        samples = path in (*layout.STEPS, layout.Layout.steering.path)
        last = 0 if samples else None
        rows = told[path] if path in told else record.read(path, 0, last, check=False)
        shape = (record.samples, *rows.shape[1:]) if samples else rows.shape
        total.update(f"{path} {rows.dtype.descr} {shape}\n".encode())
        if rows.dtype == object:
            coded = [text.encode() for text in rows]
            total.update(b"".join(len(text).to_bytes(8, "little") + text for text in coded))
        elif samples:
            block = max(1, BLOCK_BYTES // (rows.itemsize * math.prod(shape[1:])))
            for first in range(0, record.samples, block):
                total.update(record.read(path, first, first + block, check=False).tobytes())
        else:
            total.update(rows.tobytes())
    return total.hexdigest()
