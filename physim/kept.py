"""Values that a kernel takes again and again, handed to it once.

Python hands a tuple of arrays to a kernel array by array, at every call. Kept, it is one pointer.
"""

from __future__ import annotations

from typing import Any

from numba.typed import List

from physim.compiled import compiled


@compiled
def kept(value: Any) -> Any:
    """Compiled list of one value: kernels take element 0, and nothing in it may be changed."""
    values = List()
    values.append(value)
    return values
