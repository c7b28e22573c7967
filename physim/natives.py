"""What kernels call that is no Python in what is compiled: memory and functions by their addresses,
and wide products.

The names stand here for the plain kernels; `physim.joining` has them in C.
"""

from __future__ import annotations

import ctypes

import numpy as np

from physim.geometry.shapes import FloatArray, IntArray, IntRows2, Rows2


def _call(function: int, *arguments: int) -> None:
    kind = ctypes.CFUNCTYPE(None, *[ctypes.c_int64] * len(arguments))
    kind(int(function))(*map(int, arguments))


call2 = call3 = _call
"""(function, argument, …): call a C function that takes whole numbers and addresses"""


def doubles_at(address: int, count: int) -> FloatArray:
    """So many numbers that lie at an address."""
    return np.ctypeslib.as_array((ctypes.c_double * int(count)).from_address(int(address)))


def rows2_at(address: int, count: int) -> Rows2:
    """So many rows of two numbers that lie at an address."""
    return doubles_at(address, 2 * count).reshape(-1, 2)


def integers_at(address: int, count: int) -> IntArray:
    """So many whole numbers of 64 bits that lie at an address."""
    return np.ctypeslib.as_array((ctypes.c_int64 * int(count)).from_address(int(address)))


def int_rows2_at(address: int, count: int) -> IntRows2:
    """So many rows of two whole numbers that lie at an address."""
    return integers_at(address, 2 * count).reshape(-1, 2)


def put_short(address: int, value: int) -> None:
    """Write a whole number of 32 bits to an address."""
    ctypes.c_int32.from_address(int(address)).value = int(value)


def high_product(a: np.uint64, b: np.uint64) -> np.uint64:
    """Upper 64 bits of the product of two words of 64 bits."""
    return np.uint64((int(a) * int(b)) >> 64)
