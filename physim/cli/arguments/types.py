"""Types of arguments: each returns the value, or says what is allowed."""

from __future__ import annotations

import argparse

LARGEST_NUMBER = 10**15


def whole(text: str) -> int:
    """Read a whole number from 0 to 10^15."""
    value = int(text) if text.isascii() and text.isdigit() and len(text) < 19 else -1
    if not 0 <= value <= LARGEST_NUMBER:
        raise argparse.ArgumentTypeError(f'"{text}" is not a whole number from 0 to 10^15')
    return value


def seed_range(text: str) -> tuple[int, int]:
    """Read seeds A:B, half-open."""
    first, colon, last = text.partition(":")
    if not colon or not first or not last:
        raise argparse.ArgumentTypeError(f'"{text}" is not A:B, two whole numbers')
    ends = (whole(first), whole(last))
    if ends[1] <= ends[0]:
        message = f'"{text}" holds no seed: A:B goes from A to B - 1'
        raise argparse.ArgumentTypeError(message)
    return ends


def positive(text: str) -> float:
    """Read a number greater than 0."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f'"{text}" is not a number greater than 0')
    return value


def distance(text: str) -> float:
    """Read a number of 0 or more."""
    return 0.0 if text.strip() in ("0", "0.0") else positive(text)


def count(text: str) -> int:
    """Read a whole number from 1 to 10 000."""
    value = int(text) if text.isascii() and text.isdigit() and len(text) < 6 else 0
    if not 1 <= value <= 10_000:
        raise argparse.ArgumentTypeError(f'"{text}" is not a whole number from 1 to 10000')
    return value


def pair(text: str) -> tuple[float, float]:
    """Read X,Y, two finite numbers."""
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        x = y = float("nan")
    if not (abs(x) <= LARGEST_NUMBER and abs(y) <= LARGEST_NUMBER):
        raise argparse.ArgumentTypeError(f'"{text}" is not X,Y, two numbers')
    return x, y


def size(text: str) -> tuple[float, float]:
    """Read LENGTH,WIDTH, two numbers greater than 0."""
    length, width = pair(text)
    if not (0.0 < length <= 1000.0 and 0.0 < width <= 1000.0):
        raise argparse.ArgumentTypeError(f'"{text}" is not LENGTH,WIDTH from 0 to 1000 m')
    return length, width
