"""Transforms of a style, as CSS has them, as the attribute ``transform`` has them.

Those of a style have units and commas; what is not valid is passed over by a browser, while an
attribute of the same text would be read.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, tan
from typing import Any

from physim.authoring.importing.svg_values import PIXELS

LENGTHS = {**PIXELS, "q": PIXELS["mm"] / 4.0}
ANGLES = {"deg": 1.0, "grad": 0.9, "turn": 360.0, "rad": degrees(1.0)}
"""Degrees of a unit of angle."""
COUNTS = {
    "translate": (1, 2), "translatex": (1,), "translatey": (1,), "scale": (1, 2), "scalex": (1,),
    "scaley": (1,), "rotate": (1,), "skew": (1, 2), "skewx": (1,), "skewy": (1,), "matrix": (6,),
}  # fmt: skip
"""How many values each function takes."""
OTHERS = ("matrix3d", "translate3d", "translatez", "scale3d", "scalez", "rotate3d", "rotatex",
          "rotatey", "rotatez", "perspective")  # fmt: skip
"""Functions that are valid, and not read"""
UNREAD = "unread"


def as_attribute(tokens: Sequence[Any]) -> str | None:
    """What functions of a style, without blanks between them, are as an attribute.

    Empty where they are not valid, None where they are, or may be, and are not read.
    """
    found: list[str] = []
    is_read = True
    for token in tokens:
        if token.type != "function":
            return ""
        name = token.lower_name
        values = _values(token)
        if name in OTHERS or UNREAD in values:
            is_read = False
            continue
        if name not in COUNTS or "" in values or len(values) not in COUNTS[name]:
            return ""
        found.append(_written(name, [float(value) for value in values]))
    return " ".join(found) if is_read else None


def _values(function: Any) -> list[Any]:
    """Its values in pixels and degrees; each ``""`` where it is not valid."""
    parts: list[list[Any]] = [[]]
    for token in function.arguments:
        if token == ",":
            parts.append([])
        elif token.type not in ("whitespace", "comment"):
            parts[-1].append(token)
    return [_value(function.lower_name, part) for part in parts]


def _value(name: str, tokens: Sequence[Any]) -> Any:
    if len(tokens) != 1:
        return ""
    (token,) = tokens
    units = _units(name)
    match token.type:
        case "function":
            return UNREAD
        case "number":
            return token.value if not units or token.value == 0.0 else ""
        case "percentage":
            share = name.startswith("scale")
            return token.value / 100.0 if share else UNREAD if name.startswith("tr") else ""
        case "dimension" if units and token.lower_unit in units:
            return token.value * units[token.lower_unit]
        case "dimension" if name.startswith("translate") and token.lower_unit not in ANGLES:
            return UNREAD  # lengths of a font or of a window
    return ""


def _units(name: str) -> dict[str, float]:
    if name.startswith("translate"):
        return {unit: pixels for unit, pixels in LENGTHS.items() if unit}
    return ANGLES if name.startswith(("rotate", "skew")) else {}


def _written(name: str, values: list[float]) -> str:
    first, *others = values
    second = others[0] if others else 0.0
    match name:
        case "translate" | "translatex":
            name, values = "translate", [first, second]
        case "translatey":
            name, values = "translate", [0.0, first]
        case "scalex":
            name, values = "scale", [first, 1.0]
        case "scaley":
            name, values = "scale", [1.0, first]
        case "skew" | "skewx":
            name, values = "matrix", [1.0, _slope(second), _slope(first), 1.0, 0.0, 0.0]
        case "skewy":
            name, values = "matrix", [1.0, _slope(first), 0.0, 1.0, 0.0, 0.0]
    return f"{name}({','.join(map(repr, values))})"


def _slope(angle: float) -> float:
    return tan(angle / degrees(1.0))
