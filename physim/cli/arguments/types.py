"""Types of arguments: each returns the value, or says ``GIVEN: must be ALLOWED``."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from physim.cli.mistakes import shown

LARGEST_NUMBER = 10**15


def refused(text: str, allowed: str) -> argparse.ArgumentTypeError:
    """Error of a value; the parser puts its option before it."""
    return argparse.ArgumentTypeError(f"{shown(text)}: must be {allowed}")


def whole(text: str) -> int:
    """Read a whole number from 0 to 10^15."""
    value = int(text) if text.isascii() and text.isdigit() and len(text) < 19 else -1
    if not 0 <= value <= LARGEST_NUMBER:
        raise refused(text, "a whole number from 0 to 10^15")
    return value


def whole_from(least: int, most: int) -> Callable[[str], int]:
    """Type of whole numbers between two bounds, both allowed."""

    def read(text: str) -> int:
        value = int(text) if text.isascii() and text.isdigit() and len(text) < 19 else -1
        if not least <= value <= most:
            raise refused(text, f"a whole number from {least} to {most}")
        return value

    return read


def number_from(least: float, most: float) -> Callable[[str], float]:
    """Type of numbers between two bounds, both allowed."""

    def read(text: str) -> float:
        value = _number(text)
        if not least <= value <= most:
            raise refused(text, f"a number from {least:.15g} to {most:.15g}")
        return value

    return read


def seed_range(text: str) -> tuple[int, int]:
    """Read seeds A:B, half-open."""
    first, _, last = text.partition(":")
    try:
        ends = (whole(first), whole(last))
    except argparse.ArgumentTypeError:
        raise refused(text, "A:B, two whole numbers from 0 to 10^15, as 1:101") from None
    if ends[1] <= ends[0]:
        raise refused(text, "A:B with A below B: it goes from A to B - 1")
    return ends


def positive(text: str) -> float:
    """Read a number greater than 0."""
    value = _number(text)
    if not 0.0 < value < float("inf"):
        raise refused(text, "a number greater than 0")
    return value


def distance(text: str) -> float:
    """Read a number of 0 or more."""
    value = _number(text)
    if not 0.0 <= value < float("inf"):
        raise refused(text, "a number of 0 or more")
    return value


def count(text: str) -> int:
    """Read a whole number from 1 to 10 000."""
    return whole_from(1, 10_000)(text)


def pair(text: str) -> tuple[float, float]:
    """Read X,Y, two finite numbers."""
    ends = _pair(text)
    if not all(abs(value) <= LARGEST_NUMBER for value in ends):
        raise refused(text, "X,Y, two numbers [m], as 14.5,-3")
    return ends


def size(text: str) -> tuple[float, float]:
    """Read LENGTH,WIDTH, two numbers greater than 0."""
    length, width = _pair(text)
    if not (0.0 < length <= 1000.0 and 0.0 < width <= 1000.0):
        raise refused(text, "LENGTH,WIDTH, two numbers above 0, at most 1000 [m], as 1.8,1.0")
    return length, width


def _pair(text: str) -> tuple[float, float]:
    first, _, last = text.partition(",")
    return _number(first), _number(last)


def _number(text: str) -> float:
    """Number, or NaN, which no bounds hold."""
    try:
        return float(text)
    except ValueError:
        return float("nan")
