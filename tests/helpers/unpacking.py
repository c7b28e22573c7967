"""What ``assets/decode.js`` does, in plain Python: an oracle for what is packed."""

from __future__ import annotations

import base64
import gzip
import json
from typing import Any

import numpy as np


def unpack(text: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Header and arrays by name, byte for byte as they stand."""
    raw = gzip.decompress(base64.b64decode(text))
    length = int.from_bytes(raw[:4], "little")
    header, planes = json.loads(raw[4 : 4 + length]), raw[4 + length :]
    return header, {name: _array(planes, header["arrays"], name) for name in header["arrays"]}


def _array(planes: bytes, index: dict[str, Any], name: str) -> Any:
    if index[name]["quantum"] == 0.0:
        at, n = index[name]["at"], index[name]["n"]
        return np.array(
            [np.frombuffer(planes[at + k : at + 8 * n : n])[0] for k in range(n)], dtype=float
        )
    numbers = _whole(planes, **{key: index[name][key] for key in ("at", "n", "planes", "order")})
    values = (np.array(numbers, dtype=float) + index[name].get("base", 0)) * index[name]["quantum"]
    if f"{name}?" in index:
        about = index[f"{name}?"]
        kinds = _whole(planes, about["at"], about["n"], about["planes"], about["order"])
        for k, kind in enumerate(kinds):
            if kind:
                values[k] = (0.0, np.nan, np.inf, -np.inf)[kind]
    return values


def _whole(data: bytes, at: int, n: int, planes: int, order: int) -> list[int]:
    numbers = []
    for k in range(n):
        zigzag = sum(data[at + plane * n + k] << (8 * plane) for plane in range(planes))
        numbers.append((zigzag >> 1) if zigzag % 2 == 0 else -(zigzag >> 1) - 1)
    for _ in range(order):
        for k in range(1, n):
            numbers[k] += numbers[k - 1]
    return numbers
