"""Kernels called from Python, from kernels, and from functions that know nothing of them."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray


@compiled
def leaf(values: FloatArray, factor: float) -> float:
    total = 0.0
    for value in values:
        total += factor * value
    return total


@compiled
def middle(values: FloatArray) -> float:
    return leaf(values, 2.0) + leaf(values[1:], 0.1)


@compiled
def top(values: FloatArray) -> float:
    return middle(values) + leaf(values, 3.0)


@compiled
def misfit(values: FloatArray) -> float:
    values[:2] = values[:3]
    return leaf(values, 1.0)


@compiled
def calls_misfit(values: FloatArray) -> float:
    return misfit(values)


VALUES = np.array([0.1, 0.7, 1.3, 2.9])


def test_kernels_agree_with_their_plain_functions() -> None:
    for kernel in (middle, top):
        assert kernel(VALUES) == kernel.py_func(VALUES)  # type: ignore[attr-defined]


def test_kernels_may_be_called_from_any_compiled_function() -> None:
    @numba.njit
    def outside(values: FloatArray) -> float:
        return float(top(values) + leaf(values, 1.0))

    assert outside(VALUES) == top(VALUES) + leaf(VALUES, 1.0)


def test_errors_come_out_of_inner_kernels() -> None:
    with pytest.raises(ValueError, match="cannot assign slice"):
        calls_misfit(VALUES.copy())


def test_a_kernel_keeps_its_name_and_its_words() -> None:
    assert leaf.__name__ == "leaf"
    assert compiled(test_a_kernel_keeps_its_name_and_its_words).__module__ == __name__
