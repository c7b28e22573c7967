"""What may be meant by a number that is none, or too many: units, decimal commas, millimetres."""

from __future__ import annotations

import re
import unicodedata
from math import pi
from types import MappingProxyType
from typing import Any

WITH_UNIT = re.compile(r"\s*([+-]?\d+(?:\.\d*)?)\s*([a-z°/]+)\s*", re.IGNORECASE)
"""Number and unit in one text, as in "6 m"."""
DECIMAL_COMMA = re.compile(r"\s*([+-]?\d+),(\d+)\s*")
"""Number as written in many languages, as in "6,5"."""
NUMBER = re.compile(r"[+-]?\d+(?:\.\d*)?(?:e[+-]?\d+)?", re.IGNORECASE)
MINUSES = dict.fromkeys(map(ord, "\N{MINUS SIGN}\N{EN DASH}\N{HYPHEN}\N{NON-BREAKING HYPHEN}"), "-")
"""Signs that look like a minus, as programs for texts and files of print have them"""
MOST_FLAT = 12
"""Numbers that are written as points"""
SCALES = MappingProxyType(
    {
        "[m]": {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0},
        "[s]": {"s": 1.0, "sec": 1.0, "ms": 0.001, "min": 60.0, "h": 3600.0},
        "[m/s]": {"m/s": 1.0, "cm/s": 0.01, "mm/s": 0.001, "km/h": 1.0 / 3.6},
        "[rad]": {"rad": 1.0, "deg": pi / 180.0, "°": pi / 180.0},
        "[rad/s]": {"rad/s": 1.0, "deg/s": pi / 180.0, "°/s": pi / 180.0},
        "[kg]": {"kg": 1.0, "g": 0.001, "t": 1000.0},
    }
)
"""What a number with another unit is worth in that of a key, as its description begins."""


def of_text(given: str, unit: str) -> str:
    """What to write for a text that is a number with a unit or a comma; ``unit`` is the key's."""
    plain = unicodedata.normalize("NFKC", given).translate(MINUSES)
    if plain != given and NUMBER.fullmatch(plain):
        return f"; write it with the signs of a keyboard: {plain}"
    if comma := DECIMAL_COMMA.fullmatch(given):
        return f"; decimals take a point: {comma[1]}.{comma[2]}"
    found = WITH_UNIT.fullmatch(given)
    if found is None:
        return ""
    scale = SCALES.get(unit, {}).get(found[2].lower())
    if scale is None:
        return "; units are not written, each key has its own"
    return f"; units are not written: {float(found[1]) * scale:.6g} is meant"


def of_commas(given: Any, most: int) -> str:
    """What to write for ``[8,0, 1,0, 0,0]``: twice as many whole numbers as there may be."""
    if not isinstance(given, list | tuple) or len(given) != 2 * most:
        return ""
    if not all(type(one) is int for one in given) or min(given[1::2]) < 0:
        return ""
    pairs = zip(given[::2], given[1::2], strict=True)
    return f"; decimals take a point: [{', '.join(f'{whole}.{part}' for whole, part in pairs)}]"


def of_flat(given: Any) -> str:
    """What to write for points in one list of numbers, as [0, 0, 12, 0]."""
    if not isinstance(given, list | tuple) or len(given) % 2 or not 4 <= len(given) <= MOST_FLAT:
        return ""
    if not all(isinstance(one, int | float) for one in given):
        return ""
    points = zip(given[::2], given[1::2], strict=True)
    return f"; write [{', '.join(f'[{x:.6g}, {y:.6g}]' for x, y in points)}]"


def in_metres(length: float) -> str:
    """What to write where a length is likely none in metres."""
    return (
        f"lengths are in metres: if centimetres are meant, write {length / 100.0:.6g}, if "
        f"millimetres, {length / 1000.0:.6g}"
    )
