"""Values on the command line: each type reads a text, or says what is allowed in its place."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from physim.drawing.printed import WIDTHS, printed_width
from physim.escaping import escaped

LONGEST_QUOTE = 60
"""Characters of what was given that an error repeats."""
LARGEST_NUMBER = 10**15


def quoted(text: str) -> str:
    """What was given, in quotes where it would not be seen as one word."""
    text = escaped(text[: LONGEST_QUOTE + 1])
    text = text if len(text) <= LONGEST_QUOTE else text[: LONGEST_QUOTE - 1] + "…"
    return text if text and re.fullmatch(r"[^\s\"']+", text) else f'"{text}"'


class Value(click.ParamType[Any]):
    """Type of an option whose value a function reads.

    The function raises ValueError with what is allowed, e.g. ``a number greater than 0``.
    """

    name = "value"

    def __init__(self, read: Callable[[str], Any]) -> None:
        self.read = read

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Read a value; a default that is no text stays as it is."""
        if not isinstance(value, str):
            return value
        try:
            return self.read(value)
        except ValueError as error:
            self.fail(f"{quoted(value)}: must be {error}", param, ctx)


class OneOf(click.Choice[str]):
    """Type of an option that takes one of several words."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the word, or name all that are allowed and the nearest one."""
        if value not in self.choices:
            self.fail(not_among(value, list(self.choices)), param, ctx)
        return str(value)


def not_among(given: str, allowed: list[str]) -> str:
    """``GIVEN: must be one of ALLOWED``, and the nearest one."""
    from physim.errors import nearest

    close = nearest(given[:LONGEST_QUOTE], allowed)
    return f"{quoted(given)}: must be one of {', '.join(allowed)}{close}"


def whole_from(least: int, most: int, allowed: str = "", step: int = 1) -> Value:
    """Type of whole numbers between two bounds, both allowed, every ``step`` of them from 0 on."""

    def read(text: str) -> int:
        value = int(text) if text.isascii() and text.isdigit() and len(text) < 19 else -1
        if not least <= value <= most or value % step:
            raise ValueError(allowed or f"a whole number from {least} to {most}")
        return value

    return Value(read)


def number_from(least: float, most: float = sys.float_info.max, allowed: str = "") -> Value:
    """Type of numbers between two bounds, both allowed."""

    def read(text: str) -> float:
        value = _number(text)
        if not least <= value <= most:
            raise ValueError(allowed or f"a number from {least:.15g} to {most:.15g}")
        return value

    return Value(read)


WHOLE = whole_from(0, LARGEST_NUMBER, "a whole number from 0 to 10^15")
COUNT = whole_from(1, 10_000)
POSITIVE = number_from(math.nextafter(0.0, 1.0), allowed="a number greater than 0")
DISTANCE = number_from(0.0, allowed="a number of 0 or more")


def print_width(text: str) -> float:
    """Read a width in print [in]. Raises ValueError with what is allowed."""
    return printed_width(text if text in WIDTHS else _number(text))


PRINTED = Value(print_width)


def seed_range(text: str) -> tuple[int, int]:
    """Read seeds A:B, half-open. Raises ValueError with what is allowed."""
    first, _, last = text.partition(":")
    try:
        ends = (WHOLE.read(first), WHOLE.read(last))
    except ValueError:
        raise ValueError("A:B, two whole numbers from 0 to 10^15, as 1:101") from None
    if ends[1] <= ends[0]:
        raise ValueError("A:B with A below B: it goes from A to B - 1")
    return ends


def pair(text: str) -> tuple[float, float]:
    """Read X,Y, two finite numbers. Raises ValueError with what is allowed."""
    x, y = _numbers(text)
    if not (abs(x) <= LARGEST_NUMBER and abs(y) <= LARGEST_NUMBER):
        raise ValueError("X,Y, two numbers [m], as 14.5,-3")
    return x, y


def size(text: str) -> tuple[float, float] | str:
    """Read LENGTH,WIDTH, two numbers greater than 0, or fit. Raises ValueError with the allowed."""
    if text == "fit":
        return text
    length, width = _numbers(text)
    if not (0.0 < length <= 1000.0 and 0.0 < width <= 1000.0):
        raise ValueError("LENGTH,WIDTH, two numbers above 0, at most 1000 [m], as 1.8,1.0, or fit")
    return length, width


def _numbers(text: str) -> tuple[float, float]:
    first, _, last = text.partition(",")
    return _number(first), _number(last)


def _number(text: str) -> float:
    """Number in plain digits, or NaN, which no bounds hold."""
    try:
        return float(text) if text.isascii() and "_" not in text else math.nan
    except ValueError:
        return math.nan


def _path(text: str) -> Path:
    if not text:  # Python's would be the working folder; mostly it is a variable that is not set
        raise ValueError("the name of a file or folder")
    if "\n" in text:  # it would end the lines that tell of it, and begin some of its own
        raise ValueError("the name of a file or folder in one line")
    return Path(text)


PATH = Value(_path)


def record_file(text: str) -> Path:
    """File of a record that is named by itself or by the folder of its run."""
    path = _path(text)
    return path / "record.h5" if path.is_dir() else path


RECORD = Value(record_file)
RECORD_HELP = "a run: its folder or its record.h5"
WORLD_HELP = (
    "a world file; the name of a shipped world, or of one in worlds/; or the record.h5 of a run, "
    "whose world is taken"
)
