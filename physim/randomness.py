"""Randomness that only the seed decides: streams for what is drawn once, noise for a run.

Starts and whatever else is drawn once come from a stream keyed by seed, purpose and robot. Noise in
a run is a pure function of seed, purpose, step and two indices: no generator has a state that would
have to be kept, and one robot, neighbour or disturbance more shifts no other draw. It is the
counter-based generator Philox4x64 with ten rounds (Salmon, Moraes, Dror and Shaw: Parallel random
numbers: as easy as 1, 2, 3; 2011), which numpy has too.
"""

from __future__ import annotations

import hashlib
from functools import cache
from math import cos, log, pi, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, Rows4
from physim.natives import high_product

Word = np.uint64
Words = NDArray[np.uint64]

ROUNDS = 10
MULTIPLIERS = 0xD2E7470EE14C6C93, 0xCA5A826395121157
WEYL = 0x9E3779B97F4A7C15, 0xBB67AE8584CAA73B
"""Constants of Philox4x64."""


def stream(seed: int, purpose: str, robot: int) -> np.random.Generator:
    """Generator of the stream (seed, purpose, robot index); equal on every machine."""
    return np.random.Generator(
        np.random.PCG64(np.random.SeedSequence([seed, purpose_key(purpose), robot]))
    )


@cache
def purpose_key(purpose: str) -> int:
    """64-bit key of a purpose."""
    return int.from_bytes(hashlib.sha256(purpose.encode()).digest()[:8], "little")


def normal(
    seed: int, purpose: str, step: int, i: ArrayLike = 0, j: ArrayLike = 0, width: int = 1
) -> FloatArray:
    """Standard normal numbers that depend on these arguments alone.

    ``i`` and ``j``, at least 0, are whatever tells draws of one step apart, such as an observer
    and whom it sees; of shape S together they give S + (width,) numbers, width 1 to 4, which are
    independent of one another.
    """
    return _drawn(seed, purpose, step, i, j, width, True)


def uniform(
    seed: int, purpose: str, step: int, i: ArrayLike = 0, j: ArrayLike = 0, width: int = 1
) -> FloatArray:
    """As `normal`, evenly between 0 and 1 (1 left out)."""
    return _drawn(seed, purpose, step, i, j, width, False)


def _drawn(
    seed: int, purpose: str, step: int, i: ArrayLike, j: ArrayLike, width: int, is_normal: bool
) -> FloatArray:
    first, second = np.broadcast_arrays(np.asarray(i), np.asarray(j))
    if not 1 <= width <= 4:
        raise ValueError(f"width = {width}; allowed: 1 to 4")
    if min(seed, step, int(first.min(initial=0)), int(second.min(initial=0))) < 0:
        raise ValueError("seed, step, i and j must be at least 0")
    out = np.empty((first.size, 4), dtype=np.float64)
    key = np.array([seed, purpose_key(purpose)], dtype=np.uint64)
    draw(key, np.uint64(step), words(first), words(second), first.size, is_normal, out)
    return out[:, :width].reshape(*first.shape, width)


def words(values: ArrayLike) -> Words:
    """Flat 64-bit words of indices."""
    return np.ascontiguousarray(np.ravel(values), dtype=np.uint64)


@compiled
def philox(key0: Word, key1: Word, c0: Word, c1: Word, c2: Word, c3: Word, out: Words) -> None:
    """Write four 64-bit words of the counter (c0 … c3) under the key into ``out`` (4,)."""
    m0, m1 = np.uint64(MULTIPLIERS[0]), np.uint64(MULTIPLIERS[1])
    for _ in range(ROUNDS):
        high0, low0 = high_product(m0, c0), m0 * c0
        high1, low1 = high_product(m1, c2), m1 * c2
        c0, c1, c2, c3 = high1 ^ c1 ^ key0, low1, high0 ^ c3 ^ key1, low0
        key0 += np.uint64(WEYL[0])
        key1 += np.uint64(WEYL[1])
    out[0], out[1], out[2], out[3] = c0, c1, c2, c3


@compiled
def share(word: Word) -> float:
    """Number of [0, 1) from the upper 53 bits of a word."""
    return float(word >> np.uint64(11)) * 2.0**-53


@compiled
def draw(
    key: Words,
    step: Word,
    first: Words,
    second: Words,
    many: int,
    is_normal: bool,
    out: Rows4,
) -> None:
    """Four numbers for each pair of indices into ``out`` (M, 4)."""
    found = np.empty(4, np.uint64)
    for k in range(many):
        if is_normal:
            draw_normal(key, step, first[k], second[k], 2, out[k])
        else:
            philox(key[0], key[1], step, first[k], second[k], np.uint64(0), found)
            for m in range(4):
                out[k, m] = share(found[m])


@compiled
def draw_normal(
    key: Words, step: Word, first: Word, second: Word, pairs: int, out: FloatArray
) -> None:
    """Write the first two or four normal numbers of a pair of indices, by Box and Muller."""
    found = np.empty(4, np.uint64)
    philox(key[0], key[1], step, first, second, np.uint64(0), found)
    for m in range(pairs):
        radius = sqrt(-2.0 * log(1.0 - share(found[2 * m])))
        angle = 2.0 * pi * share(found[2 * m + 1])
        out[2 * m], out[2 * m + 1] = radius * cos(angle), radius * sin(angle)
