"""Values of SVG elements that cannot be meant: sizes of the page, lengths of shapes, transforms."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import isfinite

from physim.escaping import escaped

NUMBERS = {
    "matrix": (6,), "translate": (1, 2), "scale": (1, 2), "rotate": (1, 3), "skewX": (1,),
    "skewY": (1,),
}  # fmt: skip
"""How many numbers each function of a transform takes."""
NUMBER = re.compile(r"[-+]?(?:\d+(?:\.\d+)?|\.\d+)(?:[eE][-+]?\d+)?", re.A)
FUNCTION = re.compile(r"\s*([A-Za-z]+)\s*\(([^()]*)\)\s*,?", re.A)
STRAY = re.compile(r"^\s*,|,\s*,|,\s*$", re.A)
"""A comma that does not stand between two numbers"""
LENGTH = re.compile(rf"({NUMBER.pattern})(px|mm|cm|in|pt|pc|)", re.I | re.A)
PAGE = re.compile(rf"({NUMBER.pattern})([A-Za-z%]*)", re.A)
"""A unit that is none stands for user units, as some programs write ``30m``."""
VIEW = re.compile(rf"\s*{NUMBER.pattern}(?:(?:\s*,\s*|\s+|(?=[-+])){NUMBER.pattern}){{3}}\s*", re.A)
NO_LENGTH = re.compile(r"em|ex|ch|lh|rem|v[a-z]+", re.I)
"""Units of a font or of a window"""
NO_POINTS = re.compile(r"[^0,\s]|,\s*,|^\s*,", re.A)
"""Of points, with noughts for their numbers"""
BLANKS = " \t\r\n\f"
"""Those of the standard alone"""
AUTO = "auto"
"""Of a radius that is not given: as long as the other"""
RADII = ("rx", "ry")
SIZES = ("width", "height")
EXTENTS = (*SIZES, "r", *RADII)
PIXELS: Mapping[str, float] = {
    "": 1.0, "px": 1.0, "mm": 96.0 / 25.4, "cm": 96.0 / 2.54, "in": 96.0, "pt": 4.0 / 3.0,
    "pc": 16.0,
}  # fmt: skip
"""Pixels of a unit of length"""
TAKES: Mapping[str, Mapping[str, str]] = {
    "path": {"d": ""},
    "rect": {**dict.fromkeys(("x", "y", "width", "height"), "0"), **dict.fromkeys(RADII, AUTO)},
    "circle": dict.fromkeys(("cx", "cy", "r"), "0"),
    "ellipse": {"cx": "0", "cy": "0", **dict.fromkeys(RADII, AUTO)},
    "line": dict.fromkeys(("x1", "y1", "x2", "y2"), "0"),
    "polyline": {"points": ""},
    "polygon": {"points": ""},
    "use": {"x": "0", "y": "0"},
}
"""What says where the lines of an element lie, and what holds where it is not said"""
SHAPES = tuple(tag for tag in TAKES if tag != "use")
ORIGINS = ("transform-origin", "transform-box")
"""Properties that say about which point an element is turned."""
NO_ORIGIN = re.compile(
    r"(?:(?:[-+]?(?:0+(?:\.0*)?|\.0+)(?:px|mm|cm|in|pt|pc|%)?|left|top)(?:\s+|$))+"
)
"""The point (0, 0), about which elements are turned anyway."""


def page_fault(values: dict[str, str]) -> str:
    """What is wrong with width, height and viewBox of an ``svg``; empty where nothing is."""
    for key in SIZES:
        given = values.get(key, "1").strip(BLANKS)
        found = PAGE.fullmatch(given)
        if found is None or not 0.0 < float(found[1]) < float("inf"):
            return f'{key}="{escaped(given)[:40]}": a length above 0 is needed, such as 240mm'
        if NO_LENGTH.fullmatch(found[2]):
            return f'{key}="{escaped(given)[:40]}": has no length of its own; give it as 240mm'
    box = values.get("viewBox", "0 0 1 1")
    numbers = [float(one) for one in NUMBER.findall(box)]
    if VIEW.fullmatch(box) is None:
        return f'viewBox="{escaped(box)[:60]}": four numbers are needed: x, y, width and height'
    if not all(map(isfinite, numbers)) or min(numbers[2:]) <= 0.0:
        return f'viewBox="{escaped(box)[:60]}": its width and height, the last two, must be above 0'
    return ""


def pixels_of(length: str) -> float:
    """Length in pixels, of one without a `shape_fault`."""
    found = LENGTH.fullmatch(length.strip(BLANKS))
    return float(found[1]) * PIXELS[found[2].lower()] if found is not None else 0.0


def turns(transform: str) -> bool:
    """Whether a transform does more than move."""
    at, text = 0, transform.strip(BLANKS)
    while found := FUNCTION.match(text, at):
        numbers = [float(one) for one in NUMBER.findall(found[2])]
        is_plain = found[1] == "matrix" and numbers[:4] == [1.0, 0.0, 0.0, 1.0]
        if not (is_plain or found[1].startswith("translate")):
            return True
        at = found.end()
    return text[at:] not in ("", "none")


def origin_of(values: dict[str, str]) -> str:
    """``transform-origin: center``: what turns elements about another point than (0, 0)."""
    given = {key: values[key].strip(BLANKS).lower() for key in ORIGINS if values.get(key)}
    if given.get("transform-box") == "view-box":
        del given["transform-box"]
    if NO_ORIGIN.fullmatch(given.get("transform-origin", "0")):
        given.pop("transform-origin", None)
    return " and ".join(f"{key}: {escaped(value)[:40]}" for key, value in given.items())


def shape_fault(tag: str, values: Mapping[str, str]) -> str:
    """What is wrong with the lengths and points of a shape, or a copy; empty where nothing is."""
    for key in TAKES.get(tag, ()):
        given = values.get(key, "").strip(BLANKS)
        if key in ("d", "points") or not given:
            continue
        found = LENGTH.fullmatch(given)
        if found is None or not isfinite(float(found[1])):
            units = "px, mm, cm, in, pt or pc"
            return f'{key}="{escaped(given)[:40]}": a number is needed, alone or with {units}'
        if key in EXTENTS and float(found[1]) < 0.0:
            return f'{key}="{escaped(given)[:40]}": must not be negative'
    points = values.get("points", "") if "points" in TAKES.get(tag, ()) else ""
    gaps = NUMBER.sub(lambda found: "0" * len(found[0]), points)
    if bad := NO_POINTS.search(gaps):
        return f'points: "{escaped(points[bad.start() : bad.start() + 20])}" cannot be read'
    if (count := len(NUMBER.findall(points))) % 2:
        return f"points: {count} numbers; they come in pairs x,y"
    return ""


def transform_fault(text: str) -> str:
    """What is wrong with the text of a transform; empty where nothing is.

    One with too many or too few numbers would be applied as something else.
    """
    at = 0
    text = text.strip(BLANKS)
    while at < len(text) and text != "none":
        found = FUNCTION.match(text, at)
        if found is None or found[1] not in NUMBERS:
            return f'"{escaped(text[at : at + 30])}" is none of {", ".join(NUMBERS)}'
        quoted, allowed = escaped(found[0].strip(" ,"))[:60], NUMBERS[found[1]]
        numbers = NUMBER.findall(found[2])
        if NUMBER.sub(" ", found[2]).strip(BLANKS + ",") or STRAY.search(found[2]):
            return f'"{quoted}": only numbers may stand in the brackets'
        if found[0].rstrip().endswith(",") and found.end() == len(text):
            return f'"{quoted}" is followed by a comma and nothing else'
        if len(numbers) not in allowed:
            counts = " or ".join(map(str, allowed))
            return f'"{quoted}" has {len(numbers)} numbers; {found[1]} takes {counts}'
        if _flattens(found[1], [float(one) for one in numbers]):
            return f'"{quoted}" leaves no area of what it is applied to; its determinant is 0'
        at = found.end()
    return ""


def _flattens(function: str, numbers: list[float]) -> bool:
    if function == "scale":
        return 0.0 in numbers
    return function == "matrix" and numbers[0] * numbers[3] == numbers[1] * numbers[2]
