"""Whether two values are the same to the last bit."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np


def differences(a: Any, b: Any, place: str = "scene") -> list[str]:
    """Places where two values, arrays within them included, are not equal to the last bit."""
    if type(a) is not type(b):
        return [place]
    if isinstance(a, np.ndarray):
        same = a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
        return [] if same else [place]
    if dataclasses.is_dataclass(a):
        a, b = ({f.name: getattr(one, f.name) for f in dataclasses.fields(one)} for one in (a, b))
    if isinstance(a, dict) and a.keys() == b.keys():
        return [d for key in a for d in differences(a[key], b[key], f"{place}.{key}")]
    if isinstance(a, tuple | list) and len(a) == len(b):
        return [d for k in range(len(a)) for d in differences(a[k], b[k], f"{place}[{k}]")]
    if hasattr(a, "settings") and not callable(a.settings):  # a part, which is its settings
        return differences(a.settings, b.settings, f"{place}.settings")
    return [] if a == b else [place]
